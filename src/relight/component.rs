//! What a frame shows: a new component is one line here and in [`shown`].

use std::fmt;
use std::str::FromStr;

use glam::Vec3;
use thiserror::Error;

/// A component of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Component {
    /// Direct, indirect and glossy light: radiance.
    #[default]
    Global,
    /// Direct light alone, radiance with albedo.
    Direct,
    /// Indirect light of bounces 1 to N alone, radiance with albedo.
    Indirect,
    /// The final glossy bounce alone: light of the sky and of bounces by the
    /// materials' lobes, radiance.
    Glossy,
    /// Direct and indirect irradiance, without albedo.
    Irradiance,
    /// Diffuse albedo.
    Albedo,
    /// World shading normal.
    Normal,
    /// Distance along the view axis, scene units; 0 where nothing is seen.
    Depth,
    /// Direct light as the bounces are given it: S S^T B, the radiosity B at the
    /// vertices after projection on the basis, radiance with albedo.
    ApproximatedDirect,
    /// The partitions of the basis, each in a flat colour of its own.
    Partitions,
    /// One function of the basis over its largest magnitude: red is positive,
    /// blue negative, white zero, grey outside of the function's partition.
    Basis(BasisFunction),
}

/// All components by their names on the command line, but for
/// [`Component::Basis`], whose name holds a number: see [`Component::from_str`].
pub const COMPONENTS: [(&str, Component); 10] = [
    ("global", Component::Global),
    ("direct", Component::Direct),
    ("indirect", Component::Indirect),
    ("glossy", Component::Glossy),
    ("irradiance", Component::Irradiance),
    ("albedo", Component::Albedo),
    ("normal", Component::Normal),
    ("depth", Component::Depth),
    ("approximated-direct", Component::ApproximatedDirect),
    ("partitions", Component::Partitions),
];

/// A function of the spectral basis; all numbers count from 0. The functions of
/// partition 0 come first, those of a partition by rising frequency.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BasisFunction {
    /// By its number in the whole basis.
    InAll(u32),
    /// By its partition and its number there.
    InPartition {
        /// Number of the partition.
        partition: u32,
        /// Number of the function among the partition's.
        function: u32,
    },
}

impl fmt::Display for BasisFunction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InAll(function) => write!(f, "basis:{function}"),
            Self::InPartition {
                partition,
                function,
            } => write!(f, "basis:{partition}.{function}"),
        }
    }
}

impl fmt::Display for Component {
    /// The name on the command line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Basis(function) => function.fmt(f),
            plain => {
                let found = COMPONENTS.iter().find(|(_, known)| known == plain);
                f.write_str(found.map_or("", |(name, _)| name))
            }
        }
    }
}

/// The name of a component means none.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum ComponentError {
    /// No component has this name.
    #[error("components are {}, basis:K and basis:P.K", names())]
    UnknownName,
    /// What follows `basis:` is no number.
    #[error(
        "`basis:` takes the number of a function, as in basis:0, \
         or those of a partition and of a function in it, as in basis:3.0"
    )]
    NoFunction,
}

fn names() -> String {
    COMPONENTS.map(|(name, _)| name).join(", ")
}

impl FromStr for Component {
    type Err = ComponentError;

    /// The component of a name on the command line: one of [`COMPONENTS`],
    /// `basis:K` or `basis:P.K`.
    fn from_str(name: &str) -> Result<Self, ComponentError> {
        if let Some(function) = name.strip_prefix("basis:") {
            return basis_function(function)
                .map(Self::Basis)
                .ok_or(ComponentError::NoFunction);
        }
        let found = COMPONENTS.iter().find(|(known, _)| *known == name);
        match found {
            Some(&(_, component)) => Ok(component),
            None if name == "basis" => Err(ComponentError::NoFunction),
            None => Err(ComponentError::UnknownName),
        }
    }
}

/// `K` or `P.K`.
fn basis_function(text: &str) -> Option<BasisFunction> {
    let number = |digits: &str| {
        let is_plain = digits.bytes().all(|byte| byte.is_ascii_digit());
        digits.parse::<u32>().ok().filter(|_| is_plain)
    };
    match text.split_once('.') {
        None => number(text).map(BasisFunction::InAll),
        Some((partition, function)) => Some(BasisFunction::InPartition {
            partition: number(partition)?,
            function: number(function)?,
        }),
    }
}

