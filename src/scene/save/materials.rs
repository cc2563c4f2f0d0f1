//! `[[material]]`: how materials reflect.

use super::changes::set_all;
use super::editor::Editor;
use super::in_force::InForce;
use super::layout::Place;
use super::values::{Keys, changed, quoted, reflection_keys, written};
use super::{Edited, SaveError};

/// Writes what differs of the materials, each into the entry of its name.
pub(super) fn write(
    editor: &mut Editor,
    in_force: &mut InForce,
    loaded: Edited<'_>,
    edited: Edited<'_>,
) -> Result<(), SaveError> {
    let pairs = loaded.reflections.iter().zip(edited.reflections);
    let mut seen: Vec<&str> = Vec::new();
    for (name, (old, new)) in loaded.material_names.iter().zip(pairs) {
        // A second material of a name is the first one without its maps.
        if seen.contains(&name.as_str()) {
            continue;
        }
        seen.push(name);
        let all = reflection_keys(*new);
        let keys = changed(reflection_keys(*old), all.clone());
        if !keys.is_empty() {
            edit(editor, in_force, name, keys, all)?;
        }
    }
    Ok(())
}

fn edit(
    editor: &mut Editor,
    in_force: &mut InForce,
    name: &str,
    mut keys: Keys,
    all: Keys,
) -> Result<(), SaveError> {
    let list = editor.list("material")?;
    let mut entries = list.entries().iter();
    let index = entries
        .position(|entry| entry.key("name").and_then(|key| key.string.as_deref()) == Some(name));
    let place = index.map(|index| Place::Entry("material", index));
    let entry = index.and_then(|index| list.entries().get(index));
    let has_brdf = entry.is_some_and(|entry| entry.key("brdf").is_some())
        || in_force.gives("material", name, "brdf");
    // Another roughness is of the same kind of surface; with other colours it is
    // another one, and what `brdf` made of it is written out instead.
    if has_brdf && keys.iter().any(|(key, _)| *key != "roughness") {
        keys = all;
        in_force.settle_entry("material", name, "brdf");
        if let Some(place) = place {
            replace_brdf(editor, place, &keys)?;
        }
    }
    for (key, _) in &keys {
        in_force.settle_entry("material", name, key);
    }
    match place {
        Some(place) => set_all(editor, place, &keys),
        None => {
            let mut entry = vec![("name", quoted(name))];
            entry.extend(
                keys.iter()
                    .map(|(key, value)| (*key, written(value).text())),
            );
            editor.append_entry("material", &entry)
        }
    }
}

/// Puts the first of the keys that an entry lacks into the place of its `brdf`,
/// beside the comment there.
fn replace_brdf(editor: &mut Editor, place: Place, keys: &Keys) -> Result<(), SaveError> {
    let entry = editor.entry(place)?;
    let lacks = |key: &str| entry.as_ref().is_some_and(|entry| entry.key(key).is_none());
    match keys.iter().find(|(key, _)| lacks(key)) {
        Some((key, value)) => editor.rename(place, ["brdf", key], &written(value)),
        None => editor.remove(place, "brdf"),
    }
}
