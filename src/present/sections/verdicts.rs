//! Who is right, case by case.

use std::collections::BTreeMap;

use crate::cells::{Cell as Measured, label};
use crate::findings::verdicts::{Answer, Matrix, case, judged};
use crate::number::plural;
use crate::present::document::{Block, Text};
use crate::present::table::{Cell, Column, Table};
use crate::record::column;

/// For a report: how to read the tables, and the tables.
pub fn blocks(found: &Matrix) -> Vec<Block> {
    let how = Text::from(
        "Right is an answer with exactly the pairs that touch in exact arithmetic in the scene as \
         given. First the number of answers of each kind, then the cases in which someone is not \
         right, and how: -3 +1 is three pairs missed and one added (by the predicate, or by the \
         representation of the scene), ",
    )
    .emphasis("lossy")
    .plain(" (a textbook filter lost contacts), ")
    .emphasis("refused")
    .plain(" (the reason is given below, one example of its kind), ")
    .emphasis("DEFECT")
    .plain(
        " (not the answer of the detector's own arithmetic). Detectors that are not named are \
         right. Every answer is in ",
    )
    .link("verdicts.csv", "verdicts.csv")
    .plain(".");
    let mut out = vec![Block::Paragraph(how), Block::Table(totals(found))];
    if !found.lines.is_empty() {
        out.push(Block::Table(lines(found)));
    }
    out.extend(rest(found));
    out
}

/// For a terminal.
pub fn terminal(found: &Matrix) -> Vec<Block> {
    let legend = "-: pairs missed, +: pairs added; in brackets: the reason below, one example of \
                  its kind";
    let mut table = lines(found);
    table.rows.extend(totals(found).rows.into_iter().map(|mut row| {
        row.insert(1, "".into());
        row
    }));
    let head = [Block::Table(table), Block::paragraph(legend)];
    head.into_iter().chain(rest(found)).collect()
}

fn totals(found: &Matrix) -> Table {
    let columns = found.arithmetics.iter().map(|name| Column::right(name.as_str(), ""));
    let row = |(word, counts): &(&str, Vec<u64>)| {
        std::iter::once(Cell::from(*word)).chain(counts.iter().map(|n| Cell::count(*n))).collect()
    };
    let columns = std::iter::once(Column::left("answers")).chain(columns).collect();
    Table::new("", columns).with(found.totals.iter().map(row))
}

fn lines(found: &Matrix) -> Table {
    let columns = ["case", "dim"].into_iter().chain(found.arithmetics.iter().map(String::as_str));
    let table = Table::new("", columns.map(Column::left).collect());
    table.with(found.lines.iter().map(|line| {
        let answers = line.answers.iter().map(|answer| match answer {
            Some(lines) => Cell::lines(lines.clone()),
            None => Cell::absent(),
        });
        let head = [Cell::from(line.case.as_str()), line.shown_dims(" ").into()];
        head.into_iter().chain(answers).collect()
    }))
}

/// Cases that everybody gets right, and reasons.
fn rest(found: &Matrix) -> Vec<Block> {
    let mut out = Vec::new();
    if !found.right.is_empty() {
        out.push(Block::paragraph(format!(
            "Right by every detector in every arithmetic, {}: {}.",
            plural(found.right.len(), "case"),
            found.right.join(", ")
        )));
    }
    let reasons = found.reasons.iter().enumerate();
    out.extend(reasons.map(|(k, reason)| Block::paragraph(format!("({}) {reason}", k + 1))));
    out
}

/// `verdicts.csv`: every answer.
pub fn rows(cells: &[&Measured]) -> Table {
    let (cells, names) =
        (judged(cells), column::errors().map(|error| &*error.name).collect::<Vec<_>>());
    let mut swept: BTreeMap<&str, Vec<&Measured>> = BTreeMap::new();
    for &cell in &cells {
        swept.entry(&cell.id.experiment).or_default().push(cell);
    }
    let swept: BTreeMap<&str, Vec<String>> =
        swept.into_iter().map(|(experiment, cells)| (experiment, label::swept(&cells))).collect();
    let words = [
        "experiment",
        "case",
        "dim",
        "n",
        "seed",
        "detector",
        "arithmetic",
        "answer",
        "outcome",
        "reason",
    ];
    let numbers: Vec<&str> = ["contacts", "true_contacts"].into_iter().chain(names).collect();
    let columns = words.iter().chain(&numbers).map(|name| Column::left(*name)).collect();
    let row = |cell: &&Measured| {
        let (key, (outcome, reason)) = (&cell.id, cell.overall());
        let mut row: Vec<Cell> = vec![
            key.experiment.as_str().into(),
            case(key, &swept[&*key.experiment]).0.into(),
            Cell::count(key.dim.into()),
            Cell::count(key.n),
            Cell::count(key.seed),
        ];
        row.extend(
            [&*key.detector, &*key.arithmetic, Answer::new(cell).word(), outcome.name(), reason]
                .map(Cell::from),
        );
        row.extend(numbers.iter().map(|name| Cell::from(cell.variable(name, None))));
        row
    };
    Table::new("", columns).with(cells.iter().map(row))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells;
    use crate::findings::verdicts::testing::lab;
    use crate::present::document::{markdown, plain};
    use crate::present::table::csv;

    #[test]
    fn report_and_terminal_say_the_same_and_fit() {
        let cells = cells::cells(&lab().rows());
        let found = Matrix::new(&cells.iter().collect::<Vec<_>>()).unwrap();
        let (report, terminal) = (markdown(&blocks(&found)), plain(&terminal(&found), 110));
        assert!(terminal.lines().all(|line| line.chars().count() <= 110), "{terminal}");
        for part in ["Right by every detector", "1 case: calm", "(1)", "nbs would need"] {
            assert!(report.contains(part) && terminal.contains(part), "{part}: {report}{terminal}");
        }
        assert!(
            report.contains("| tangent | 2D | -3 | nbs, sorting: lossy -2 | right |"),
            "{report}"
        );
    }

    #[test]
    fn every_answer_is_a_line_of_the_csv() {
        let cells = cells::cells(&lab().rows());
        let csv = csv(&[rows(&cells.iter().collect::<Vec<_>>())]);
        assert_eq!(csv.lines().count(), 1 + 5 * 3 * 3);
        assert!(
            csv.contains("e,tangent,2,100,1,nbs,textbook,lossy,lossy,,250,250,2,0,0,0,0,0,2,"),
            "{csv}"
        );
        assert!(
            csv.contains(
                "e,far,3,100,1,nbs,exact,refused,refused,nbs would need 5.3e11 cells; use direct,,"
            ),
            "{csv}"
        );
    }
}
