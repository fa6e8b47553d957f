//! A contact list, and its checks against the box of the particles.

use anyhow::ensure;

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
    /// Names of unused columns, or their numbers from 1.
    pub others: Vec<String>,
    /// Whether an unused column has no name, so that it may be an image.
    pub unnamed: bool,
    /// Whether numbers are LAMMPS ids instead of positions in a file.
    pub ids: bool,
    /// Whether the columns are called `id1` and `id2`, which means ids if the particles have any.
    pub named_ids: bool,
    pub notices: Vec<Notice>,
}

impl List {
    /// Refuses a list whose images have too few axes for the periodic box, or with columns without
    /// names, which may be images.
    pub fn understood(&self, dim: usize, periodic: [bool; 3]) -> anyhow::Result<()> {
        let third = self.images.is_none() || !self.flat || dim == 2 || !periodic[2];
        ensure!(third, "images have two numbers, and the box repeats along z, too; add sz");
        let two = self.images.is_none() || self.flat || dim == 3 || self.format != "npy";
        ensure!(two, "images have three numbers, and these are discs; or give --frame all");
        let z = if dim == 2 { "" } else { ",SZ" };
        ensure!(
            self.images.is_some() || !self.unnamed,
            "{} may be images; give --pairs-columns I,J[,SX,SY{z}]",
            columns_of(&self.others)
        );
        Ok(())
    }
}

pub fn columns_of(names: &[String]) -> String {
    let listed = crate::raw::lines::listed(names);
    format!("column{} {listed}", if names.len() == 1 { "" } else { "s" })
}
