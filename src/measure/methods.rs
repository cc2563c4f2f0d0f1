//! How the method was chosen: variants that were tried before, as a table that
//! was recorded then.
//!
//! `methods.csv` holds a row for every variant and scene. Variants that lost may
//! have left the code; their rows stay. The laboratory that measured them stands in
//! the history of the repository (`src/measure/laboratory.rs`, in the commit that
//! the table's head names).

use super::tables;
use crate::report::Section;

/// The recorded table.
const TABLE: &str = include_str!("methods.csv");
/// What was found of one variant in one scene. Errors in per cent; `None`: not
/// measured.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Finding {
    pub(super) scene: String,
    /// Entries a vertex that were asked for, changed until bytes are like those of
    /// the chosen variant.
    pub(super) entries: Option<f64>,
    /// Mean, 95th percentile and signed mean over the lights after one bounce.
    pub(super) one: [f64; 3],
    /// After four.
    pub(super) four: Option<[f64; 3]>,
    /// Bytes a vertex.
    pub(super) bytes: Option<f64>,
    /// Seconds of the processor for the vertices that were baked.
    pub(super) cpu_seconds: Option<f64>,
}

/// One variant.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Variant {
    pub(super) name: String,
    /// Whether the method has it.
    pub(super) chosen: bool,
    pub(super) findings: Vec<Finding>,
}

/// Variants of one knob.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Knob {
    pub(super) name: String,
    /// Why the chosen variant was.
    pub(super) reason: String,
    pub(super) variants: Vec<Variant>,
}

/// All that was tried.
pub(super) fn knobs() -> Vec<Knob> {
    let lines = TABLE.lines().filter(|line| !line.starts_with('#'));
    let mut knobs: Vec<Knob> = Vec::new();
    for line in lines.skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let number = |field: usize| fields.get(field)?.parse::<f64>().ok();
        let three = |first: usize| Some([number(first)?, number(first + 1)?, number(first + 2)?]);
        let (Some(one), Some(&[knob, variant, chosen, scene])) = (three(5), fields.first_chunk())
        else {
            continue;
        };
        let finding = Finding {
            scene: scene.to_owned(),
            entries: number(4),
            one,
            four: three(8),
            bytes: number(11),
            cpu_seconds: number(12),
        };
        if knobs.last().is_none_or(|last| last.name != knob) {
            knobs.push(Knob {
                name: knob.to_owned(),
                reason: reason(knob).unwrap_or_default(),
                variants: Vec::new(),
            });
        }
        let variants = &mut knobs.last_mut().expect("one was pushed").variants;
        if variants.last().is_none_or(|last| last.name != variant) {
            variants.push(Variant {
                name: variant.to_owned(),
                chosen: chosen == "yes",
                findings: Vec::new(),
            });
        }
        let last = variants.last_mut().expect("one was pushed");
        last.findings.push(finding);
    }
    knobs
}

/// How many variants were tried: those that lost, and the method.
pub(super) fn tried(knobs: &[Knob]) -> usize {
    let variants = knobs.iter().flat_map(|knob| &knob.variants);
    variants.filter(|variant| !variant.chosen).count() + 1
}

/// What the head of the table says.
fn remarks() -> Vec<String> {
    let remark = |line: &str| line.strip_prefix("# ").map(str::to_owned);
    TABLE.lines().filter_map(remark).collect()
}

/// Why the chosen variant of a knob was, as the head of the table says.
fn reason(knob: &str) -> Option<String> {
    let of_knob = |line: &str| {
        let (name, reason) = line.strip_prefix("#= ")?.split_once(": ")?;
        (name == knob).then(|| reason.to_owned())
    };
    TABLE.lines().find_map(of_knob)
}

