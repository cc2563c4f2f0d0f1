//! `relume golden bless`: frames that fail become the goldens.

use relume::golden::{Checked, Suite};
use serde_json::json;

use super::arguments::{Bless, GoldenFormat};
use super::check::stray_text;
use super::github::printable;
use super::{check_all, counted, exit_code, suite, text_of, warn};
use crate::cli::error::CliError;
use crate::cli::report::Report;

/// Set by all common CI services.
const CI: &str = "CI";

pub(super) fn execute(arguments: &Bless) -> Result<Report, CliError> {
    let is_ci =
        std::env::var_os(CI).is_some_and(|it| !["", "0", "false"].map(Into::into).contains(&it));
    if is_ci && !arguments.in_ci {
        return Err(CliError::Usage(
            "this is a CI (the environment variable CI is set), where nobody looks at goldens; \
             bless on a machine of yours, or say --in-ci"
                .to_owned(),
        ));
    }
    let Suite {
        mut scenes,
        without_scene,
    } = suite(&arguments.suite)?;
    if arguments.format == GoldenFormat::Exr {
        scenes = scenes
            .into_iter()
            .map(|it| it.with_linear_golden())
            .collect();
    }
    // All frames come first: a job that is stopped has written nothing.
    let checked = check_all(scenes, &arguments.suite)?;
    warn(without_scene.iter().map(|it| stray_text(it)).collect());
    let mut done = Done::default();
    checked.iter().for_each(|one| done.take(one));
    Ok(done.report(checked.len()))
}

/// What became of the scenes that failed.
#[derive(Default)]
struct Done {
    blessed: Vec<serde_json::Value>,
    refused: Vec<serde_json::Value>,
    text: String,
    exit_code: u8,
}

impl Done {
    fn take(&mut self, one: &Checked) {
        let scene = text_of(one.scene.scene());
        let golden = text_of(one.scene.golden());
        let verdict = one.verdict.name();
        let (problems, code) = match one.bless() {
            Ok(true) => {
                let shown = printable(&golden);
                self.text
                    .push_str(&format!("written  {shown} (was: {verdict})\n"));
                let entry = json!({ "scene": scene, "golden": golden, "was": verdict });
                self.blessed.push(entry);
                return;
            }
            Ok(false) if one.passes() => return,
            Ok(false) => (one.verdict.problems(), exit_code(&one.verdict)),
            Err(error) => (vec![error.with_causes()], 3),
        };
        self.text.push_str(&format!(
            "refused  {}\n         {}\n",
            printable(&scene),
            printable(&problems.join("; "))
        ));
        let entry =
            json!({ "scene": scene, "golden": golden, "verdict": verdict, "problems": problems });
        self.refused.push(entry);
        self.exit_code = self.exit_code.max(code);
    }

    fn report(self, scenes: usize) -> Report {
        let unchanged = scenes - self.blessed.len() - self.refused.len();
        let text = format!(
            "{}{} written, {unchanged} as they were, {} refused",
            self.text,
            counted(self.blessed.len(), "golden"),
            self.refused.len()
        );
        Report {
            json: json!({
                "scenes": scenes,
                "unchanged": unchanged,
                "blessed": self.blessed,
                "refused": self.refused,
            }),
            text,
            exit_code: self.exit_code,
        }
    }
}
