//! The judge of a scene at rest, or of one frame, with boundaries of either kind.

use std::rc::Rc;

use crate::contact::Arithmetic;
use crate::periodic::{self, Contacts, Periodic};
use crate::run::judge::in_box::InBox;
use crate::run::judge::open::{Open, Truths};
use crate::run::judge::{Judged, Nothing};
use crate::scene::Given;
use crate::sink::Digest;

/// What is true of a scene.
pub(super) enum AtRest<'a> {
    Open(Open<'a>),
    InBox(InBox),
}

/// What is true of it in one arithmetic, by its own contact test.
pub(super) enum Known {
    Open(Truths),
    InBox(Rc<Periodic<'static>>, Rc<periodic::Truth>),
}

impl<'a> AtRest<'a> {
    /// A list of contacts may take so many bytes.
    ///
    /// # Errors
    /// A box that does not suit the scene.
    pub fn new(given: &'a Given, memory_limit: u64) -> anyhow::Result<AtRest<'a>> {
        Ok(match given.periodic()? {
            None => AtRest::Open(Open::new(&given.scene, memory_limit)),
            Some(periodic) => AtRest::InBox(InBox::new(periodic, memory_limit)),
        })
    }

    pub fn known(&mut self, arithmetic: Arithmetic) -> anyhow::Result<Result<Known, Nothing>> {
        match self {
            AtRest::Open(open) => Ok(open.known(arithmetic)?.map(Known::Open)),
            AtRest::InBox(boxed) => {
                let known = boxed.known(arithmetic)?;
                Ok(known.map(|truth| Known::InBox(boxed.periodic.clone(), truth)))
            }
        }
    }

    pub fn judge(
        &mut self,
        arithmetic: Arithmetic,
        said: Digest,
        fetch: impl FnOnce() -> Result<Contacts, String>,
    ) -> anyhow::Result<Result<Judged, Nothing>> {
        match self {
            AtRest::Open(open) => open.judge(arithmetic, said, fetch),
            AtRest::InBox(boxed) => boxed.judge(arithmetic, said, fetch),
        }
    }
}

impl Known {
    /// The fingerprint of the right answer.
    pub fn digest(&self) -> Digest {
        match self {
            Known::Open(truths) => truths.rounded.digest,
            Known::InBox(_, truth) => truth.digest,
        }
    }
}
