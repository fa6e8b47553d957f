//! Output for continuous integration: JUnit XML, GitHub annotations, and the summary of a job.

use std::fmt::Write as _;
use std::io::Write;
use std::path::PathBuf;

use anyhow::Context;

use contactbench_io::write;
use contactbench_terms::text::{html, lines};

const CI: &str = "Continuous integration";

/// Options of verbs with a verdict.
#[derive(clap::Args, Clone, Debug, Default)]
pub struct Outputs {
    /// Write the verdicts as JUnit XML
    #[arg(long, value_name = "FILE", help_heading = CI)]
    pub junit: Option<PathBuf>,
    /// Print failures as GitHub annotations
    #[arg(long, help_heading = CI)]
    pub annotations: bool,
    /// Append the verdicts as Markdown: "$GITHUB_STEP_SUMMARY"
    #[arg(long, value_name = "FILE", help_heading = CI)]
    pub summary: Option<PathBuf>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Group of the case, with dots: `scaling.packed`.
    pub class: String,
    pub name: String,
    pub outcome: Outcome,
    /// The reason for the outcome; empty if the case passed.
    pub why: String,
}

contactbench_terms::named! {
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub enum Outcome {
        Failed = "failed",
        /// The case did not fail, but deserves a look.
        Noted = "noted",
        /// The case was not decided.
        Skipped = "skipped",
        Passed = "passed",
    }
}

impl Case {
    pub fn passed(class: &str, name: &str) -> Case {
        let (class, name) = (class.into(), name.into());
        Case { class, name, outcome: Outcome::Passed, why: String::new() }
    }
}

impl Outputs {
    /// Writes the requested files, and annotations to standard output.
    pub fn write(&self, suite: &str, cases: &[Case]) -> anyhow::Result<()> {
        if let Some(path) = &self.junit {
            write::whole(path, |out| out.write_all(junit(suite, cases).as_bytes()))
                .with_context(|| format!("cannot write {}", path.display()))?;
        }
        if let Some(path) = &self.summary {
            write::append(path, &summary(suite, cases), "--summary")?;
        }
        if self.annotations {
            // `terminal::out` would escape these commands.
            std::io::stdout().lock().write_all(annotations(suite, cases).as_bytes())?;
        }
        Ok(())
    }
}

pub fn junit(suite: &str, cases: &[Case]) -> String {
    let count = |wanted| cases.iter().filter(|case| case.outcome == wanted).count();
    let (failed, skipped) = (count(Outcome::Failed), count(Outcome::Skipped));
    let (tests, suite) = (cases.len(), xml(suite));
    let mut out = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"contactbench\" \
         tests=\"{tests}\" failures=\"{failed}\" skipped=\"{skipped}\" errors=\"0\">\n<testsuite \
         name=\"{suite}\" tests=\"{tests}\" failures=\"{failed}\" skipped=\"{skipped}\" \
         errors=\"0\">\n"
    );
    for Case { class, name, outcome, why } in cases {
        let first = xml(why.lines().next().unwrap_or_default());
        let why = xml(why);
        let _ = write!(out, "<testcase classname=\"{}\" name=\"{}\"", xml(class), xml(name));
        out += &match outcome {
            Outcome::Passed => "/>\n".into(),
            Outcome::Noted => format!("><system-out>{why}</system-out></testcase>\n"),
            Outcome::Failed => {
                format!("><failure message=\"{first}\">{why}</failure></testcase>\n")
            }
            Outcome::Skipped => format!("><skipped message=\"{why}\"/></testcase>\n"),
        };
    }
    out + "</testsuite>\n</testsuites>\n"
}

/// Escapes text for XML; a bare line break in an attribute would be read as a blank.
fn xml(text: &str) -> String {
    let broken = [('\n', "&#10;"), ('\t', "&#9;"), ('\r', "&#13;")];
    broken.into_iter().fold(html(text), |text, (c, name)| text.replace(c, name))
}

