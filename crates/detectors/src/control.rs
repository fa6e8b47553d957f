//! `nothing`: the control that finds no contacts.
//!
//! The time of this detector is the floor of every measurement: the cost of the clock, the call and
//! an empty result. Its rows are marked as a control, not as wrong. The other kind of control, the
//! A/A twin, is a second entry of the table with the code of another detector.

use contactbench_ground::contact::Particles;
use contactbench_ground::detect::{Declare, Detector, Options};
use contactbench_ground::limits::refusal::Refusal;
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::probe::Probe;
use contactbench_ground::scene::Real;

/// A detector that reports no contacts.
pub struct Nothing;

impl Declare for Nothing {
    fn with(_: Options) -> Nothing {
        Nothing
    }
}

impl<T: Real, const D: usize> Detector<T, D> for Nothing {
    fn detect<B: Particles<T, D>, P: Probe, S: Sink>(
        &mut self,
        _: B,
        _: &mut P,
        _: &mut S,
    ) -> Result<(), Refusal> {
        Ok(())
    }
}
