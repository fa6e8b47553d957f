//! Counts the rebuilds of a tracker, and whether they came too late.

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Builds {
    pub built: u64,
    /// Number of builds that LAMMPS would call dangerous.
    pub dangerous: u64,
    /// Number of dangerous builds with a missed contact between them and the build before.
    pub rightly: u64,
    /// Number of builds, dangerous or not, with a missed contact between them and the build before.
    /// Misses after the last build are not counted.
    pub missing: u64,
    missed_before: u64,
}

impl Builds {
    /// Adds a frame. `missed` is the total number of contacts missed in all earlier frames.
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
            (true, true, 0),
            // Contacts are missed in two frames, but the build is not dangerous.
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
