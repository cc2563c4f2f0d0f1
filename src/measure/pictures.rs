//! Pictures of a report: frames beside references, the basis, the components.

use glam::Vec3;

use super::MeasureError;
use super::frame_errors::Compared;
use crate::bake::{Bake, RunSettings};
use crate::frame::{EncodedImage, FlipMap, Image};
use crate::maths::functions::linear_from_srgb;
use crate::output::encode_png;
use crate::relight::{BasisFunction, Component, FrameSettings, Renderer, develop};
use crate::report::{Block, Comparison, LabelledPicture, Picture, PngImage};
use crate::scene::Scene;
use crate::simd::Level;
use crate::surface::{NONE, Ray, Surface};

/// FLIP at which the map is white; beyond, everybody sees the difference.
pub(super) const BRIGHTEST_FLIP: f32 = 0.5;
/// Colours of the map in equal steps, sRGB.
const RAMP: [[f64; 3]; 5] = [
    [0.0, 0.0, 0.05],
    [0.35, 0.05, 0.45],
    [0.8, 0.25, 0.3],
    [1.0, 0.7, 0.2],
    [1.0, 1.0, 0.9],
];

/// A frame beside its reference, with the map of FLIP.
pub(super) fn comparison(scene: &Scene, compared: &Compared) -> Result<Block, MeasureError> {
    let name = compared.name();
    let file_name = name.replace(", ", "-");
    let levels = |image: &Image| {
        let render = &scene.render;
        develop(image, compared.component, render.exposure, render.tone)
    };
    Ok(Block::Comparison(Comparison {
        name: format!("{file_name}-against-reference"),
        caption: format!(
            "{name} light: a relit frame and the path-traced reference. FLIP from 0 (dark) to \
             {BRIGHTEST_FLIP} and above (bright); mean {:.4}, of which the reference's halves \
             differ from each other by {:.4}.",
            compared.flip.mean(),
            compared.flip_of_halves,
        ),
        left: labelled(
            "reference",
            &levels(&compared.reference),
            "the path-traced reference",
        )?,
        right: labelled("frame", &levels(&compared.frame), "the relit frame")?,
        strip: None,
        difference: Some(labelled(
            "FLIP",
            &develop(
                &flip_picture(&compared.flip),
                Component::Albedo,
                0.0,
                scene.render.tone,
            ),
            "where the two differ to an observer",
        )?),
    }))
}

/// A map of FLIP as linear colours.
fn flip_picture(flip: &FlipMap) -> Image {
    let pixels = flip
        .values()
        .iter()
        .map(|&error| ramp(error / BRIGHTEST_FLIP));
    Image::new(flip.width(), flip.height(), pixels.collect()).expect("a colour a pixel")
}

fn ramp(value: f32) -> Vec3 {
    let place = f64::from(value.clamp(0.0, 1.0)) * (RAMP.len() - 1) as f64;
    let below = (place.floor() as usize).min(RAMP.len() - 2);
    let share = place - below as f64;
    let channel = |c: usize| {
        let encoded = RAMP[below][c] + share * (RAMP[below + 1][c] - RAMP[below][c]);
        linear_from_srgb(encoded) as f32
    };
    Vec3::new(channel(0), channel(1), channel(2))
}

