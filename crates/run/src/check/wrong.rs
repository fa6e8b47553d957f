use std::fmt;
use std::time::Duration;

use contactbench_detectors::oracle::loaded::{Difference, differences};
use contactbench_ground::pairs::sink::Digest;
use contactbench_ground::periodic::ImagePair;

#[derive(Clone, Debug, PartialEq)]
pub enum Wrong {
    Pairs(Differences),
    /// The detector refuses the scene after reporting this many pairs.
    RefusesLate(u64),
    Panics(String),
    Hangs(Duration),
    Dies {
        /// The cause of the runner's end and its last words, in one sentence. `errors` is the end
        /// of its standard error.
        how: String,
        errors: String,
    },
    Breaks(String),
    /// A function failed. The text describes how, for example `raises an error`.
    Fails(String),
    /// The digest is wrong, and the pairs are unknown, because the runner does not write them or
    /// there are too many.
    Counts {
        said: Digest,
        truth: Digest,
    },
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
            Wrong::Fails(what) => write!(f, "it {what}"),
            Wrong::Breaks(what) => write!(f, "it breaks the protocol: {what}"),
            Wrong::Counts { said, truth } => {
                let (said, truth) = (said.contacts, truth.contacts);
                match said == truth {
                    true => {
                        write!(f, "it finds the right number of pairs ({said}), but other pairs")?
                    }
                    false => write!(f, "it finds {said} pairs instead of {truth}")?,
                }
                f.write_str(", which are not known")
            }
        }
    }
}

impl std::error::Error for Wrong {}
