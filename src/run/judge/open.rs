//! The judge of open scenes.

use std::collections::HashMap;
use std::rc::Rc;

use crate::contact::{Arithmetic, Test};
use crate::oracle::{self, Causes, Errors, NoTruth, Truth};
use crate::periodic::Contacts;
use crate::run::judge::{Judged, Nothing};
use crate::scene::AnyScene;
use crate::sink::{Digest, normalise};

/// What is true of an open scene.
pub(super) struct Open<'a> {
    scene: &'a AnyScene<'a>,
    /// For a list of pairs, in bytes.
    memory_limit: u64,
    known: HashMap<Arithmetic, Result<Truths, Nothing>>,
}

/// What is true in one arithmetic. Arithmetics that store the scene alike share.
#[derive(Clone)]
pub(super) struct Truths {
    pub stored: Rc<AnyScene<'static>>,
    /// By the arithmetic's own contact test.
    pub rounded: Rc<Truth>,
    /// By exact decisions on the scene as stored.
    exact: Rc<Truth>,
}

impl<'a> Open<'a> {
    pub fn new(scene: &'a AnyScene<'a>, memory_limit: u64) -> Open<'a> {
        Open { scene, memory_limit, known: HashMap::new() }
    }

    pub fn judge(
        &mut self,
        arithmetic: Arithmetic,
        said: Digest,
        fetch: impl FnOnce() -> Result<Contacts, String>,
    ) -> anyhow::Result<Result<Judged, Nothing>> {
        let truths = match self.known(arithmetic)? {
            Ok(truths) => truths,
            Err(nothing) => return Ok(Err(nothing)),
        };
        let fetched;
        let pairs = if said == truths.rounded.digest {
            &truths.rounded.pairs
        } else {
            fetched = match fetch() {
                Ok(Contacts { mut plain, .. }) => {
                    normalise(&mut plain);
                    plain
                }
                Err(why) => return Ok(Ok(Judged::unseen(&why))),
            };
            &fetched
        };
        let own = compare(pairs, &truths.rounded, &truths.stored);
        let mut judged = Judged::by(&own, arithmetic);
        if let Ok(given) = self.known(Arithmetic::Exact)? {
            let scene = self.scene;
            judged.errors = Some(compare(pairs, &given.exact, scene));
            judged.causes = Some(Causes {
                representation: compare(&truths.exact.pairs, &given.exact, scene),
                predicate: compare(&truths.rounded.pairs, &truths.exact, &truths.stored),
                search: own,
                stored: compare(pairs, &truths.exact, &truths.stored),
            });
        }
        Ok(Ok(judged))
    }

    /// What is true in an arithmetic.
    pub fn known(&mut self, arithmetic: Arithmetic) -> anyhow::Result<Result<Truths, Nothing>> {
        if let Some(known) = self.known.get(&arithmetic) {
            return Ok(known.clone());
        }
        let found = match arithmetic {
            Arithmetic::Textbook => self.known(Arithmetic::F64)?,
            Arithmetic::F64 => match self.known(Arithmetic::Exact)? {
                Ok(exact) => {
                    let found = self.truth_of(&exact.stored, Test::Rounded);
                    or_nothing(found.map(|rounded| Truths { rounded, ..exact }))?
                }
                nothing => nothing,
            },
            _ => or_nothing(self.find(arithmetic))?,
        };
        self.known.insert(arithmetic, found.clone());
        Ok(found)
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
        let known = self.known.values().flatten();
        let mut known = known.flat_map(|truths| [&truths.exact, &truths.rounded]);
        let same = known.find(|known| known.digest == found.digest).cloned();
        Ok(same.unwrap_or_else(|| Rc::new(found)))
    }
}

/// A defect of this program is an error.
pub(super) fn or_nothing<T>(found: Result<T, NoTruth>) -> anyhow::Result<Result<T, Nothing>> {
    found.map_or_else(|reason| Ok(Err(Nothing::new(reason)?)), |found| Ok(Ok(found)))
}

/// Most answers are right: their pairs need not be sorted.
fn compare(reported: &[[u32; 2]], truth: &Truth, scene: &AnyScene<'_>) -> Errors {
    if Digest::from_pairs(reported) == truth.digest {
        Errors::default()
    } else {
        oracle::compare(reported, &truth.pairs, scene)
    }
}
