//! What differs between a scene as it was loaded and as it was edited, key by key.

use super::editor::{Editor, Written};
use super::in_force::InForce;
use super::layout::Place;
use super::values::{
    Keys, camera_keys, changed, kind_name, light_keys, quoted, render_keys, written,
};
use super::{Edited, SaveError, materials, spots};
use crate::scene::file::default_light_name;
use crate::scene::{Light, LightKind, Override, Radiance};

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

    /// Writes them; gives the overrides that still hold then.
    pub(super) fn apply(
        &self,
        editor: &mut Editor,
        overrides: &[Override],
    ) -> Result<Vec<Override>, SaveError> {
        let mut in_force = InForce::new(overrides);
        let cameras = [self.loaded.camera, self.edited.camera].map(camera_keys);
        set_section(editor, &mut in_force, "camera", cameras)?;
        self.lights(editor, &mut in_force)?;
        materials::write(editor, &mut in_force, self.loaded, self.edited)?;
        let renders = [self.loaded.render, self.edited.render].map(render_keys);
        set_section(editor, &mut in_force, "render", renders)?;
        Ok(in_force.into_overrides())
    }

    fn lights(&self, editor: &mut Editor, in_force: &mut InForce) -> Result<(), SaveError> {
        let in_file = editor.list("light")?.entries().len();
        if in_file != self.loaded.lights.len() {
            return Err(SaveError::NotTheText(format!(
                "the scene file has {in_file} lights, but {} were loaded",
                self.loaded.lights.len()
            )));
        }
        for index in (0..in_file).rev() {
            if !self.origins.contains(&Some(index)) {
                in_force.settle_light(&self.loaded.lights[index].name, &[]);
                editor.remove_entry("light", index)?;
            }
        }
        // From the last to the first: what is edited moves nothing that comes
        // before it, so that one parsed text serves for all.
        let kept = self.origins.iter().enumerate();
        let kept = kept.filter_map(|(index, origin)| Some((index, (*origin)?)));
        let kept: Vec<(usize, usize)> = kept.collect();
        for (entry, &(index, origin)) in kept.iter().enumerate().rev() {
            let place = Place::Entry("light", entry);
            let edited = &self.edited.lights[index];
            if index != origin && edited.name == default_light_name(origin) {
                keep_name(editor, place, &edited.name)?;
            }
            edit_light(editor, in_force, place, &self.loaded.lights[origin], edited)?;
        }
        for (index, (light, origin)) in self.edited.lights.iter().zip(&self.origins).enumerate() {
            if origin.is_none() {
                in_force.settle_light(&light.name, &[]);
                insert_light(editor, index, light)?;
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

/// A light whose name was its place among the others keeps it at another place.
fn keep_name(editor: &mut Editor, place: Place, name: &str) -> Result<(), SaveError> {
    let entry = editor.entry(place)?;
    if entry.is_some_and(|entry| entry.key("name").is_none()) {
        editor.set_first(place, "name", &quoted(name))?;
    }
    Ok(())
}

fn edit_light(
    editor: &mut Editor,
    in_force: &mut InForce,
    place: Place,
    loaded: &Light,
    edited: &Light,
) -> Result<(), SaveError> {
    let mut keys = changed(light_keys(&loaded.kind), light_keys(&edited.kind));
    if keys.is_empty() {
        return Ok(());
    }
    let entry = editor.entry(place)?;
    let kind = entry.as_ref().and_then(|entry| entry.key("kind"));
    let kind = kind.and_then(|key| key.string.as_deref());
    if kind != Some(kind_name(&edited.kind)) {
        // An override made another kind of it, which now becomes the file's.
        keys = become_kind(editor, in_force, place, edited)?;
    }
    for (key, _) in &keys {
        in_force.settle_entry("light", &edited.name, key);
    }
    if let LightKind::Spot(spot) = &edited.kind {
        let mut written = spots::Written {
            editor,
            in_force,
            place,
            name: &edited.name,
            keys: &mut keys,
        };
        written.complete_cone(spot)?;
        written.aim(spot)?;
    }
    if keys.iter().any(|(key, _)| *key == "radiance") {
        in_force.settle_entry("light", &edited.name, "map");
        editor.remove(place, "map")?;
    }
    set_all(editor, place, &keys)
}

/// Gives an entry a kind, and returns all its keys. It has no others: the reader
/// would have refused them under the override that made it that kind.
fn become_kind(
    editor: &mut Editor,
    in_force: &mut InForce,
    place: Place,
    light: &Light,
) -> Result<Keys, SaveError> {
    let has_map = matches!(
        &light.kind,
        LightKind::Environment(sky) if matches!(sky.radiance, Radiance::Map(_))
    );
    // The name of a map is known to the override alone.
    let still: &[&str] = if has_map { &["map"] } else { &[] };
    in_force.settle_light(&light.name, still);
    let kind = Written::Plain(quoted(kind_name(&light.kind)));
    editor.set(place, "kind", &kind)?;
    Ok(light_keys(&light.kind))
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

fn set_section(
    editor: &mut Editor,
    in_force: &mut InForce,
    section: &'static str,
    [old, new]: [Keys; 2],
) -> Result<(), SaveError> {
    let keys = changed(old, new);
    for (key, _) in &keys {
        in_force.settle_section(section, key);
    }
    set_all(editor, Place::Section(section), &keys)
}

pub(super) fn set_all(editor: &mut Editor, place: Place, keys: &Keys) -> Result<(), SaveError> {
    for (key, value) in keys {
        editor.set(place, key, &written(value))?;
    }
    Ok(())
}
