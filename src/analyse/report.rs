//! The report of a result folder: `report.md`, `report.html`, `summary.csv` and `figures/`, from the record alone.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::Context;
use serde_json::Value;

use super::claim::{self, Verdict};
use super::keyed::by_machine;
use super::machine::Machine;
use super::speed::{self, Files};
use super::value::{Cell, cells};
use super::verdicts::{self, Matrix};
use super::{csv, errors, price, summary, text};
use crate::figure::{self, style::Styles};
use crate::harness::experiment::{Experiment, Table};
use crate::harness::record::Row;
use crate::page::{self, Page, Part, command, shown};

/// How to read the table of errors.
const ERRORS: &str = "Pairs missed / pairs added, by cause: *storing* the scene (its coordinates rounded, then decided exactly), \
    *deciding* (the arithmetic's contact test on all pairs of the stored scene), *looking* (what the detector made of that). *Together* is the \
    answer against exact decisions on the scene as given; errors of two causes can cancel. The error rate is the number of wrong pairs over \
    that of true contacts. Depths and gaps are in mean radii of the couple: a miss of 0 r is a pair exactly in touch.";

/// How to read the table of verdicts.
const VERDICTS: &str = "Right is an answer with exactly the pairs that touch in exact arithmetic in the scene as given. First the number of \
answers of each kind, then the cases in which someone is not right, and how: -3 +1 is three pairs missed and one added (by the \
    arithmetic, or by storing the scene in it), *lossy* (a textbook filter lost contacts), *refused* (the reason stands below, one example of its kind), *DEFECT* (not the answer of the \
    detector's own arithmetic). Detectors that are not named are right. Every answer is in [verdicts.csv](verdicts.csv).";

/// What was written.
pub struct Report {
    /// All claims, in the order of the experiments.
    pub verdicts: Vec<Verdict>,
    /// Tables of verdicts, for a terminal.
    pub tables: Vec<String>,
    /// The figures, SVG and PNG.
    pub figures: Vec<PathBuf>,
    /// The report in Markdown.
    pub path: PathBuf,
    /// The report as a page, with charts.
    pub page: PathBuf,
    /// Sentences about what was left out: those given, and figures that could not be drawn.
    pub warnings: Vec<String>,
}

/// Writes the report of these experiments into `folder`. Rows of other experiments are in `summary.csv` only. A figure that cannot be
/// drawn as written is a warning; files that cannot be written are an error.
pub fn write(folder: &Path, experiments: &[Experiment], rows: &[Row], warnings: &[String]) -> anyhow::Result<Report> {
    let cells = cells(rows);
    let styles = Styles::new(cells.iter().map(|cell| cell.key.detector.as_str()));
    let figure_folder = folder.join("figures");
    std::fs::create_dir_all(&figure_folder).with_context(|| format!("cannot make the folder {}", figure_folder.display()))?;
    let (path, page, warnings) = (folder.join("report.md"), page::path(folder), warnings.to_vec());
    let mut report = Report { verdicts: Vec::new(), tables: Vec::new(), figures: Vec::new(), path, page, warnings };
    let provenance = std::fs::read(folder.join("provenance.json")).ok().and_then(|bytes| serde_json::from_slice::<Value>(&bytes).ok());
    let machine = Machine::of(provenance.as_ref());
    let (mut body, mut files, mut parts) = (String::new(), Files::default(), Vec::new());
    for experiment in experiments {
        let own: Vec<&Cell> = cells.iter().filter(|cell| cell.key.experiment == experiment.name).collect();
        let verdicts = claim::verdicts(experiment, &cells);
        section(&mut body, experiment, &own, &verdicts);
        let matrix = Matrix::new(&own).filter(|_| experiment.table == Some(Table::Verdicts));
        let (mut said, mut analysis, mut drawn) = (None, String::new(), Vec::new());
        if let Some(matrix) = &matrix {
            let text = format!("{VERDICTS}\n\n{}\n", matrix.markdown());
            let _ = write!(body, "### Who is right\n\n{text}");
            said = Some(text);
            report.tables.push(format!("{}: {}\n\n{}", experiment.name, experiment.title, matrix.plain()));
        }
        for plan in &experiment.figures {
            match figure::draw(&figure_folder, experiment, plan, &cells, &styles, &machine) {
                Ok(paths) => {
                    embed(&mut body, &plan.title, &paths);
                    report.figures.extend(paths.iter().cloned());
                    drawn.extend((!paths.is_empty()).then(|| (plan.title.clone(), paths)));
                }
                Err(error) => report.warnings.push(format!("the figure {} of {} was not drawn: {error:#}", plan.name, experiment.name)),
            }
        }
        speed::sections(&mut analysis, experiment, &own, &machine, &mut files);
        // The matrix says all that these would, of a hundred scenes.
        if matrix.is_none() {
            tables(&mut analysis, &own);
        }
        body += &analysis;
        report.verdicts.extend(verdicts.iter().cloned());
        parts.push(Part { experiment, cells: own, verdicts, figures: drawn, matrix: said, tables: analysis });
    }
    let text = head(experiments, &report, &cells, provenance.as_ref()) + &body + &foot(provenance.as_ref());
    let (provenance, resumed) = (provenance.as_ref(), resumed(folder));
    let page = Page { parts, cells: &cells, styles: &styles, provenance, resumed, warnings: &report.warnings }.html();
    for (path, text) in [(&report.path, text), (&report.page, page)] {
        std::fs::write(path, text).with_context(|| format!("cannot write the report {}", path.display()))?;
    }
    let mut tables = vec![("summary.csv", csv::csv(&cells))];
    if !report.tables.is_empty() {
        let asked = |cell: &&Cell| experiments.iter().any(|e| e.table == Some(Table::Verdicts) && e.name == cell.key.experiment);
        tables.push(("verdicts.csv", verdicts::csv(cells.iter().filter(asked))));
    }
    tables.extend(files.all());
    for (name, text) in tables {
        let path = folder.join(name);
        std::fs::write(&path, text).with_context(|| format!("cannot write {}", path.display()))?;
    }
    Ok(report)
}

