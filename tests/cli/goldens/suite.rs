//! A suite of small scenes in the folder of a test, and readers of its reports.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use serde_json::Value;

use crate::program::{Finished, relume, run, succeed, temporary_folder};

/// A floor that is seen from above.
pub(super) const MESH: &str = "o floor\nv -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 4 3 2 1\n";

/// A scene of direct light, which needs no bake.
pub(super) fn scene_text(intensity: &str) -> String {
    format!(
        "mesh = \"floor.obj\"\n\
         [camera]\nposition = [0.0, 2.0, 1.5]\ntarget = [0.0, 0.0, 0.0]\nvfov = 40.0\n\
         size = [16, 12]\n\
         [[light]]\nname = \"lamp\"\nkind = \"point\"\nposition = [0.3, 0.8, 0.1]\n\
         intensity = [{intensity}, 1.0, 1.0]\n\
         [render]\nbounces = 0\n"
    )
}

/// A suite with goldens in the folder of a test.
pub(super) struct Suite {
    folder: tempfile::TempDir,
}

impl Suite {
    /// Scenes of these names, blessed.
    pub(super) fn of(names: &[&str]) -> Self {
        let suite = Self {
            folder: temporary_folder(),
        };
        fs::create_dir_all(suite.at("golden")).expect("the folder can be made");
        suite.write("scenes/floor.obj", MESH);
        for name in names {
            suite.write(&format!("scenes/{name}.toml"), &scene_text("1.0"));
        }
        if !names.is_empty() {
            succeed(&mut suite.command("bless", &[]));
        }
        suite
    }

    pub(super) fn at(&self, path: &str) -> PathBuf {
        self.folder.path().join(path)
    }

    pub(super) fn write(&self, path: &str, text: &str) {
        let path = self.at(path);
        fs::create_dir_all(path.parent().expect("a file lies in a folder"))
            .expect("the folder can be made");
        fs::write(path, text).expect("the file can be written");
    }

    pub(super) fn command(&self, name: &str, arguments: &[&str]) -> Command {
        let mut command = relume(&["golden", name, "--no-cache"]);
        command.args(arguments).current_dir(self.folder.path());
        // The tests themselves may run in a CI.
        for variable in [
            "CI",
            "GITHUB_ACTIONS",
            "GITHUB_STEP_SUMMARY",
            "GITHUB_WORKSPACE",
        ] {
            command.env_remove(variable);
        }
        command
    }

    /// `check --json` and the one object that it prints.
    pub(super) fn check(&self, exit_code: i32) -> (Finished, Value) {
        let finished = run(&mut self.command("check", &["--json"]));
        assert_eq!(finished.exit_code, Some(exit_code), "{finished:#?}");
        let report = finished.json();
        let summary =
            fs::read(self.at("golden-report/summary.json")).expect("the report is complete");
        let summary: Value = serde_json::from_slice(&summary).expect("the report is complete");
        assert_eq!(report, summary, "the file holds what --json prints");
        (finished, report)
    }

    /// Verdicts by scene.
    pub(super) fn verdicts(report: &Value) -> Vec<(String, String)> {
        let text = |value: &Value| value.as_str().expect("the report is complete").to_owned();
        let results = report["results"]
            .as_array()
            .expect("the report is complete")
            .iter();
        results
            .map(|it| (text(&it["scene"]), text(&it["verdict"])))
            .collect()
    }

    pub(super) fn report_file(&self, name: &str) -> String {
        fs::read_to_string(self.at("golden-report").join(name)).expect("the report is complete")
    }
}

/// (name of the case, type of its failure or error) of each case that did not
/// pass, after a check of the counts.
pub(super) fn failed_cases(junit: &str) -> Vec<(String, String)> {
    let document = roxmltree::Document::parse(junit).expect("the report is complete");
    let suite = document
        .descendants()
        .find(|it| it.has_tag_name("testsuite"))
        .expect("the report is complete");
    let cases = || suite.children().filter(|it| it.has_tag_name("testcase"));
    let count = |name: &str| {
        let outcome =
            |case: &roxmltree::Node<'_, '_>| case.children().any(|it| it.has_tag_name(name));
        cases().filter(outcome).count().to_string()
    };
    assert_eq!(
        suite.attribute("tests"),
        Some(cases().count().to_string().as_str())
    );
    assert_eq!(suite.attribute("failures"), Some(count("failure").as_str()));
    assert_eq!(suite.attribute("errors"), Some(count("error").as_str()));
    let failed = cases().filter_map(|case| {
        let outcome = case.children().find(|it| it.is_element())?;
        assert!(
            !outcome
                .attribute("message")
                .expect("the report is complete")
                .is_empty()
        );
        let attribute = |node: roxmltree::Node<'_, '_>, name| {
            node.attribute(name)
                .expect("the report is complete")
                .to_owned()
        };
        Some((attribute(case, "name"), attribute(outcome, "type")))
    });
    failed.collect()
}
