//! The judge: whether an answer is right, lossy or wrong, and why, is decided here and nowhere
//! else.

use std::collections::HashMap;
use std::rc::Rc;

use crate::contact::{Arithmetic, Test};
use crate::oracle::{self, Causes, Errors, NoTruth, Truth};
use crate::record::row::Outcome;
use crate::run::protocol;
use crate::scene::AnyScene;
use crate::sink::{Digest, normalise};

/// Judges the answers about one scene. What is true is found when it is first needed.
pub(crate) struct Judge<'a> {
    scene: &'a AnyScene<'a>,
    /// For a list of pairs, in bytes.
    memory_limit: u64,
    truths: HashMap<Arithmetic, Known>,
    /// Answers judged before, by who gave them: timed samples repeat the same answer.
    seen: HashMap<(Arithmetic, String, u64, u64), Judged>,
}

/// What is known of a scene in one arithmetic.
#[derive(Clone)]
enum Known {
    Truths(Truths),
    /// Nothing, for this reason; whether nobody can answer, since the pairs of the scene are too
    /// many.
    Nothing {
        reason: String,
        hopeless: bool,
    },
}

/// What is true in one arithmetic. Arithmetics that store the scene alike share.
#[derive(Clone)]
struct Truths {
    stored: Rc<AnyScene<'static>>,
    /// By the arithmetic's own contact test.
    rounded: Rc<Truth>,
    /// By exact decisions on the scene as stored.
    exact: Rc<Truth>,
}

/// The judgement on an answer.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Judged {
    /// `ok`, `lossy` or `wrong`; `refused` where no truth is known.
    pub outcome: Outcome,
    /// Why it is not `ok`.
    pub reason: String,
    /// Against exact decisions on the scene as given. `None` where the pairs are not known.
    pub errors: Option<Errors>,
    /// The same by cause.
    pub causes: Option<Causes>,
}

impl Judged {
    fn without_pairs(outcome: Outcome, reason: String) -> Judged {
        Judged { outcome, reason, errors: None, causes: None }
    }
}

/// What pairs are worth against the truth in an arithmetic: `ok`; `lossy`, if contacts are missing
/// and nothing else is wrong, where the arithmetic allows it; or `wrong`. The pairs are in order.
pub(crate) fn verdict(
    pairs: &[[u32; 2]],
    truth: &Truth,
    stored: &AnyScene<'_>,
    arithmetic: Arithmetic,
) -> (Outcome, Errors) {
    let errors = compare(pairs, truth, stored);
    let outcome = if errors.wrong() == 0 {
        Outcome::Ok
    } else if errors.wrong() == errors.missed && !arithmetic.is_safe() {
        Outcome::Lossy
    } else {
        Outcome::Wrong
    };
    (outcome, errors)
}

