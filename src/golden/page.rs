//! The verdicts as a page to look at, with its loose pictures.

use std::path::{Path, PathBuf};

use super::check::is_linear;
use super::{Checked, Pictures, Verdict};
use crate::compare::Judgement;
use crate::frame::EncodedImage;
use crate::output::{OutputError, encode_png};
use crate::report::{
    Block, Cell, Column, Comparison, Fact, LabelledPicture, Picture, PngImage, Report, ReportError,
    ReportFile, Row, Section, Table,
};

/// The report's pages for programs have other schemas than this room's.
const NOT_OF_THIS_REPORT: &str = "report.json";

/// Why a report cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum PageError {
    /// A picture cannot be encoded.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The parts do not fit together.
    #[error(transparent)]
    Report(#[from] ReportError),
}

/// `report.html`, which needs no other file, and below `pictures/` what failed:
/// expected, actual, strip and heat map. `report.html` is the last.
///
/// # Errors
/// If a picture cannot be encoded as PNG.
pub fn report_files(
    checked: &[Checked],
    without_scene: &[PathBuf],
) -> Result<Vec<ReportFile>, PageError> {
    let names = picture_names(checked);
    let failed = || {
        let named = checked.iter().zip(&names);
        named.filter_map(|(one, name)| Some((one, name.as_deref()?)))
    };
    let mut sections = Vec::new();
    for (one, name) in failed() {
        sections.push(failure(one, name)?);
    }
    sections.push(overview(checked));
    if !without_scene.is_empty() {
        sections.push(strays(without_scene));
    }
    let report = Report {
        title: "Golden images".to_owned(),
        summary: summary(checked, without_scene),
        sections,
    };
    // Linear values of a frame, to look at in another program.
    let linear = failed().filter(|(one, _)| is_linear(one.scene.golden()));
    let linear = linear.filter_map(|(one, name)| {
        Some(ReportFile {
            path: format!("pictures/{name}-actual.exr"),
            bytes: one.candidate.clone()?,
        })
    });
    let mut files: Vec<ReportFile> = linear.collect();
    files.extend(report.files()?);
    files.retain(|file| file.path != NOT_OF_THIS_REPORT);
    Ok(files)
}

/// A slug for each scene that fails, by which the report calls its pictures: its
/// number among them and its path. `None` for those that pass.
pub fn picture_names(checked: &[Checked]) -> Vec<Option<String>> {
    let mut failed = 0;
    let names = checked.iter().map(|one| {
        if one.passes() {
            return None;
        }
        failed += 1;
        let path = slug(&one.scene.scene().with_extension(""));
        Some(format!("{failed}-{path}").trim_end_matches('-').to_owned())
    });
    names.collect()
}

/// The last letters and digits of a path, in words with hyphens between them.
fn slug(path: &Path) -> String {
    /// Leaves room for a number and the file's word in a report's 80.
    const LONGEST: usize = 50;
    let text = path.to_string_lossy().to_lowercase();
    let words = text.split(|letter: char| !letter.is_ascii_alphanumeric());
    let slug = words
        .filter(|word| !word.is_empty())
        .collect::<Vec<_>>()
        .join("-");
    let start = slug.len().saturating_sub(LONGEST);
    slug[start..].trim_matches('-').to_owned()
}

fn summary(checked: &[Checked], without_scene: &[PathBuf]) -> Vec<Fact> {
    let fact = |label: &str, value: usize, note: &str| Fact {
        label: label.to_owned(),
        value: value.to_string(),
        note: note.to_owned(),
    };
    let passed = checked.iter().filter(|it| it.passes()).count();
    let mut facts = vec![
        fact("Scenes", checked.len(), "checked"),
        fact("Passed", passed, "as near as their limits ask"),
        fact("Failed", checked.len() - passed, "see below"),
    ];
    if !without_scene.is_empty() {
        let note = "not a failure";
        facts.push(fact("Goldens without a scene", without_scene.len(), note));
    }
    facts
}

/// A scene that failed, with what there is to look at.
fn failure(checked: &Checked, name: &str) -> Result<Section, PageError> {
    let mut paragraphs = checked.verdict.problems();
    let Verdict::Differs {
        judgement,
        metadata,
    } = &checked.verdict
    else {
        let block = match &checked.pictures {
            Some(pictures) => Some(look(pictures, name)?),
            None => None,
        };
        return Ok(section(
            checked,
            name,
            paragraphs,
            block.into_iter().collect(),
        ));
    };
    if let Judgement::Measured(measured) = judgement {
        let keys = measured.passing.keys_text();
        paragraphs.push(format!("It would pass with {keys} in [golden]."));
    }
    let mut blocks = Vec::new();
    if let Some(pictures) = &checked.pictures {
        blocks.push(look(pictures, name)?);
    }
    if !metadata.is_empty() {
        let none = || Cell::Text("–".to_owned());
        let cell = |text: &Option<String>| text.clone().map_or_else(none, Cell::Text);
        let rows = metadata.iter().map(|it| {
            Row::plain(vec![
                it.name.as_str().into(),
                cell(&it.reference),
                cell(&it.candidate),
            ])
        });
        blocks.push(Block::Table(Table {
            name: format!("{name}-metadata"),
            caption: "What the files say of themselves.".to_owned(),
            columns: ["entry", "golden", "frame"].map(Column::text).to_vec(),
            rows: rows.collect(),
        }));
    }
    Ok(section(checked, name, paragraphs, blocks))
}

