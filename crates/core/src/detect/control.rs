//! `nothing`: the control that does nothing.
//!
//! Its time is the floor of every measurement: what the clock, the call and the delivery of no
//! contacts cost. Its rows are marked as control, not as wrong. (The other control, the A/A twin,
//! needs no code: it is a second line of the table.)

use super::{Declare, Detector, Options, Refusal};
use crate::contact::Bodies;
use crate::probe::Probe;
use crate::scene::Real;
use crate::sink::Sink;

/// Reports nothing.
pub struct Nothing;

impl Declare for Nothing {
    fn with(_: Options) -> Nothing {
        Nothing
    }

    fn formula_bytes(&self) -> u64 {
        0
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
