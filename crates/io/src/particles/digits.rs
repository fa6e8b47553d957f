//! Coordinates that were cut to few digits.

use super::Particles;

/// Coordinates of at most so many significant digits were cut to them: %g writes six.
const FEW_DIGITS: usize = 6;
/// Coordinates of so many particles are looked at for this.
pub(crate) const LOOKED_AT: usize = 1000;

/// How many coordinates have how many significant digits; the last place is of all that have more
/// than are few.
pub type Counts = [u32; FEW_DIGITS + 2];

/// Counts one more, as it is written.
pub fn count(counts: &mut Counts, cell: &[u8]) {
    counts[significant(cell).min(FEW_DIGITS + 1)] += 1;
}

impl Particles {
    /// The most significant digits that a coordinate has, where they are few and half of many have
    /// so many or one less: those of a lattice are short, too, and need no more.
    pub(crate) fn cut_to(&self) -> Option<u32> {
        let [few @ .., more] = &self.digits;
        let most = few.iter().rposition(|&count| count > 0).filter(|&most| most >= 4)?;
        let cut = few[most] + few[most - 1];
        let all: u32 = few.iter().sum();
        (*more == 0 && all >= 30 && 2 * cut >= all).then_some(most as u32)
    }
}

/// The significant digits of a number as it is written: from the first that is not 0 to the last
/// that is not.
fn significant(cell: &[u8]) -> usize {
    let digits = cell.iter().take_while(|byte| !matches!(byte, b'e' | b'E' | b'd' | b'D'));
    let (mut count, mut zeros) = (0, 0);
    for &digit in digits.filter(|byte| byte.is_ascii_digit()) {
        match digit {
            b'0' if count == 0 => {}
            b'0' => zeros += 1,
            _ => (count, zeros) = (count + zeros + 1, 0),
        }
    }
    count
}
