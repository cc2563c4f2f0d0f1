//! The verdicts as one JSON object: `summary.json`, and what `--json` prints.

use std::path::PathBuf;

use relume::golden::{Checked, Verdict};
use serde_json::{Value, json};

use super::text_of;
use crate::cli::diff::judgement_json;
use crate::cli::report::rounded;

/// Raised when a key changes its meaning or goes away.
const SCHEMA: u32 = 1;

pub(super) fn of_check(checked: &[Checked], without_scene: &[PathBuf]) -> Value {
    let passed = checked.iter().filter(|it| it.passes()).count();
    json!({
        "schema": SCHEMA,
        "passes": passed == checked.len(),
        "scenes": checked.len(),
        "passed": passed,
        "failed": checked.len() - passed,
        "results": checked.iter().map(result).collect::<Vec<_>>(),
        "goldens_without_scene": without_scene.iter().map(|it| text_of(it)).collect::<Vec<_>>(),
    })
}

fn result(checked: &Checked) -> Value {
    let comparison = match &checked.verdict {
        Verdict::Passes(judgement) => judgement_json(judgement, &[]),
        Verdict::Differs {
            judgement,
            metadata,
        } => judgement_json(judgement, metadata),
        _ => Value::Null,
    };
    json!({
        "scene": text_of(checked.scene.scene()),
        "golden": text_of(checked.scene.golden()),
        "passes": checked.passes(),
        "verdict": checked.verdict.name(),
        "problems": checked.verdict.problems(),
        "warnings": checked.warnings,
        "comparison": comparison,
        "ms": rounded(checked.time_ms),
    })
}