/// What shading knows of one piece of surface in a pixel.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Shaded {
    /// Direct irradiance, W/m2.
    pub(super) direct: Vec3,
    /// Indirect irradiance, W/m2, not negative.
    pub(super) indirect: Vec3,
    /// Radiosity by direct light as the basis has it, W/m2, not negative.
    pub(super) approximated: Vec3,
    /// Emitted radiance, W/(m2 sr).
    pub(super) emission: Vec3,
    pub(super) albedo: Vec3,
    /// Albedo of the diffuse part, for the viewer: Kd less what the lobe takes.
    pub(super) diffuse: Vec3,
    /// Direct light by the glossy lobe, W/(m2 sr).
    pub(super) reflected: Vec3,
    /// Bounced light by the glossy lobe, W/(m2 sr), not negative.
    pub(super) glossy: Vec3,
    /// Unit shading normal.
    pub(super) normal: Vec3,
    /// Scene units.
    pub(super) depth: f32,
    /// What is shown of the basis itself, a linear colour.
    pub(super) basis: Vec3,
}

/// The value of a component; radiance is irradiance x albedo / pi, and what is
/// emitted counts as direct light.
pub(super) fn shown(component: Component, s: &Shaded) -> Vec3 {
    let diffuse = s.diffuse * std::f32::consts::FRAC_1_PI;
    let direct = s.emission + diffuse * s.direct + s.reflected;
    match component {
        Component::Global => direct + diffuse * s.indirect + s.glossy,
        Component::Direct => direct,
        Component::Indirect => diffuse * s.indirect,
        Component::Glossy => s.glossy,
        Component::Irradiance => s.direct + s.indirect,
        Component::Albedo => s.albedo,
        Component::Normal => s.normal,
        Component::Depth => Vec3::splat(s.depth),
        Component::ApproximatedDirect => s.emission + s.approximated * std::f32::consts::FRAC_1_PI,
        Component::Partitions | Component::Basis(_) => s.basis,
    }
}

impl Component {
    /// Whether it is light, which exposure and tone curve apply to.
    pub fn is_light(self) -> bool {
        match self {
            Self::Global | Self::Direct | Self::Indirect | Self::Glossy => true,
            Self::Irradiance | Self::ApproximatedDirect => true,
            Self::Albedo | Self::Normal | Self::Depth => false,
            Self::Partitions | Self::Basis(_) => false,
        }
    }

    /// Whether it shows what emits light.
    pub(super) fn shows_emission(self) -> bool {
        matches!(self, Self::Global | Self::Direct | Self::ApproximatedDirect)
    }

    /// Whether it needs direct light at pixels.
    pub(super) fn needs_direct(self) -> bool {
        matches!(self, Self::Global | Self::Direct | Self::Irradiance)
    }

    /// Whether it needs bounced light.
    pub fn needs_indirect(self) -> bool {
        matches!(self, Self::Global | Self::Indirect | Self::Irradiance)
    }

    /// Whether it shows the final glossy bounce.
    pub(super) fn needs_glossy(self) -> bool {
        matches!(self, Self::Global | Self::Glossy)
    }

    /// Whether it shows the basis, or light by it.
    pub(super) fn needs_basis(self) -> bool {
        matches!(
            self,
            Self::ApproximatedDirect | Self::Partitions | Self::Basis(_)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_and_other_words_are_not() {
        for (name, component) in COMPONENTS {
            assert_eq!(name.parse(), Ok(component));
            assert_eq!(component.to_string(), name);
        }
        let in_all = BasisFunction::InAll(17);
        let in_partition = BasisFunction::InPartition {
            partition: 3,
            function: 0,
        };
        for function in [in_all, in_partition] {
            let name = function.to_string();
            assert_eq!(name.parse(), Ok(Component::Basis(function)), "{name}");
        }
        for name in [
            "basis",
            "basis:",
            "basis:x",
            "basis:-1",
            "basis:+1",
            "basis:1.",
            "basis:.1",
            "basis:1.2.3",
            "basis:4294967296",
        ] {
            let read = name.parse::<Component>();
            assert_eq!(read, Err(ComponentError::NoFunction), "{name}");
        }
        let read = "base:1".parse::<Component>();
        assert_eq!(read, Err(ComponentError::UnknownName));
    }
}
