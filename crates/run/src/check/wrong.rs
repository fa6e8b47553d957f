use std::fmt;
use std::time::Duration;

use contactbench_detectors::oracle::loaded::{Difference, differences};
use contactbench_ground::pairs::sink::Digest;
use contactbench_ground::periodic::ImagePair;

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Wrong {
    #[error("{0}")]
    Pairs(Differences),
    /// The detector refuses the scene after reporting this many pairs.
    #[error("it refuses after it has reported {0} pairs")]
    RefusesLate(u64),
    #[error("it panics: {}", .0.lines().next().unwrap_or_default())]
    Panics(String),
    #[error("it hangs: not ready after {} s", .0.as_secs_f64())]
    Hangs(Duration),
    #[error("it dies: {how}")]
    Dies {
        /// The cause of the runner's end and its last words, in one sentence. `errors` is the end
        /// of its standard error.
        how: String,
        errors: String,
    },
    #[error("it breaks the protocol: {0}")]
    Breaks(String),
    /// A function failed. The text describes how, for example `raises an error`.
    #[error("it {0}")]
    Fails(String),
    /// The digest is wrong, and the pairs are unknown, because the runner does not write them or
    /// there are too many.
    #[error("it finds {}, which are not known", unknown(said.contacts, truth.contacts))]
    Counts { said: Digest, truth: Digest },
}

/// Errors of a contact list. Each pair has the smaller index first; images are 0 in open space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Differences {
    pub missed: Vec<ImagePair>,
    pub spurious: Vec<ImagePair>,
    pub selves: Vec<ImagePair>,
    /// Pairs that are reported more than once, with an entry for each repetition.
    pub duplicate: Vec<ImagePair>,
}

const SHOWN: usize = 4;

impl Differences {
    /// Compares reported pairs, in any order, with the true pairs, which must be unique and
    /// ascending.
    pub fn new(mut reported: Vec<ImagePair>, truth: &[ImagePair]) -> Differences {
        reported.sort_unstable();
        let mut all = Differences::default();
        differences(&reported, truth, |kind, pair| match kind {
            Difference::Missed => all.missed.push(pair),
            Difference::Added if pair.i == pair.j && pair.image == [0; 3] => all.selves.push(pair),
            Difference::Added => all.spurious.push(pair),
            Difference::Repeated => all.duplicate.push(pair),
        });
        all
    }
}

impl fmt::Display for Differences {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Differences { missed, spurious, selves, duplicate } = self;
        let [misses, added, repeated] = [missed, spurious, duplicate].map(Vec::len);
        write!(f, "{misses} missed, {added} spurious, {repeated} duplicate pairs")?;
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
                let shown = pairs.iter().take(SHOWN).map(ImagePair::to_string);
                let more = if pairs.len() > SHOWN { " ..." } else { "" };
                write!(f, "; {kind} {}{more}", shown.collect::<Vec<_>>().join(" "))?;
            }
        }
        Ok(())
    }
}

/// Formats numbers of pairs that are found, while the pairs are not known.
fn unknown(said: u64, truth: u64) -> String {
    match said == truth {
        true => format!("the right number of pairs ({said}), but other pairs"),
        false => format!("{said} pairs instead of {truth}"),
    }
}
