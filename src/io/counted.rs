//! Columns without names that count the particles, such as Finney's packing is published with.

use crate::io::particles::Particles;

/// Which column counts the particles: see [`Particles::counted`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Counted {
    First,
    Last,
}

impl Particles {
    /// Whether x or the radius counts the particles, and so is likely neither. Beads on a row may
    /// well have x = 0, 1, 2, but then they have one radius.
    pub(crate) fn counted(&self) -> Option<Counted> {
        let (n, radii) = (self.len(), self.radii.as_ref()?);
        let counts = |value: &dyn Fn(usize) -> f64| {
            let from = value(0);
            (from == 0.0 || from == 1.0) && (0..n).all(|k| value(k) == from + k as f64)
        };
        if n < 3 {
            None
        } else if counts(&|k| radii[k]) {
            Some(Counted::Last)
        } else {
            let one = radii.iter().all(|r| *r == radii[0]);
            (!one && counts(&|k| self.centre(k)[0])).then_some(Counted::First)
        }
    }
}
