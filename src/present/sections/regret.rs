//! What following printed advice would cost: a table, its sources, and `regret.csv`.

use crate::findings::regret::{Followed, Regret};
use crate::number::{times, with_interval};
use crate::present::document::{Block, Text};
use crate::present::table::{Cell, Column, Table};

/// The section of a report.
pub fn blocks(found: &[Followed]) -> Vec<Block> {
    let how = "The time of the advised detector over that of the fastest, scene by scene and N by \
               N, each detector in its plainest setting; 1 is the best advice. Undecided: blocks \
               and noise do not tell it from the fastest. One without an answer (refused, over \
               the time limit) counts as infinitely slow in the median, though one that ran out \
               of time may be hardly slower than the limit; the worst is of those with a time. \
               The fastest is chosen from the same times, so regret is a little too large. All \
               scenes are in ";
    let how = Text::from(how).link("regret.csv", "regret.csv").plain(". Sources:");
    let source = |one: &Followed| {
        let advice = &one.advice;
        let note = match advice.note.as_str() {
            "" => String::new(),
            note => format!(" ({note})"),
        };
        Text::new().emphasis(advice.name.as_str()).plain(format!(": {}{note}.", advice.source))
    };
    let sources = Block::List(found.iter().map(source).collect());
    vec![Block::Table(table(found)), Block::Paragraph(how), sources]
}

fn table(found: &[Followed]) -> Table {
    let columns = vec![
        Column::left("advice"),
        Column::right("scenes", ""),
        Column::right("time / best: median", ""),
        Column::right("worst that has a time", ""),
        Column::left("where"),
        Column::right("fastest in", ""),
        Column::right("undecided in", ""),
        Column::right("slower in", ""),
        Column::right("no answer in", ""),
    ];
    let row = |one: &Followed| {
        let [first, undecided, slower, endless] =
            one.tally().map(|count| Cell::count(count as u64));
        let typical = one.typical();
        let (worst, place) = match one.worst() {
            Some((place, ratio)) => (Cell::from(with_interval(&ratio)), place.title.as_str()),
            None => (Cell::absent(), ""),
        };
        let typical = if typical.is_finite() { times(typical) } else { "no answer".into() };
        let scenes = Cell::count(one.places.len() as u64);
        let name = one.advice.name.as_str().into();
        let medians = [typical.into(), worst, place.into()];
        let counts = [first, undecided, slower, endless];
        [name, scenes].into_iter().chain(medians).chain(counts).collect()
    };
    Table::new("", columns).with(found.iter().map(row))
}

/// `regret.csv`: a line per advice and scene.
pub fn rows(found: &[Followed]) -> Table {
    let words = |names: &[&str]| names.iter().map(|name| Column::left(*name)).collect::<Vec<_>>();
    let mut columns = words(&["experiment", "scene", "n", "advice", "advised", "fastest"]);
    columns.push(Column::ratio("regret"));
    columns.extend(words(&["blocks", "slower", "outcome", "source"]));
    let mut table = Table::new("", columns);
    for (one, place) in found.iter().flat_map(|one| one.places.iter().map(move |at| (one, at))) {
        let (ratio, blocks, slower, outcome) = match place.regret {
            Regret::None => (Cell::number(1.0), Cell::absent(), "no", "ok"),
            Regret::Times(ratio, slower) => {
                let blocks = Cell::count(ratio.count as u64);
                (Cell::ratio(&ratio), blocks, if slower { "yes" } else { "undecided" }, "ok")
            }
            Regret::Endless(outcome) => (Cell::absent(), Cell::absent(), "yes", outcome.name()),
        };
        table.rows.push(vec![
            place.experiment.as_str().into(),
            place.title.as_str().into(),
            Cell::count(place.n),
            one.advice.name.as_str().into(),
            place.advised.as_str().into(),
            place.fastest.as_str().into(),
            ratio,
            blocks,
            slower.into(),
            outcome.into(),
            one.advice.source.as_str().into(),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::findings::regret::tests::made_up;
    use crate::present::document::markdown;
    use crate::present::table::csv;

    #[test]
    fn each_piece_of_advice_has_its_median_its_worst_and_its_source() {
        let found = made_up();
        let text = markdown(&blocks(&found));
        for part in [
            "| the book: screening where memory allows, NBS else | 2 | 6.32 | 20.0 (20.0 to 20.0) \
             | loose, 2D, N = 100, fraction = 0.01 | 0 | 0 | 2 | 0 |",
            "| one grid, with cells for the largest body | 2 | no answer | – |  | 1 | 0 | 0 | 1 |",
            "The Combined Finite-Discrete Element Method",
        ] {
            assert!(text.contains(part), "{part} is not in {text}");
        }
        let text = csv(&[rows(&found)]);
        assert_eq!(text.lines().count(), 11, "{text}");
        let line = |part: &str| text.lines().find(|line| line.contains(part)).unwrap();
        let best = "one grid, with cells for the largest body\",cell-grid,cell-grid,1,,,,no,ok,";
        assert!(text.contains(best), "{text}");
        assert!(line(",timeout,").contains(",cell-grid,hgrid,,,,,yes,timeout,"), "{text}");
        assert!(line(",bvh,hgrid,").contains(",15,yes,ok,"), "{text}");
    }
}
