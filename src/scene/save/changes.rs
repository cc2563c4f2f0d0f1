//! What differs between a scene as it was loaded and as it was edited, key by key.

use glam::{DVec3, Vec3};

use super::editor::{Editor, Written};
use super::layout::Place;
use super::{Edited, SaveError, numbers};
use crate::scene::file::default_light_name;
use crate::scene::{Bounces, Camera, Light, LightKind, Radiance, RenderKeys, Tone};

/// A value of the scene file.
#[derive(Debug, Clone, PartialEq)]
enum Value {
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
type Keys = Vec<(&'static str, Value)>;

/// All that is to be written.
pub(super) struct Changes<'a> {
    loaded: Edited<'a>,
    edited: Edited<'a>,
    /// Of each edited light, in order, the light of the file that it was.
    origins: Vec<Option<usize>>,
}

/// Whether any bit of two lights differs.
pub(super) fn differ(a: &LightKind, b: &LightKind) -> bool {
    kind_name(a) != kind_name(b) || !changed(light_keys(a), light_keys(b)).is_empty()
}

/// Whether any bit of two cameras differs.
pub(super) fn cameras_differ(a: &Camera, b: &Camera) -> bool {
    !changed(camera_keys(a), camera_keys(b)).is_empty()
}

impl<'a> Changes<'a> {
    pub(super) fn between(loaded: Edited<'a>, edited: Edited<'a>) -> Self {
        Self {
            loaded,
            edited,
            origins: origins(loaded.lights, edited.lights),
        }
    }

    pub(super) fn apply(&self, editor: &mut Editor) -> Result<(), SaveError> {
        self.section(editor, "camera", camera_keys)?;
        self.lights(editor)?;
        self.materials(editor)?;
        let keys = changed(
            render_keys(self.loaded.render),
            render_keys(self.edited.render),
        );
        set_all(editor, Place::Section("render"), &keys)
    }

    fn section(
        &self,
        editor: &mut Editor,
        name: &'static str,
        keys: fn(&Camera) -> Keys,
    ) -> Result<(), SaveError> {
        let keys = changed(keys(self.loaded.camera), keys(self.edited.camera));
        set_all(editor, Place::Section(name), &keys)
    }

    fn lights(&self, editor: &mut Editor) -> Result<(), SaveError> {
        let in_file = editor.list("light")?.entries().len();
        if in_file != self.loaded.lights.len() {
            return Err(SaveError::NotTheText(format!(
                "the scene file has {in_file} lights, but {} were loaded",
                self.loaded.lights.len()
            )));
        }
        for index in (0..in_file).rev() {
            if !self.origins.contains(&Some(index)) {
                editor.remove_entry("light", index)?;
            }
        }
        for (index, (light, origin)) in self.edited.lights.iter().zip(&self.origins).enumerate() {
            match origin {
                Some(origin) => {
                    edit_light(editor, index, &self.loaded.lights[*origin], light)?;
                }
                None => append_light(editor, light)?,
            }
        }
        Ok(())
    }