/// Formats one line for each failure and note.
pub fn annotations(suite: &str, cases: &[Case]) -> String {
    let mut out = String::new();
    for Case { class, name, outcome, why } in cases {
        let kind = match outcome {
            Outcome::Failed => "error",
            Outcome::Noted => "warning",
            Outcome::Passed | Outcome::Skipped => continue,
        };
        let title = command(&format!("contactbench {suite}: {class}: {name}"))
            .replace(':', "%3A")
            .replace(',', "%2C");
        let _ = writeln!(out, "::{kind} title={title}::{}", command(why));
    }
    out
}

/// Formats the verdicts as Markdown: how many of each, and a line for each that did not pass.
pub fn summary(suite: &str, cases: &[Case]) -> String {
    let (mut numbers, mut lines) = (Vec::new(), String::new());
    for kind in Outcome::ALL {
        let of: Vec<_> = cases.iter().filter(|case| case.outcome == kind).collect();
        let (count, kind) = (of.len(), kind.name());
        if count > 0 {
            numbers.push(format!("{count} {kind}"));
        }
        for Case { class, name, why, .. } in of.into_iter().filter(|_| kind != "passed") {
            let [class, name, why] = [class.as_str(), name, why].map(cell);
            let _ = writeln!(lines, "| {kind} | {class} | {name} | {why} |");
        }
    }
    let head = if lines.is_empty() { "" } else { "| | of | what | why |\n|---|---|---|---|\n" };
    format!("### contactbench {suite}: {}\n\n{head}{lines}\n", numbers.join(", "))
}

/// Escapes the first line of a text for a cell of a table.
fn cell(text: &str) -> String {
    let first = text.lines().next().unwrap_or_default();
    lines(first)
        .chars()
        .flat_map(|c| [Some('\\').filter(|_| "\\|<>`*_[]".contains(c)), Some(c)])
        .flatten()
        .collect()
}

/// Escapes the text of a workflow command, which is one line.
fn command(text: &str) -> String {
    lines(text).replace('%', "%25").replace('\n', "%0A")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cases() -> Vec<Case> {
        let case = |name: &str, outcome, why: &str| Case {
            outcome,
            why: why.into(),
            ..Case::passed("a.b", name)
        };
        vec![
            case("good", Outcome::Passed, ""),
            case("bad <&\"'> \u{1}", Outcome::Failed, "50% off: a, b\nsecond ]]> line\r"),
            case("seen", Outcome::Noted, "n"),
            case("none", Outcome::Skipped, "s"),
        ]
    }

    #[test]
    fn junit_is_well_formed_and_counts() {
        let text = junit("compare & more", &cases());
        let document = roxmltree::Document::parse(&text).unwrap();
        let suite = document.descendants().find(|node| node.has_tag_name("testsuite")).unwrap();
        let numbers = ["tests", "failures", "skipped"].map(|name| suite.attribute(name).unwrap());
        assert_eq!((numbers, suite.attribute("name")), (["4", "1", "1"], Some("compare & more")));
        let failure = document.descendants().find(|node| node.has_tag_name("failure")).unwrap();
        assert_eq!(failure.attribute("message"), Some("50% off: a, b"));
        assert_eq!(failure.text(), Some("50% off: a, b\nsecond ]]> line\r"));
        assert_eq!(failure.parent().unwrap().attribute("name"), Some("bad <&\"'> \u{fffd}"));
        assert_eq!(document.descendants().filter(|node| node.has_tag_name("testcase")).count(), 4);
    }

    #[test]
    fn a_summary_counts_and_names_what_did_not_pass() {
        let text = summary("compare", &cases());
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "### contactbench compare: 1 failed, 1 noted, 1 skipped, 1 passed");
        assert_eq!(lines[4], "| failed | a.b | bad \\<&\"'\\> \u{fffd} | 50% off: a, b |");
        assert_eq!(lines[5..], ["| noted | a.b | seen | n |", "| skipped | a.b | none | s |", ""]);
        let passed = &cases()[..1];
        assert_eq!(summary("run", passed), "### contactbench run: 1 passed\n\n\n");
    }
}