impl<'a> Judge<'a> {
    /// A judge who knows nothing yet. A list of pairs may take so many bytes.
    pub fn new(scene: &'a AnyScene<'a>, memory_limit: u64) -> Judge<'a> {
        Judge { scene, memory_limit, truths: HashMap::new(), seen: HashMap::new() }
    }

    /// Judges the answer of a contender in its arithmetic: the number and the digest of its pairs.
    /// `fetch` asks for the pairs; it is not called for an answer that is right or was judged
    /// before.
    pub fn judge(
        &mut self,
        contender: &str,
        arithmetic: Arithmetic,
        (contacts, digest): (u64, &str),
        fetch: impl FnOnce() -> Result<Vec<[u32; 2]>, String>,
    ) -> anyhow::Result<Judged> {
        let truths = match self.known(arithmetic)? {
            Known::Truths(truths) => truths.clone(),
            Known::Nothing { reason, .. } => {
                let reason = format!("the answer cannot be checked: {reason}");
                return Ok(Judged::without_pairs(Outcome::Refused, reason));
            }
        };
        let said = match protocol::digest(contacts, digest) {
            Ok(said) => said,
            Err(reason) => return Ok(Judged::without_pairs(Outcome::Wrong, reason)),
        };
        let key = (arithmetic, contender.to_string(), said.contacts, said.sum);
        if let Some(judged) = self.seen.get(&key) {
            return Ok(judged.clone());
        }
        let fetched;
        let pairs = if said == truths.rounded.digest {
            &truths.rounded.pairs
        } else {
            let answer = fetch().and_then(|pairs| {
                let same = Digest::from_pairs(&pairs) == said;
                if same { Ok(pairs) } else { Err("asked for them, it gave others".into()) }
            });
            fetched = match answer {
                Ok(mut pairs) => {
                    normalise(&mut pairs);
                    pairs
                }
                Err(why) => {
                    let reason =
                        format!("the pairs differ from the truth, and could not be read: {why}");
                    return Ok(Judged::without_pairs(Outcome::Wrong, reason));
                }
            };
            &fetched
        };
        let (outcome, own) = verdict(pairs, &truths.rounded, &truths.stored, arithmetic);
        let reason = if outcome == Outcome::Ok {
            String::new()
        } else {
            format!("against the true pairs in {}: {own}", arithmetic.name())
        };
        let mut judged = Judged::without_pairs(outcome, reason);
        let scene = self.scene;
        if let Known::Truths(given) = self.known(Arithmetic::Exact)? {
            judged.errors = Some(compare(pairs, &given.exact, scene));
            judged.causes = Some(Causes {
                representation: compare(&truths.exact.pairs, &given.exact, scene),
                predicate: compare(&truths.rounded.pairs, &truths.exact, &truths.stored),
                search: own,
                stored: compare(pairs, &truths.exact, &truths.stored),
            });
        }
        self.seen.insert(key, judged.clone());
        Ok(judged)
    }

    /// What the arithmetic's own contact test gives for all pairs. `None` where no truth is known.
    pub fn truth(&mut self, arithmetic: Arithmetic) -> anyhow::Result<Option<&Truth>> {
        Ok(match self.known(arithmetic)? {
            Known::Truths(truths) => Some(&truths.rounded),
            Known::Nothing { .. } => None,
        })
    }

    /// Why nobody can answer, if the scene has too many pairs.
    pub fn hopeless(&mut self, arithmetic: Arithmetic) -> anyhow::Result<Option<&str>> {
        Ok(match self.known(arithmetic)? {
            Known::Nothing { reason, hopeless: true } => Some(reason),
            _ => None,
        })
    }

    /// Why no truth is known in `arithmetic`; empty where one is, or nobody has asked for it.
    pub fn why_none(&self, arithmetic: Arithmetic) -> &str {
        match self.truths.get(&arithmetic) {
            Some(Known::Nothing { reason, .. }) => reason,
            _ => "",
        }
    }

    fn known(&mut self, arithmetic: Arithmetic) -> anyhow::Result<&Known> {
        if !self.truths.contains_key(&arithmetic) {
            let known = match arithmetic {
                Arithmetic::Textbook => self.known(Arithmetic::F64)?.clone(),
                Arithmetic::F64 => match self.known(Arithmetic::Exact)?.clone() {
                    Known::Truths(exact) => {
                        let found = self.truth_of(&exact.stored, Test::Rounded);
                        Known::new(found.map(|rounded| Truths { rounded, ..exact }))?
                    }
                    nothing => nothing,
                },
                _ => Known::new(self.find(arithmetic))?,
            };
            self.truths.insert(arithmetic, known);
        }
        Ok(&self.truths[&arithmetic])
    }

    fn find(&self, arithmetic: Arithmetic) -> Result<Truths, NoTruth> {
        let stored = Rc::new(self.scene.stored(arithmetic)?);
        let exact = self.truth_of(&stored, Test::Exact)?;
        let rounded = match arithmetic.test() {
            Test::Exact => exact.clone(),
            test => match self.truth_of(&stored, test)? {
                same if same.digest == exact.digest => exact.clone(),
                rounded => rounded,
            },
        };
        Ok(Truths { stored, rounded, exact })
    }

    /// What is true in a test. Lists that are the same are kept once.
    fn truth_of(&self, stored: &AnyScene<'_>, test: Test) -> Result<Rc<Truth>, NoTruth> {
        let found = oracle::truth_as_stored(stored, test, self.memory_limit)?;
        let known = self.truths.values().filter_map(|known| match known {
            Known::Truths(truths) => Some([&truths.exact, &truths.rounded]),
            Known::Nothing { .. } => None,
        });
        let same = known.flatten().find(|known| known.digest == found.digest).cloned();
        Ok(same.unwrap_or_else(|| Rc::new(found)))
    }
}

