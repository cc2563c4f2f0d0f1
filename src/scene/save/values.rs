//! Keys of the scene file with their values, taken from a scene, and how they are
//! written.

use glam::{DVec3, Vec3};

use super::editor::Written;
use super::numbers;
use crate::scene::{Bounces, Camera, LightKind, Radiance, Reflection, RenderKeys, Tone};

/// A value of the scene file.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    Vector(DVec3),
    Colour(Vec3),
    /// A unit vector, which the reader normalises again.
    Direction(Vec3),
    Up(DVec3),
    Single(f32),
    Double(f64),
    Text(String),
    Size([u32; 2]),
}

/// Keys with their values.
pub(super) type Keys = Vec<(&'static str, Value)>;

/// Whether any bit of two lights differs.
pub(super) fn differ(a: &LightKind, b: &LightKind) -> bool {
    kind_name(a) != kind_name(b) || !changed(light_keys(a), light_keys(b)).is_empty()
}

/// Whether any bit of two cameras differs.
pub(super) fn cameras_differ(a: &Camera, b: &Camera) -> bool {
    !changed(camera_keys(a), camera_keys(b)).is_empty()
}

/// `kind` of a light.
pub(super) fn kind_name(kind: &LightKind) -> &'static str {
    match kind {
        LightKind::Point(_) => "point",
        LightKind::Spot(_) => "spot",
        LightKind::Directional(_) => "directional",
        LightKind::Area(_) => "area",
        LightKind::Environment(_) => "environment",
    }
}

/// The keys of a light besides `name` and `kind`.
pub(super) fn light_keys(kind: &LightKind) -> Keys {
    match kind {
        LightKind::Point(light) => vec![
            ("position", Value::Vector(light.position)),
            ("intensity", Value::Colour(light.intensity)),
        ],
        LightKind::Spot(light) => vec![
            ("position", Value::Vector(light.position)),
            ("direction", Value::Direction(light.direction)),
            ("intensity", Value::Colour(light.intensity)),
            ("cutoff", Value::Single(light.cutoff_deg)),
            ("beam", Value::Single(light.beam_deg)),
        ],
        LightKind::Directional(light) => vec![
            ("direction", Value::Direction(light.direction)),
            ("irradiance", Value::Colour(light.irradiance)),
        ],
        LightKind::Area(light) => vec![
            ("corner", Value::Vector(light.corner)),
            ("edge_u", Value::Vector(light.edge_u)),
            ("edge_v", Value::Vector(light.edge_v)),
            ("radiance", Value::Colour(light.radiance)),
        ],
        LightKind::Environment(light) => {
            let mut keys = vec![
                ("scale", Value::Single(light.scale)),
                ("rotation", Value::Single(light.rotation_deg)),
            ];
            // A map stays the map that the file names.
            if let Radiance::Constant(radiance) = light.radiance {
                keys.insert(0, ("radiance", Value::Colour(radiance)));
            }
            keys
        }
    }
}

/// The keys of a `[[material]]` that are edited.
pub(super) fn reflection_keys(reflection: Reflection) -> Keys {
    vec![
        ("albedo", Value::Colour(reflection.albedo)),
        ("specular", Value::Colour(reflection.specular)),
        ("roughness", Value::Single(reflection.roughness)),
    ]
}

/// The keys of `[camera]`.
pub(super) fn camera_keys(camera: &Camera) -> Keys {
    vec![
        ("position", Value::Vector(camera.position)),
        ("target", Value::Vector(camera.target)),
        ("up", Value::Up(camera.up)),
        ("vfov", Value::Double(camera.vfov_deg)),
        ("size", Value::Size(camera.size)),
    ]
}

/// The keys of `[render]`.
pub(super) fn render_keys(keys: &RenderKeys) -> Keys {
    let bounces = match keys.bounces {
        Bounces::Count(count) => count.to_string(),
        Bounces::All => quoted("all"),
    };
    let tone = match keys.tone {
        Tone::Srgb => "srgb",
        Tone::Filmic => "filmic",
    };
    vec![
        ("bounces", Value::Text(bounces)),
        ("exposure", Value::Single(keys.exposure)),
        ("tone", Value::Text(quoted(tone))),
        ("light_samples", Value::Text(keys.light_samples.to_string())),
    ]
}

/// The second keys whose values differ from the first ones.
pub(super) fn changed(old: Keys, new: Keys) -> Keys {
    let is_old = |key: &(&str, Value)| {
        let mut known = old.iter();
        known.any(|old| old.0 == key.0 && same(&old.1, &key.1))
    };
    new.into_iter().filter(|key| !is_old(key)).collect()
}

/// Whether two values have the same bits.
pub(super) fn same(a: &Value, b: &Value) -> bool {
    let doubles = |v: &DVec3| v.to_array().map(f64::to_bits);
    let singles = |v: &Vec3| v.to_array().map(f32::to_bits);
    match (a, b) {
        (Value::Vector(a), Value::Vector(b)) | (Value::Up(a), Value::Up(b)) => {
            doubles(a) == doubles(b)
        }
        (Value::Colour(a), Value::Colour(b)) | (Value::Direction(a), Value::Direction(b)) => {
            singles(a) == singles(b)
        }
        (Value::Single(a), Value::Single(b)) => a.to_bits() == b.to_bits(),
        (Value::Double(a), Value::Double(b)) => a.to_bits() == b.to_bits(),
        (a, b) => a == b,
    }
}

/// A value as it is to be written.
pub(super) fn written(value: &Value) -> Written {
    match value {
        Value::Vector(vector) => numbers::vector(*vector).into(),
        Value::Colour(colour) => numbers::colour(*colour).into(),
        Value::Direction(direction) => numbers::direction(*direction).into(),
        Value::Up(up) => numbers::unit_direction(*up).into(),
        Value::Single(number) => Written::Plain(numbers::single(*number)),
        Value::Double(number) => Written::Plain(numbers::double(*number)),
        Value::Text(text) => Written::Plain(text.clone()),
        Value::Size(size) => size.map(|side| side.to_string()).into(),
    }
}

/// A string of TOML.
pub(super) fn quoted(text: &str) -> String {
    toml_edit::Value::from(text).to_string()
}
