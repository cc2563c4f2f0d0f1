//! `relume diff`: how far one image is from another.

use relume::{Difference, LoadedImage, SizeMismatch, compare, count_beyond, read_image};
use serde_json::json;

use super::args::{Diff, PixelLimit};
use super::error::CliError;
use super::report::Report;

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
    let allowed = match arguments.max_differing_pixels {
        PixelLimit::Count(count) => count,
        PixelLimit::Share(share) => (share * pixel_count as f64).floor() as u64,
    };
    let beyond = count_beyond(a_values, b_values, arguments.max_channel_difference)?;
    let passes = beyond <= allowed;
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
    });
    Ok(Report {
        json,
        text: text(passes, &values, &linear, &blocks, pixel_count),
        exit_code: u8::from(!passes),
    })
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
