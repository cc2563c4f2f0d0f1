//! The report: what was measured, in words, tables, plots and pictures.

use super::MeasureError;
use super::figures::{MainFigures, main_figures};
use super::frame_errors::{BLOCK, Compared, TIMED_FRAMES, TRIED_SAMPLES};
use super::glossy::{BLOCK as SIDE, LONGER_SIDE, MOST_SAMPLES};
use super::methods;
use super::paths::{PATHS, VERTICES};
use super::run::{Measured, ReportSettings, Sweeps, Vertices, measure};
use super::sweeps::Swept;
use super::tables;
use super::vertices::{BOUNCES, LAST_RAYS, MANY_POINTS};
use crate::bake::{LIGHTS, RunSettings};
use crate::report::{Fact, Report, ReportFile, Section};
use crate::scene::{Bounces, Scene};

/// A report with what matters most of it.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredReport {
    /// The report's files.
    pub files: Vec<ReportFile>,
    /// Main figures.
    pub figures: MainFigures,
    /// What is out of the usual; the report says it too.
    pub warnings: Vec<String>,
}

/// Measures a scene and writes its speed-against-error report. Nothing comes
/// from or goes to a cache; all but times is the same on every machine.
///
/// # Errors
/// If a chapter fails or the job is stopped.
pub fn report(
    scene: Scene,
    settings: &ReportSettings,
    run: &RunSettings,
) -> Result<MeasuredReport, MeasureError> {
    let mut measured = measure(scene, settings, run)?;
    let figures = main_figures(&measured);
    let report = Report {
        title: format!("{}: speed against error", measured.settings.name),
        summary: facts(&measured, &figures),
        sections: sections(&mut measured),
    };
    Ok(MeasuredReport {
        files: report.files()?,
        figures,
        warnings: measured.warnings,
    })
}

fn fact(label: &str, value: String, note: &str) -> Fact {
    Fact {
        label: label.to_owned(),
        value,
        note: note.to_owned(),
    }
}

fn percent(value: f64) -> String {
    format!("{:.2} %", value * 100.0)
}

fn facts(measured: &Measured, figures: &MainFigures) -> Vec<Fact> {
    let [width, height] = measured.settings.frame.camera.size;
    let mut facts = vec![fact(
        "scene",
        format!("{} vertices", figures.vertices),
        &format!(
            "{} triangles, frames of {width} x {height}, {}",
            measured.figures.triangles,
            bounces(measured.settings.frame.bounces)
        ),
    )];
    for scheme in &figures.schemes {
        facts.push(fact(
            &format!("error, {}", scheme.scheme.name()),
            percent(scheme.one_bounce.mean),
            &format!(
                "one bounce, {:.0} bytes a vertex; 95th percentile {}, signed {:+.3} %; four \
                 bounces {} and {}",
                scheme.bytes_per_vertex,
                percent(scheme.one_bounce.p95),
                scheme.one_bounce.signed * 100.0,
                percent(scheme.four_bounces.mean),
                percent(scheme.four_bounces.p95),
            ),
        ));
    }
    if let Some(stated) = figures.stated {
        facts.push(fact(
            "error, stated",
            percent(stated.mean),
            &format!(
                "by the bake itself, one bounce, other lights, some of the vertices; 95th percentile {}",
                percent(stated.p95)
            ),
        ));
    }
    let rays = figures.rays_of_ratios.map_or(String::new(), rays_text);
    for &(bytes, ratio) in &figures.ratios_at_equal_bytes {
        let note = format!("within {bytes:.0} bytes a vertex, one bounce, by {rays}");
        facts.push(fact(
            "paper's error / relume's",
            format!("{ratio:.2}"),
            &note,
        ));
    }
    for image in &figures.images {
        facts.push(fact(
            &format!("FLIP, {}", image.name()),
            format!("{:.4}", image.flip[0]),
            &format!(
                "mean; 95th percentile {:.4}; between the reference's own halves {:.4}",
                image.flip[1], image.flip_of_halves
            ),
        ));
        facts.push(fact(
            &format!("paths / frame, {}", image.name()),
            image.ratio_text(0),
            &format!(
                "time of one thread at equal relRMSE of pixels ({}); {} at that of {BLOCK} x \
                 {BLOCK} blocks",
                image.error_text(0),
                image.ratio_text(1)
            ),
        ));
    }
    facts.push(fact(
        "bake",
        format!("{:.1} s", figures.bake_seconds),
        &format!("by the clock, threads: {}", figures.threads),
    ));
    for warning in &measured.warnings {
        facts.push(fact("warning", "note".to_owned(), warning));
    }
    facts
}

