//! The main results as a table for a paper (LaTeX, `booktabs`) or for a README (Markdown): per scene and N, a line per detector.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::grid::{self, Seeds};
use super::interval::median;
use super::summary::is_control;
use super::text;
use super::value::Cell;
use crate::harness::experiment::Experiment;
use crate::harness::record::Outcome;

/// In which language.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// LaTeX, one `tabular` per scene; needs the package booktabs
    Latex,
    /// Markdown
    Markdown,
}

/// The columns after N and detector; the name, and its unit.
const HEADS: [(&str, &str); 5] =
    [("time / N", "ns"), ("95% interval", "ns"), ("peak memory / N", "bytes"), ("contact tests / N", ""), ("missed / added", "pairs")];

/// A line: what is at an N with a detector.
struct Entry {
    n: u64,
    detector: String,
    fields: [String; 5],
    time: Option<f64>,
}

/// The tables of these experiments, one per scene. Controls are left out.
pub fn tables(experiments: &[Experiment], cells: &[Cell], format: Format) -> String {
    let mut out = match format {
        Format::Latex => "% \\usepackage{booktabs}\n% N elements; bold: the least time at that N.\n".to_string(),
        Format::Markdown => String::new(),
    };
    for experiment in experiments {
        let own: Vec<&Cell> =
            cells.iter().filter(|cell| cell.key.experiment == experiment.name && !is_control(&cell.key.detector)).collect();
        for group in grid::groups(&own) {
            let mut sizes: BTreeMap<u64, Vec<Entry>> = BTreeMap::new();
            for (line, cells) in &group.lines {
                for (&n, seeds) in cells {
                    sizes.entry(n).or_default().push(entry(n, grid::label(line, &own), seeds));
                }
            }
            let place = |entry: &Entry| (entry.time.is_none(), entry.time.unwrap_or(f64::INFINITY));
            sizes.values_mut().for_each(|entries| {
                entries.sort_by(|a, b| place(a).partial_cmp(&place(b)).unwrap_or(std::cmp::Ordering::Equal));
            });
            out += &match format {
                Format::Latex => latex(&experiment.title, &group.title, &sizes),
                Format::Markdown => markdown(&group.title, &sizes),
            };
        }
    }
    out
}

/// One line: medians over seeds; an interval only where there is one seed.
fn entry(n: u64, detector: String, seeds: &Seeds<'_>) -> Entry {
    let elements = n.max(1) as f64;
    let number = |value: Option<f64>| value.map_or("–".into(), text::number);
    let of = |name: &str| {
        // Runners that count nothing say nothing, and their counts are empty.
        let silent = |cell: &Cell| name == "contact_test" && cell.counts.as_ref().is_none_or(|counts| counts.is_empty());
        let found: Option<Vec<f64>> = seeds.iter().map(|cell| cell.variable(name, None).filter(|_| !silent(cell))).collect();
        found.and_then(|found| median(&found))
    };
    let (outcome, time) = (grid::outcome(seeds).0, grid::time(seeds).map(|time| time / elements));
    let good = outcome.is_good();
    let interval = match seeds[..] {
        [cell] => cell.time().filter(|time| time.count > 1),
        _ => None,
    };
    let interval =
        interval.map_or("–".into(), |time| format!("{} to {}", text::number(time.low / elements), text::number(time.high / elements)));
    let shown = if good { number(time) } else { outcome.name().into() };
    let compared = seeds.iter().all(|cell| cell.errors.is_some()) && (good || outcome == Outcome::Wrong);
    let sum = |wrong: fn(&Cell) -> u64| seeds.iter().map(|cell| wrong(cell)).sum::<u64>();
    let missed = sum(|cell| cell.errors.map_or(0, |errors| errors.missed));
    let added = sum(|cell| cell.errors.map_or(0, |errors| errors.wrong() - errors.missed));
    let errors = if compared { format!("{missed} / {added}") } else { "–".into() };
    let per = |name: &str| number(of(name).map(|value| value / elements));
    Entry { n, detector, fields: [shown, interval, per("peak_bytes"), per("contact_test"), errors], time: time.filter(|_| good) }
}

fn markdown(title: &str, sizes: &BTreeMap<u64, Vec<Entry>>) -> String {
    let head = |(name, unit): (&str, &str)| if unit.is_empty() { format!(">{name}") } else { format!(">{name} ({unit})") };
    let heads: Vec<String> = [">N".to_string(), "detector".into()].into_iter().chain(HEADS.map(head)).collect();
    let mut rows = Vec::new();
    for entry in sizes.values().flatten() {
        rows.push([entry.n.to_string(), entry.detector.clone()].into_iter().chain(entry.fields.iter().cloned()).collect());
    }
    let mut table: Vec<String> =
        text::markdown_table(&heads.iter().map(String::as_str).collect::<Vec<_>>(), &rows).lines().map(String::from).collect();
    // The first of each N is the fastest, if it has a time at all.
    let mut at = 2;
    for entries in sizes.values() {
        if let (Some(first), Some(line)) = (entries.first().filter(|entry| entry.time.is_some()), table.get_mut(at)) {
            let plain = format!(" | {} | ", text::escape(&first.fields[0]));
            *line = line.replacen(&plain, &format!(" | **{}** | ", first.fields[0]), 1);
        }
        at += entries.len();
    }
    format!("**{}**\n\n{}\n\n", text::escape(title), table.join("\n"))
}

