//! Campaigns test every detector and every safe rule on any number of nearly tangent contacts,
//! built from integers, and on moving particles.

pub mod boxes;
pub mod draw;
pub mod near;
pub mod predicate;
pub mod skin;
pub mod tracking;
pub mod whole;

use std::collections::BTreeMap;
use std::ops::AddAssign;

use rayon::prelude::*;

#[derive(Clone, Copy)]
pub struct Plan {
    /// Least number of decisions. A decision is a pair for the contact test, a pair and detector
    /// for detectors, and a contact in a frame of a tracker for trackers.
    pub pairs: u64,
    pub seed: u64,
}

contactbench_terms::named! {
    /// A column of counts.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum What {
        Pairs = "pairs",
        Tangent = "tangent",
        Overlap = "overlap",
        Apart = "apart",
        /// Decisions that the floating-point filter left to exact arithmetic.
        Exact = "exact",
        /// Decisions made in f64 on the same pairs, then those of them that were wrong.
        Rounded = "in f64",
        RoundedWrong = "wrong in f64",
        /// Pairs whose label was compared with rational arithmetic.
        Sampled = "sampled",
        /// Frames given to a tracker, and frames in which it built its list.
        Frames = "frames",
        Built = "built",
        /// Pairs that came into contact and were not in the list at first.
        Came = "came",
        /// Touching pairs that were not reported. This and all later kinds are errors.
        Missed = "missed",
        /// Reported pairs that do not touch.
        Spurious = "spurious",
        /// Touching pairs that were reported again.
        Duplicate = "duplicate",
        Itself = "itself",
        /// Labels (apart, tangent, overlap) that differ from the constructed label.
        Label = "label",
        /// Depths whose sign contradicts the label.
        Depth = "depth",
        /// Constructed labels that differ from rational arithmetic: an error of the campaign
        /// itself.
        Construction = "construction",
        Refused = "refused",
    }
}

#[derive(Clone, Copy, Default)]
pub struct Counts([u64; What::ALL.len()]);

impl Counts {
    pub fn add(&mut self, what: What, n: u64) {
        self.0[what as usize] += n;
    }

    pub fn get(&self, what: What) -> u64 {
        self.0[what as usize]
    }

    pub fn errors(&self) -> u64 {
        self.0[What::Missed as usize..].iter().sum()
    }
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Counts) {
        self.0.iter_mut().zip(other.0).for_each(|(mine, theirs)| *mine += theirs);
    }
}

/// Suffix in the name of a control: a tracker that may miss contacts, and must miss some.
pub const CONTROL: &str = " (control)";

/// Counts by subject (a family, a kind of box, a tracker) and by offset.
#[derive(Default)]
pub struct Totals(pub BTreeMap<(String, String), Counts>);

impl Totals {
    pub fn add(&mut self, what: &str, place: &str, counts: Counts) {
        *self.0.entry((what.into(), place.into())).or_default() += counts;
    }

    fn and(mut self, other: Totals) -> Totals {
        other.0.into_iter().for_each(|(key, counts)| *self.0.entry(key).or_default() += counts);
        self
    }

    /// Sums the rows of safe subjects, which must not have errors; if `safe` is false, those of the
    /// controls.
    pub fn total(&self, safe: bool) -> Counts {
        let lines = self.0.iter().filter(|((what, _), _)| what.ends_with(CONTROL) != safe);
        lines.fold(Counts::default(), |mut sum, (_, counts)| {
            sum += *counts;
            sum
        })
    }

    /// Returns the number of errors; contacts that controls miss do not count.
    pub fn errors(&self) -> u64 {
        let control = self.total(false);
        self.total(true).errors() + control.errors() - control.get(What::Missed)
    }

    /// Formats one line per row, without the columns that are all 0.
    pub fn text(&self) -> String {
        let used: Vec<usize> = (0..What::ALL.len())
            .filter(|&k| k == What::Missed as usize || self.0.values().any(|it| it.0[k] > 0))
            .collect();
        let row = |head: String, cell: &dyn Fn(usize) -> String| {
            used.iter().fold(head, |row, &k| row + &format!(" {:>12}", cell(k))) + "\n"
        };
        let mut text = row(format!("{:24} {:12}", "", ""), &|k| What::ALL[k].name().into());
        for ((what, place), counts) in &self.0 {
            text += &row(format!("{what:24} {place:12}"), &|k| counts.0[k].to_string());
        }
        text
    }
}

/// Runs pieces of a campaign in parallel, in complete batches, until enough pairs are decided.
pub(crate) fn in_batches(
    plan: Plan,
    batch: usize,
    piece: impl Fn(usize) -> Totals + Sync,
) -> Totals {
    let (mut sum, mut done) = (Totals::default(), 0);
    while sum.total(true).get(What::Pairs) < plan.pairs {
        let pieces = (done..done + batch).into_par_iter().map(&piece);
        sum = sum.and(pieces.reduce(Totals::default, Totals::and));
        done += batch;
    }
    sum
}
