//! Detects unnamed columns that only number the particles, as in the published data of Finney's
//! packing.

use crate::particles::Particles;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Counted {
    First,
    Last,
    Graph,
}

impl Particles {
    /// Returns the column that seems to number the particles, in any order, instead of holding x or
    /// the radius. Beads on a row may have x = 0, 1, 2, but they share one radius, y and z.
    pub fn counted(&self) -> Option<Counted> {
        let (n, radii) = (self.len(), self.radii.as_deref());
        if n < 3 {
            return None;
        }
        if radii.is_some_and(|radii| counts(n, |k| radii[k])) {
            return Some(Counted::Last);
        }
        let one = |value: &dyn Fn(usize) -> f64| (0..n).all(|k| value(k) == value(0));
        let row = radii.is_none_or(|radii| one(&|k| radii[k]))
            && (1..3).all(|axis| one(&|k| self.centre(k)[axis]));
        let which =
            if self.dim() == 2 && radii.is_none() { Counted::Graph } else { Counted::First };
        (!row && counts(n, |k| self.centre(k)[0])).then_some(which)
    }
}

/// Whether the values are the whole numbers from 0 or from 1, each once. Also false if there is no
/// memory for one bit per value.
fn counts(n: usize, value: impl Fn(usize) -> f64) -> bool {
    let (mut seen, mut count) = (Vec::<u64>::new(), 0);
    for k in 0..n {
        let value = value(k);
        if !(0.0..=n as f64).contains(&value) || value.fract() != 0.0 {
            return false;
        }
        let (word, bit) = (value as usize / 64, value as usize % 64);
        if seen.is_empty() {
            if seen.try_reserve_exact(n / 64 + 1).is_err() {
                return false;
            }
            seen.resize(n / 64 + 1, 0);
        }
        count += usize::from(seen[word] >> bit & 1 == 0);
        seen[word] |= 1 << bit;
    }
    // All n values are different, and 0 or n does not occur.
    count == n && (seen[0] & 1 == 0 || seen[n / 64] >> (n % 64) & 1 == 0)
}
