//! A made-up map, for tests of this crate and of reports.

use super::*;
use crate::cells;
use crate::cells::testing::{self, Lab};

/// At n = 100, nbs is twice as fast as sorting in loose scenes and undecided in dense ones. At n =
/// 1000, sorting is 1.25 times as fast in loose scenes; dense ones have no times.
pub fn lab() -> Lab {
    let mut lab = Lab::new("e", "packed");
    for (n, fraction, nbs, sorting) in
        [(100, 0.1, 1000, 2000), (100, 0.6, 1000, 1010), (1000, 0.1, 5000, 4000)]
    {
        lab.n(n).param("fraction", fraction);
        lab.filled(fraction);
        lab.detector("nbs").time(&[nbs; 15]);
        lab.detector("nbs-twin").time(&[nbs + nbs / 20; 15]);
        lab.detector("sorting").time(&[sorting; 15]);
    }
    lab.n(1000).param("fraction", 0.6).filled(0.6);
    lab.detector("nbs").fail(Pass::Time, Outcome::Timeout, "30 s, the limit");
    lab
}

pub fn filter(text: &str) -> Where {
    let claim =
        format!("[[claim]]\nname = 'x'\nkind = 'constant'\nvalue = 'n'\nwhere = {{ {text} }}");
    testing::experiment(&claim).claims[0].filter.clone()
}

pub fn map(lab: &Lab, x: &str, y: &str, text: &str) -> anyhow::Result<Map> {
    Map::new(&MapAxes::new(x, y), &filter(text), &cells::cells(&lab.rows()))
}

pub fn made_up() -> Map {
    map(&lab(), "n", "fraction", "").unwrap()
}
