//! The scenes and subjects that an experiment plans. Runs follow this plan, and reports are
//! compared with it.

use std::collections::BTreeSet;

use contactbench_terms::arithmetic::Arithmetic;

use crate::record::id::CellId;
use crate::record::role::Role;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Planned {
    /// Axes of every scene of a full run, in order; n is 0 if the scene determines it.
    pub scenes: Vec<CellId>,
    pub quick: Vec<CellId>,
    pub subjects: Vec<PlannedSubject>,
    /// Names of scenes that determine their particles: n is 0 unless the experiment gives it.
    pub own_n: BTreeSet<String>,
}

impl Planned {
    pub fn scenes(&self, quick: bool) -> &[CellId] {
        if quick { &self.quick } else { &self.scenes }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct PlannedSubject {
    pub name: String,
    pub role: Role,
    pub arithmetic: Option<Arithmetic>,
    pub threads: usize,
}

impl PlannedSubject {
    /// Whether this subject is also timed in the other build of a comparison. Runners are not part
    /// of a build, and controls do not depend on it.
    pub fn is_of_builds(&self) -> bool {
        self.role != Role::Runner && !self.role.is_control()
    }

    /// Returns the id of this subject's measurement on `scene`, without a machine. A runner is
    /// assumed to use the default arithmetic.
    pub fn cell(&self, scene: &CellId) -> CellId {
        let arithmetic = self.arithmetic.unwrap_or_default().name().into();
        let id = CellId { arithmetic, ..scene.clone() };
        id.with_subject(&self.name).with_threads(self.threads as u32)
    }
}
