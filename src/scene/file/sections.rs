//! The sections of the scene file that stand alone: `[camera]`, `[render]`,
//! `[bake]`, `[golden]` and the entries of `[[material]]`.

use std::ops::Bound::Excluded;
use std::path::Path;

use glam::{DVec3, Vec3};

use super::fields::{Fields, Item, LARGEST, key_error, unit};
use super::tree::{Node, Value};
use crate::brdf::{NAMED_BRDFS, NamedBrdf};
use crate::scene::place::Place;
use crate::scene::{
    BakeKeys, Bounces, Camera, GoldenKeys, Override, PixelLimit, RenderKeys, SceneError, Tone,
};

/// Widest and highest picture, pixels.
const LARGEST_SIZE: u32 = 16_384;

/// Sine of the angle between view and up below which up says nothing.
const PARALLEL: f64 = 1e-6;

/// Most bounces that can be asked for by number; light that is left after
/// so many is beyond single precision unless the albedo is 1 everywhere.
const MOST_BOUNCES: u32 = 10_000;

/// Exposures beyond this leave the range of single precision.
const LARGEST_EXPOSURE: f64 = 64.0;

/// A set of sample points has 65,536 of them.
const MOST_SAMPLES: u32 = 65_536;

const CAMERA: [&str; 5] = ["position", "target", "up", "vfov", "size"];
const RENDER: [&str; 4] = ["bounces", "exposure", "tone", "light_samples"];
const BAKE: [&str; 7] = [
    "error",
    "max_edge",
    "vertices",
    "rays",
    "functions",
    "coefficients",
    "fixed_albedo",
];
const GOLDEN: [&str; 5] = [
    "max_channel_difference",
    "max_differing_pixels",
    "max_flip",
    "mask",
    "set",
];
const MATERIAL: [&str; 6] = [
    "name",
    "albedo",
    "brdf",
    "specular",
    "roughness",
    "emission",
];
const TONES: [(&str, Tone); 2] = [("srgb", Tone::Srgb), ("filmic", Tone::Filmic)];

/// An entry of `[[material]]`: what it changes, and where it says so.
#[derive(Debug, Clone)]
pub(crate) struct MaterialKeys {
    pub(crate) name: String,
    pub(crate) name_place: Place,
    pub(crate) albedo: Option<Vec3>,
    /// Sets albedo, specular colour and roughness; the other keys come after it.
    pub(crate) brdf: Option<NamedBrdf>,
    pub(crate) specular: Option<Vec3>,
    pub(crate) roughness: Option<f32>,
    pub(crate) emission: Option<Vec3>,
}

/// `[camera]`.
pub(crate) fn camera(mut fields: Fields) -> Result<Camera, SceneError> {
    fields.allow(&CAMERA)?;
    let position = fields.require("position", "the eye, [x, y, z]")?.vector()?;
    let target_item = fields.require("target", "a point in the middle of the picture")?;
    let target = target_item.vector()?;
    let vfov_item = fields.require("vfov", "the full vertical angle in degrees")?;
    let vfov_deg = vfov_item.number(
        (Excluded(0.0), Excluded(180.0)),
        "above 0 and below 180 (degrees)",
    )?;
    let size = size(&fields.require("size", "[width, height] in pixels")?)?;
    let Some(view) = unit(target - position) else {
        return Err(target_item.error("another point than the camera's position"));
    };
    let up_item = fields.take("up");
    let up = up_item.as_ref().map_or(Ok(DVec3::Y), Item::direction)?;
    if view.cross(up).length() < PARALLEL {
        let reason = format!("not parallel to the view from `position` to `target`, {view}");
        return Err(match up_item {
            Some(item) => item.error(&reason),
            None => fields.error(format!(
                "needs a key `up`: its default [0, 1, 0] must be {reason}"
            )),
        });
    }
    Ok(Camera {
        position,
        target,
        up,
        vfov_deg,
        size,
    })
}

fn size(item: &Item) -> Result<[u32; 2], SceneError> {
    let side = |node: &Node| match node.value {
        Value::Integer(integer) => u32::try_from(integer)
            .ok()
            .filter(|n| (1..=LARGEST_SIZE).contains(n)),
        _ => None,
    };
    let sides: Option<Vec<u32>> = item.list()?.iter().map(side).collect();
    match sides.as_deref() {
        Some(&[width, height]) => Ok([width, height]),
        _ => Err(item.error(&format!(
            "two whole numbers [width, height] from 1 to {LARGEST_SIZE}"
        ))),
    }
}

/// `[render]`.
pub(crate) fn render(mut fields: Fields) -> Result<RenderKeys, SceneError> {
    fields.allow(&RENDER)?;
    let mut keys = RenderKeys::default();
    if let Some(item) = fields.take("bounces") {
        keys.bounces = bounces(&item)?;
    }
    if let Some(item) = fields.take("exposure") {
        let range = -LARGEST_EXPOSURE..=LARGEST_EXPOSURE;
        keys.exposure = item.number(range, "from -64 to 64 (EV)")? as f32;
    }
    if let Some(item) = fields.take("tone") {
        keys.tone = item.choice(&TONES)?;
    }
    if let Some(item) = fields.take("light_samples") {
        keys.light_samples = item.count(1..=RenderKeys::MOST_LIGHT_SAMPLES)?;
    }
    Ok(keys)
}