/// Components of light, partitions and functions of one partition.
pub(super) fn components(
    renderer: &mut Renderer,
    frame: &FrameSettings,
    has_light: bool,
    run: &RunSettings,
) -> Result<Vec<Block>, MeasureError> {
    let mut wanted: Vec<(String, Component, String)> = Vec::new();
    let mut add = |name: &str, component, caption: &str| {
        wanted.push((name.to_owned(), component, caption.to_owned()));
    };
    if has_light {
        add(
            "direct",
            Component::Direct,
            "Direct light, by shadow rays at the pixels.",
        );
        add(
            "approximated-direct",
            Component::ApproximatedDirect,
            "Direct light as the bounces are given it: projected on the basis.",
        );
        add(
            "indirect",
            Component::Indirect,
            "Indirect light of all bounces.",
        );
        add("global", Component::Global, "Direct and indirect light.");
    }
    add(
        "partitions",
        Component::Partitions,
        "Partitions of the basis, each in a colour of its own.",
    );
    let (surface, bake) = renderer.transfer();
    let basis = bake.map(|bake| looked_at(surface, bake, frame, run.level));
    for (name, function, caption) in basis
        .iter()
        .flat_map(|&(part, count)| functions(part, count))
    {
        wanted.push((name, Component::Basis(function), caption));
    }
    let mut blocks = Vec::new();
    run.progress.stage("pictures", wanted.len() as u64);
    for (name, component, caption) in wanted {
        let settings = FrameSettings {
            component,
            ..*frame
        };
        let picture = renderer.frame(&settings, run)?;
        let render = &renderer.scene().render;
        let levels = picture.develop(render.exposure, render.tone);
        blocks.push(Block::Picture(Picture {
            alt: caption.clone(),
            image: png(&levels)?,
            name,
            caption,
        }));
        run.progress.advance(1);
    }
    Ok(blocks)
}

/// The partition in the middle of the picture and how many functions it has; the
/// first one where nothing is there.
fn looked_at(surface: &Surface, bake: &Bake, frame: &FrameSettings, level: Level) -> (u32, usize) {
    let camera = frame.camera.place(&surface.placement);
    let [x, y] = frame.camera.size.map(|side| f64::from(side) * 0.5);
    let hit = surface.rays.closest(
        level,
        &Ray {
            origin: camera.eye.as_vec3(),
            direction: camera.direction(x, y),
            t_max: f32::INFINITY,
        },
    );
    let corner = hit.and_then(|hit| {
        let sides = [true, false].map(|front| surface.vertices.of_triangle(hit.triangle, front));
        sides.into_iter().flatten().find(|&corner| corner != NONE)
    });
    let basis = bake.basis();
    let part = corner.map_or(0, |v| basis.row(basis.slot_of_vertex()[v as usize]).0);
    (part, basis.function_range(part).len())
}

/// The two lowest and the two highest functions of a partition.
fn functions(partition: u32, count: usize) -> Vec<(String, BasisFunction, String)> {
    let mut numbers = vec![0, 1, count.saturating_sub(2), count.saturating_sub(1)];
    numbers.retain(|&number| number < count);
    numbers.sort_unstable();
    numbers.dedup();
    let one = |number: usize| {
        let caption = format!(
            "Function {number} of partition {partition}, of 0 to {}: red is positive, blue \
             negative, grey outside.",
            count - 1
        );
        let function = BasisFunction::InPartition {
            partition,
            function: number as u32,
        };
        (format!("function-{number}"), function, caption)
    };
    numbers.into_iter().map(one).collect()
}

fn labelled(
    label: &str,
    levels: &EncodedImage,
    alt: &str,
) -> Result<LabelledPicture, MeasureError> {
    Ok(LabelledPicture {
        label: label.to_owned(),
        image: png(levels)?,
        alt: alt.to_owned(),
        file_word: label.to_lowercase(),
    })
}

fn png(levels: &EncodedImage) -> Result<PngImage, MeasureError> {
    Ok(PngImage::new(encode_png(levels)?)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ramp_brightens_and_ends() {
        let brightness: Vec<f32> = (0..=20)
            .map(|i| ramp(i as f32 / 20.0).element_sum())
            .collect();
        assert!(
            brightness.windows(2).all(|pair| pair[0] < pair[1]),
            "{brightness:?}"
        );
        assert_eq!(ramp(7.0), ramp(1.0));
    }

    #[test]
    fn small_partitions_have_no_function_twice() {
        let numbers = |count| {
            functions(3, count)
                .into_iter()
                .map(|f| f.0)
                .collect::<Vec<_>>()
        };
        assert_eq!(
            numbers(20),
            ["function-0", "function-1", "function-18", "function-19"]
        );
        assert_eq!(numbers(2), ["function-0", "function-1"]);
        assert_eq!(numbers(1), ["function-0"]);
    }
}
