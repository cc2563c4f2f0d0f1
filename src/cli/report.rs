//! What a command says at its end: a JSON object, or lines for a person.

use relume::{BakeFigures, LightErrors, SceneFigures, Stages};
use serde_json::{Map, Value, json};

use super::error::CliError;

/// A finished command.
pub(super) struct Report {
    pub(super) json: Value,
    pub(super) text: String,
    pub(super) exit_code: u8,
}

impl Report {
    /// Prints the one or the other on standard output. A reader that has gone
    /// away (a closed pipe) is no error; a full disk is.
    pub(super) fn print(&self, json: bool) -> Result<(), CliError> {
        use std::io::{ErrorKind, Write};
        let mut out = std::io::stdout().lock();
        let written = if json {
            writeln!(out, "{}", self.json)
        } else if self.text.is_empty() {
            Ok(())
        } else {
            writeln!(out, "{}", self.text)
        };
        match written.and_then(|()| out.flush()) {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => {
                Err(CliError::StandardOutput(error))
            }
            _ => Ok(()),
        }
    }
}

/// Milliseconds by stage, with `total`.
pub(super) fn stage_times(stages: &[&Stages]) -> Value {
    let mut object = Map::new();
    for &(name, time_ms) in stages.iter().flat_map(|s| s.times_ms()) {
        object.insert(stage_key(name), rounded(time_ms));
    }
    object.insert(
        "total".to_owned(),
        rounded(stages.iter().map(|s| s.total_ms()).sum()),
    );
    Value::Object(object)
}

/// A stage as a key of JSON.
pub(super) fn stage_key(stage: &str) -> String {
    stage.replace(' ', "_")
}

/// Microseconds are as fine as clocks are worth printing.
pub(super) fn rounded(time_ms: f64) -> Value {
    json!((time_ms * 1e3).round() / 1e3)
}

/// The figures of a scene and its bake as keys of a report.
pub(super) fn add_figures(object: &mut Value, figures: &SceneFigures) {
    let bake = figures.bake;
    let number = |value: fn(&BakeFigures) -> Value| bake.as_ref().map_or(json!(0), value);
    object["vertices"] = json!(figures.vertices);
    object["back_vertices"] = json!(figures.back_vertices);
    object["triangles"] = json!(figures.triangles);
    object["max_edge"] = json!(figures.max_edge);
    object["partitions"] = number(|b| json!(b.partitions));
    object["functions"] = number(|b| json!(b.functions));
    object["coefficients_per_vertex"] = number(|b| json!(b.coefficients_per_vertex));
    object["bake_bytes"] = number(|b| json!(b.bytes));
    object["row_bytes"] = number(|b| json!(b.row_bytes));
    if let Some(bake) = figures.bake.filter(|b| b.glossy_vertices > 0) {
        object["glossy_vertices"] = json!(bake.glossy_vertices);
        object["slice_coefficients_per_vertex"] = json!(bake.slice_coefficients_per_vertex);
        object["slice_bytes"] = json!(bake.slice_bytes);
    }
    object["cache"] = bake.map_or(json!("none"), |b| {
        json!(if b.cached { "hit" } else { "miss" })
    });
    if let Some(bake) = bake {
        object["bake"] = json!({
            "scheme": bake.stats.scheme.name(),
            "partitioner": bake.stats.partitioner.name(),
            "rays": bake.stats.rays,
            "arrived_share": bake.stats.arrived_share,
            "escaped_share": bake.stats.escaped_share,
            "senders_per_group": bake.stats.senders_per_group,
            "largest_eigenvalue": bake.stats.largest_eigenvalue,
            "energy_mean": bake.stats.energy_mean,
            "energy_worst": bake.stats.energy_worst,
            "error": errors(&bake.stats.errors.total),
            "error_of": {
                "sampling_noise": errors(&bake.stats.errors.noise),
                "basis": errors(&bake.stats.errors.basis),
                "compression": errors(&bake.stats.errors.compression),
            },
            "noise_of_truth": bake.stats.errors.truth.mean,
        });
        if let Some(folding) = bake.stats.folding {
            object["folded_bytes"] = json!(bake.folded_bytes);
            object["bake"]["error_of_folding"] = errors(&folding);
        }
    }
}

/// Relative errors of indirect light over test lights.
pub(super) fn errors(errors: &LightErrors) -> Value {
    json!({
        "mean": errors.mean,
        "p95": errors.p95,
        "worst": errors.worst,
        "signed": errors.signed,
        "lights": errors.lights,
    })
}

/// How exact indirect light is.
fn error_text(errors: &LightErrors) -> String {
    if errors.lights == 0 {
        return "no test light brings indirect light".to_owned();
    }
    format!("indirect light within {:.1} %", errors.mean * 100.0)
}

/// What is to be said of folded bounces.
fn folding_text(bake: &BakeFigures) -> String {
    bake.stats.folding.map_or(String::new(), |folding| {
        let percent = folding.mean * 100.0;
        format!(", all bounces folded within {percent:.2} %")
    })
}

/// One sentence on a scene and its bake.
pub(super) fn figures_text(figures: &SceneFigures) -> String {
    let mesh = format!(
        "{} vertices, {} triangles",
        figures.vertices, figures.triangles
    );
    match figures.bake {
        None => mesh,
        Some(bake) => format!(
            "{mesh}, {} functions, {:.0} coefficients a vertex, {}{}, \
             bake of {:.1} MB {}",
            bake.functions,
            bake.coefficients_per_vertex,
            error_text(&bake.stats.errors.total),
            folding_text(&bake),
            bake.bytes as f64 / 1e6,
            if bake.cached {
                "from the cache"
            } else {
                "made"
            }
        ),
    }
}
