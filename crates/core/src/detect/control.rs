//! `nothing`: the control that finds no contacts.
//!
//! The time of this detector is the floor of every measurement: the cost of the clock, the call and
//! an empty result. Its rows are marked as a control, not as wrong. The other kind of control, the
//! A/A twin, is a second entry of the table with the code of another detector.

use super::{Declare, Detector, Options, Refusal};
use crate::contact::Bodies;
use crate::probe::Probe;
use crate::scene::Real;
use crate::sink::Sink;

/// A detector that reports no contacts.
pub struct Nothing;

impl Declare for Nothing {
    fn with(_: Options) -> Nothing {
        Nothing
    }
}

impl<T: Real, const D: usize> Detector<T, D> for Nothing {
    fn detect<B: Bodies<T, D>, P: Probe, S: Sink>(
        &mut self,
        _: B,
        _: &mut P,
        _: &mut S,
    ) -> Result<(), Refusal> {
        Ok(())
    }
}
