//! The truths that the rows of one scene are held to.

use std::collections::BTreeMap;

use super::record::Errors;
use crate::contact::Arithmetic;
use crate::oracle::{self, NoTruth, Truth};
use crate::scene::AnyScene;

/// The truths about a scene, found when first asked for.
pub(super) struct Truths<'a> {
    scene: &'a AnyScene<'a>,
    known: BTreeMap<Arithmetic, Option<Truth>>,
    errors: BTreeMap<Arithmetic, Option<Errors>>,
}

impl<'a> Truths<'a> {
    /// None known yet.
    pub fn new(scene: &'a AnyScene<'a>) -> Truths<'a> {
        Truths { scene, known: BTreeMap::new(), errors: BTreeMap::new() }
    }

    /// `None` where the arithmetic cannot hold the scene, or nothing can be said of it.
    pub fn get(&mut self, arithmetic: Arithmetic) -> anyhow::Result<Option<&Truth>> {
        if !self.known.contains_key(&arithmetic) {
            let truth = match oracle::truth(self.scene, arithmetic) {
                Ok(truth) => Some(truth),
                Err(NoTruth::Refused(_) | NoTruth::Stored(_) | NoTruth::TooLarge { .. }) => None,
                Err(defect) => return Err(defect.into()),
            };
            self.known.insert(arithmetic, truth);
        }
        Ok(self.known[&arithmetic].as_ref())
    }

    /// What deciding in `arithmetic` itself misses and adds, against exact decisions on the scene as given.
    pub fn errors(&mut self, arithmetic: Arithmetic) -> anyhow::Result<Option<Errors>> {
        if let Some(errors) = self.errors.get(&arithmetic) {
            return Ok(*errors);
        }
        self.get(arithmetic)?;
        self.get(Arithmetic::Exact)?;
        let (Some(Some(rounded)), Some(Some(exact))) = (self.known.get(&arithmetic), self.known.get(&Arithmetic::Exact)) else {
            return Ok(None);
        };
        let errors = if rounded.digest == exact.digest { Default::default() } else { oracle::compare(&rounded.pairs, &exact.pairs) };
        self.errors.insert(arithmetic, Some(errors));
        Ok(Some(errors))
    }
}
