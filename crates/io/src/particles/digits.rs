//! Detects coordinates that were rounded to few digits.

use super::Particles;

/// Largest number of significant digits that counts as few, because %g writes six.
const FEW_DIGITS: usize = 6;
pub(crate) const LOOKED_AT: usize = 1000;

/// Number of coordinates by significant digits; the last entry counts all with more than
/// [`FEW_DIGITS`].
pub type Counts = [u32; FEW_DIGITS + 2];

pub fn count(counts: &mut Counts, cell: &[u8]) {
    counts[significant(cell).min(FEW_DIGITS + 1)] += 1;
}

impl Particles {
    /// Returns the largest number of significant digits. It must be small, and at least half of
    /// many coordinates must have it or one digit less. The second condition excludes lattices,
    /// whose coordinates are short anyway.
    pub(crate) fn cut_to(&self) -> Option<u32> {
        let [few @ .., more] = &self.digits;
        let most = few.iter().rposition(|&count| count > 0).filter(|&most| most >= 4)?;
        let cut = few[most] + few[most - 1];
        let all: u32 = few.iter().sum();
        (*more == 0 && all >= 30 && 2 * cut >= all).then_some(most as u32)
    }
}

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
