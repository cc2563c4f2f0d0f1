//! Commands as edits: a document and what is selected in it, before and after.

mod lists;
mod surfaces;

use glam::{DVec2, DVec3, Vec3};

use super::camera_moves::{dolly, look_at, orbit, pan, walk};
use super::colour;
use super::command::Command;
use super::document::{self, Document, EditedLight};
use super::hands::Selection;
use super::light_edits::{self, Way};
use super::steps::step;
use crate::maths::order::Order;
use crate::relight::COMPONENTS;
use crate::scene::{Bounces, Camera, LightKind, Tone};
use lists::{add, delete, duplicate};
use surfaces::{next_kind, paint, rougher};

/// Factors a step: of light, of albedo, of saturation, of the camera's distance.
const LIGHT_FACTOR: f64 = 1.189_207_115_002_721; // Four steps double it.
const ALBEDO_FACTOR: f64 = 1.1;
const SATURATION_FACTOR: f64 = 1.25;
const DOLLY_FACTOR: f64 = 0.9;
/// Mired and degrees of hue a step.
const MIRED: f64 = 20.0;
const HUE_DEG: f64 = 10.0;
/// Degrees of an orbit a step.
const ORBIT_DEG: f64 = 5.0;
/// A third of a stop.
const EXPOSURE: f64 = 1.0 / 3.0;
/// Black surfaces become this light when they are to be lighter.
const LEAST_ALBEDO: f32 = 0.05;
/// Most bounces of the scene file.
const MOST_BOUNCES: u32 = 10_000;

/// What an edit can look at beside the document.
pub(super) struct Context<'a> {
    /// Camera of the file.
    pub(super) home: &'a Camera,
    pub(super) extent: f64,
    pub(super) material_names: &'a [String],
    /// Names of lights that other parts of the file point at.
    pub(super) pinned: &'a [String],
    /// The point that was clicked last.
    pub(super) clicked: Option<DVec3>,
}

/// Applies a command by so many of its steps. The error says why it does nothing.
pub(super) fn apply(
    command: Command,
    steps: f64,
    document: &mut Document,
    selection: &mut Selection,
    context: &Context<'_>,
) -> Result<String, String> {
    let signed = |sign: i8| f64::from(sign) * steps;
    match command {
        Command::Nudge(way) => nudge(way, steps, document, *selection, context),
        Command::Orbit(_)
        | Command::Pan(_)
        | Command::Walk(_)
        | Command::Dolly(_)
        | Command::ResetView
        | Command::LookAtSelected => move_camera(command, steps, document, *selection, context),
        Command::Brighter(sign) => match *selection {
            Selection::Surface(index) => {
                let factor = colour::factor(ALBEDO_FACTOR, signed(sign));
                paint(document, index, context, |colour| {
                    colour::lighter(colour, factor, LEAST_ALBEDO)
                })
            }
            selection => brighten(document, selection, signed(sign)),
        },
        Command::Hue(sign) => recolour(document, *selection, context, |colour| {
            colour::turned(colour, HUE_DEG * signed(sign))
        }),
        Command::Saturation(sign) => {
            let factor = colour::factor(SATURATION_FACTOR, signed(sign));
            recolour(document, *selection, context, |colour| {
                colour::saturated(colour, factor)
            })
        }
        Command::Kind(by) => next_kind(document, *selection, context, by),
        Command::Rougher(sign) => rougher(document, *selection, context, signed(sign)),
        Command::Colder(sign) => heat(document, *selection, MIRED * signed(sign)),
        Command::Open(sign) => shape(document, *selection, |kind| {
            light_edits::open(kind, signed(sign))
        }),
        Command::OpenBeam(sign) => shape(document, *selection, |kind| {
            light_edits::open_beam(kind, signed(sign))
        }),
        Command::Turn(_) | Command::Tilt(_) | Command::Aim => {
            look(command, steps, document, *selection, context)
        }
        Command::Add(kind) => Ok(add(kind, document, selection, context)),
        Command::Duplicate => duplicate(document, selection, context),
        Command::Delete => delete(document, selection, context),
        Command::Mute => toggle(document, *selection, "muted", |it| &mut it.is_muted),
        Command::Solo => toggle(document, *selection, "soloed", |it| &mut it.is_soloed),
        Command::Show(number) => show(document, number),
        Command::Bounces(sign) => Ok(bounce(document, sign, steps)),
        Command::AllBounces => {
            document.render.bounces = Bounces::All;
            Ok("all bounces".to_owned())
        }
        Command::Exposure(sign) => Ok(expose(document, EXPOSURE * signed(sign))),
        Command::Tone => Ok(other_tone(document)),
        _ => Err(String::new()),
    }
}

