//! Scenes in open space or in periodic boxes, prepared for an arithmetic.

use super::{Periodic, PeriodicError};
use crate::contact::{Arithmetic, Test};
use crate::limits::crowd;
use crate::limits::refusal::Refusal;
use crate::scene::{AnyScene, Lattice, SceneError};

/// A scene that is prepared for an arithmetic.
#[derive(Debug)]
pub enum Loaded<'a> {
    /// A scene in open space, stored as the arithmetic requires.
    Open(AnyScene<'a>),
    /// A scene in a periodic box, stored as given.
    InBox(Periodic<'a>),
}

/// Why a scene cannot be prepared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LoadError {
    /// The arithmetic cannot store the scene.
    #[error(transparent)]
    Stored(#[from] SceneError),
    /// The box does not fit the scene.
    #[error(transparent)]
    Boxed(#[from] PeriodicError),
}

/// A scene that can be searched, with the contact test or arithmetic that decides its contacts.
#[derive(Clone, Copy)]
pub enum Searchable<'a> {
    /// A scene in open space, with a contact test.
    Open(&'a AnyScene<'a>, Test),
    /// A scene in a periodic box, with an arithmetic.
    Boxed(&'a Periodic<'a>, Arithmetic),
}

impl<'a> Searchable<'a> {
    pub fn scene(&self) -> &'a AnyScene<'a> {
        match self {
            Searchable::Open(scene, _) => scene,
            Searchable::Boxed(periodic, _) => periodic.scene(),
        }
    }
}

impl<'a> Loaded<'a> {
    /// Returns the scene for a search; `arithmetic` must be the one for which it was prepared.
    pub fn frame(&'a self, arithmetic: Arithmetic) -> Searchable<'a> {
        match self {
            Loaded::Open(scene) => Searchable::Open(scene, arithmetic.test()),
            Loaded::InBox(scene) => Searchable::Boxed(scene, arithmetic),
        }
    }

    /// Returns the number of particles.
    pub fn particles(&self) -> usize {
        self.scene().len()
    }

    /// Refuses a scene whose contacts without images will almost certainly take more than `limit`
    /// bytes. Contacts with images are estimated later, when the images are made. Fails with
    /// [`Refusal::Crowd`].
    pub fn within(&self, limit: u64) -> Result<(), Refusal> {
        crowd::within(self.scene(), limit)
    }

    fn scene(&self) -> &AnyScene<'a> {
        match self {
            Loaded::Open(scene) => scene,
            Loaded::InBox(periodic) => periodic.scene(),
        }
    }

    /// Prepares a scene for an arithmetic.
    ///
    /// # Errors
    /// Fails if the arithmetic cannot store the scene, or if the box does not fit the scene.
    pub fn new(
        scene: &AnyScene<'a>,
        lattice: Option<Lattice>,
        arithmetic: Arithmetic,
    ) -> Result<Loaded<'a>, LoadError> {
        Ok(match lattice {
            Some(lattice) => Loaded::InBox(Periodic::new(scene.clone(), lattice)?),
            None => Loaded::Open(scene.as_stored(arithmetic)?.into_owned()),
        })
    }
}
