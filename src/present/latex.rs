//! The main results as tables for a paper (LaTeX, `booktabs`) or for a README (Markdown): per
//! scene and N, a line per detector.

use std::collections::BTreeMap;

use crate::cells::series::{Line, Seeds};
use crate::cells::{Cell, series};
use crate::experiment::Experiment;
use crate::findings::noise::Noise;
use crate::findings::winners;
use crate::number::with_interval;
use crate::present::escape::one_line;
use crate::present::table::{self, Column, Table};
use crate::record::row::Outcome;
use crate::stats::interval::median;

/// In which language.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// LaTeX, one `tabular` per scene; needs the package booktabs
    Latex,
    /// Markdown
    Markdown,
}

/// The tables of these experiments, one per scene. Controls are left out.
pub fn tables(experiments: &[Experiment], cells: &[Cell], format: Format) -> String {
    let mut out = match format {
        Format::Latex => "% \\usepackage{booktabs}\n% N particles; bold: the fastest detector at \
                          that N, each with its fewest threads and exact if it can, where that is \
                          decided.\n"
            .to_string(),
        Format::Markdown => String::new(),
    };
    for experiment in experiments {
        let all: Vec<&Cell> =
            cells.iter().filter(|cell| cell.id.experiment == experiment.name).collect();
        let noise = Noise::new(&all);
        let own: Vec<&Cell> = all.into_iter().filter(|cell| !cell.role.is_control()).collect();
        for group in series::groups(&own) {
            let made = table(&group, &own, &noise);
            out += &match format {
                Format::Latex => format!(
                    "% {}: {}\n{}\n",
                    one_line(&experiment.title),
                    one_line(&group.title),
                    made.latex()
                ),
                Format::Markdown => made.markdown() + "\n",
            };
        }
    }
    out
}

/// A scene: by N, the fastest first; N is named once.
fn table(group: &series::Group<'_>, own: &[&Cell], noise: &Noise) -> Table {
    let mut sizes: BTreeMap<u64, Vec<(&Line, &Seeds<'_>)>> = BTreeMap::new();
    for (line, cells) in &group.lines {
        for (&n, seeds) in cells {
            sizes.entry(n).or_default().push((line, seeds));
        }
    }
    let columns = vec![
        Column::right("N", ""),
        Column::left("detector"),
        Column::right("time / fastest", ""),
        Column::right("time / N in this run", "ns"),
        Column::right("peak memory / N", "bytes"),
        Column::right("contact tests / N", ""),
        Column::right("missed / added", "pairs"),
    ];
    let mut made = Table::new(group.title.as_str(), columns);
    for (n, mut entries) in sizes {
        let place = |seeds: &Seeds<'_>| series::time(seeds).unwrap_or(f64::INFINITY);
        entries.sort_by(|a, b| place(a.1).total_cmp(&place(b.1)));
        let firsts: Vec<&Cell> =
            entries.iter().filter_map(|(_, seeds)| seeds.first().copied()).collect();
        let winner = winners::winner(&firsts, noise).map(Line::new);
        let timed = |seeds: &&Seeds<'_>| {
            series::outcome(seeds).0.is_good() && series::time(seeds).is_some()
        };
        let first = entries.iter().map(|(_, seeds)| *seeds).find(timed);
        for (k, (line, seeds)) in entries.into_iter().enumerate() {
            let mut row = vec![
                if k == 0 { table::Cell::count(n) } else { "".into() },
                series::label(line, own).into(),
            ];
            row.push(to_fastest(seeds, first));
            row.extend(numbers(n, seeds));
            if winner.as_ref() == Some(line) {
                row[3].strong = true;
            }
            made.rows.push(row);
        }
    }
    made
}

/// The time over that of the first, which has the shortest median: paired within blocks, with the
/// interval, where there is one seed; else of the medians over seeds.
fn to_fastest(seeds: &Seeds<'_>, first: Option<&Seeds<'_>>) -> table::Cell {
    let Some(first) = first.filter(|_| series::outcome(seeds).0.is_good()) else {
        return table::Cell::absent();
    };
    match (&seeds[..], &first[..]) {
        ([cell], [first]) if cell.id == first.id => "1".into(),
        ([cell], [first]) => match cell.ratio(first) {
            Some(ratio) => with_interval(&ratio).into(),
            None => table::Cell::absent(),
        },
        _ => series::time(seeds).zip(series::time(first)).map(|(time, first)| time / first).into(),
    }
}