    fn materials(&self, editor: &mut Editor) -> Result<(), SaveError> {
        let pairs = self.loaded.albedos.iter().zip(self.edited.albedos);
        let mut seen: Vec<&str> = Vec::new();
        for (name, (old, new)) in self.loaded.material_names.iter().zip(pairs) {
            // A second material of a name is the first one without its maps.
            if seen.contains(&name.as_str()) {
                continue;
            }
            seen.push(name);
            let albedo = Value::Colour(*new);
            if same(&Value::Colour(*old), &albedo) {
                continue;
            }
            let list = editor.list("material")?;
            let mut entries = list.entries().iter();
            let known = entries.position(|entry| {
                entry.key("name").and_then(|key| key.string.as_deref()) == Some(name)
            });
            match known {
                Some(index) => {
                    editor.set(Place::Entry("material", index), "albedo", &written(&albedo))?;
                }
                None => editor.append_entry(
                    "material",
                    &[("name", quoted(name)), ("albedo", written(&albedo).text())],
                )?,
            }
        }
        Ok(())
    }
}

/// Lights keep their order, and new ones stand behind: so an edited light is the
/// next loaded one of its name and kind, until one is new.
fn origins(loaded: &[Light], edited: &[Light]) -> Vec<Option<usize>> {
    let mut next = 0;
    let mut origins = Vec::with_capacity(edited.len());
    for light in edited {
        let is_it = |known: &Light| {
            known.name == light.name && kind_name(&known.kind) == kind_name(&light.kind)
        };
        let found = loaded[next..].iter().position(is_it);
        let origin = found.map(|ahead| next + ahead);
        next = origin.map_or(loaded.len(), |origin| origin + 1);
        origins.push(origin);
    }
    origins
}

fn edit_light(
    editor: &mut Editor,
    index: usize,
    loaded: &Light,
    edited: &Light,
) -> Result<(), SaveError> {
    let place = Place::Entry("light", index);
    let entry = editor.entry(place)?;
    let has = |key: &str| entry.as_ref().is_some_and(|entry| entry.key(key).is_some());
    if !has("name") && edited.name != default_light_name(index) {
        editor.set_first(place, "name", &quoted(&edited.name))?;
    }
    let mut keys = changed(light_keys(&loaded.kind), light_keys(&edited.kind));
    if keys.is_empty() {
        return Ok(());
    }
    let kind = entry.as_ref().and_then(|entry| entry.key("kind"));
    let kind = kind.and_then(|key| key.string.as_deref());
    if kind != Some(kind_name(&edited.kind)) {
        // An override made another kind of it, which now becomes the file's.
        keys = become_kind(editor, place, &edited.kind)?;
    }
    if let (LightKind::Spot(loaded), LightKind::Spot(spot)) = (&loaded.kind, &edited.kind) {
        complete_cone(editor, place, &mut keys, spot)?;
        if has("target") {
            aim(editor, place, loaded.position, spot)?;
            keys.retain(|(key, _)| *key != "direction");
        }
    }
    if has("map") && keys.iter().any(|(key, _)| *key == "radiance") {
        editor.remove(place, "map")?;
    }
    set_all(editor, place, &keys)
}

/// Gives an entry a kind, takes out the keys that it does not have, and returns
/// those that it has.
fn become_kind(editor: &mut Editor, place: Place, kind: &LightKind) -> Result<Keys, SaveError> {
    let keys = light_keys(kind);
    let present = editor.entry(place)?.map_or(Vec::new(), |entry| entry.keys);
    let foreign = present.iter().map(|key| key.name.as_str()).filter(|name| {
        !["name", "kind", "target", "map"].contains(name)
            && !keys.iter().any(|(known, _)| known == name)
    });
    for name in foreign {
        editor.remove(place, name)?;
    }
    editor.set(place, "kind", &Written::Plain(quoted(kind_name(kind))))?;
    Ok(keys)
}

/// The beam is a share of the cutoff where the file gives none, and at most the
/// cutoff: an angle that did not change is written too where the file, with the
/// one that did, would be read as another cone.
fn complete_cone(
    editor: &Editor,
    place: Place,
    keys: &mut Keys,
    spot: &crate::scene::Spot,
) -> Result<(), SaveError> {
    let changes = |keys: &Keys, name: &str| keys.iter().any(|(key, _)| *key == name);
    let [cutoff, beam] = [spot.cutoff_deg, spot.beam_deg];
    if changes(keys, "cutoff") && !changes(keys, "beam") {
        let in_file = editor.number(place, "beam")?;
        if in_file.is_none_or(|in_file| in_file > f64::from(cutoff)) {
            keys.push(("beam", Value::Single(beam)));
        }
    }
    if changes(keys, "beam") && !changes(keys, "cutoff") {
        let in_file = editor.number(place, "cutoff")?;
        if in_file.is_some_and(|in_file| in_file < f64::from(beam)) {
            keys.push(("cutoff", Value::Single(cutoff)));
        }
    }
    Ok(())
}

/// Moves the `target` of a spot so that the spot, where it is now, looks in its
/// direction; the target stays about as far away as it was.
fn aim(
    editor: &mut Editor,
    place: Place,
    old_position: DVec3,
    spot: &crate::scene::Spot,
) -> Result<(), SaveError> {
    let old_target = editor.numbers(place, "target")?;
    let distance = match old_target.as_slice() {
        &[x, y, z] => (DVec3::new(x, y, z) - old_position).length(),
        _ => 1.0,
    };
    match numbers::target(spot.position, spot.direction, distance) {
        Some(target) => editor.set(place, "target", &target.into()),
        None => {
            let direction = numbers::direction(spot.direction).into();
            editor.rename(place, ["target", "direction"], &direction)
        }
    }
}

fn append_light(editor: &mut Editor, light: &Light) -> Result<(), SaveError> {
    let mut keys = vec![
        ("name", quoted(&light.name)),
        ("kind", quoted(kind_name(&light.kind))),
    ];
    let mut values = light_keys(&light.kind);
    if let LightKind::Environment(sky) = &light.kind {
        // What the reader takes where a key is absent.
        values.retain(|(key, _)| match *key {
            "scale" => sky.scale != 1.0,
            "rotation" => sky.rotation_deg.to_bits() != 0,
            _ => true,
        });
    }
    keys.extend(
        values
            .iter()
            .map(|(key, value)| (*key, written(value).text())),
    );
    editor.append_entry("light", &keys)
}

fn set_all(editor: &mut Editor, place: Place, keys: &Keys) -> Result<(), SaveError> {
    for (key, value) in keys {
        editor.set(place, key, &written(value))?;
    }
    Ok(())
}

fn kind_name(kind: &LightKind) -> &'static str {
    match kind {
        LightKind::Point(_) => "point",
        LightKind::Spot(_) => "spot",
        LightKind::Directional(_) => "directional",
        LightKind::Area(_) => "area",
        LightKind::Environment(_) => "environment",
    }
}

fn light_keys(kind: &LightKind) -> Keys {
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

fn camera_keys(camera: &Camera) -> Keys {
    vec![
        ("position", Value::Vector(camera.position)),
        ("target", Value::Vector(camera.target)),
        ("up", Value::Up(camera.up)),
        ("vfov", Value::Double(camera.vfov_deg)),
        ("size", Value::Size(camera.size)),
    ]
}

fn render_keys(keys: &RenderKeys) -> Keys {
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
fn changed(old: Keys, new: Keys) -> Keys {
    let is_old = |key: &(&str, Value)| {
        let mut known = old.iter();
        known.any(|old| old.0 == key.0 && same(&old.1, &key.1))
    };
    new.into_iter().filter(|key| !is_old(key)).collect()
}

/// Whether two values have the same bits.
fn same(a: &Value, b: &Value) -> bool {
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

fn written(value: &Value) -> Written {
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
fn quoted(text: &str) -> String {
    toml_edit::Value::from(text).to_string()
}
