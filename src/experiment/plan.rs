//! What an experiment plans: every entrant on every scene, in so many blocks. Runs are made from
//! this, and reports are held to it.

use crate::experiment::{Experiment, ExternalRunner};
use crate::record::id::{CellId, split_contender};
use crate::record::role::Role;
use crate::scene::spec::Spec;
use crate::track;
use contactbench_terms::arithmetic::Arithmetic;

/// Blocks done before the budget can end a scene: the range of six values covers the median in
/// 96.9% of samples.
pub const FEWEST_BLOCKS: u32 = 6;
/// Blocks of a quick run.
const QUICK_BLOCKS: u32 = 3;
/// What stands for the number of threads in the command of a runner in another language.
pub(crate) const THREADS: &str = "{threads}";

/// A program with so many threads, which is to look at every scene.
pub struct Entrant<'a> {
    /// Its name in the experiment, with parameters.
    pub name: &'a str,
    /// What it is.
    pub program: Program<'a>,
    /// Threads given to it.
    pub threads: usize,
}

/// Who detects.
#[derive(Clone, Copy)]
pub enum Program<'a> {
    /// A detector of this program, in an arithmetic.
    Own(Arithmetic),
    /// A runner, which says its arithmetic itself.
    External(&'a ExternalRunner),
}

impl Entrant<'_> {
    /// Does it take part where another build of this program does? What is not compiled into both
    /// has nothing to say of them, nor have controls.
    pub(crate) fn is_of_builds(&self) -> bool {
        let (name, _) = split_contender(self.name);
        matches!(self.program, Program::Own(_)) && !Role::by_name(&name).is_control()
    }
}

impl Experiment {
    /// Who looks at every scene, in the order of the record.
    pub fn entrants(&self) -> Vec<Entrant<'_>> {
        let mut entrants = Vec::new();
        for &arithmetic in &self.arithmetics {
            for name in &self.detectors {
                // A sequential detector has one thread, whatever the others are given; so has a
                // peer that was not compiled.
                let several = track::parse(name).is_ok_and(|spec| spec.detector().entry.threads);
                let program = Program::Own(arithmetic);
                let all = if several { &*self.threads } else { &[1] };
                entrants.extend(all.iter().map(|&threads| Entrant { name, program, threads }));
            }
        }
        for runner in &self.runners {
            // A command that does not say how many threads is the same for all numbers of them.
            let all = if runner.says_threads() { &*self.threads } else { &self.threads[..1] };
            let (name, program) = (&*runner.name, Program::External(runner));
            entrants.extend(all.iter().map(|&threads| Entrant { name, program, threads }));
        }
        entrants
    }

    /// The paired blocks of a scene.
    pub fn all_blocks(&self, quick: bool) -> u32 {
        if quick { self.blocks.min(QUICK_BLOCKS) } else { self.blocks }
    }

    /// The same, or the fewest after which the budget may end them.
    pub fn enough_blocks(&self, quick: bool) -> u32 {
        let blocks = self.all_blocks(quick);
        if self.block_budget_s.is_finite() { blocks.min(FEWEST_BLOCKS) } else { blocks }
    }

    /// The axes of an entrant's measurement of a scene, on no machine yet. What only a runner or a
    /// file can say stands there as a guess: the arithmetic, and the number of particles, 0.
    pub fn cell(
        &self,
        spec: &Spec,
        name: &str,
        arithmetic: Option<Arithmetic>,
        threads: usize,
    ) -> CellId {
        let id = CellId {
            experiment: self.name.clone(),
            scene: spec.name.clone(),
            dim: spec.dim,
            params: spec.axes().iter().map(|(name, v)| (name.clone(), v.into())).collect(),
            order: spec.order.name().into(),
            n: spec.n,
            seed: spec.seed,
            arithmetic: arithmetic.unwrap_or_default().name().into(),
            ..CellId::default()
        };
        id.with_contender(name).with_threads(threads as u32)
    }
}

impl ExternalRunner {
    /// Does the command say how many threads?
    pub fn says_threads(&self) -> bool {
        self.command.iter().any(|word| word.contains(THREADS))
    }
}
