//! Errors by cause, in a line per scene, arithmetic and group of detectors.

use crate::findings::errors::{ErrorLine, ErrorTable};
use crate::number::radii;
use crate::present::document::{Block, Text};
use crate::present::table::{Cell, Column, Table};
use crate::record::row::Outcome;
use contactbench_terms::errors::{Causes, Errors};

/// How to read the table, and the table.
pub fn blocks(found: &ErrorTable) -> Vec<Block> {
    let how = Text::from("Pairs missed / pairs added, by cause: the ")
        .emphasis("representation")
        .plain(" of the scene (its coordinates rounded, then decided exactly), the ")
        .emphasis("predicate")
        .plain(" (the arithmetic's contact test on all pairs of the stored scene), the ")
        .emphasis("search")
        .plain(" (which pairs the detector tested). ")
        .emphasis("Together")
        .plain(
            " is the answer against exact decisions on the scene as given; errors of two causes \
             can cancel. The error rate is the number of wrong pairs over that of true contacts. \
             Depths and gaps are in mean radii of the pair: a miss of 0 r is a pair that just \
             touches.",
        );
    vec![Block::Paragraph(how), Block::Table(table(found))]
}

fn table(found: &ErrorTable) -> Table {
    let columns = vec![
        Column::left("detectors"),
        Column::left("arithmetic"),
        Column::left("scene"),
        Column::right("true contacts", ""),
        Column::right("representation", ""),
        Column::right("predicate", ""),
        Column::right("search", ""),
        Column::right("together", ""),
        Column::right("error rate", ""),
        Column::right("deepest miss", ""),
        Column::right("widest false", ""),
        Column::left("outcome"),
    ];
    Table::new("", columns).with(found.lines.iter().map(row))
}

fn row(line: &ErrorLine) -> Vec<Cell> {
    let sum = &line.sum;
    let cause = |cause: fn(&Causes) -> &Errors| {
        sum.causes.as_ref().map_or_else(Cell::absent, |causes| counts(cause(causes)).into())
    };
    let depth = |there: u64, depth: f64| match there {
        0 => Cell::absent(),
        _ => radii(depth).into(),
    };
    let outcomes: Vec<&str> = sum
        .outcomes
        .iter()
        .filter(|outcome| **outcome != Outcome::Ok)
        .map(|outcome| outcome.name())
        .collect();
    vec![
        line.detectors.as_str().into(),
        line.arithmetic.as_str().into(),
        line.scene.as_str().into(),
        Cell::number(sum.contacts),
        cause(|causes| &causes.representation),
        cause(|causes| &causes.predicate),
        cause(|causes| &causes.search),
        counts(&sum.errors).into(),
        Cell::share(sum.errors.wrong() as f64 / sum.contacts.max(1.0)),
        depth(sum.errors.missed, sum.errors.deepest_miss),
        depth(sum.errors.spurious, sum.errors.widest_false),
        outcomes.join(", ").into(),
    ]
}

/// `3 / 2` for three missed and two spurious, with pairs repeated or of one particle where there
/// are any; `0` for none.
fn counts(errors: &Errors) -> String {
    if errors.wrong() == 0 {
        return "0".into();
    }
    let mut out = format!("{} / {}", errors.missed, errors.spurious);
    for (count, noun) in [(errors.duplicate, "twice"), (errors.self_pairs, "self")] {
        if count > 0 {
            out += &format!(" / {count} {noun}");
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells;
    use crate::cells::testing::Lab;
    use crate::findings::errors::testing::{errors, lab};

    #[test]
    fn the_table_tells_causes_apart_and_folds_what_is_the_same() {
        let cells = cells::cells(&lab().rows());
        let table = table(&ErrorTable::new(&cells.iter().collect::<Vec<_>>()).unwrap()).markdown();
        let lines: Vec<&str> = table.lines().skip(2).collect();
        assert_eq!(
            lines,
            [
                "| all | exact | packed 2D | 500 | 0 | 0 | 0 | 0 | 0% | – | – |  |",
                "| all | f32 | packed 2D, offset = 0 | 250 | 0 | 1 / 0 | 0 | 1 / 0 / 2 self | \
                 1.2% | 0.2500 r | – |  |",
                "| all | f32 | packed 2D, offset = 1000 | 250 | 20 / 5 | 1 / 0 | 0 | 21 / 5 / 2 \
                 self | 11% | 0.2500 r | 0 r |  |",
                "| nbs | textbook | packed 2D, offset = 0 | 250 | 0 | 0 | 1 / 0 | 1 / 0 | 0.4% | \
                 0.2500 r | – | lossy |",
                "| sorting | textbook | packed 2D, offset = 0 | 250 | 0 | 0 | 0 | 0 | 0% | – | – \
                 |  |",
                "| nbs | textbook | packed 2D, offset = 1000 | 250 | 0 | 0 | 1 / 0 | 1 / 0 | 0.4% \
                 | 0.2500 r | – | lossy |",
                "| sorting | textbook | packed 2D, offset = 1000 | 250 | 0 | 0 | 0 | 0 | 0% | – | \
                 – |  |",
            ]
        );
    }

    #[test]
    fn a_record_without_causes_still_has_its_errors() {
        let mut lab = Lab::new("e", "packed");
        lab.count(&[]).edit(|row| row.errors = Some(errors(3, 0)));
        let cells = cells::cells(&lab.rows());
        assert_eq!(
            (cells[0].variable("missed", None), cells[0].variable("representation_missed", None)),
            (Some(3.0), None)
        );
        let table = table(&ErrorTable::new(&[&cells[0]]).unwrap()).markdown();
        assert!(
            table.contains("| all | exact | packed 2D | 250 | – | – | – | 3 / 0 | 1.2% |"),
            "{table}"
        );
    }
}
