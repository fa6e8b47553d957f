//! All contenders of each scene, in a table each.

use crate::findings::scenes::{Contender, SceneResults, Versus};
use crate::present::document::Block;
use crate::present::table::{Cell, Column, Table};
use crate::record::row::Outcome;

/// A heading and a table per scene.
pub fn blocks(found: &[SceneResults]) -> Vec<Block> {
    let section = |scene: &SceneResults| {
        [Block::heading(3, scene.title.as_str()), Block::Table(table(scene))]
    };
    found.iter().flat_map(section).collect()
}

fn table(scene: &SceneResults) -> Table {
    // Only where somebody looked.
    let quiet = scene.results.iter().any(|found| found.quiet.is_some());
    let mut columns = vec![Column::left("detector"), Column::right("time / N", "ns")];
    columns.extend(quiet.then(|| Column::right("quiet / N", "ns")));
    columns.extend([
        Column::right("first call / N", "ns"),
        Column::right("blocks", ""),
        Column::right("time / fastest", ""),
        Column::right("contact tests / N", ""),
        Column::right("list operations / N", ""),
        Column::right("peak memory / N", "bytes"),
        Column::right("by formula / N", "bytes"),
        Column::left("outcome"),
    ]);
    let row = |found: &Contender| {
        let time = Cell::from(found.time);
        let wrong = found.outcome == Outcome::Wrong && found.time.is_some();
        let mut row = vec![found.name.as_str().into(), if wrong { time.wrong() } else { time }];
        row.extend(quiet.then(|| Cell::from(found.quiet)));
        row.extend([
            found.first.into(),
            Cell::count(found.blocks as u64),
            match &found.versus {
                Versus::Fastest => Cell::count(1),
                Versus::Slower(ratio) => Cell::ratio(ratio),
                Versus::Unknown => Cell::absent(),
            },
            found.contact_tests.into(),
            found.list_operations.into(),
            found.peak_bytes.into(),
            found.formula_bytes.into(),
            found.outcome.name().into(),
        ]);
        row
    };
    Table::new("", columns).with(scene.results.iter().map(row))
}

#[cfg(test)]
mod tests {
    use crate::cells::testing::Lab;
    use crate::cells::{self, Cell};
    use crate::findings::failures::failures;
    use crate::findings::scenes::scenes;
    use crate::present::document::markdown;
    use crate::present::sections::failures as failed;
    use crate::record::row::{Outcome, Pass};

    #[test]
    fn every_contender_has_a_line_and_what_failed_a_reason() {
        let mut lab = Lab::new("e", "packed");
        lab.n(1000)
            .detector("nbs")
            .time(&[1000; 15])
            .count(&[("contact_test", 6000), ("list_push", 2000)])
            .memory(20_000, 21_000);
        lab.detector("sorting").time(&[2500; 15]);
        lab.detector("screening").time(&[500; 15]).edit(|row| row.outcome = Outcome::Wrong);
        lab.detector("direct").fail(Pass::Time, Outcome::Timeout, "30 s, the limit");
        lab.n(10).detector("direct").time(&[5]);
        let cells = cells::cells(&lab.rows());
        let all: Vec<&Cell> = cells.iter().collect();
        let found = scenes(&all);
        assert_eq!(found.len(), 2);
        let text = markdown(&super::blocks(&found[1..]));
        assert!(text.starts_with("### packed, 2D, N = 1000\n\n| detector | time / N (ns) |"));
        for line in [
            "| nbs | 1 | – | 15 | 1 | 6 | 2 | 20 | 21 | ok |",
            "| sorting | 2.500 | – | 15 | 2.50 (2.50 to 2.50) | – | – | – | – | ok |",
            "| screening | wrong (0.5000) | – | 15 | – | – | – | – | – | wrong |",
            "| direct | – | – | 0 | – | – | – | – | – | timeout |",
        ] {
            assert!(text.contains(line), "{line} is not in {text}");
        }
        let text = markdown(&failed::blocks(&failures(&all)));
        assert!(
            text.contains("| direct | packed 2D | 1000 | timeout | 30 s, the limit |"),
            "{text}"
        );
    }

    #[test]
    fn where_somebody_looked_quiet_times_stand_beside() {
        let mut lab = Lab::new("e", "packed");
        lab.time(&[100, 180, 190, 110, 200]).pulses(&[1000, 1600, 1700, 1010, 1300]);
        lab.detector("sorting").time(&[300; 5]).pulses(&[2000; 5]);
        let cells = cells::cells(&lab.rows());
        let text = markdown(&super::blocks(&scenes(&cells.iter().collect::<Vec<_>>())));
        assert!(text.contains("| detector | time / N (ns) | quiet / N (ns) | first"), "{text}");
        assert!(text.contains("| nbs | 1.800 | 1.050 | – |"), "{text}");
        assert!(text.contains("| sorting | 3 | – | – |"), "{text}");
    }
}
