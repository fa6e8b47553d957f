//! A contact list as it was read, and what it needs beside a box or without one.

use anyhow::ensure;

use super::Other;
use crate::lines::short;
use crate::notice::Notice;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct List {
    pub format: &'static str,
    /// The number of its frame, where the file has frames.
    pub frame: Option<u64>,
    /// Its time step, where the file says it.
    pub step: Option<i64>,
    /// Rows say their frame: one of which no row speaks has no pairs.
    pub sparse: bool,
    /// Couples of numbers, in file order.
    pub pairs: Vec<[i64; 2]>,
    /// Which image of the second particle it is, for each, where the list says so: so many vectors
    /// of the box are added to its place.
    pub images: Option<Vec<[i32; 3]>>,
    /// They are named along the first two vectors alone.
    pub flat: bool,
    /// Nothing says that they are images but their number: the columns have no names.
    pub guessed: bool,
    pub others: Vec<Other>,
    /// Contacts with walls, which were left out.
    pub walls: u64,
    /// The numbers are those that the program gave its particles (LAMMPS), not places in a file.
    pub ids: bool,
    /// The columns are called `id1` and `id2`: the ids of the particles, if their file has any.
    pub named_ids: bool,
    /// Every contact stands there from both sides (MercuryDPM), and was taken once.
    pub both_sides: bool,
    pub notices: Vec<Notice>,
}

impl List {
    /// Refuses a list for a box that repeats along some axes if it names images along too few, or
    /// has columns that may name images and are not known to.
    pub fn understood(&self, dim: usize, periodic: [bool; 3]) -> anyhow::Result<()> {
        ensure!(
            self.images.is_none() || !self.flat || dim == 2 || !periodic[2],
            "images are named along two vectors, and the box repeats along z, too; add the third, \
             sz"
        );
        ensure!(
            self.images.is_none() || self.flat || dim == 3 || self.format != "npy",
            "images are named along three vectors, and these are discs; if the first column is the \
             frame, give --frame all"
        );
        if self.images.is_none() {
            let names = |which: &dyn Fn(&Other) -> bool| -> Vec<&str> {
                let such = self.others.iter().filter(|other| which(other));
                such.map(|other| &*other.name).collect()
            };
            let (unnamed, whole) = (names(&|other| !other.named), names(&|other| other.whole));
            let doubtful = if unnamed.is_empty() && whole.len() >= dim { whole } else { unnamed };
            ensure!(
                doubtful.is_empty(),
                "{} may name the images that touch, and nothing says so; give --pairs-columns \
                 I,J,SX,SY{}, or --pairs-columns I,J if not",
                columns_of(&doubtful),
                if dim == 2 { "" } else { ",SZ" }
            );
        }
        Ok(())
    }

    /// Adds the doubt about a comment among the pairs that names a frame, once.
    pub(super) fn divided(&mut self, comment: &str) {
        let words = format!(
            "the comment '{}' among the pairs may begin another frame, and all pairs are taken as \
             one list; write the frame as a column",
            short(comment)
        );
        if self.notices.is_empty() {
            self.notices.push(Notice::Assumed(words));
        }
    }

    /// The list as one of a scene without a box: columns that may be images are something else.
    pub fn without_box(&mut self) {
        if std::mem::take(&mut self.guessed) {
            self.images = None;
            self.others.splice(..0, (2..if self.flat { 4 } else { 5 }).map(Other::unnamed));
        }
    }
}

pub fn columns_of(names: &[&str]) -> String {
    let listed = crate::lines::listed(names);
    format!("column{} {listed}", if names.len() == 1 { "" } else { "s" })
}
