//! A contact list, and its checks against the box of the particles.

use anyhow::ensure;

use super::columns::{Other, unnamed};
use crate::types::Notice;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct List {
    pub format: &'static str,
    pub frame: Option<u64>,
    pub step: Option<i64>,
    /// Whether rows contain their frame; then a frame without rows has no pairs.
    pub sparse: bool,
    pub pairs: Vec<[i64; 2]>,
    /// Image of the second particle of each pair: how often each box vector is added to its
    /// position. `None` if the list has no images.
    pub images: Option<Vec<[i32; 3]>>,
    /// Whether images have two numbers instead of three.
    pub flat: bool,
    /// Whether unnamed columns were taken for images only by the number of columns.
    pub guessed: bool,
    pub others: Vec<Other>,
    /// Whether numbers are LAMMPS ids instead of positions in a file.
    pub ids: bool,
    /// Whether the columns are called `id1` and `id2`, which means ids if the particles have any.
    pub named_ids: bool,
    pub notices: Vec<Notice>,
}

impl List {
    /// Refuses a list whose images have too few axes for the periodic box, or with columns that may
    /// be images but are not known to be.
    pub fn understood(&self, dim: usize, periodic: [bool; 3]) -> anyhow::Result<()> {
        let third = self.images.is_none() || !self.flat || dim == 2 || !periodic[2];
        ensure!(third, "images have two numbers, and the box repeats along z, too; add sz");
        let two = self.images.is_none() || self.flat || dim == 3 || self.format != "npy";
        ensure!(two, "images have three numbers, and these are discs; or give --frame all");
        if self.images.is_none() {
            let names = |which: &dyn Fn(&Other) -> bool| -> Vec<&str> {
                let such = self.others.iter().filter(|other| which(other));
                such.map(|other| &*other.name).collect()
            };
            let (unnamed, whole) = (names(&|other| !other.named), names(&|other| other.whole));
            let doubtful = if unnamed.is_empty() && whole.len() >= dim { whole } else { unnamed };
            let z = if dim == 2 { "" } else { ",SZ" };
            ensure!(
                doubtful.is_empty(),
                "{} may be images; give --pairs-columns I,J,SX,SY{z} if so, otherwise \
                 --pairs-columns I,J",
                columns_of(&doubtful)
            );
        }
        Ok(())
    }

    pub fn without_box(&mut self) {
        if std::mem::take(&mut self.guessed) {
            self.images = None;
            self.others.splice(..0, (2..if self.flat { 4 } else { 5 }).map(|k| unnamed(k).1));
        }
    }
}

pub fn columns_of(names: &[&str]) -> String {
    let listed = crate::raw::lines::listed(names);
    format!("column{} {listed}", if names.len() == 1 { "" } else { "s" })
}