fn latex(experiment: &str, title: &str, sizes: &BTreeMap<u64, Vec<Entry>>) -> String {
    let mut out = format!("% {}: {}\n", one_line(experiment), one_line(title));
    out += "\\begin{tabular}{rlrrrrr}\n\\toprule\n";
    let _ = writeln!(out, "\\multicolumn{{7}}{{l}}{{{}}} \\\\", tex(title));
    out += "\\midrule\n$N$ & detector";
    for (name, _) in HEADS {
        let _ = write!(out, " & {}", tex(name).replace("/ N", "/ $N$"));
    }
    out += " \\\\\n & ";
    for (_, unit) in HEADS {
        let _ = write!(out, " & {}", if unit.is_empty() { String::new() } else { format!("({unit})") });
    }
    out += " \\\\\n";
    for entries in sizes.values() {
        out += "\\midrule\n";
        for (k, entry) in entries.iter().enumerate() {
            let n = if k == 0 { entry.n.to_string() } else { String::new() };
            let _ = write!(out, "{n} & {}", tex(&entry.detector));
            for (column, field) in entry.fields.iter().enumerate() {
                let field = numbers(field);
                let bold = k == 0 && column == 0 && entry.time.is_some();
                let _ = if bold { write!(out, " & \\textbf{{{field}}}") } else { write!(out, " & {field}") };
            }
            out += " \\\\\n";
        }
    }
    out + "\\bottomrule\n\\end{tabular}\n\n"
}

/// Numbers of a field: `3.2e8` as a power of ten, ranges with a dash.
fn numbers(field: &str) -> String {
    let word = |word: &str| match word.split_once('e') {
        Some((mantissa, power)) if mantissa.parse::<f64>().is_ok() && power.parse::<i32>().is_ok() => {
            format!("${mantissa}\\times10^{{{power}}}$")
        }
        _ => tex(word),
    };
    field.split(' ').map(word).collect::<Vec<_>>().join(" ").replace(" to ", "--")
}

/// Text of a comment: one that ends with its line.
fn one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() || c == '\u{2028}' || c == '\u{2029}' { ' ' } else { c }).collect()
}

/// Text as LaTeX prints it: none of it is a command.
pub fn tex(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => out.extend(['\\', c]),
            '\\' => out += "\\textbackslash{}",
            '~' => out += "\\textasciitilde{}",
            '^' => out += "\\textasciicircum{}",
            '<' => out += "\\textless{}",
            '>' => out += "\\textgreater{}",
            '|' => out += "\\textbar{}",
            '"' => out += "\\textquotedbl{}",
            // At the head of a line it would be an option of the line break before it.
            '[' | ']' => out.extend(['{', c, '}']),
            '–' => out += "--",
            '×' => out += "$\\times$",
            '²' => out += "$^2$",
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::{fake, fake::Lab, value};
    use super::*;
    use crate::harness::record::{Errors, Pass};

    fn made(format: Format) -> String {
        let mut lab = Lab::new("e", "packed");
        for n in [100, 1000] {
            lab.n(n).detector("nbs").time(&[100 * n, 110 * n, 120 * n, 130 * n, 140 * n, 150 * n]).memory(12 * n, 12 * n);
            lab.count(&[("contact_test", 3 * n)]).edit(|row| row.errors = Some(Errors { missed: 2, spurious: 1, ..Errors::default() }));
            lab.detector("my_50% & {[fast]}\\").time(&[50 * n; 6]);
            lab.detector("direct").fail(Pass::Time, Outcome::Timeout, "30 s");
            lab.detector("nbs-twin").time(&[7; 6]);
        }
        tables(&[fake::experiment("")], &value::cells(&lab.rows()), format)
    }

    #[test]
    fn markdown_has_a_line_per_n_and_detector() {
        let found = made(Format::Markdown);
        assert!(found.starts_with("**packed, 2D**\n\n| N | detector | time / N (ns) |"), "{found}");
        assert!(found.contains("| 100 | my\\_50% & {\\[fast\\]}\\\\ | **50** | 50 to 50 | – | – | – |"), "{found}");
        assert!(found.contains("| 1000 | nbs | 125 | 100 to 150 | 12 | 3 | 2 / 1 |"), "{found}");
        assert!(found.contains("| 1000 | direct | timeout | – | – | – | – |") && !found.contains("twin"), "{found}");
    }

    #[test]
    fn latex_is_balanced_and_escaped() {
        let found = made(Format::Latex);
        assert!(
            found.contains("100 & my\\_50\\% \\& \\{{[}fast{]}\\}\\textbackslash{} & \\textbf{50} & 50--50 & -- & -- & -- \\\\\n"),
            "{found}"
        );
        assert!(found.contains(" & nbs & 125 & 100--150 & 12 & 3 & 2 / 1 \\\\\n"), "{found}");
        let plain = found.replace("\\{", "").replace("\\}", "");
        assert_eq!(plain.matches('{').count(), plain.matches('}').count());
        let table = found.lines().filter(|line| line.ends_with("\\\\") && !line.contains("multicolumn"));
        for line in table {
            assert_eq!(line.replace("\\&", "").matches('&').count(), 6, "{line}");
        }
        assert_eq!(found.matches("\\begin{tabular}").count(), found.matches("\\end{tabular}").count());
        assert_eq!(numbers("1.250e9 to 2e10"), "$1.250\\times10^{9}$--$2\\times10^{10}$");
    }
}
