//! `relume diff`: how far one image is from another.

use std::path::Path;

use relume::{
    Figure, Judgement, Limits, Mask, Measured, MetadataDifference, heat_map, judge, read_compared,
    read_image, strip, write_png,
};
use serde_json::{Map, Value, json};

use super::args::Diff;
use super::error::CliError;
use super::report::Report;
use super::run::thread_pool;

pub(super) fn execute(arguments: &Diff) -> Result<Report, CliError> {
    check_pictures(arguments)?;
    let reference = read_compared(&arguments.reference)?;
    let candidate = read_compared(&arguments.candidate)?;
    let mask = arguments.mask.as_deref().map(read_mask).transpose()?;
    let limits = Limits {
        max_channel_difference: arguments.max_channel_difference,
        max_differing_pixels: arguments.max_differing_pixels,
        max_flip: arguments.max_flip,
    };
    let pool = thread_pool(&arguments.run)?;
    let judgement = pool.install(|| judge(&reference, &candidate, &limits, mask.as_ref()))?;
    let mut text = judgement_text(&judgement);
    if let Some(path) = &arguments.strip {
        write_png(path, &strip(&reference, &candidate, mask.as_ref()))?;
    }
    if let Some(path) = &arguments.heatmap {
        match judgement.measured() {
            Some(measured) => write_png(path, &heat_map(&measured.flip_map))?,
            None => text.push_str("\nno heat map of images of two sizes"),
        }
    }
    let metadata = if judgement.is_equal() {
        Vec::new()
    } else {
        reference.metadata_differences(&candidate)
    };
    text.push_str(&metadata_text(&metadata));
    Ok(Report {
        json: judgement_json(&judgement, &metadata),
        text,
        exit_code: u8::from(!judgement.passes()),
    })
}

/// Refuses, before any work, pictures that are not called PNG, and those that
/// would take the place of an image that is read or of each other.
fn check_pictures(arguments: &Diff) -> Result<(), CliError> {
    let pictures = [&arguments.strip, &arguments.heatmap];
    let mut taken: Vec<&Path> = vec![&arguments.reference, &arguments.candidate];
    taken.extend(arguments.mask.as_deref());
    for path in pictures.into_iter().flatten() {
        if taken.iter().any(|other| are_one_file(other, path)) {
            return Err(CliError::Usage(format!(
                "{}: would be written over another image of this comparison; choose another name",
                path.display()
            )));
        }
        taken.push(path);
        if !path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("png"))
        {
            return Err(CliError::Usage(format!(
                "{}: strips and heat maps are PNG files; use .png",
                path.display()
            )));
        }
    }
    Ok(())
}

/// Whether two paths name one file, there or not.
fn are_one_file(a: &Path, b: &Path) -> bool {
    a == b || matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

fn read_mask(path: &Path) -> Result<Mask, CliError> {
    let image = read_image(path)?;
    Mask::of_image(&image).map_err(|error| CliError::Usage(format!("{}: {error}", path.display())))
}

/// A judgement as an object of a report.
pub(super) fn judgement_json(judgement: &Judgement, metadata: &[MetadataDifference]) -> Value {
    let mut object = Map::new();
    object.insert("passes".to_owned(), json!(judgement.passes()));
    match judgement {
        Judgement::OfOtherSize(mismatch) => {
            object.insert("failed_limits".to_owned(), json!(["size"]));
            object.insert("reference_size".to_owned(), json!(mismatch.reference));
            object.insert("candidate_size".to_owned(), json!(mismatch.candidate));
        }
        Judgement::Measured(measured) => add_measured(&mut object, measured),
    }
    object.insert("failures".to_owned(), json!(judgement.failures()));
    let metadata = metadata.iter().map(|difference| {
        json!({
            "name": difference.name,
            "reference": difference.reference,
            "candidate": difference.candidate,
        })
    });
    object.insert("metadata_differences".to_owned(), metadata.collect());
    Value::Object(object)
}

fn add_measured(object: &mut Map<String, Value>, measured: &Measured) {
    for (key, figure) in measured.figures.entries() {
        let value = match figure {
            Figure::Count(count) => json!(count),
            Figure::Number(number) => json!(number),
        };
        object.insert(key.to_owned(), value);
    }
    let failed = measured.failures.iter().map(|failure| failure.limit());
    object.insert("failed_limits".to_owned(), failed.collect());
    let passing = &measured.passing;
    object.insert(
        "passing_limits".to_owned(),
        json!({
            "max_channel_difference": passing.max_channel_difference,
            "max_differing_pixels": passing.max_differing_pixels,
            "max_flip": passing.max_flip,
            "options": passing.options(),
        }),
    );
}

/// A judgement as lines for a person.
pub(super) fn judgement_text(judgement: &Judgement) -> String {
    let measured = match judgement {
        Judgement::OfOtherSize(mismatch) => return format!("different: {mismatch}"),
        Judgement::Measured(measured) => measured,
    };
    let figures = &measured.figures;
    let verdict = if !judgement.passes() {
        "different"
    } else if judgement.is_equal() {
        "same"
    } else {
        "same within the limits"
    };
    let mut text = format!("{verdict}: {}", figures.text());
    for failure in &measured.failures {
        text.push_str(&format!("\nfails: {failure}"));
    }
    if !judgement.passes() {
        let options = measured.passing.options().join(", or ");
        text.push_str(&format!("\nwould pass with {options}"));
    }
    text
}

/// Both sides' values as lines to go behind a judgement's; empty for none.
pub(super) fn metadata_text(differences: &[MetadataDifference]) -> String {
    if differences.is_empty() {
        return String::new();
    }
    let none = "nothing";
    let lines = differences.iter().map(|difference| {
        format!(
            "\n  {}: {} | {}",
            difference.name,
            difference.reference.as_deref().unwrap_or(none),
            difference.candidate.as_deref().unwrap_or(none),
        )
    });
    let lines: String = lines.collect();
    format!("\nthe files say of themselves (reference | candidate):{lines}")
}