const NO_LIGHT: &str = "no light is selected; Tab selects one";

fn selected(document: &mut Document, selection: Selection) -> Result<&mut EditedLight, String> {
    let light = match selection {
        Selection::Light(index) => document.lights.get_mut(index),
        _ => None,
    };
    light.ok_or_else(|| NO_LIGHT.to_owned())
}

fn said(edited: &EditedLight) -> String {
    format!(
        "{}: {}",
        edited.light.name,
        light_edits::described(&edited.light.kind)
    )
}

fn nudge(
    way: Way,
    steps: f64,
    document: &mut Document,
    selection: Selection,
    context: &Context<'_>,
) -> Result<String, String> {
    let camera = document.camera;
    if let Ok(edited) = selected(document, selection) {
        light_edits::nudge(&mut edited.light.kind, way, steps, &camera, context.extent);
        return Ok(said(edited));
    }
    let instead = match way {
        Way::Away => Command::Dolly(1),
        Way::Closer => Command::Dolly(-1),
        way => Command::Orbit(way),
    };
    move_camera(instead, steps, document, selection, context)
}

fn move_camera(
    command: Command,
    steps: f64,
    document: &mut Document,
    selection: Selection,
    context: &Context<'_>,
) -> Result<String, String> {
    let (camera, extent) = (document.camera, context.extent);
    document.camera = match command {
        Command::Orbit(way) => {
            let [right, up, _] = way.signs().map(|sign| sign * steps * ORBIT_DEG);
            orbit(&camera, [right, up], extent)
        }
        Command::Pan(way) => {
            let [right, up, _] = way.signs().map(|sign| sign * steps * step(extent));
            pan(&camera, DVec2::new(right, -up), extent)
        }
        Command::Walk(way) => walk(
            &camera,
            way.signs().map(|s| s * steps * step(extent)),
            extent,
        ),
        Command::Dolly(sign) => dolly(
            &camera,
            colour::factor(DOLLY_FACTOR, f64::from(sign) * steps),
            extent,
        ),
        Command::LookAtSelected => {
            let light = selected(document, selection).ok();
            let place = light.and_then(|edited| document::position(&edited.light.kind));
            match place.or(context.clicked) {
                Some(place) => look_at(&camera, place, extent),
                None => {
                    return Err("nothing to look at; select a light that has a place".to_owned());
                }
            }
        }
        _ => Camera {
            size: camera.size,
            ..*context.home
        },
    };
    let eye = document.camera.position;
    Ok(format!("camera at {:.4} {:.4} {:.4}", eye.x, eye.y, eye.z))
}

fn brighten(document: &mut Document, selection: Selection, steps: f64) -> Result<String, String> {
    let factor = colour::factor(LIGHT_FACTOR, steps);
    let edited = selected(document, selection)?;
    if let Some(old) = document::colour(&edited.light.kind) {
        // From black, which no factor brightens.
        let new = if old == Vec3::ZERO && factor > 1.0 {
            Vec3::ONE
        } else {
            colour::brighter(old, factor)
        };
        document::set_colour(&mut edited.light.kind, new);
    } else if let LightKind::Environment(sky) = &mut edited.light.kind {
        sky.scale = colour::digits(f64::from(sky.scale) * factor, 6) as f32;
        if sky.scale == 0.0 && factor > 1.0 {
            sky.scale = 1.0;
        }
        return Ok(format!("{}: scale {}", edited.light.name, sky.scale));
    }
    Ok(said_colour(edited))
}

fn said_colour(edited: &EditedLight) -> String {
    let unit = match edited.light.kind {
        LightKind::Point(_) | LightKind::Spot(_) => "W/sr",
        LightKind::Directional(_) => "W/m2",
        LightKind::Area(_) | LightKind::Environment(_) => "W/(m2 sr)",
    };
    let [r, g, b] = document::colour(&edited.light.kind).map_or([0.0; 3], |c| c.to_array());
    format!("{}: {r:.4} {g:.4} {b:.4} {unit}", edited.light.name)
}

