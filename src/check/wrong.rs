//! In which way an answer is wrong.

use std::fmt;
use std::time::Duration;

use crate::sink::{Digest, key, normalise};

/// In which way a detector is wrong.
#[derive(Clone, Debug, PartialEq)]
pub enum Wrong {
    /// It misses, adds or repeats pairs.
    Pairs(Differences),
    /// It refuses the scene, but has reported so many pairs before.
    RefusesLate(u64),
    /// It panics, with this message.
    Panics(String),
    /// It was not ready after this time.
    Hangs(Duration),
    /// A runner died: how, and the end of what it said on its standard error.
    Dies {
        /// How, and its last words, in one sentence.
        how: String,
        /// The last lines.
        errors: String,
    },
    /// A runner broke the protocol: what it should have done, and what it did.
    Breaks(String),
    /// A runner that does not give its pairs has others than the truth.
    Counts {
        /// What it says.
        said: Digest,
        /// What is true.
        truth: Digest,
    },
}

/// What is wrong with a list of pairs. The smaller index stands first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Differences {
    /// Touching pairs not reported.
    pub missed: Vec<[u32; 2]>,
    /// Reported pairs that do not touch.
    pub spurious: Vec<[u32; 2]>,
    /// Particles reported with themselves.
    pub selves: Vec<[u32; 2]>,
    /// Pairs reported again, once for each time.
    pub duplicate: Vec<[u32; 2]>,
}

/// This many pairs of a kind are shown.
const SHOWN: usize = 4;

impl Differences {
    /// Compares what was reported, in any order, with the true pairs, each once and in ascending
    /// order.
    pub fn new(mut reported: Vec<[u32; 2]>, truth: &[[u32; 2]]) -> Differences {
        normalise(&mut reported);
        let duplicate: Vec<[u32; 2]> =
            reported.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0]).collect();
        reported.dedup();
        let without = |pairs: &[[u32; 2]], others: &[[u32; 2]]| {
            let absent = |[i, j]: &[u32; 2]| {
                others.binary_search_by_key(&key(*i, *j), |&[i, j]| key(i, j)).is_err()
            };
            pairs.iter().copied().filter(absent).collect::<Vec<_>>()
        };
        let (selves, spurious) = without(&reported, truth).into_iter().partition(|[i, j]| i == j);
        Differences { missed: without(truth, &reported), spurious, selves, duplicate }
    }
}

impl fmt::Display for Differences {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Differences { missed, spurious, selves, duplicate } = self;
        write!(
            f,
            "{} missed, {} spurious, {} duplicate pairs",
            missed.len(),
            spurious.len(),
            duplicate.len()
        )?;
        if !selves.is_empty() {
            write!(f, ", {} of a particle with itself", selves.len())?;
        }
        for (kind, pairs) in [
            ("missed", missed),
            ("spurious", spurious),
            ("itself", selves),
            ("duplicate", duplicate),
        ] {
            if !pairs.is_empty() {
                let shown: Vec<String> =
                    pairs.iter().take(SHOWN).map(|[i, j]| format!("{i},{j}")).collect();
                write!(
                    f,
                    "; {kind} {}{}",
                    shown.join(" "),
                    if pairs.len() > SHOWN { " ..." } else { "" }
                )?;
            }
        }
        Ok(())
    }
}

impl fmt::Display for Wrong {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Wrong::Pairs(differences) => differences.fmt(f),
            Wrong::RefusesLate(reported) => {
                write!(f, "it refuses after it has reported {reported} pairs")
            }
            Wrong::Panics(message) => {
                write!(f, "it panics: {}", message.lines().next().unwrap_or_default())
            }
            Wrong::Hangs(deadline) => {
                write!(f, "it hangs: not ready after {} s", deadline.as_secs_f64())
            }
            Wrong::Dies { how, .. } => write!(f, "it dies: {how}"),
            Wrong::Breaks(what) => write!(f, "it breaks the protocol: {what}"),
            Wrong::Counts { said, truth } if said.contacts == truth.contacts => {
                write!(
                    f,
                    "it finds other pairs, as many as there are ({}); its runner does not say \
                     which",
                    said.contacts
                )
            }
            Wrong::Counts { said, truth } => {
                write!(
                    f,
                    "it finds {} pairs, there are {}; its runner does not say which",
                    said.contacts, truth.contacts
                )
            }
        }
    }
}