/// The provenance of runs that went on with a record, in the order of their dates.
fn resumed(folder: &Path) -> Vec<Value> {
    let names = std::fs::read_dir(folder).into_iter().flatten().filter_map(|entry| Some(entry.ok()?.path()));
    let is_resumed = |path: &PathBuf| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("provenance-resumed-"));
    let mut paths: Vec<PathBuf> = names.filter(is_resumed).collect();
    paths.sort();
    paths.iter().filter_map(|path| serde_json::from_slice(&std::fs::read(path).ok()?).ok()).collect()
}

/// Title, the command that made it, the score of the claims, warnings; each question with its answer: who won where.
fn head(experiments: &[Experiment], report: &Report, cells: &[Cell], provenance: Option<&Value>) -> String {
    let titles: Vec<String> = experiments.iter().map(|experiment| text::escape(&experiment.title)).collect();
    let mut out = format!("# {}\n\n", if titles.len() == 1 { titles.join("") } else { "Contact detection: results".into() });
    let command = provenance.and_then(|fields| fields.get("command")).map(command);
    if let Some(command) = command {
        // a fence longer than any in the command
        let _ = write!(out, "Made by\n\n````text\n{}\n````\n\n", command.replace("````", "'"));
    }
    if report.verdicts.is_empty() {
        out += "No claims were checked.\n\n";
    } else {
        let _ = write!(out, "**{}.**\n\n", claim::score(&report.verdicts));
    }
    for warning in &report.warnings {
        let _ = writeln!(out, "> Warning: {}\n", text::escape(warning));
    }
    for experiment in experiments {
        let own: Vec<&Cell> = cells.iter().filter(|cell| cell.key.experiment == experiment.name).collect();
        let _ = write!(out, "**{}**\n\n", text::escape(&experiment.question));
        if let Some(headline) = speed::headline(experiment, &own) {
            let _ = writeln!(out, "{headline}\n");
        }
        if let Some(price) = price::table(&own) {
            let _ = writeln!(out, "{price}");
        }
        if let Some(winners) = summary::winners(&own) {
            let _ = writeln!(out, "{winners}");
        }
    }
    out
}

/// Question, verdicts, how to read.
fn section(out: &mut String, experiment: &Experiment, own: &[&Cell], verdicts: &[Verdict]) {
    let _ = write!(out, "## {}\n\n{}\n\n", text::escape(&experiment.title), text::escape(&experiment.question));
    if own.is_empty() {
        *out += "The record has no rows of this experiment.\n\n";
    }
    if !verdicts.is_empty() {
        *out += &claim::markdown(verdicts);
        *out += "\nClaims are checked from counts, bytes and digests, which are the same on every machine, except those marked \"of this machine\".\n\n";
    }
    let _ = write!(out, "*How to read it:* {}\n\n", text::escape(&experiment.reading));
}

fn embed(out: &mut String, title: &str, paths: &[PathBuf]) {
    let name = |ending: &str| {
        let path = paths.iter().find(|path| path.extension().is_some_and(|found| found == ending))?;
        path.file_name().map(|name| name.to_string_lossy().into_owned())
    };
    if let (Some(png), Some(svg)) = (name("png"), name("svg")) {
        let _ = write!(out, "![{}](figures/{png})\n\n[as SVG](figures/{svg})\n\n", text::escape(title));
    }
}

