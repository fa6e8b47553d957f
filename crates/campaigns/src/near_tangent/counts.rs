//! What is counted.

use std::ops::AddAssign;

/// What is counted in both parts of the campaign.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum What {
    /// Pairs decided: couples, or couples times detectors.
    Pairs,
    /// Couples by their label.
    Apart,
    Tangent,
    Overlap,
    /// Decisions that the filter left to exact arithmetic.
    Exact,
    /// Decisions made in f64 on the same couples, and how many of them were wrong.
    Rounded,
    RoundedWrong,
    /// Couples whose label was compared with that of rational arithmetic.
    Sampled,
    /// Errors, from here on: touching couples not reported.
    Missed,
    /// Pairs reported that do not touch.
    Spurious,
    /// Touching couples reported again.
    Duplicate,
    /// Particles reported as touching themselves.
    Itself,
    /// Labels (apart, tangent, overlap) that differ from the construction's.
    Label,
    /// Depths whose sign is not that of the label.
    Depth,
    /// Labels of the construction that differ from rational arithmetic: the campaign itself would
    /// be wrong.
    Construction,
    /// Scenes that a detector refused.
    Refused,
}

const KINDS: usize = What::Refused as usize + 1;

/// How often each happened.
#[derive(Clone, Copy, Default)]
pub struct Counts([u64; KINDS]);

impl Counts {
    pub fn add(&mut self, what: What, n: u64) {
        self.0[what as usize] += n;
    }

    pub fn get(&self, what: What) -> u64 {
        self.0[what as usize]
    }

    /// All errors together.
    pub fn errors(&self) -> u64 {
        self.0[What::Missed as usize..].iter().sum()
    }
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Counts) {
        for (mine, theirs) in self.0.iter_mut().zip(other.0) {
            *mine += theirs;
        }
    }
}
