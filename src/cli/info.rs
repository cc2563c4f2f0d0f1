//! `relume info`: what a scene asks for and what it will cost.

use relume::measure::{ReportSettings, report_seconds};
use relume::{BakeForecast, Bounces, LightCounts, Outlook, Renderer, Scene, SkyView};
use serde_json::{Value, json};

use super::args::{Info, Run};
use super::error::CliError;
use super::report::Report;
use super::run::{cache_folder, load_scene, say, warn, with_run};

/// Bakes that take longer than this are announced, seconds.
const LONG_BAKE: f64 = 20.0;

pub(super) fn execute(arguments: &Info) -> Result<Report, CliError> {
    let scene = load_scene(&arguments.scene)?;
    let folder = cache_folder(&arguments.scene.run);
    let (outlook, warnings) = with_run(&arguments.scene.run, |run| {
        let mut renderer = Renderer::with_scheme(scene, folder.as_deref(), arguments.scene.scheme);
        let outlook = renderer.outlook(run)?;
        Ok((outlook, renderer.take_warnings()))
    })?;
    warn(warnings);
    Ok(Report {
        json: object(&outlook),
        text: text(&outlook),
        exit_code: 0,
    })
}

fn object(outlook: &Outlook) -> Value {
    let (contents, lights, bake) = (&outlook.contents, &outlook.contents.lights, &outlook.bake);
    json!({
        "file_triangles": contents.triangles,
        "triangles": outlook.triangles,
        "vertices": bake.vertices,
        "front_vertices": bake.vertices - bake.back_vertices,
        "back_vertices": bake.back_vertices,
        "sides_are_exact": bake.sides_are_exact,
        "glossy_vertices": bake.glossy_vertices,
        "max_edge": outlook.max_edge,
        "max_edge_asked": outlook.max_edge_asked,
        "extent": contents.extent,
        "materials": contents.materials,
        "images": {
            "count": contents.images.count,
            "pixels": contents.images.pixels,
            "bytes": contents.images.bytes,
        },
        "lights": kinds(lights).into_iter().collect::<serde_json::Map<_, _>>(),
        "emitting_triangles": lights.emitting_triangles,
        "suns": lights.suns,
        "sky": match outlook.sky_view() {
            SkyView::Fronts => "present",
            SkyView::BacksAlone => "outside",
            SkyView::Nobody => "absent",
        },
        "escaped_share_of_fronts": outlook.escaped_share_of_fronts,
        "escaped_share": bake.escaped_share,
        "cache": if bake.cached { "hit" } else { "miss" },
        "scheme": bake.scheme.name(),
        "partitioner": bake.partitioner.name(),
        "rays": bake.rays,
        "partitions": bake.partitions,
        "functions": bake.functions,
        "coefficients_per_vertex": bake.coefficients_per_vertex,
        "bake_bytes": bake.bytes,
        "row_bytes": bake.row_bytes,
        "sky_bytes": bake.sky_bytes,
        "slice_bytes": bake.slice_bytes,
        "folded_bytes": bake.folded_bytes,
        "peak_bytes": bake.peak_bytes + contents.images.bytes,
        "bake_seconds": bake.seconds,
        "error_asked": outlook.error_asked,
        "size": outlook.frame.camera.size,
        "bounces": match outlook.frame.bounces {
            Bounces::All => json!("all"),
            Bounces::Count(count) => json!(count),
        },
        "shadow_rays_a_pixel": outlook.shadow_rays_a_pixel(),
    })
}

fn kinds(lights: &LightCounts) -> [(String, Value); 5] {
    [
        ("point", lights.point),
        ("spot", lights.spot),
        ("directional", lights.directional),
        ("area", lights.area),
        ("environment", lights.environment),
    ]
    .map(|(kind, count)| (kind.to_owned(), json!(count)))
}

/// Lines for a person: a name, then what there is to say.
fn text(outlook: &Outlook) -> String {
    let lines = [
        ("scene", scene_text(outlook)),
        ("lights", lights_text(outlook)),
        ("mesh", mesh_text(outlook)),
        ("sky", sky_text(outlook)),
        ("glossy", glossy_text(&outlook.bake)),
        ("basis", basis_text(&outlook.bake)),
        ("bake", bake_text(outlook)),
        ("frame", frame_text(outlook)),
    ];
    let lines = lines.map(|(name, text)| format!("{name:<7} {text}"));
    lines.join("\n")
}

