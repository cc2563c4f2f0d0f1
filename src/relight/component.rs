//! What a frame shows: a new component is one line here and in [`shown`].

use glam::Vec3;

/// A component of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Component {
    /// Direct and indirect light: radiance.
    #[default]
    Global,
    /// Direct light alone, radiance with albedo.
    Direct,
    /// Indirect light of bounces 1 to N alone, radiance with albedo.
    Indirect,
    /// Direct and indirect irradiance, without albedo.
    Irradiance,
    /// Diffuse albedo.
    Albedo,
    /// World shading normal.
    Normal,
    /// Distance along the view axis, scene units; 0 where nothing is seen.
    Depth,
}

/// All components by their names on the command line.
pub const COMPONENTS: [(&str, Component); 7] = [
    ("global", Component::Global),
    ("direct", Component::Direct),
    ("indirect", Component::Indirect),
    ("irradiance", Component::Irradiance),
    ("albedo", Component::Albedo),
    ("normal", Component::Normal),
    ("depth", Component::Depth),
];

/// What shading knows of one piece of surface in a pixel.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Shaded {
    /// Direct irradiance, W/m2.
    pub(super) direct: Vec3,
    /// Indirect irradiance, W/m2, not negative.
    pub(super) indirect: Vec3,
    /// Emitted radiance, W/(m2 sr).
    pub(super) emission: Vec3,
    pub(super) albedo: Vec3,
    /// Unit shading normal.
    pub(super) normal: Vec3,
    /// Scene units.
    pub(super) depth: f32,
}

/// The value of a component; radiance is irradiance x albedo / pi, and what is
/// emitted counts as direct light.
pub(super) fn shown(component: Component, s: &Shaded) -> Vec3 {
    let reflected = s.albedo * std::f32::consts::FRAC_1_PI;
    match component {
        Component::Global => s.emission + reflected * s.direct + reflected * s.indirect,
        Component::Direct => s.emission + reflected * s.direct,
        Component::Indirect => reflected * s.indirect,
        Component::Irradiance => s.direct + s.indirect,
        Component::Albedo => s.albedo,
        Component::Normal => s.normal,
        Component::Depth => Vec3::splat(s.depth),
    }
}

impl Component {
    /// Whether it is light, which exposure and tone curve apply to.
    pub fn is_light(self) -> bool {
        !matches!(self, Self::Albedo | Self::Normal | Self::Depth)
    }

    /// Whether it shows what emits light.
    pub(super) fn shows_emission(self) -> bool {
        matches!(self, Self::Global | Self::Direct)
    }

    /// Whether it needs direct light at pixels.
    pub(super) fn needs_direct(self) -> bool {
        matches!(self, Self::Global | Self::Direct | Self::Irradiance)
    }

    /// Whether it needs bounced light.
    pub fn needs_indirect(self) -> bool {
        matches!(self, Self::Global | Self::Indirect | Self::Irradiance)
    }
}