fn bounces(bounces: Bounces) -> String {
    match bounces {
        Bounces::Count(1) => "1 bounce".to_owned(),
        Bounces::Count(count) => format!("{count} bounces"),
        Bounces::All => "all bounces".to_owned(),
    }
}

fn sections(measured: &mut Measured) -> Vec<Section> {
    let comparisons = std::mem::take(&mut measured.comparisons);
    let pictures = std::mem::take(&mut measured.pictures);
    let mut sections = Vec::new();
    if let Some(found) = &measured.vertices {
        sections.push(vertex_section(found, measured.figures.vertices));
    }
    if let Some(sweeps) = &measured.sweeps {
        sections.push(sweep_section(sweeps));
    }
    if let Some(image) = &measured.image {
        let mut section = image_section(image, measured);
        section.blocks.extend(comparisons);
        sections.push(section);
    }
    if !measured.glossy.is_empty() {
        sections.push(glossy_section(measured));
    }
    sections.push(methods::section());
    sections.push(Section {
        heading: "Pictures".to_owned(),
        anchor: "pictures".to_owned(),
        paragraphs: vec![
            "The functions are those of the partition in the middle of the picture.".to_owned(),
        ],
        blocks: pictures,
    });
    sections.push(Section {
        heading: "This report".to_owned(),
        anchor: "this-report".to_owned(),
        paragraphs: Vec::new(),
        blocks: vec![tables::chapter_times(&measured.chapter_seconds)],
    });
    sections
}

fn vertex_section(found: &Vertices, vertex_count: usize) -> Section {
    let receivers = found.truth.receivers.len();
    let compared = if receivers == vertex_count {
        format!("All {receivers} vertices are compared.")
    } else {
        format!(
            "{receivers} of {vertex_count} vertices are compared, spread evenly over the scene."
        )
    };
    let mut blocks = vec![
        tables::vertex_errors(found),
        tables::parts(found),
        tables::errors_by_kind(found),
    ];
    blocks.extend(tables::errors_by_contact(found));
    blocks.extend([tables::extremes(found), tables::paths(found)]);
    Section {
        heading: "Indirect light at the vertices".to_owned(),
        anchor: "vertices".to_owned(),
        paragraphs: vec![
            format!(
                "{} test lights that chose and tuned nothing and bring indirect light, of {LIGHTS} \
                 (points and spots in free \
                 space; suns and skies where the scene is open). The error of a light is \
                 sqrt(sum A (E - R)^2 / sum A R^2) of its indirect light alone, the signed error \
                 that of its sum; mean, 95th percentile, worst and signed mean are over the \
                 lights. The standard error is that of the mean error, as if the lights \
                 had been drawn at random; they are spread evenly over what makes them hard, so \
                 it is less in truth.",
                found.lights_that_arrive(),
            ),
            format!(
                "{compared} R is their row of the true transfer, by {} rays in two independent \
                 halves, whose difference is its noise. The bounces before the last one use a row \
                 of every vertex, sampled in the same halves. Rows are used and forgotten one by \
                 one, so no matrix of all vertices exists.",
                2 * LAST_RAYS
            ),
            format!(
                "One bounce is that of direct light on white surfaces, what a bake states of \
                 itself too; {BOUNCES} bounces are on the scene's albedo, the mean of its \
                 channels."
            ),
            format!(
                "Parts: noise is that of the sampled rows, before anything is left out; basis \
                 what the functions cannot express with the near field; compression what is \
                 stored against the sampled rows on all functions. Vertex sampling compares \
                 direct light by up to 8 points of each area with that by {MANY_POINTS}, through \
                 the same true rows; areas partly inside a body keep their points, and skies are \
                 left out."
            ),
            format!(
                "Against the path tracer: up to {VERTICES} random vertices, {PATHS} paths each, \
                 from points of the vertex's area. That error holds everything, the \
                 discretisation of light into vertices too."
            ),
        ],
        blocks,
    }
}

