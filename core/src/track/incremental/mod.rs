//! Detectors that are carried from frame to frame: what they made for one frame is mended for the
//! next.
//!
//! Each finds all contacts of every frame by itself, whatever the frame before was, and promises
//! what its detector promises: the cells, boxes and comparisons are the same, from the same code.
//! What is kept decides on speed only. The textbook's cells are not kept: under that test, too, the
//! filters here lose nothing.

mod bvh;
mod lists;
mod nbs;
mod screening;
mod sweep;
#[cfg(test)]
mod tests;

use std::time::Duration;

use super::{Step, Tracker};
use crate::contact::{Arithmetic, Test};
use crate::detect::any::{self, DetectorOfAll};
use crate::detect::{Declare, Options};
use crate::event::Event;
use crate::pair_list::{Allowance, PairList};
use crate::periodic::{Contacts, Periodic};
use crate::probe::{Op, Probe, Silent, Tally};
use crate::refusal::Refusal;
use crate::scene::{AnyScene, Stored};

/// Which detector is carried on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Native {
    /// The order of the bodies is repaired by insertion sort.
    Sweep,
    /// Bodies that left their row (in space their layer) are put on the list of another.
    Nbs,
    /// Bodies that left their cell are put on the list of another.
    Screening,
    /// Boxes are made again where bodies have left them.
    Bvh {
        /// How far the box of a body reaches beyond it, in its own diameters.
        margin: f64,
    },
}

impl Native {
    /// The margin of boxes where none is given: an eighth of a body's extent, as in rapier (12.5%
    /// of the smallest extent).
    const MARGIN: f64 = 0.125;

    /// All, with their margin where they have one.
    pub const ALL: [Native; 4] =
        [Native::Sweep, Native::Nbs, Native::Screening, Native::Bvh { margin: Native::MARGIN }];

    /// Of the detector.
    pub fn name(self) -> &'static str {
        match self {
            Native::Sweep => "sweep",
            Native::Nbs => "nbs",
            Native::Screening => "screening",
            Native::Bvh { .. } => "bvh",
        }
    }

    /// A tracker that has seen no frame.
    pub(super) fn make(self, options: Options) -> Box<dyn Tracker> {
        match self {
            Native::Sweep => {
                Incremental::boxed(sweep::Sweeping::<2>::with, sweep::Sweeping::<3>::with, options)
            }
            Native::Nbs => Incremental::boxed(nbs::Plane::with, nbs::Space::with, options),
            Native::Screening => {
                Incremental::boxed(screening::Plane::with, screening::Space::with, options)
            }
            Native::Bvh { margin } => Incremental::boxed(
                |options| bvh::Refitted::<2>::new(options, margin),
                |options| bvh::Refitted::<3>::new(options, margin),
                options,
            ),
        }
    }
}

/// A detector that keeps what it has made.
trait Carried: Declare {
    /// The time in which it made everything anew for the last frame, if it did.
    fn built(&self) -> Option<Duration>;

    /// It is to make everything anew for the next frame.
    fn forget(&mut self);
}

/// Its form for the plane and that for space.
struct Incremental<A, B> {
    plane: A,
    space: B,
    /// For the list of contacts, in bytes.
    limit: u64,
}

impl<A, B> Incremental<A, B>
where
    A: Carried + DetectorOfAll<2> + 'static,
    B: Carried + DetectorOfAll<3> + 'static,
{
    fn boxed(
        plane: impl Fn(Options) -> A,
        space: impl Fn(Options) -> B,
        options: Options,
    ) -> Box<dyn Tracker> {
        let limit = options.memory_limit;
        Box::new(Incremental { plane: plane(options), space: space(options), limit })
    }
}

impl<A, B> Tracker for Incremental<A, B>
where
    A: Carried + DetectorOfAll<2> + 'static,
    B: Carried + DetectorOfAll<3> + 'static,
{
    fn step(
        &mut self,
        frame: &AnyScene<'_>,
        test: Test,
        tally: Option<&mut Tally>,
        pairs: &mut Vec<[u32; 2]>,
    ) -> Result<Step, Refusal> {
        let allowance = Allowance::new(self.limit);
        let mut list = PairList::behind(std::mem::take(pairs), &allowance);
        let test = test.safe();
        let found = match frame {
            AnyScene::Plane(scene) => find(&mut self.plane, scene, test, tally, &mut list),
            AnyScene::Space(scene) => find(&mut self.space, scene, test, tally, &mut list),
        };
        let found = list.end(frame.len(), pairs).and(found);
        let (built, listed) = found.inspect_err(|_| self.forget())?;
        let building = built.unwrap_or_default();
        Ok(Step { built: built.is_some(), listed, dangerous: false, building })
    }

    fn step_in_box(
        &mut self,
        _: &Periodic<'_>,
        _: Arithmetic,
        _: Option<&mut Tally>,
        _: &mut Contacts,
    ) -> Result<Step, Refusal> {
        Err(Refusal::Boxed { tracker: "incremental" })
    }

    fn forget(&mut self) {
        self.plane.forget();
        self.space.forget();
    }

    fn formula_bytes(&self) -> u64 {
        self.plane.formula_bytes() + self.space.formula_bytes()
    }
}

/// The time of making all anew, if that was done, and contact tests; counts all operations if there
/// is a tally.
fn find<const D: usize>(
    detector: &mut (impl Carried + DetectorOfAll<D>),
    scene: &Stored<'_, D>,
    test: Test,
    tally: Option<&mut Tally>,
    pairs: &mut PairList<'_>,
) -> Result<(Option<Duration>, u64), Refusal> {
    let tests = match tally {
        Some(tally) => {
            let before = tally.get(Op::ContactTest);
            any::run_any(detector, scene, test, tally, pairs)?;
            tally.get(Op::ContactTest) - before
        }
        None => {
            let mut silent = Silent;
            let mut meter = Meter::new(&mut silent);
            any::list(detector, scene, test, &mut meter, pairs)?;
            meter.tests
        }
    };
    Ok((detector.built(), tests))
}

/// What sorting takes: N log2 N comparisons, rounded up.
fn sorting(n: usize) -> u64 {
    n as u64 * u64::from(n.max(1).next_power_of_two().trailing_zeros())
}

/// Counts contact tests, and visits to nodes and bounds, on the way to another probe.
struct Meter<'a, P> {
    probe: &'a mut P,
    tests: u64,
    visits: u64,
}

impl<P> Meter<'_, P> {
    fn new(probe: &mut P) -> Meter<'_, P> {
        Meter { probe, tests: 0, visits: 0 }
    }
}

impl<P: Probe> Probe for Meter<'_, P> {
    const SILENT: bool = false;

    #[inline(always)]
    fn add(&mut self, op: Op, n: u64) {
        match op {
            Op::ContactTest => self.tests += n,
            Op::NodeVisit | Op::BoundTest => self.visits += n,
            _ => {}
        }
        self.probe.add(op, n);
    }

    #[inline(always)]
    fn note(&mut self, event: impl FnOnce() -> Event) {
        self.probe.note(event);
    }
}
