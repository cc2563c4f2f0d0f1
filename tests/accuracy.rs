//! What relume promises of its accuracy, by its own report: ignored by default, since
//! a report takes minutes. Run it, with nothing else on the machine, as
//! `cargo test --release --test accuracy -- --ignored --nocapture --test-threads 1`.
#![allow(clippy::print_stdout, reason = "its figures are for reading")]

mod program;

use serde_json::Value;

use program::{relume, scene, succeed, temporary_folder};

/// A scene with a mesh so coarse that the dense transfer of all its vertices is known.
struct Subject {
    name: &'static str,
    edge: &'static str,
    /// Error of indirect light over lights that no bake knows, of one bounce and of four:
    /// a third above what is measured.
    most_error: [f64; 2],
}

/// Measured: 1.04 and 0.82 %, 0.90 and 0.65 %, 1.93 and 1.46 %.
const SUBJECTS: [Subject; 3] = [
    Subject {
        name: "cornell",
        edge: "bake.max_edge=0.12",
        most_error: [0.014, 0.011],
    },
    Subject {
        name: "sheet",
        edge: "bake.max_edge=0.14",
        most_error: [0.012, 0.009],
    },
    Subject {
        name: "window",
        edge: "bake.max_edge=0.25",
        most_error: [0.026, 0.02],
    },
];
/// The same at the 95th percentile of the lights, for any scene: 5.0 % is measured (window).
const MOST_ERROR_P95: f64 = 0.08;
/// And with its sign: 0.06 % is measured (sheet, window).
const MOST_SIGNED: f64 = 0.005;
/// Bytes a vertex for which that is promised.
const MOST_BYTES: f64 = 160.0;
/// What a bake states of itself, relative to what the report finds under other lights:
/// up to 4 % is measured by these meshes, 13 % at their own (statues).
const STATED_WITHIN: f64 = 0.2;
/// What a bake is asked for.
const ASKED: f64 = 0.02;
/// How many times as wrong the published scheme is within the same bytes: 6 to 9 is
/// measured by relume's partitions.
const LEAST_RATIO: f64 = 3.0;
/// Mean FLIP of a frame against 512 paths a pixel, whose grain is in it: 0.022 is measured
/// (window).
const MOST_FLIP: f64 = 0.03;
/// Time of paths over that of a frame of the same error of 8 x 8 means, in the window's
/// room: 320 is measured.
const LEAST_SPEED: f64 = 100.0;
/// A report of the box, some 12,000 vertices, on two idle cores, seconds: 192 is measured.
const MOST_SECONDS: f64 = 360.0;

/// The figures of a report, as `relume measure --json` prints them.
struct Figures(Value);

impl Figures {
    fn of(&Subject { name, edge, .. }: &Subject, arguments: &[&str]) -> Self {
        let folder = temporary_folder();
        let mut command = relume(&["measure", "--json", "--set", edge]);
        command.arg(scene(name)).args(arguments);
        command.arg("-o").arg(folder.path().join("report"));
        Self(succeed(&mut command).json())
    }

    /// A number by the names of what it is in, one after another.
    fn at(&self, path: &str) -> f64 {
        let value = self.0.pointer(path).and_then(Value::as_f64);
        value.unwrap_or_else(|| panic!("no number at {path}: {}", self.0))
    }

    /// Mean error of one bounce, found by the report.
    fn found(&self) -> f64 {
        self.at("/schemes/relume/one_bounce/mean")
    }

    fn stated_is_found(&self, name: &str) {
        let (stated, found) = (self.at("/stated/mean"), self.found());
        println!("{name}: stated {stated:.4}, found {found:.4}");
        let off = (stated / found - 1.0).abs();
        assert!(off <= STATED_WITHIN, "{name}: stated {stated}, {found}");
    }
}

#[test]
#[ignore = "three reports, some fifteen minutes; a frame's time is a figure of it"]
fn defaults_are_as_accurate_as_promised() {
    for subject in &SUBJECTS {
        let (name, figures) = (subject.name, Figures::of(subject, &[]));
        let bytes = figures.at("/schemes/relume/bytes_per_vertex");
        assert!(bytes <= MOST_BYTES, "{name}: {bytes} bytes a vertex");
        let all_bounces = ["one_bounce", "four_bounces"].into_iter();
        for (bounces, most) in all_bounces.zip(subject.most_error) {
            let [mean, p95, signed] = ["mean", "p95", "signed"]
                .map(|key| figures.at(&format!("/schemes/relume/{bounces}/{key}")));
            println!("{name}, {bounces}: {mean:.4}, {p95:.4}, {signed:+.5}");
            assert!(mean <= most, "{name}, {bounces}: {mean}");
            assert!(p95 <= MOST_ERROR_P95, "{name}, {bounces}: {p95}");
            assert!(signed.abs() <= MOST_SIGNED, "{name}, {bounces}: {signed}");
        }
        figures.stated_is_found(name);
        for size in 0..3 {
            let at = |key: &str| figures.at(&format!("/paper_over_relume/{size}/{key}"));
            let (ratio, bytes) = (at("ratio"), at("bytes_per_vertex"));
            println!("{name}: {ratio:.1} times as wrong within {bytes} bytes");
            assert!(ratio >= LEAST_RATIO, "{name}, {bytes} bytes: {ratio}");
        }
        let flip = figures.at("/images/global/flip/mean");
        println!("{name}: FLIP {flip:.4}");
        assert!(flip <= MOST_FLIP, "{name}: {flip}");
        if name == "window" {
            let path = "/images/global/blocks/ratio";
            // An error below the paths' noise is reached at no time: JSON knows no infinity.
            let is_endless = figures.0.pointer(path) == Some(&Value::Null);
            let times = if is_endless {
                f64::INFINITY
            } else {
                figures.at(path)
            };
            println!("{name}: paths take {times:.0} times as long");
            assert!(times >= LEAST_SPEED, "{name}: {times}");
        }
        if name == "cornell" {
            let seconds = figures.at("/seconds");
            println!("{name}: {seconds:.0} s");
            assert!(seconds <= MOST_SECONDS, "{name}: {seconds} s");
        }
    }
}

#[test]
#[ignore = "two reports and the searches before them, some eight minutes"]
fn an_error_asked_for_is_kept_under_other_lights() {
    for subject in &SUBJECTS[..2] {
        let name = subject.name;
        let asked = ASKED.to_string();
        let figures = Figures::of(subject, &["--error", &asked]);
        figures.stated_is_found(name);
        let found = figures.found();
        assert!(found <= ASKED, "{name}: {found} for {ASKED}");
    }
}
