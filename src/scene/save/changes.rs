//! What differs between a scene as it was loaded and as it was edited, key by key.

use glam::DVec3;

use super::editor::{Editor, Written};
use super::layout::Place;
use super::values::{
    Keys, Value, camera_keys, changed, kind_name, light_keys, quoted, render_keys, same, written,
};
use super::{Edited, SaveError, numbers};
use crate::scene::file::default_light_name;
use crate::scene::{Light, LightKind, Spot};

/// All that is to be written.
pub(super) struct Changes<'a> {
    loaded: Edited<'a>,
    edited: Edited<'a>,
    /// Of each edited light, in order, the light of the file that it was.
    origins: Vec<Option<usize>>,
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
        let keys = changed(
            camera_keys(self.loaded.camera),
            camera_keys(self.edited.camera),
        );
        set_all(editor, Place::Section("camera"), &keys)?;
        self.lights(editor)?;
        self.materials(editor)?;
        let keys = changed(
            render_keys(self.loaded.render),
            render_keys(self.edited.render),
        );
        set_all(editor, Place::Section("render"), &keys)
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
                None => insert_light(editor, index, light)?,
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

/// Of each edited light the loaded one that it was: the one of its name and kind.
/// Where the order is another, the longest run of lights in the order of the file
/// keeps its entries, and the others are written anew between them.
fn origins(loaded: &[Light], edited: &[Light]) -> Vec<Option<usize>> {
    let origin = |light: &Light| {
        loaded.iter().position(|known| {
            known.name == light.name && kind_name(&known.kind) == kind_name(&light.kind)
        })
    };
    let mut origins: Vec<Option<usize>> = edited.iter().map(origin).collect();
    // For each light, the longest rising run that ends there and the light before.
    let mut runs: Vec<(usize, Option<usize>)> = vec![(0, None); origins.len()];
    for index in 0..origins.len() {
        let Some(own) = origins[index] else {
            continue;
        };
        let before = (0..index).filter(|&i| origins[i].is_some_and(|other| other < own));
        let best = before.max_by_key(|&i| runs[i].0);
        runs[index] = (1 + best.map_or(0, |best| runs[best].0), best);
    }
    let mut kept = vec![false; origins.len()];
    let mut last = (0..runs.len()).max_by_key(|&index| runs[index].0);
    while let Some(index) = last {
        kept[index] = true;
        last = runs[index].1;
    }
    for (origin, kept) in origins.iter_mut().zip(kept) {
        *origin = origin.filter(|_| kept);
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
    spot: &Spot,
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
    spot: &Spot,
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

fn insert_light(editor: &mut Editor, index: usize, light: &Light) -> Result<(), SaveError> {
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
    editor.insert_entry("light", index, &keys)
}

fn set_all(editor: &mut Editor, place: Place, keys: &Keys) -> Result<(), SaveError> {
    for (key, value) in keys {
        editor.set(place, key, &written(value))?;
    }
    Ok(())
}