fn heat(document: &mut Document, selection: Selection, mired: f64) -> Result<String, String> {
    let edited = selected(document, selection)?;
    let Some(old) = document::colour(&edited.light.kind) else {
        return Err(format!("{}: a map has its own colours", edited.light.name));
    };
    let (new, kelvin) = colour::colder(old, mired);
    document::set_colour(&mut edited.light.kind, new);
    Ok(format!("{}: {kelvin:.0} K", edited.light.name))
}

fn recolour(
    document: &mut Document,
    selection: Selection,
    context: &Context<'_>,
    new: impl Fn(Vec3) -> Vec3,
) -> Result<String, String> {
    if let Selection::Surface(index) = selection {
        return paint(document, index, context, |colour| {
            colour::within_one(new(colour))
        });
    }
    let edited = selected(document, selection)?;
    let Some(old) = document::colour(&edited.light.kind) else {
        return Err(format!("{}: a map has its own colours", edited.light.name));
    };
    document::set_colour(&mut edited.light.kind, new(old));
    Ok(said_colour(edited))
}

fn shape(
    document: &mut Document,
    selection: Selection,
    change: impl Fn(&mut LightKind) -> bool,
) -> Result<String, String> {
    let edited = selected(document, selection)?;
    if change(&mut edited.light.kind) {
        return Ok(said(edited));
    }
    Err(format!(
        "{}: only spots and rectangles have a width",
        edited.light.name
    ))
}

fn look(
    command: Command,
    steps: f64,
    document: &mut Document,
    selection: Selection,
    context: &Context<'_>,
) -> Result<String, String> {
    let camera = document.camera;
    let edited = selected(document, selection)?;
    let kind = &mut edited.light.kind;
    match command {
        Command::Turn(sign) => light_edits::turn(kind, f64::from(sign) * steps, &camera),
        Command::Tilt(sign) => light_edits::tilt(kind, f64::from(sign) * steps, &camera),
        _ => light_edits::aim(kind, context.clicked.unwrap_or(camera.target), &camera),
    }
    match edited.light.kind {
        LightKind::Point(_) => Err(format!(
            "{}: a point light shines all around",
            edited.light.name
        )),
        _ => Ok(said(edited)),
    }
}

fn toggle(
    document: &mut Document,
    selection: Selection,
    what: &str,
    flag: fn(&mut EditedLight) -> &mut bool,
) -> Result<String, String> {
    let edited = selected(document, selection)?;
    let flag = flag(edited);
    *flag = !*flag;
    let not = if *flag { "" } else { "not " };
    Ok(format!("{}: {not}{what}", edited.light.name))
}

fn show(document: &mut Document, number: u8) -> Result<String, String> {
    let (name, component) = COMPONENTS
        .get(usize::from(number))
        .ok_or_else(|| "no such component".to_owned())?;
    document.component = *component;
    Ok((*name).to_owned())
}

fn bounce(document: &mut Document, sign: i8, steps: f64) -> String {
    let by = steps.at_least(1.0) as u32;
    let count = match (document.render.bounces, sign > 0) {
        (Bounces::Count(count), true) => count.saturating_add(by).min(MOST_BOUNCES),
        (Bounces::Count(count), false) => count.saturating_sub(by),
        (Bounces::All, true) => return "all bounces".to_owned(),
        (Bounces::All, false) => 8,
    };
    document.render.bounces = Bounces::Count(count);
    format!("{count} bounces")
}

fn expose(document: &mut Document, by: f64) -> String {
    // Thirds of a stop come back to whole ones, and are short in a file.
    let thirtieths = ((f64::from(document.render.exposure) + by) * 30.0).round();
    let hundredths = (thirtieths / 0.3).round();
    let exposure = (hundredths / 100.0).clamp(-64.0, 64.0) as f32;
    document.render.exposure = exposure + 0.0;
    format!("exposure {exposure:+.2} EV")
}

fn other_tone(document: &mut Document) -> String {
    let (tone, name) = match document.render.tone {
        Tone::Srgb => (Tone::Filmic, "filmic"),
        Tone::Filmic => (Tone::Srgb, "srgb"),
    };
    document.render.tone = tone;
    format!("tone curve {name}")
}
