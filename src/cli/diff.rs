//! `relume diff`: how far one image is from another.

use relume::{
    Difference, FlipMap, Image, LoadedImage, PIXELS_PER_DEGREE, SizeMismatch, compare,
    count_beyond, flip, hdr_flip, read_image,
};
use serde_json::json;

use super::args::{Diff, PixelLimit};
use super::error::CliError;
use super::report::Report;
use super::run::thread_pool;

/// Side of the blocks over which noise and edges are averaged out, pixels.
const BLOCK: u32 = 8;

pub(super) fn execute(arguments: &Diff) -> Result<Report, CliError> {
    let reference = read_image(&arguments.reference)?;
    let candidate = read_image(&arguments.candidate)?;
    if matches!(reference, LoadedImage::Levels(_)) != matches!(candidate, LoadedImage::Levels(_)) {
        return Err(CliError::Usage(
            "a PNG and an EXR hold different things (levels, linear values); compare two of a kind"
                .to_owned(),
        ));
    }
    let (a_values, b_values) = (reference.values(), candidate.values());
    let values = match compare(a_values, b_values) {
        Ok(values) => values,
        Err(mismatch) => return Ok(of_other_size(mismatch)),
    };
    let (a, b) = (reference.to_linear(), candidate.to_linear());
    let linear = compare(&a, &b)?;
    let blocks = compare(&a.block_means(BLOCK), &b.block_means(BLOCK))?;
    let pixel_count = u64::from(a.width()) * u64::from(a.height());
    let seen = thread_pool(&arguments.run)?.install(|| Seen::new(&reference, &candidate))?;
    let passes = passes(arguments, a_values, b_values, &seen)?;
    let json = json!({
        "passes": passes,
        "max_channel_difference": values.max_channel,
        "differing_pixels": values.differing_pixels,
        "pixels": pixel_count,
        "rmse": values.rmse,
        "relative_rmse": linear.relative_rmse,
        "bias": linear.bias,
        "relative_rmse_8x8": blocks.relative_rmse,
        "non_finite_pixels": values.non_finite_pixels,
        "flip_mean": seen.mean,
        "flip_median": seen.median,
        "flip_p95": seen.percentile_95,
        "flip_max": seen.max,
    });
    let of_values = text(passes, &values, &linear, &blocks, pixel_count);
    Ok(Report {
        json,
        text: format!("{of_values}\n{}", seen.text()),
        exit_code: u8::from(!passes),
    })
}

/// Whether all limits hold that are given. Those on channels and pixels are one:
/// so many pixels may differ by more than so much. Without any limit the images
/// must be equal.
fn passes(
    arguments: &Diff,
    reference: &Image,
    candidate: &Image,
    seen: &Seen,
) -> Result<bool, CliError> {
    let flip_passes = arguments.max_flip.is_none_or(|limit| seen.mean <= limit);
    let (channels, pixels) = (
        arguments.max_channel_difference,
        arguments.max_differing_pixels,
    );
    if channels.is_none() && pixels.is_none() && arguments.max_flip.is_some() {
        return Ok(flip_passes);
    }
    let pixel_count = reference.pixels().len() as u64;
    let allowed = match pixels.unwrap_or(PixelLimit::Count(0)) {
        PixelLimit::Count(count) => count,
        PixelLimit::Share(share) => (share * pixel_count as f64).floor() as u64,
    };
    let beyond = count_beyond(reference, candidate, channels.unwrap_or(0.0))?;
    Ok(beyond <= allowed && flip_passes)
}

/// FLIP over the image: what an observer sees of the difference.
struct Seen {
    measure: &'static str,
    mean: f64,
    median: f64,
    percentile_95: f64,
    max: f64,
}

impl Seen {
    /// LDR-FLIP of levels, HDR-FLIP of linear values.
    fn new(reference: &LoadedImage, candidate: &LoadedImage) -> Result<Self, SizeMismatch> {
        let (a, b) = (reference.values(), candidate.values());
        let (measure, map): (_, FlipMap) = match reference {
            LoadedImage::Levels(_) => ("LDR-FLIP", flip(a, b, PIXELS_PER_DEGREE)?),
            LoadedImage::Linear(_) => ("HDR-FLIP", hdr_flip(a, b, PIXELS_PER_DEGREE)?.map),
        };
        Ok(Self {
            measure,
            mean: map.mean(),
            median: map.percentile(50.0),
            percentile_95: map.percentile(95.0),
            max: map.max(),
        })
    }

    fn text(&self) -> String {
        format!(
            "{}: mean {:.5}, median {:.5}, 95th percentile {:.5}, max {:.5}",
            self.measure, self.mean, self.median, self.percentile_95, self.max
        )
    }
}

/// Images of unequal size are different images, not wrong usage.
fn of_other_size(mismatch: SizeMismatch) -> Report {
    Report {
        json: json!({
            "passes": false,
            "reference_size": mismatch.reference,
            "candidate_size": mismatch.candidate,
        }),
        text: format!("different: {mismatch}"),
        exit_code: 1,
    }
}

fn text(
    passes: bool,
    values: &Difference,
    linear: &Difference,
    blocks: &Difference,
    pixels: u64,
) -> String {
    format!(
        "{}: {} of {pixels} pixels differ, by {} at most\nlinear light: relRMSE {:.3} %, over 8 x 8 pixels {:.3} %, bias {:+.3} %",
        if passes {
            "same within the limits"
        } else {
            "different"
        },
        values.differing_pixels,
        values.max_channel,
        linear.relative_rmse * 100.0,
        blocks.relative_rmse * 100.0,
        linear.bias * 100.0,
    )
}
