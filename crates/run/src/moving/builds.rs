//! When a tracker built its list, and whether it was high time.

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Builds {
    /// Frames in which the detector was asked, or all was made anew, the first among them.
    pub built: u64,
    /// Of those, how many LAMMPS would call dangerous.
    pub dangerous: u64,
    /// Of those, how many came after a frame with a missed contact, counted from the build before.
    pub rightly: u64,
    /// Builds that came after such a frame, dangerous or not. Misses after the last build belong to
    /// none.
    pub missing: u64,
    /// Missed when the list was last built.
    missed_before: u64,
}

impl Builds {
    /// One more frame. Before it, so many contacts were missed, summed over the frames.
    pub fn take(&mut self, built: bool, dangerous: bool, missed: u64) {
        if !built {
            return;
        }
        if self.built > 0 {
            let missing = missed > self.missed_before;
            self.missing += u64::from(missing);
            self.rightly += u64::from(missing && dangerous);
        }
        self.missed_before = missed;
        self.built += 1;
        self.dangerous += u64::from(dangerous);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_build_is_dangerous_rightly_if_contacts_were_missed_since_the_last() {
        let mut builds = Builds::default();
        for (built, dangerous, missed) in [
            (true, false, 0),
            (false, false, 0),
            // Nothing was missed.
            (true, true, 0),
            // Two frames with misses, and nobody says so.
            (false, false, 3),
            (true, false, 5),
            (true, true, 6),
            (true, true, 6),
        ] {
            builds.take(built, dangerous, missed);
        }
        let Builds { built, dangerous, rightly, missing, .. } = builds;
        assert_eq!([built, dangerous, rightly, missing], [5, 3, 1, 2]);
    }
}
