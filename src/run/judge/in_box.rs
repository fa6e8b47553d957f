//! The judge of scenes in boxes: contacts are of particles and images, and what rounded arithmetics
//! decide depends on how images are made.

use std::collections::HashMap;
use std::rc::Rc;

use crate::contact::Arithmetic;
use crate::oracle::{Causes, Errors, compare_by};
use crate::periodic::{self, Contacts, ImagePair, Periodic, Truth, depth};
use crate::run::judge::open::or_nothing;
use crate::run::judge::{Judged, Nothing};
use crate::sink::Digest;

/// What is true of a scene in its box.
pub(super) struct InBox {
    pub periodic: Rc<Periodic<'static>>,
    /// For a list of contacts, in bytes.
    memory_limit: u64,
    known: HashMap<(Arithmetic, Decided), Result<Rc<Truth>, Nothing>>,
}

/// Who decides what is true in an arithmetic.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Decided {
    /// Its own contact test.
    ByItself,
    /// Exact decisions, on particles and images as it stores them.
    AsStored,
}

impl InBox {
    pub fn new(periodic: Periodic<'static>, memory_limit: u64) -> InBox {
        InBox { periodic: Rc::new(periodic), memory_limit, known: HashMap::new() }
    }

    pub fn judge(
        &mut self,
        arithmetic: Arithmetic,
        said: Digest,
        fetch: impl FnOnce() -> Result<Contacts, String>,
    ) -> anyhow::Result<Result<Judged, Nothing>> {
        let truth = match self.known(arithmetic)? {
            Ok(truth) => truth,
            Err(nothing) => return Ok(Err(nothing)),
        };
        let fetched;
        let pairs = if said == truth.digest {
            &truth.pairs
        } else {
            let particles = self.periodic.scene().len();
            let sorted = |contacts: Contacts| {
                let sorted = contacts.sorted(particles, self.memory_limit);
                sorted.map_err(|refusal| refusal.to_string())
            };
            fetched = match fetch().and_then(sorted) {
                Ok(pairs) => pairs,
                Err(why) => return Ok(Ok(Judged::unseen(&why))),
            };
            &fetched
        };
        let own = self.compare(pairs, &truth);
        let mut judged = Judged::by(&own, arithmetic);
        if let Ok(exact) = self.known(Arithmetic::Exact)? {
            judged.errors = Some(self.compare(pairs, &exact));
            if let Ok(stored) = self.stored(arithmetic)? {
                judged.causes = Some(Causes {
                    representation: self.compare(&stored.pairs, &exact),
                    predicate: self.compare(&truth.pairs, &stored),
                    search: own,
                    stored: self.compare(pairs, &stored),
                });
            }
        }
        Ok(Ok(judged))
    }

    /// What the arithmetic's own contact test gives.
    pub fn known(&mut self, arithmetic: Arithmetic) -> anyhow::Result<Result<Rc<Truth>, Nothing>> {
        self.decided(arithmetic, Decided::ByItself)
    }

    fn stored(&mut self, arithmetic: Arithmetic) -> anyhow::Result<Result<Rc<Truth>, Nothing>> {
        match arithmetic {
            // It stores no images.
            Arithmetic::Exact => self.known(arithmetic),
            _ => self.decided(arithmetic, Decided::AsStored),
        }
    }

    fn decided(
        &mut self,
        arithmetic: Arithmetic,
        decided: Decided,
    ) -> anyhow::Result<Result<Rc<Truth>, Nothing>> {
        if let Some(known) = self.known.get(&(arithmetic, decided)) {
            return Ok(known.clone());
        }
        let truth = match decided {
            Decided::ByItself => periodic::truth,
            Decided::AsStored => periodic::truth_as_stored,
        };
        let found = truth(&self.periodic, arithmetic, self.memory_limit);
        let found = or_nothing(found.map(Rc::new))?;
        self.known.insert((arithmetic, decided), found.clone());
        Ok(found)
    }

    fn compare(&self, pairs: &[ImagePair], truth: &Truth) -> Errors {
        let is_self = |pair: ImagePair| pair.i == pair.j && pair.image == [0; 3];
        compare_by(pairs, &truth.pairs, is_self, |pair| depth(&self.periodic, pair))
    }
}
