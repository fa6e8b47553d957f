//! What an experiment plans, as data: scenes and entrants. Runs are made from the same plan, and
//! reports are held to it.

use std::collections::{BTreeMap, BTreeSet};

use contactbench_terms::arithmetic::Arithmetic;

use crate::record::id::CellId;
use crate::record::role::Role;
use crate::record::value::AxisValue;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Planned {
    /// The axes of every scene of a whole run, in the order run. n is 0 where the scene decides.
    pub scenes: Vec<CellId>,
    pub quick: Vec<CellId>,
    /// The subjects of every scene, in the order of the record.
    pub entrants: Vec<Entrant>,
    /// Scenes that bring their own particles: their n is 0 unless the experiment gives it.
    pub own_n: BTreeSet<String>,
    /// The default values of the parameters of the scenes, by scene and dimension.
    pub defaults: BTreeMap<(String, u32), BTreeMap<String, AxisValue>>,
}

impl Planned {
    pub fn scenes(&self, quick: bool) -> &[CellId] {
        if quick { &self.quick } else { &self.scenes }
    }
}

/// A program with a number of threads, which is to look at every scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Entrant {
    pub name: String,
    /// What it is there for; a runner is [`Role::Runner`].
    pub role: Role,
    /// The arithmetic of a detector; `None` for a runner, which reports its own.
    pub arithmetic: Option<Arithmetic>,
    pub threads: usize,
}

impl Entrant {
    /// Whether it takes part where another build of this program does. Runners are not compiled
    /// into both builds, and controls say nothing about them.
    pub fn is_of_builds(&self) -> bool {
        self.role != Role::Runner && !self.role.is_control()
    }

    /// Returns the id of this subject's measurement on `scene`, without a machine. A runner is
    /// assumed to use the default arithmetic.
    pub fn cell(&self, scene: &CellId) -> CellId {
        let arithmetic = self.arithmetic.unwrap_or_default().name().into();
        let id = CellId { arithmetic, ..scene.clone() };
        id.with_contender(&self.name).with_threads(self.threads as u32)
    }
}
