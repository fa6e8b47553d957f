//! All contenders of each scene, in a table each.

use super::{About, Section};
use crate::document::Block;
use crate::table::{Cell, Table};
use contactbench_record::findings::scenes::{Contender, SceneResults, Versus, scenes};
use contactbench_record::record::row::Outcome;

/// A section for each scene.
pub fn sections(about: &About<'_>) -> Vec<Section> {
    let section = |scene: SceneResults| Section::new(&scene.title, vec![table(&scene)]);
    scenes(about.cells).into_iter().map(section).collect()
}

fn table(scene: &SceneResults) -> Block {
    // Only where the state of the machine was watched.
    let quiet = scene.results.iter().any(|found| found.quiet.is_some());
    let time = |found: &Contender| {
        let time = Cell::from(found.time);
        if found.outcome == Outcome::Wrong && found.time.is_some() { time.wrong() } else { time }
    };
    let versus = |found: &Contender| match found.versus {
        Versus::Fastest => Cell::count(1),
        Versus::Slower(ratio) => ratio.into(),
        Versus::Unknown => Cell::absent(),
    };
    let table = Table::of("", &scene.results)
        .left("detector", |found| &*found.name)
        .unit("time / N", "ns", time)
        .when(quiet, |table| table.unit("quiet / N", "ns", |found| found.quiet))
        .unit("first call / N", "ns", |found| found.first)
        .right("blocks", |found| found.blocks as u64)
        .right("time / fastest", versus)
        .right("contact tests / N", |found| found.contact_tests)
        .right("list operations / N", |found| found.list_operations)
        .unit("peak memory / N", "bytes", |found| found.peak_bytes)
        .unit("by formula / N", "bytes", |found| found.formula_bytes)
        .left("outcome", |found| found.outcome.name());
    Block::table(table)
}

#[cfg(test)]
mod tests {
    use crate::document::markdown;
    use crate::sections::failures as failed;
    use contactbench_record::cells::testing::Lab;
    use contactbench_record::cells::{self, Cell};
    use contactbench_record::findings::failures::failures;
    use contactbench_record::findings::scenes::scenes;
    use contactbench_record::record::row::{Outcome, Pass};

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
        assert_eq!(found[1].title, "packed, 2D, N = 1000");
        let text = markdown(&[super::table(&found[1])]);
        assert!(text.starts_with("| detector | time / N (ns) |"), "{text}");
        for line in [
            "| nbs | 1 | – | 15 | 1 | 6 | 2 | 20 | 21 | ok |",
            "| sorting | 2.500 | – | 15 | 2.50 (2.50 to 2.50) | – | – | – | – | ok |",
            "| screening | wrong (0.5000) | – | 15 | – | – | – | – | – | wrong |",
            "| direct | – | – | 0 | – | – | – | – | – | timeout |",
        ] {
            assert!(text.contains(line), "{line} is not in {text}");
        }
        let text = markdown(&[failed::table(&failures(&all))]);
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
        let text = markdown(&[super::table(&scenes(&cells.iter().collect::<Vec<_>>())[0])]);
        assert!(text.contains("| detector | time / N (ns) | quiet / N (ns) | first"), "{text}");
        assert!(text.contains("| nbs | 1.800 | 1.050 | – |"), "{text}");
        assert!(text.contains("| sorting | 3 | – | – |"), "{text}");
    }
}