fn sweep_section(sweeps: &Sweeps) -> Section {
    let mut paragraphs = vec![
        "Every point is a bake of its own, measured at the same vertices under the same lights; \
         what a sweep does not change, and the default, is as the scene asks for it or, of \
         relume's own scheme where it asks for an error, as was found for that. Functions are those of the basis as \
         built: equal eigenvalues stay together. Bytes are those of the operator, without the \
         basis. Milliseconds are the least of several tries on all threads, of the bounces alone."
            .to_owned(),
    ];
    if sweeps.is_reduced {
        paragraphs.push(format!(
            "The points share their rays, which are kept in memory: functions and coefficients \
             are swept by {}, fewer than the scene's bake has, rows marked \"default\" too. The \
             sweep of rays has nothing in between.",
            rays_text(sweeps.rays)
        ));
    }
    let mut blocks = Vec::new();
    for (swept, points) in &sweeps.points {
        blocks.extend(tables::sweep_plots(*swept, points));
        blocks.push(tables::sweep_table(*swept, points));
        if *swept == Swept::Coefficients {
            blocks.push(tables::equal_bytes(&sweeps.points));
        }
    }
    Section {
        heading: "Error against what it costs".to_owned(),
        anchor: "sweeps".to_owned(),
        paragraphs,
        blocks,
    }
}

/// Rays of relume's own scheme and of the published one.
fn rays_text([relume, paper]: [u32; 2]) -> String {
    match relume == paper {
        true => format!("{relume} rays a vertex"),
        false => format!("{relume} rays a vertex (the published scheme {paper})"),
    }
}

fn glossy_section(measured: &Measured) -> Section {
    Section {
        heading: "Glossy surfaces".to_owned(),
        anchor: "glossy".to_owned(),
        paragraphs: vec![format!(
            "The component \"glossy\", bounced light by the materials' lobes, of frames whose \
             longer side has {LONGER_SIDE} pixels, with all glossy materials at one roughness: \
             16 slices a vertex against up to {MOST_SAMPLES} paths a pixel that are reflected by \
             lobes at the eye's end and diffusely before. Means of {SIDE} x {SIDE} pixels, \
             without the reference's noise. Below a roughness of 0.5 sixteen terms are broader \
             than the lobe: the picture is that of a rougher surface of the same albedo."
        )],
        blocks: vec![tables::glossy_errors(&measured.glossy)],
    }
}

fn image_section(image: &[Compared], measured: &Measured) -> Section {
    let [width, height] = measured.settings.frame.camera.size;
    let bake_seconds = measured.bake_seconds * measured.threads as f64;
    let tried = TRIED_SAMPLES.map(|samples| samples.to_string()).join(", ");
    Section {
        heading: "Frames against the path tracer".to_owned(),
        anchor: "image".to_owned(),
        paragraphs: vec![
            format!(
                "{width} x {height} pixels, {}, against {} paths a pixel in two halves of \
                 independent seeds; direct light is traced apart with as many. relRMSE is \
                 sqrt(sum (frame - reference)^2 / sum reference^2) of linear light, bias the same \
                 of the sums; half the difference of the halves is the reference's noise, which \
                 is taken off in quadrature. FLIP is that of the developed frames, with the \
                 reference's noise in it: the halves differ by twice that noise.",
                bounces(measured.settings.frame.bounces),
                measured.settings.samples / 2 * 2,
            ),
            format!(
                "Times are of one thread by the clock: the median of {TIMED_FRAMES} frames in \
                 which every light changed (of a gather, one frame), and the path tracer at {} paths a pixel. Its error is \
                 measured at {tried} paths. The bake took {:.1} s on {} threads; break-even \
                 counts their product.",
                TRIED_SAMPLES[TRIED_SAMPLES.len() - 1],
                measured.bake_seconds,
                measured.threads,
            ),
        ],
        blocks: vec![
            tables::image_errors(image),
            tables::image_flip(image),
            tables::image_times(image, bake_seconds),
            tables::path_errors(image),
        ],
    }
}