/// Time, memory, tests and errors: medians over seeds. An interval of absolute times would hold in
/// one run alone.
fn numbers(n: u64, seeds: &Seeds<'_>) -> [table::Cell; 4] {
    let particles = n.max(1) as f64;
    let per = |name: &str| {
        let found: Option<Vec<f64>> = seeds.iter().map(|cell| cell.variable(name, None)).collect();
        table::Cell::from(found.and_then(|found| median(&found)).map(|value| value / particles))
    };
    let (outcome, time) = (series::outcome(seeds).0, series::time(seeds));
    let good = outcome.is_good();
    let shown = if good { time.map(|time| time / particles).into() } else { outcome.name().into() };
    let compared =
        seeds.iter().all(|cell| cell.errors.is_some()) && (good || outcome == Outcome::Wrong);
    let sum = |wrong: fn(&Cell) -> u64| seeds.iter().map(|cell| wrong(cell)).sum::<u64>();
    let missed = sum(|cell| cell.errors.map_or(0, |errors| errors.missed));
    let added = sum(|cell| cell.errors.map_or(0, |errors| errors.wrong() - errors.missed));
    let errors = match compared {
        true => format!("{missed} / {added}").into(),
        false => table::Cell::absent(),
    };
    [shown, per("peak_bytes"), per("contact_test"), errors]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells;
    use crate::cells::testing;
    use crate::cells::testing::Lab;
    use crate::record::row::Pass;
    use contactbench_terms::errors::Errors;

    fn made(format: Format) -> String {
        let mut lab = Lab::new("e", "packed");
        for n in [100, 1000] {
            lab.n(n)
                .detector("nbs")
                .time(&[100 * n, 110 * n, 120 * n, 130 * n, 140 * n, 150 * n])
                .memory(12 * n, 12 * n);
            lab.count(&[("contact_test", 3 * n)]).edit(|row| {
                row.errors = Some(Errors { missed: 2, spurious: 1, ..Errors::default() })
            });
            lab.detector("my_50% & {[fast]}\\").time(&[50 * n; 6]);
            lab.detector("direct").fail(Pass::Time, Outcome::Timeout, "30 s");
            lab.detector("nbs-twin").time(&[100 * n, 110 * n, 120 * n, 130 * n, 140 * n, 150 * n]);
        }
        tables(&[testing::experiment("")], &cells::cells(&lab.rows()), format)
    }

    #[test]
    fn markdown_has_a_line_per_n_and_detector() {
        let found = made(Format::Markdown);
        assert!(
            found.starts_with(
                "**packed, 2D**\n\n| N | detector | time / fastest | time / N in this run (ns) |"
            ),
            "{found}"
        );
        assert!(
            found.contains("| 100 | my\\_50% & {\\[fast\\]}\\\\ | 1 | **50** | – | – | – |"),
            "{found}"
        );
        assert!(
            found.contains("|  | nbs | 2.50 (2.00 to 3.00) | 125 | 12 | 3 | 2 / 1 |"),
            "{found}"
        );
        assert!(
            found.contains("|  | direct | – | timeout | – | – | – |") && !found.contains("twin"),
            "{found}"
        );
    }

    #[test]
    fn latex_is_balanced_and_escaped() {
        let found = made(Format::Latex);
        assert!(
            found.contains(
                "100 & my\\_50\\% \\& \\{{[}fast{]}\\}\\textbackslash{} & 1 & \\textbf{50} & \
                 -- & -- & -- \\\\\n"
            ),
            "{found}"
        );
        assert!(
            found.contains(" & nbs & 2.50 (2.00 to 3.00) & 125 & 12 & 3 & 2 / 1 \\\\\n"),
            "{found}"
        );
        let plain = found.replace("\\{", "").replace("\\}", "");
        assert_eq!(plain.matches('{').count(), plain.matches('}').count());
        let table =
            found.lines().filter(|line| line.ends_with("\\\\") && !line.contains("multicolumn"));
        for line in table {
            assert_eq!(line.replace("\\&", "").matches('&').count(), 6, "{line}");
        }
        assert_eq!(
            found.matches("\\begin{tabular}").count(),
            found.matches("\\end{tabular}").count()
        );
    }
}
