//! How surfaces reflect.

use glam::Vec3;

use super::Context;
use crate::preview::document::{Document, reflection_summary};
use crate::preview::hands::Selection;
use crate::scene::Reflection;

/// Roughness a step.
const ROUGHNESS: f64 = 0.05;

/// Gives a surface another colour: another albedo, and a metal another specular
/// colour.
pub(super) fn paint(
    document: &mut Document,
    index: usize,
    context: &Context<'_>,
    new: impl Fn(Vec3) -> Vec3,
) -> Result<String, String> {
    change(document, index, context, |mut surface| {
        if surface.is_metal() {
            surface.specular = new(surface.specular);
        } else {
            surface.albedo = new(surface.albedo);
        }
        Ok((surface, None))
    })
}

/// Makes a surface the next named kind, or the one before.
pub(super) fn next_kind(
    document: &mut Document,
    selection: Selection,
    context: &Context<'_>,
    by: i8,
) -> Result<String, String> {
    change(document, selected(selection)?, context, |surface| {
        let (surface, kind) = surface.next_kind(by);
        Ok((surface, Some(kind)))
    })
}

/// Makes a surface rougher by steps, or smoother.
pub(super) fn rougher(
    document: &mut Document,
    selection: Selection,
    context: &Context<'_>,
    steps: f64,
) -> Result<String, String> {
    change(document, selected(selection)?, context, |surface| {
        if !surface.is_glossy() {
            return Err("has no gloss to be rough; } gives it some".to_owned());
        }
        Ok((surface.rougher(ROUGHNESS * steps), None))
    })
}

fn selected(selection: Selection) -> Result<usize, String> {
    match selection {
        Selection::Surface(index) => Ok(index),
        _ => Err("no surface is selected; ] selects one".to_owned()),
    }
}

/// Changes a material; the change may name what it makes, or say what is in its way.
/// All materials of one name are one entry of the scene file.
fn change(
    document: &mut Document,
    index: usize,
    context: &Context<'_>,
    change: impl Fn(Reflection) -> Result<(Reflection, Option<&'static str>), String>,
) -> Result<String, String> {
    let missing = || "no such surface".to_owned();
    let old = *document.reflections.get(index).ok_or_else(missing)?;
    let name = context.material_names.get(index).ok_or_else(missing)?;
    let (new, made) = change(old).map_err(|reason| format!("{name}: {reason}"))?;
    for (known, slot) in context.material_names.iter().zip(&mut document.reflections) {
        if known == name {
            *slot = new;
        }
    }
    let made = made.map_or(String::new(), |made| format!("{made}, "));
    Ok(format!("{name}: {made}{}", reflection_summary(&new, 4)))
}