fn scene_text(outlook: &Outlook) -> String {
    let contents = &outlook.contents;
    let mut text = format!(
        "{}, longest side {}, {}",
        counted(contents.triangles, "triangle"),
        brief(contents.extent),
        counted(contents.materials, "material"),
    );
    let images = contents.images;
    if images.count > 0 {
        text.push_str(&format!(
            ", {} of {:.1} million pixels ({} in memory)",
            counted(images.count, "image"),
            images.pixels as f64 / 1e6,
            megabytes(images.bytes),
        ));
    }
    text
}

fn lights_text(outlook: &Outlook) -> String {
    let lights = &outlook.contents.lights;
    let mut parts: Vec<String> = [
        ("point", lights.point),
        ("spot", lights.spot),
        ("directional", lights.directional),
        ("area", lights.area),
        ("environment", lights.environment),
    ]
    .into_iter()
    .filter(|&(_, count)| count > 0)
    .map(|(kind, count)| format!("{count} {kind}"))
    .collect();
    if lights.emitting_triangles > 0 {
        parts.push(counted(lights.emitting_triangles, "emitting triangle"));
    }
    if lights.suns > 0 {
        parts.push(format!("{} of a map", counted(lights.suns, "sun")));
    }
    if parts.is_empty() {
        return "none: the picture will be black".to_owned();
    }
    format!(
        "{}; {} a pixel",
        parts.join(", "),
        counted(outlook.shadow_rays_a_pixel(), "shadow ray"),
    )
}

fn mesh_text(outlook: &Outlook) -> String {
    let bake = &outlook.bake;
    let about = if bake.sides_are_exact { "" } else { "about " };
    let fronts = bake.vertices - bake.back_vertices;
    let asked = outlook.max_edge_asked.map_or(String::new(), |asked| {
        let asked = brief(asked);
        format!(" ({asked} would make more vertices than bake.vertices allows)")
    });
    format!(
        "{}, edges up to {}{asked}, {}; {about}{} of these have a back side that is seen or lit",
        counted(outlook.triangles, "triangle"),
        brief(outlook.max_edge),
        counted(fronts, "vertex"),
        grouped(bake.back_vertices),
    )
}

fn sky_text(outlook: &Outlook) -> String {
    let bake = &outlook.bake;
    let shares = format!(
        "of all rays {} escape, of those of front sides {}",
        percent(bake.escaped_share),
        percent(outlook.escaped_share_of_fronts),
    );
    let has_environment = outlook.contents.lights.environment > 0;
    let meaning = match (outlook.sky_view(), has_environment) {
        (SkyView::Fronts, true) => "the sky's light is baked, and an environment uses it",
        (SkyView::Fronts, false) => "the sky's light is baked, and no environment uses it so far",
        (SkyView::BacksAlone, true) => {
            "closed but for the outside: the environment lights back sides alone"
        }
        (SkyView::BacksAlone, false) => {
            "closed but for the outside: an environment would light back sides alone"
        }
        (SkyView::Nobody, true) => {
            "absent, since the scene is closed: the environment lights only its outside"
        }
        (SkyView::Nobody, false) => "absent, since the scene is closed",
    };
    format!("{meaning}; {shares}")
}

fn percent(share: f64) -> String {
    match share * 100.0 {
        0.0 => "none".to_owned(),
        percent if percent < 0.1 => format!("{percent:.3} %"),
        percent => format!("{percent:.1} %"),
    }
}

fn basis_text(bake: &BakeForecast) -> String {
    format!(
        "{}, {}, {:.0} coefficients a vertex, {}",
        counted(bake.partitions, "partition"),
        counted(bake.functions, "function"),
        bake.coefficients_per_vertex,
        counted(bake.rays as usize, "ray") + " a vertex",
    )
}

fn glossy_text(bake: &BakeForecast) -> String {
    if bake.glossy_vertices == 0 {
        return "no material: nothing is kept for the final glossy bounce".to_owned();
    }
    format!(
        "16 slices at {} of {}, {}",
        counted(bake.glossy_vertices, "vertex"),
        grouped(bake.vertices),
        megabytes(bake.slice_bytes)
    )
}

