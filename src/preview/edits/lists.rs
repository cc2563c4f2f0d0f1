//! Lights that come and go.

use super::{Context, selected};
use crate::preview::document::{self, Document, EditedLight};
use crate::preview::hands::Selection;
use crate::preview::light_edits::{self, Way};
use crate::preview::new_lights::{NewKind, free_name, new_light};

pub(super) fn add(
    kind: NewKind,
    document: &mut Document,
    selection: &mut Selection,
    context: &Context<'_>,
) -> String {
    let name = free_name(kind.name(), &document.lights);
    let exposure = document.render.exposure;
    let light = new_light(kind, name, &document.camera, context.extent, exposure);
    let message = format!("{}: new", light.name);
    document.lights.push(EditedLight::new(light));
    *selection = Selection::Light(document.lights.len() - 1);
    message
}

pub(super) fn duplicate(
    document: &mut Document,
    selection: &mut Selection,
    context: &Context<'_>,
) -> Result<String, String> {
    let edited = selected(document, *selection)?.clone();
    let mut light = edited.light;
    if document::colour(&light.kind).is_none() {
        return Err(format!(
            "{}: a sky with a map cannot be duplicated",
            light.name
        ));
    }
    let old = light.name.clone();
    light.name = free_name(&light.name, &document.lights);
    // Beside the other, or it could not be seen.
    if document::position(&light.kind).is_some() {
        light_edits::nudge(
            &mut light.kind,
            Way::Right,
            2.0,
            &document.camera,
            context.extent,
        );
    }
    let message = format!("{}: like {old}", light.name);
    document.lights.push(EditedLight::new(light));
    *selection = Selection::Light(document.lights.len() - 1);
    Ok(message)
}

pub(super) fn delete(
    document: &mut Document,
    selection: &mut Selection,
    context: &Context<'_>,
) -> Result<String, String> {
    let name = selected(document, *selection)?.light.name.clone();
    if context.pinned.contains(&name) {
        return Err(format!(
            "{name}: [[animate]] or [golden] of the file needs it; mute it instead"
        ));
    }
    if let Selection::Light(index) = *selection {
        document.lights.remove(index);
        *selection = match document.lights.len() {
            0 => Selection::Nothing,
            left => Selection::Light(index.min(left - 1)),
        };
    }
    Ok(format!("{name}: deleted"))
}