fn bounces(item: &Item) -> Result<Bounces, SceneError> {
    if item.string().is_ok_and(|word| word == "all") {
        return Ok(Bounces::All);
    }
    item.count(0..=MOST_BOUNCES)
        .map(Bounces::Count)
        .map_err(|_| {
            item.error(&format!(
                "a whole number from 0 to {MOST_BOUNCES}, or \"all\""
            ))
        })
}

/// `[bake]`.
pub(crate) fn bake(mut fields: Fields) -> Result<BakeKeys, SceneError> {
    fields.allow(&BAKE)?;
    let mut keys = BakeKeys::default();
    if let Some(item) = fields.take("error") {
        keys.error = Some(item.number((Excluded(0.0), Excluded(1.0)), "above 0 and below 1")?);
    }
    if let Some(item) = fields.take("max_edge") {
        let range = (Excluded(0.0), Excluded(LARGEST));
        keys.max_edge = Some(item.number(range, "above 0 (scene units)")?);
    }
    let mut count = |key, range| fields.take(key).map(|item| item.count(range)).transpose();
    keys.vertices = count("vertices", 1..=u32::MAX)?;
    keys.rays = count("rays", 1..=MOST_SAMPLES)?;
    keys.functions = count("functions", 1..=u32::MAX)?;
    keys.coefficients = count("coefficients", 1..=u32::MAX)?;
    if let Some(item) = fields.take("fixed_albedo") {
        keys.fixed_albedo = item.flag()?;
    }
    Ok(keys)
}

/// `[golden]`; the mask's path is relative to `folder`.
pub(crate) fn golden(mut fields: Fields, folder: &Path) -> Result<GoldenKeys, SceneError> {
    fields.allow(&GOLDEN)?;
    let mut keys = GoldenKeys::default();
    if let Some(item) = fields.take("max_channel_difference") {
        keys.max_channel_difference = Some(item.number(0.0..=LARGEST, "of at least 0")?);
    }
    if let Some(item) = fields.take("max_differing_pixels") {
        keys.max_differing_pixels = Some(pixel_limit(&item)?);
    }
    if let Some(item) = fields.take("max_flip") {
        keys.max_flip = Some(item.number(0.0..=1.0, "from 0 to 1")?);
    }
    if let Some(item) = fields.take("mask") {
        keys.mask = Some(folder.join(item.name()?));
    }
    if let Some(item) = fields.take("set") {
        let nodes = item.list()?.iter();
        keys.set = nodes.map(golden_override).collect::<Result<_, _>>()?;
    }
    Ok(keys)
}

/// An entry of `set`, which must be what `--set` takes.
fn golden_override(node: &Node) -> Result<String, SceneError> {
    let Value::String(text) = &node.value else {
        let message = format!(
            "an entry of `set` is {}; it must be a string such as \"bake.rays=128\"",
            node.written
        );
        return Err(key_error(&node.place, message));
    };
    match Override::parse(text) {
        Ok(_) => Ok(text.clone()),
        Err(error) => Err(key_error(&node.place, error.to_string())),
    }
}

fn pixel_limit(item: &Item) -> Result<PixelLimit, SceneError> {
    if let Ok(count) = item.count(0..=u32::MAX) {
        return Ok(PixelLimit::Count(count));
    }
    let percent = item.string().ok().and_then(|text| text.strip_suffix('%'));
    percent
        .and_then(|number| number.trim().parse::<f64>().ok())
        .filter(|percent| (0.0..=100.0).contains(percent))
        .map(|percent| PixelLimit::Share(percent / 100.0))
        .ok_or_else(|| item.error("a count of pixels, or a share such as \"0.5%\""))
}

/// One entry of `[[material]]`.
pub(crate) fn material(mut fields: Fields) -> Result<MaterialKeys, SceneError> {
    fields.allow(&MATERIAL)?;
    let name = fields.require("name", "the name that MTL gives the material")?;
    fields.rename(format!("material {:?}", name.string()?));
    let mut colour = |key, read: fn(&Item) -> Result<Vec3, SceneError>| {
        fields.take(key).map(|item| read(&item)).transpose()
    };
    let albedo = colour("albedo", Item::reflectance)?;
    let specular = colour("specular", Item::reflectance)?;
    let emission = colour("emission", Item::light)?;
    let brdfs = NAMED_BRDFS.map(|brdf| (brdf.name, brdf));
    let brdf = fields
        .take("brdf")
        .map(|item| item.choice(&brdfs))
        .transpose()?;
    let roughness = fields
        .take("roughness")
        .map(|item| item.number(0.0..=1.0, "from 0 to 1"))
        .transpose()?;
    Ok(MaterialKeys {
        name: name.string()?.to_owned(),
        name_place: name.place().clone(),
        albedo,
        brdf,
        specular,
        roughness: roughness.map(|roughness| roughness as f32),
        emission,
    })
}

/// All entries of `[[material]]`.
///
/// # Errors
/// Two entries of one name, besides what each entry refuses.
pub(crate) fn materials(entries: Vec<Fields>) -> Result<Vec<MaterialKeys>, SceneError> {
    let mut read: Vec<MaterialKeys> = Vec::new();
    for fields in entries {
        let keys = material(fields)?;
        if let Some(first) = read.iter().find(|known| known.name == keys.name) {
            return Err(key_error(
                &keys.name_place,
                format!(
                    "a second [[material]] entry is called {:?}; put its keys into the first one, at {}",
                    keys.name, first.name_place
                ),
            ));
        }
        read.push(keys);
    }
    Ok(read)
}