impl Known {
    /// A defect of this program is an error.
    fn new(found: Result<Truths, NoTruth>) -> anyhow::Result<Known> {
        match found {
            Ok(truths) => Ok(Known::Truths(truths)),
            Err(reason @ (NoTruth::Refused(_) | NoTruth::Stored(_) | NoTruth::TooLarge { .. })) => {
                let hopeless =
                    matches!(&reason, NoTruth::Refused(refusal) if refusal.is_of_scene());
                Ok(Known::Nothing { reason: reason.to_string(), hopeless })
            }
            Err(defect) => Err(defect.into()),
        }
    }
}

/// Most answers are right: their pairs need not be sorted.
fn compare(reported: &[[u32; 2]], truth: &Truth, scene: &AnyScene<'_>) -> Errors {
    if Digest::from_pairs(reported) == truth.digest {
        Errors::default()
    } else {
        oracle::compare(reported, &truth.pairs, scene)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Radii, Scene};

    /// Four unit discs in a row, of which neighbours touch.
    fn row() -> AnyScene<'static> {
        let centres = [0.0, 2.0, 4.0, 6.0].map(|x| nalgebra::Point::from([x, 0.0]));
        Scene::<f64, 2>::new(centres.to_vec(), Radii::Uniform(1.0)).unwrap().into()
    }

    const RIGHT: [[u32; 2]; 3] = [[0, 1], [1, 2], [2, 3]];

    fn judged(arithmetic: Arithmetic, said: &[[u32; 2]], shown: Option<&[[u32; 2]]>) -> Judged {
        let scene = row();
        let digest = Digest::from_pairs(said);
        let fetch = || shown.map(<[_]>::to_vec).ok_or_else(|| "it has gone".into());
        let answer = (digest.contacts, &*digest.hex());
        Judge::new(&scene, 1 << 20).judge("one", arithmetic, answer, fetch).unwrap()
    }

    #[test]
    fn answers_are_right_lossy_or_wrong() {
        use Outcome::{Lossy, Ok, Wrong};
        let turned = [[2, 1], [3, 2], [1, 0]];
        let (fewer, more) = (&RIGHT[..2], [[0, 1], [1, 2], [2, 3], [0, 3]]);
        let twice = [[0, 1], [1, 2], [1, 2]];
        for (arithmetic, said, outcome) in [
            (Arithmetic::Exact, &turned[..], Ok),
            (Arithmetic::Exact, fewer, Wrong),
            (Arithmetic::Textbook, fewer, Lossy),
            (Arithmetic::Textbook, &more, Wrong),
            (Arithmetic::Textbook, &twice, Wrong),
        ] {
            let judged = judged(arithmetic, said, Some(said));
            assert_eq!(judged.outcome, outcome, "{arithmetic:?} {said:?}: {}", judged.reason);
            assert_eq!(judged.reason.is_empty(), outcome == Ok, "{}", judged.reason);
            let wrong = |errors: Option<Errors>| errors.unwrap().wrong() > 0;
            assert_eq!(wrong(judged.errors), outcome != Ok);
            assert_eq!(wrong(judged.causes.map(|causes| causes.search)), outcome != Ok);
        }
    }

    #[test]
    fn pairs_that_cannot_be_seen_are_wrong_with_the_reason() {
        for (shown, words) in [(None, "it has gone"), (Some(&RIGHT[..1]), "it gave others")] {
            let judged = judged(Arithmetic::Textbook, &RIGHT[..2], shown);
            assert_eq!((judged.outcome, judged.errors), (Outcome::Wrong, None));
            assert!(judged.reason.contains(words), "{}", judged.reason);
        }
        // Nobody asks for the pairs of a right answer.
        assert_eq!(judged(Arithmetic::F32, &RIGHT, None).outcome, Outcome::Ok);
    }

    #[test]
    fn a_digest_that_is_none_is_wrong() {
        let scene = row();
        let upper = Digest::from_pairs(&RIGHT).hex().to_uppercase();
        let judged = Judge::new(&scene, 1 << 20)
            .judge("one", Arithmetic::Exact, (3, &upper), || Ok(RIGHT.to_vec()))
            .unwrap();
        assert_eq!(judged.outcome, Outcome::Wrong);
        assert!(judged.reason.contains("16 lower-case hexadecimal digits"), "{}", judged.reason);
    }
}