/// The chapter.
pub(super) fn section() -> Section {
    let knobs = knobs();
    let mut paragraphs = vec![format!(
        "{} variants were tried, the method itself included. These figures are recorded: they were \
         not measured in this run, nor on this scene alone. What this table decided was \
         decided under lights that neither this report nor a bake states an error for.",
        tried(&knobs)
    )];
    paragraphs.extend(remarks());
    Section {
        heading: "How the method was chosen".to_owned(),
        anchor: "methods".to_owned(),
        paragraphs,
        blocks: knobs.iter().map(tables::knob).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::{BakeSettings, chosen_by, light_seeds, ray_seeds};
    use crate::measure::vertices::{LAST_SEEDS, LIGHT_SEED, ROW_SEEDS};
    use crate::scene::BakeKeys;

    /// Head of the table's columns.
    const HEAD: &str = "knob,variant,chosen,scene,entries,one_mean,one_p95,one_signed,four_mean,\
                        four_p95,four_signed,bytes,cpu_seconds";

    /// The number that a remark of the table's head begins with this word.
    fn recorded_seed() -> u32 {
        let remark = remarks()
            .into_iter()
            .find_map(|remark| Some(remark.split_once("seed 0x")?.1.to_owned()))
            .expect("the head names the seed of the lights");
        let digits: String = remark.chars().take_while(char::is_ascii_hexdigit).collect();
        u32::from_str_radix(&digits, 16).unwrap()
    }

    #[test]
    fn every_row_is_read_and_every_knob_has_one_choice() {
        let rows = TABLE.lines().filter(|line| !line.starts_with('#'));
        assert_eq!(rows.clone().next(), Some(HEAD));
        let knobs = knobs();
        let variants = || knobs.iter().flat_map(|knob| &knob.variants);
        let findings: usize = variants().map(|variant| variant.findings.len()).sum();
        assert_eq!(findings, rows.count() - 1, "no row is left out");
        for knob in &knobs {
            let chosen = knob.variants.iter().filter(|variant| variant.chosen);
            assert_eq!(chosen.count(), 1, "{}", knob.name);
            assert!(knob.variants.len() > 1, "{}", knob.name);
            assert!(!knob.reason.is_empty(), "{}: why?", knob.name);
            let counts = knob.variants.iter().map(|variant| variant.findings.len());
            let counts: std::collections::BTreeSet<usize> = counts.collect();
            assert_eq!(counts.len(), 1, "{}: all in the same scenes", knob.name);
        }
        for variant in variants() {
            let scenes = variant.findings.iter().map(|it| it.scene.as_str());
            let scenes: std::collections::BTreeSet<&str> = scenes.collect();
            let known = ["cornell", "window", "sheet", "statues", "bunny_room"];
            assert!(scenes.iter().all(|scene| known.contains(scene)));
            assert_eq!(scenes.len(), 5, "{}", variant.name);
            assert_eq!(scenes.len(), variant.findings.len(), "{}", variant.name);
            for finding in &variant.findings {
                assert!(finding.one[0] > 0.0 && finding.one[1] >= finding.one[0] * 0.5);
            }
        }
        assert!(tried(&knobs) > 40, "{}", tried(&knobs));
    }

    #[test]
    fn what_was_chosen_is_what_a_bake_does() {
        let defaults = BakeSettings::of_keys(&BakeKeys::default());
        let knobs = knobs();
        let chosen = |name: &str| -> String {
            let knob = knobs.iter().find(|knob| knob.name == name).unwrap();
            let variant = knob.variants.iter().find(|variant| variant.chosen);
            variant.unwrap().name.clone()
        };
        assert_eq!(chosen("rays"), defaults.rays.to_string());
        assert_eq!(chosen("entries"), defaults.coefficients.to_string());
        assert_eq!(
            chosen("functions for 1000 vertices"),
            defaults.function_count(1000).to_string()
        );
        assert_eq!(
            chosen("vertices a partition"),
            defaults.vertices_per_part.to_string()
        );
        for (knob, value) in chosen_by() {
            assert_eq!(chosen(knob).parse::<f64>().unwrap(), value, "{knob}");
        }
    }

    #[test]
    fn choosing_has_seen_no_light_of_a_report_or_a_bake() {
        let mut lights = light_seeds();
        lights.extend([recorded_seed(), LIGHT_SEED]);
        let mut rays = ray_seeds();
        rays.extend([ROW_SEEDS, LAST_SEEDS].concat());
        for mut seeds in [lights, rays] {
            let count = seeds.len();
            seeds.sort_unstable();
            seeds.dedup();
            assert_eq!(seeds.len(), count, "two are one: {seeds:x?}");
        }
    }
}
