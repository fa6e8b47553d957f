//! Each planned cell has its rows.

use std::collections::BTreeSet;

use super::rows;
use contactbench::record::row::{Measurement, Outcome, Pass, Row};

#[test]
fn every_planned_cell_has_its_rows_and_the_answers_are_right() {
    let text = "detectors = [\"screening\", \"nbs\", \"nothing\"]\narithmetics = [\"f32\", \
                \"exact\"]\n[[scene]]\nname = \"packed\"\ndim = [2, 3]\nn = [0, 60]\nseed = [1, \
                2]\n[[scene]]\nname = \"pack-c\"\nn = 16\ns = [1, 3]\n";
    let (_at, rows) = rows(text, 0);
    let keys: BTreeSet<Measurement> = rows.iter().map(Row::measurement).collect();
    assert_eq!(keys.len(), rows.len(), "no cell has two rows");
    // packed has 2 dimensions, 2 sizes, 2 seeds; pack-c 2 spacings. Each scene has 3 detectors in 2
    // arithmetics and a twin in the first; each of them has counts, memory and one block.
    assert_eq!(rows.len(), (2 * 2 * 2 + 2) * (3 * 2 + 1) * (1 + 1 + 1));
    for row in &rows {
        let control = row.id.detector == "nothing";
        assert_eq!(row.outcome, if control { Outcome::Control } else { Outcome::Ok }, "{row:?}");
        assert_eq!(row.block > 0, row.pass == Pass::Time);
        assert_eq!(row.time_ns.is_some(), row.pass == Pass::Time);
        assert_eq!(row.peak_bytes.is_some(), row.pass == Pass::Memory);
        assert_eq!(row.counts.is_empty(), row.pass != Pass::Count);
        let others = rows.iter().filter(|other| {
            other.stats == row.stats
                && other.id.arithmetic == row.id.arithmetic
                && other.id.detector != "nothing"
        });
        assert!(control || others.clone().all(|other| other.digest == row.digest), "{row:?}");
    }
    assert!(rows.iter().any(|row| row.contacts > Some(60)), "the packed scenes have contacts");
}