/// Growth, summary, what did not end well, errors, noise.
fn tables(out: &mut String, own: &[&Cell]) {
    if let Some(growth) = summary::growth(own) {
        let _ = write!(out, "### How all operations together grow with N (from exact counts)\n\n{growth}\n");
    }
    for table in summary::largest(own) {
        let _ = write!(out, "### {}\n\n{}\n", text::escape(&table.title), table.markdown);
    }
    if let Some(table) = summary::not_ok(own) {
        let _ = write!(out, "### What did not end well\n\n{table}\n");
    }
    if let Some(table) = errors::table(own) {
        let _ = write!(out, "### Against the exact truth\n\n{ERRORS}\n\n{table}\n");
    }
    let noise: Vec<(Option<String>, Vec<String>)> = by_machine(own)
        .into_iter()
        .map(|(machine, cells)| (machine, summary::noise(&cells)))
        .filter(|(_, noise)| !noise.is_empty())
        .collect();
    if !noise.is_empty() {
        *out += "### Noise floor\n\n";
    }
    for (machine, noise) in noise {
        let lines = std::iter::once(speed::of_machine(&machine)).chain(noise.iter().map(|line| text::escape(line)));
        lines.filter(|line| !line.is_empty()).for_each(|line| *out += &format!("{line}\n\n"));
    }
}

/// Legend of the tables, machine, bias.
fn foot(provenance: Option<&Value>) -> String {
    let mut out = String::from(
        "## How to read the tables\n\nTimes are medians over paired blocks, from raw coordinates to the complete list of pairs. Ratios are \
         taken within a block; the numbers in brackets are the exact order-statistic interval of their median (15 blocks: the 4th to \
         the 12th, 96.5%). No time is shown without a right answer. Counts are exact and the same on every machine. All values, one \
         line per cell, are in [summary.csv](summary.csv); every single measurement is in [samples.jsonl](samples.jsonl).\n\nIn which \
         ways this comparison is unfair is written in BIAS.md at the root of the project.\n\n",
    );
    if let Some(Value::Object(fields)) = provenance {
        out += "## Machine and provenance\n\n";
        for (name, value) in fields {
            let _ = writeln!(out, "* {}: {}", text::escape(name), text::escape(&shown(value)));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::{fake, fake::Lab};
    use super::*;
    use crate::harness::record::{Causes, Errors, Outcome, Pass};

    #[test]
    fn a_report_has_question_verdicts_figures_and_provenance() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("provenance.json"), r#"{"command": ["contactbench", "run"], "cpu": {"name": "A_1"}}"#).unwrap();
        let mut lab = Lab::new("e", "packed");
        for n in [100, 1000] {
            lab.n(n).detector("nbs").time(&[n; 15]).count(&[("list_push", 2 * n)]);
            lab.detector("direct").fail(Pass::Time, Outcome::Crashed, "signal 11");
        }
        let experiment = fake::experiment(
            "[[claim]]\nname = 'two pushes'\nkind = 'equal'\nvalue = 'list_push'\nto = '2 * n'\nwhere = { detector = 'nbs' }\n\
             [[figure]]\nname = 'time'\ntitle = 'Time'\nx = 'n'\nx-label = 'N'\ny = 'time_ns'\ny-label = 'ns'\n\
             [[figure]]\nname = 'bad'\ntitle = 'Bad'\nx = 'n'\nx-label = 'N'\ny = 'speed'\ny-label = 'ns'\n",
        );
        let report = write(folder.path(), std::slice::from_ref(&experiment), &lab.rows(), &["line 9 is torn".into()]).unwrap();
        let page = std::fs::read_to_string(&report.path).unwrap();
        for part in
            ["**Which is fastest?**", "| two pushes | holds |", "(figures/e-time.png)", "signal 11", "contactbench run", "A\\_1", "BIAS.md"]
        {
            assert!(page.contains(part), "{part} is not in\n{page}");
        }
        assert!(page.contains("Warning: line 9 is torn") && page.contains("unknown variable 'speed'"), "{page}");
        assert_eq!((report.figures.len(), report.warnings.len(), report.verdicts.len()), (2, 2, 1));
        assert!(report.figures.iter().all(|path| std::fs::metadata(path).is_ok_and(|file| file.len() > 1000)));
        assert_eq!(std::fs::read_to_string(folder.path().join("summary.csv")).unwrap().lines().count(), 5);
        assert!(report.tables.is_empty() && !folder.path().join("verdicts.csv").exists());
        // a report can be made again, and is the same
        assert!(write(folder.path(), &[experiment], &lab.rows(), &["line 9 is torn".into()]).is_ok());
        assert_eq!(page, std::fs::read_to_string(&report.path).unwrap());
    }

    #[test]
    fn verdicts_are_in_the_report_on_the_terminal_and_in_a_file() {
        let folder = tempfile::tempdir().unwrap();
        let mut lab = Lab::new("e", "packed");
        lab.count(&[]).errors(Errors { spurious: 4, ..Errors::default() }, Causes::default());
        let experiment = fake::experiment("table = 'verdicts'");
        let report = write(folder.path(), &[experiment], &lab.rows(), &[]).unwrap();
        let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
        assert_eq!(report.tables.len(), 1);
        assert!(report.tables[0].starts_with("e: A title\n\ncase") && report.tables[0].contains("+4"), "{:?}", report.tables);
        assert!(read("report.md").contains("| packed, N = 100 | 2D | +4 |"), "{}", read("report.md"));
        assert!(read("verdicts.csv").contains("e,\"packed, N = 100\",2,100,1,nbs,exact,wrong,ok,"), "{}", read("verdicts.csv"));
    }
}
