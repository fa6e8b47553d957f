//! One frame: its true contacts, and how an answer differs from them.

use std::borrow::Cow;
use std::collections::HashMap;
use std::rc::Rc;

use crate::run::judge::{Nothing, kept, nothing};
use contactbench_detectors::oracle::loaded::depth;
use contactbench_detectors::oracle::{self, Causes, Errors, NoTruth, boxes, compare_by};
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::periodic::{ContactList, ImagePair, Loaded};
use contactbench_io::Given;

pub(super) struct JudgedFrame<'a> {
    pub given: Cow<'a, Given>,
    boxed: Option<Rc<Loaded<'static>>>,
    memory_limit: u64,
    known: HashMap<Arithmetic, Result<Truths, Nothing>>,
}

/// The truth in one arithmetic. Arithmetics that store the scene in the same way share the scene.
#[derive(Clone)]
pub(super) struct Truths {
    /// The scene as the arithmetic stores it; in a box, the given scene.
    pub stored: Rc<Loaded<'static>>,
    pub own: Rc<ContactList>,
    /// Contacts by exact decisions on the stored particles and images. `None` if they cannot be
    /// found, which only happens in a box.
    exact: Option<Rc<ContactList>>,
}

#[derive(Clone, Default)]
pub(super) struct Differs {
    pub own: Errors,
    /// Errors compared with exact decisions on the given scene; `None` if the truth is unknown.
    pub errors: Option<Errors>,
    pub causes: Option<Causes>,
}

impl Differs {
    pub fn add(&mut self, other: &Differs) {
        self.own.add(&other.own);
        match (&mut self.errors, &other.errors) {
            (Some(all), Some(of)) => all.add(of),
            (all, _) => *all = None,
        }
        match (&mut self.causes, &other.causes) {
            (Some(all), Some(of)) => all.add(of),
            (all, _) => *all = None,
        }
    }
}

impl<'a> JudgedFrame<'a> {
    /// A list of contacts may use `memory_limit` bytes. Fails if the box does not fit `given`.
    pub fn new(given: Cow<'a, Given>, memory_limit: u64) -> anyhow::Result<JudgedFrame<'a>> {
        let boxed = given.periodic()?.map(|periodic| Rc::new(Loaded::InBox(periodic)));
        Ok(JudgedFrame { given, boxed, memory_limit, known: HashMap::new() })
    }

    /// Compares the sorted contacts of an answer with the truth. `None` stands for an answer that
    /// is right.
    pub fn compare(
        &mut self,
        arithmetic: Arithmetic,
        contacts: Option<&ContactList>,
    ) -> anyhow::Result<Differs> {
        let truths = self.known(arithmetic)?;
        let contacts = contacts.unwrap_or(&truths.own);
        let own = compare(contacts, &truths.own, &truths.stored);
        let given = match self.known(arithmetic.exact()) {
            Ok(given) => given,
            Err(error) => {
                nothing(error)?;
                return Ok(Differs { own, ..Differs::default() });
            }
        };
        let causes = truths.exact.map(|exact| Causes {
            representation: compare(&exact, &given.own, &given.stored),
            predicate: compare(&truths.own, &exact, &truths.stored),
            search: own,
            stored: compare(contacts, &exact, &truths.stored),
        });
        Ok(Differs { own, errors: Some(compare(contacts, &given.own, &given.stored)), causes })
    }

    pub fn known(&mut self, arithmetic: Arithmetic) -> anyhow::Result<Truths> {
        if let Some(known) = self.known.get(&arithmetic) {
            return Ok(known.clone()?);
        }
        let found = self.find(arithmetic);
        kept(&mut self.known, arithmetic, found)
    }

    fn find(&mut self, arithmetic: Arithmetic) -> anyhow::Result<Truths> {
        let stored = match (&self.boxed, arithmetic) {
            (Some(boxed), _) => boxed.clone(),
            (None, Arithmetic::Textbook) => return self.known(Arithmetic::F64),
            // f64 stores the scene as it is given, like exact arithmetic.
            (None, Arithmetic::F64) => self.known(Arithmetic::Exact)?.stored,
            (None, _) => {
                let stored = self.given.scene.stored(arithmetic).map_err(NoTruth::from)?;
                Rc::new(Loaded::Open(stored))
            }
        };
        let limit = self.memory_limit;
        let (own, exact) = match &*stored {
            Loaded::Open(scene) => {
                let truth = |test| {
                    let plain = oracle::truth_as_stored(scene, test, limit)?.pairs;
                    Ok::<_, NoTruth>(ContactList { plain, ..ContactList::default() })
                };
                let exact = match arithmetic {
                    Arithmetic::F64 => self.known(Arithmetic::Exact)?.own,
                    _ => self.share(truth(arithmetic.exact().test())?),
                };
                let own = match arithmetic.test() {
                    test if test.is_exact() => exact.clone(),
                    test => match truth(test)? {
                        same if same.digest() == exact.digest() => exact.clone(),
                        own => self.share(own),
                    },
                };
                (own, Some(exact))
            }
            Loaded::InBox(periodic) => {
                let own = boxes::truth(periodic, arithmetic, limit)?.pairs.into_iter().collect();
                let own = self.share(own);
                let exact = match arithmetic {
                    // Exact arithmetic does not round images, so the contacts are the same.
                    _ if arithmetic.is_exact() => Some(own.clone()),
                    _ => match boxes::truth_as_stored(periodic, arithmetic, limit) {
                        Ok(exact) => Some(self.share(exact.pairs.into_iter().collect())),
                        Err(reason) => {
                            nothing(reason.into())?;
                            None
                        }
                    },
                };
                (own, exact)
            }
        };
        Ok(Truths { stored, own, exact })
    }

    fn share(&self, found: ContactList) -> Rc<ContactList> {
        let (digest, known) = (found.digest(), self.known.values().flatten());
        let mut known = known.flat_map(|truths| truths.exact.iter().chain([&truths.own]));
        let same = known.find(|known| known.digest() == digest).cloned();
        same.unwrap_or_else(|| Rc::new(found))
    }
}

/// Finds the errors of an answer. Most answers have the right digest, and need no comparison.
fn compare(reported: &ContactList, truth: &ContactList, scene: &Loaded<'_>) -> Errors {
    if std::ptr::eq(reported, truth) || reported.digest() == truth.digest() {
        return Errors::default();
    }
    let ContactList { plain, shifted } = truth;
    let unshifted = |[i, j]: [u32; 2]| depth(scene, ImagePair::new(i, j, [0; 3]));
    let mut errors = compare_by(&reported.plain, plain, |[i, j]| i == j, unshifted);
    errors.add(&compare_by(&reported.shifted, shifted, |_| false, |pair| depth(scene, pair)));
    errors
}
