//! The truths that the rows of one scene are held to, and the errors of the answers.

use std::collections::HashMap;
use std::rc::Rc;

use super::record::{Causes, Errors};
use crate::contact::{Arithmetic, Test};
use crate::oracle::{self, NoTruth, Truth};
use crate::scene::AnyScene;
use crate::sink::Digest;

/// The truths about a scene, found when first asked for.
pub(crate) struct Truths<'a> {
    scene: &'a AnyScene<'a>,
    /// Or why nothing is.
    known: HashMap<Arithmetic, Result<Known, String>>,
    /// The errors of answers seen before, by who gave them: timed samples repeat the same answer.
    seen: HashMap<(Arithmetic, String, u64, u64), (Errors, Causes)>,
}

/// What is true in one arithmetic. Arithmetics that store the scene alike share.
#[derive(Clone)]
struct Known {
    stored: Rc<AnyScene<'static>>,
    /// By the arithmetic's own contact test.
    rounded: Rc<Truth>,
    /// By exact decisions on the scene as stored.
    exact: Rc<Truth>,
}

impl<'a> Truths<'a> {
    /// None known yet.
    pub fn new(scene: &'a AnyScene<'a>) -> Truths<'a> {
        Truths { scene, known: HashMap::new(), seen: HashMap::new() }
    }

    /// What the arithmetic's own contact test gives for all pairs. `None` where the arithmetic cannot hold the scene, or nothing can be
    /// said of it.
    pub fn get(&mut self, arithmetic: Arithmetic) -> anyhow::Result<Option<&Truth>> {
        Ok(self.known(arithmetic)?.map(|known| &*known.rounded))
    }

    fn known(&mut self, arithmetic: Arithmetic) -> anyhow::Result<Option<&Known>> {
        if !self.known.contains_key(&arithmetic) {
            let known = match arithmetic {
                Arithmetic::Textbook => self.alike(Arithmetic::F64)?,
                Arithmetic::F64 => match self.alike(Arithmetic::Exact)? {
                    Ok(exact) => known(oracle::truth_as_stored(&exact.stored, Test::Rounded))?
                        .map(|rounded| Known { rounded: Rc::new(rounded), ..exact }),
                    reason => reason,
                },
                _ => known(self.find(arithmetic))?,
            };
            self.known.insert(arithmetic, known);
        }
        Ok(self.known[&arithmetic].as_ref().ok())
    }

    /// Why there is no truth in `arithmetic`; empty where there is one, or nobody has asked for it.
    pub fn why_none(&self, arithmetic: Arithmetic) -> &str {
        self.known.get(&arithmetic).and_then(|known| known.as_ref().err()).map_or("", |reason| reason)
    }

    fn alike(&mut self, arithmetic: Arithmetic) -> anyhow::Result<Result<Known, String>> {
        self.known(arithmetic)?;
        Ok(self.known[&arithmetic].clone())
    }

    fn find(&self, arithmetic: Arithmetic) -> Result<Known, NoTruth> {
        let stored = Rc::new(self.scene.stored(arithmetic)?);
        let exact = Rc::new(oracle::truth_as_stored(&stored, Test::Exact)?);
        let rounded = match arithmetic.test() {
            Test::Exact => exact.clone(),
            test => Rc::new(oracle::truth_as_stored(&stored, test)?),
        };
        Ok(Known { stored, rounded, exact })
    }

    /// The errors of a detector's answer in `arithmetic`, all together and by cause. `pairs` fetches it; it is not called for an answer that is
    /// right in its arithmetic, or has been seen before. `None` where there is no truth.
    pub fn errors(
        &mut self,
        arithmetic: Arithmetic,
        detector: &str,
        answer: Digest,
        pairs: impl FnOnce() -> Result<Vec<[u32; 2]>, String>,
    ) -> anyhow::Result<Result<Option<(Errors, Causes)>, String>> {
        let key = (arithmetic, detector.to_string(), answer.contacts, answer.sum);
        if let Some(errors) = self.seen.get(&key) {
            return Ok(Ok(Some(*errors)));
        }
        let (known, given) = (self.known(arithmetic)?.cloned(), self.known(Arithmetic::Exact)?.cloned());
        let (Some(known), Some(given)) = (known, given) else { return Ok(Ok(None)) };
        let fetched;
        let answered = if answer == known.rounded.digest {
            &known.rounded.pairs
        } else {
            fetched = match pairs() {
                Ok(pairs) if Digest::of(&pairs) == answer => pairs,
                Ok(_) => return Ok(Err("asked for them, it gave others".into())),
                Err(error) => return Ok(Err(error)),
            };
            &fetched
        };
        let errors = compare(answered, &given.exact, self.scene);
        let causes = Causes {
            input: compare(&known.exact.pairs, &given.exact, self.scene),
            arithmetic: compare(&known.rounded.pairs, &known.exact, &known.stored),
            algorithm: compare(answered, &known.rounded, &known.stored),
            stored: compare(answered, &known.exact, &known.stored),
        };
        self.seen.insert(key, (errors, causes));
        Ok(Ok(Some((errors, causes))))
    }
}

/// What is known, or why nothing can be said; a defect is an error.
fn known<T>(found: Result<T, NoTruth>) -> anyhow::Result<Result<T, String>> {
    match found {
        Ok(known) => Ok(Ok(known)),
        Err(reason @ (NoTruth::Refused(_) | NoTruth::Stored(_) | NoTruth::TooLarge { .. })) => Ok(Err(reason.to_string())),
        Err(defect) => Err(defect.into()),
    }
}

/// Most answers are right: their pairs need not be sorted.
fn compare(reported: &[[u32; 2]], truth: &Truth, scene: &AnyScene<'_>) -> Errors {
    if Digest::of(reported) == truth.digest { Errors::default() } else { oracle::compare(reported, &truth.pairs, scene) }
}