fn bake_text(outlook: &Outlook) -> String {
    let bake = &outlook.bake;
    let mut rows = format!("{} of it rows", megabytes(bake.row_bytes + bake.sky_bytes));
    if bake.folded_bytes > 0 {
        rows.push_str(&format!(
            " and {} all bounces",
            megabytes(bake.folded_bytes)
        ));
    }
    if bake.cached {
        return format!("cached, {}, {rows}: nothing to do", megabytes(bake.bytes));
    }
    let search = outlook
        .error_asked
        .map_or(String::new(), |error| format!("; {}", search_text(error)));
    format!(
        "not cached: about {}, {}, {rows}; {} of memory{search}",
        seconds(bake.seconds),
        megabytes(bake.bytes),
        megabytes(bake.peak_bytes + outlook.contents.images.bytes),
    )
}

fn frame_text(outlook: &Outlook) -> String {
    let [width, height] = outlook.frame.camera.size;
    let bounces = match outlook.frame.bounces {
        Bounces::All => "all bounces".to_owned(),
        Bounces::Count(count) => counted(count as usize, "bounce"),
    };
    format!("{width} x {height}, {bounces}")
}

/// A count with its noun.
fn counted(count: usize, noun: &str) -> String {
    match (count, noun.strip_suffix("ex")) {
        (1, _) => format!("1 {noun}"),
        (_, Some(stem)) => format!("{} {stem}ices", grouped(count)),
        _ => format!("{} {noun}s", grouped(count)),
    }
}

/// Digits in groups of three.
fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Three digits of a length.
fn brief(length: f64) -> String {
    if (0.01..1e5).contains(&length) {
        let text = format!("{length:.3}");
        return text.trim_end_matches('0').trim_end_matches('.').to_owned();
    }
    format!("{length:.2e}")
}

fn megabytes(bytes: usize) -> String {
    match bytes as f64 / 1e6 {
        megabytes if megabytes < 9.95 => format!("{megabytes:.1} MB"),
        megabytes => format!("{megabytes:.0} MB"),
    }
}

/// A duration, as exact as a forecast is.
fn seconds(seconds: f64) -> String {
    match seconds {
        s if s < 9.5 => format!("{s:.1} s"),
        s if s < 119.5 => format!("{s:.0} s"),
        s if s < 7170.0 => format!("{:.0} minutes", s / 60.0),
        s => format!("{:.1} hours", s / 3600.0),
    }
}

/// Front vertices below which no bake is long.
const LONG_BAKE_VERTICES: usize = 10_000;

/// Says on standard error how long a report will take, if it is long.
pub(super) fn announce_report(
    scene: &Scene,
    settings: &ReportSettings,
    arguments: &Run,
) -> Result<(), CliError> {
    if scene.bake.error.is_some() {
        return Ok(());
    }
    let bake = with_run(arguments, |run| {
        Ok(Renderer::new(scene.clone(), None).outlook(run)?.bake)
    })?;
    let forecast = report_seconds(scene, settings, bake.vertices, bake.seconds);
    if let Some(forecast) = forecast.filter(|it| *it > LONG_BAKE) {
        say(&[format!(
            "report: about {}, of which the bake {}",
            seconds(forecast),
            seconds(bake.seconds)
        )]);
    }
    Ok(())
}

/// What a forecast does not know.
fn search_text(error: f64) -> String {
    format!(
        "a search for {} comes first and may change rays, functions and coefficients, and with \
         them all of this",
        percent(error)
    )
}

/// Says on standard error how long the bake will take, if it is long.
pub(super) fn announce_bake(renderer: &mut Renderer, arguments: &Run) -> Result<(), CliError> {
    // The forecast itself takes a moment; no small scene is worth it.
    if renderer.figures().vertices < LONG_BAKE_VERTICES {
        return Ok(());
    }
    let outlook = with_run(arguments, |run| Ok(renderer.outlook(run)?))?;
    let bake = outlook.bake;
    if bake.seconds > LONG_BAKE {
        let rest = match outlook.error_asked {
            Some(error) => search_text(error),
            None => "`relume info` says more".to_owned(),
        };
        say(&[format!(
            "bake: about {}, {}; {rest}",
            seconds(bake.seconds),
            megabytes(bake.bytes)
        )]);
    }
    Ok(())
}
