//! The verdicts as JUnit XML, as the schema of the Jenkins xUnit plugin and the
//! common readers have it: a suite of one case a scene.

use std::path::Path;

use super::{Checked, Verdict};
use crate::report::ReportFile;

/// `junit.xml`: a scene that differs is a failure, one that could not be drawn
/// or compared an error; goldens without a scene are in the suite's output.
pub fn junit(checked: &[Checked], without_scene: &[std::path::PathBuf]) -> ReportFile {
    let count = |is: fn(&Verdict) -> bool| checked.iter().filter(|it| is(&it.verdict)).count();
    let errors = count(Verdict::is_error);
    let failures = count(|it| !it.is_error() && !matches!(it, Verdict::Passes(_)));
    let time: f64 = checked.iter().map(|it| it.time_ms).sum();
    let counts = format!(
        "tests=\"{}\" failures=\"{failures}\" errors=\"{errors}\" skipped=\"0\" time=\"{}\"",
        checked.len(),
        seconds(time)
    );
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <testsuites name=\"relume golden\" {counts}>\n  \
         <testsuite name=\"relume golden\" {counts}>\n"
    );
    checked.iter().for_each(|one| text.push_str(&case(one)));
    if !without_scene.is_empty() {
        let lines = without_scene
            .iter()
            .map(|it| format!("golden without a scene: {}\n", shown(it)));
        text.push_str(&format!(
            "    <system-err>{}</system-err>\n",
            lines.collect::<String>()
        ));
    }
    text.push_str("  </testsuite>\n</testsuites>\n");
    ReportFile {
        path: "junit.xml".to_owned(),
        bytes: text.into_bytes(),
    }
}

fn case(checked: &Checked) -> String {
    let scene = shown(checked.scene.scene());
    let head = format!(
        "    <testcase classname=\"relume.golden\" name=\"{scene}\" file=\"{scene}\" time=\"{}\"",
        seconds(checked.time_ms)
    );
    let verdict = &checked.verdict;
    if checked.passes() {
        return format!("{head}/>\n");
    }
    let element = if verdict.is_error() {
        "error"
    } else {
        "failure"
    };
    let problems = escaped(&verdict.problems().join("; "));
    format!(
        "{head}>\n      <{element} type=\"{}\" message=\"{problems}\">{problems}\ngolden: {}</{element}>\n    </testcase>\n",
        verdict.name(),
        shown(checked.scene.golden())
    )
}

fn seconds(time_ms: f64) -> String {
    format!("{:.3}", time_ms / 1e3)
}

fn shown(path: &Path) -> String {
    escaped(&path.to_string_lossy())
}

/// A text as content or as an attribute's value. What XML 1.0 (section 2.2) does
/// not know as a character is shown as the replacement character.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&apos;"),
            // A bare line break in an attribute would be read as a space.
            '\t' | '\n' | '\r' => escaped.push_str(&format!("&#{};", u32::from(letter))),
            '\0'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => escaped.push('\u{fffd}'),
            _ => escaped.push(letter),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_xml_does_not_know_is_replaced() {
        assert_eq!(escaped("a<&\"'>"), "a&lt;&amp;&quot;&apos;&gt;");
        assert_eq!(escaped("\u{1b}[31m\0"), "\u{fffd}[31m\u{fffd}");
        assert_eq!(escaped("a\nb"), "a&#10;b");
    }
}