fn section(
    checked: &Checked,
    name: &str,
    mut paragraphs: Vec<String>,
    blocks: Vec<Block>,
) -> Section {
    paragraphs.push(format!("Golden: {}", checked.scene.golden().display()));
    Section {
        heading: checked.scene.scene().display().to_string(),
        anchor: format!("failure-{name}"),
        paragraphs,
        blocks,
    }
}

/// Expected and actual beside each other, or what there is of them.
fn look(pictures: &Pictures, name: &str) -> Result<Block, PageError> {
    let Some(expected) = &pictures.expected else {
        return Ok(Block::Picture(Picture {
            name: format!("{name}-actual"),
            caption: "The frame.".to_owned(),
            image: png(&pictures.actual)?,
            alt: "the frame".to_owned(),
        }));
    };
    let heat_map = pictures.heat_map.as_ref();
    let heat_map = heat_map.map(|it| labelled("Heat map", "FLIP by pixel", it));
    let strip = pictures.strip.as_ref().map(png);
    Ok(Block::Comparison(Comparison {
        name: name.to_owned(),
        caption: String::new(),
        left: labelled("Expected", "the golden", expected)?,
        right: labelled("Actual", "the frame", &pictures.actual)?,
        difference: heat_map.transpose()?,
        strip: strip.transpose()?,
    }))
}

fn labelled(label: &str, alt: &str, levels: &EncodedImage) -> Result<LabelledPicture, PageError> {
    Ok(LabelledPicture {
        label: label.to_owned(),
        image: png(levels)?,
        alt: alt.to_owned(),
        file_word: label.to_lowercase().replace(' ', "-"),
    })
}

fn png(levels: &EncodedImage) -> Result<PngImage, PageError> {
    Ok(PngImage::new(encode_png(levels)?)?)
}

/// A row a scene, failures first.
fn overview(checked: &[Checked]) -> Section {
    let (passed, failed): (Vec<_>, Vec<_>) = checked.iter().partition(|it| it.passes());
    Section {
        heading: "All scenes".to_owned(),
        anchor: "all-scenes".to_owned(),
        paragraphs: Vec::new(),
        blocks: vec![Block::Table(Table {
            name: "scenes".to_owned(),
            caption: String::new(),
            columns: vec![
                Column::text("scene"),
                Column::text("verdict"),
                Column::number("differing pixels", "", 0),
                Column::number("largest difference", "levels, or linear", 4),
                Column::number("FLIP", "mean", 5),
                Column::number("time", "s", 2),
            ],
            rows: failed.into_iter().chain(passed).map(row).collect(),
        })],
    }
}

fn row(checked: &Checked) -> Row {
    let judgement = match &checked.verdict {
        Verdict::Passes(judgement) | Verdict::Differs { judgement, .. } => Some(judgement),
        _ => None,
    };
    let figures = judgement
        .and_then(Judgement::measured)
        .map(|it| &it.figures);
    let cells = vec![
        checked.scene.scene().display().to_string().into(),
        checked.verdict.name().into(),
        figures.map(|it| it.differing_pixels as f64).into(),
        figures.map(|it| it.max_channel_difference).into(),
        figures.map(|it| it.flip_mean).into(),
        ((checked.time_ms / 10.0).round() / 100.0).into(),
    ];
    match checked.passes() {
        true => Row::plain(cells),
        false => Row::highlighted(cells, "fails"),
    }
}

fn strays(without_scene: &[PathBuf]) -> Section {
    let rows = without_scene
        .iter()
        .map(|it| Row::plain(vec![it.display().to_string().into()]));
    Section {
        heading: "Goldens without a scene".to_owned(),
        anchor: "goldens-without-a-scene".to_owned(),
        paragraphs: vec!["Nothing draws these; delete them, or put their scenes back.".to_owned()],
        blocks: vec![Block::Table(Table {
            name: "without-scene".to_owned(),
            caption: String::new(),
            columns: vec![Column::text("golden")],
            rows: rows.collect(),
        })],
    }
}
