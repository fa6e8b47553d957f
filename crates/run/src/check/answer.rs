//! Questions to subjects of the check, and their answers.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use crate::check::{Differences, Wrong};
use crate::run::judge::outcome;
use contactbench_detectors::oracle;
use contactbench_detectors::oracle::boxes::Truth;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::limits::refusal::{Refusal, no_memory, panic_text};
use contactbench_ground::pairs::sink::{Digest, Sink};
use contactbench_ground::periodic::{ContactList, ImagePair, Loaded};
use contactbench_ground::probe::Tally;
use contactbench_io::Given;
use contactbench_lists::searcher::Searcher;

pub struct Question<'a> {
    pub given: &'a Given,
    /// The scene as the arithmetic stores it.
    pub stored: &'a Arc<Loaded<'static>>,
    pub arithmetic: Arithmetic,
    /// Whether the subject must be restarted, so that no earlier scene affects the answer.
    pub fresh: bool,
    pub truth: &'a Truth,
}

/// A running subject. It keeps what earlier scenes left in its buffers, unless a question is
/// `fresh`.
pub trait Respondent {
    fn ask(&mut self, question: &Question<'_>) -> anyhow::Result<Answer>;
}

pub enum Answer {
    Right,
    Pairs(Vec<ImagePair>),
    Refused(Refusal, u64),
    Declined(String),
    Wrong(Wrong),
}

impl Answer {
    pub(super) fn of(pairs: Vec<ImagePair>, truth: &Truth, arithmetic: Arithmetic) -> Answer {
        let of_itself = |pair: ImagePair| pair.i == pair.j && pair.image == [0; 3];
        let errors = oracle::compare_by(&pairs, &truth.pairs, of_itself, |_| 0.0);
        let good = outcome(&errors, arithmetic).is_good();
        if good { Answer::Right } else { Answer::Pairs(pairs) }
    }

    pub fn refusal(&self) -> Option<String> {
        match self {
            Answer::Refused(refusal, 0) => Some(refusal.to_string()),
            Answer::Declined(reason) => Some(reason.clone()),
            _ => None,
        }
    }

    pub fn wrong(self, truth: &Truth) -> Option<Wrong> {
        match self {
            Answer::Right => None,
            Answer::Pairs(pairs) => Some(Wrong::Pairs(Differences::new(pairs, &truth.pairs))),
            Answer::Refused(_, 0) | Answer::Declined(_) => None,
            Answer::Wrong(wrong) => Some(wrong),
            Answer::Refused(_, reported) => Some(Wrong::RefusesLate(reported)),
        }
    }
}

/// The first `most` reported pairs, so that a detector that reports without end does not fill the
/// memory.
struct Kept {
    pairs: Vec<[u32; 2]>,
    most: usize,
    reported: u64,
}

impl Sink for Kept {
    fn contact(&mut self, i: u32, j: u32) {
        self.reported += 1;
        if self.pairs.len() < self.most {
            if self.pairs.len() == self.pairs.capacity() && self.pairs.try_reserve(1).is_err() {
                self.most = self.pairs.len();
                return;
            }
            self.pairs.push([i, j]);
        }
    }
}

/// Runs a detector in the calling thread: first a form that counts, which is safe if pairs are
/// reported without end; if it is right, the timed form, which is compiled separately.
pub fn answer(
    searcher: &mut Searcher,
    scene: &Loaded<'_>,
    arithmetic: Arithmetic,
    expected: Expected,
) -> Answer {
    let mut contacts = ContactList::default();
    let mut reported = 0;
    let both = || {
        match scene {
            Loaded::Open(scene) => {
                let mut kept = Kept { pairs: Vec::new(), most: expected.most, reported: 0 };
                let visited = searcher.detector_mut().visit(scene, arithmetic.test(), &mut kept);
                (contacts.plain, reported) = (kept.pairs, kept.reported);
                visited?;
            }
            Loaded::InBox(_) => {
                let (frame, mut tally) = (scene.frame(arithmetic), Tally::default());
                let counted = searcher.find(frame, Some(&mut tally), &mut contacts);
                reported = searcher.found_in_box();
                counted?;
            }
        }
        if contacts.digest() == expected.digest {
            searcher.list(scene, arithmetic, &mut contacts)?;
        }
        Ok(())
    };
    match catch_unwind(AssertUnwindSafe(both)) {
        Ok(Ok(())) if contacts.digest() == expected.digest => Answer::Right,
        Ok(Ok(())) => match contacts.sorted(scene.particles(), searcher.memory_limit()) {
            Ok(pairs) => Answer::Pairs(pairs),
            Err(_) => {
                let (said, truth) = (contacts.digest(), expected.digest);
                Answer::Wrong(Wrong::Counts { said, truth })
            }
        },
        Ok(Err(refusal)) => Answer::Refused(refusal, reported),
        Err(cause) => {
            let refusal = no_memory(&*cause).map(|refusal| refusal.to_string());
            let why = refusal.unwrap_or_else(|| panic_text(&*cause).into());
            Answer::Wrong(Wrong::Panics(why))
        }
    }
}

#[derive(Clone, Copy, Default)]
pub struct Expected {
    digest: Digest,
    /// Number of pairs to store: enough to show that an answer is wrong, and how.
    most: usize,
}

impl From<&Truth> for Expected {
    fn from(truth: &Truth) -> Expected {
        Expected { digest: truth.digest, most: 2 * truth.pairs.len() + 1000 }
    }
}
