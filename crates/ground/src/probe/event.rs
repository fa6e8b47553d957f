//! Events: the single steps of a detector, for probes that show them
//! ([`crate::probe::Probe::note`]).
//!
//! Detectors of the book emit events: `nbs` for discs, `screening`, `sorting` and `binary-tree`.
//! The statement that performs a step also emits its event, but only if the probe requests events:
//! no such code is compiled for [`crate::probe::Silent`] and [`crate::probe::Tally`].
//!
//! Particles, lists, places and nodes are numbered from 0, cells from 1 as in
//! [`crate::filter::cells`]. In three dimensions an event holds the first two axes of a cell.

/// A step of a detector. In all events `particle`, `i` and `j` are particle numbers, and `cell` is
/// a column and a row. `heads` is the letter of an array of heads, `list` an index in it and
/// `first` its value. `places` are the first place and the one after the last.
#[allow(missing_docs, reason = "fields have one meaning in all events")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// A part of the algorithm began.
    Begin(Part),
    /// A loop over particles reached this particle.
    Visit { particle: u32 },
    /// The particle was put on a list, before `next`, which was the first particle of the list.
    Push { heads: char, list: usize, particle: u32, next: Option<u32> },
    /// The head of a list was read.
    Look { heads: char, list: usize, first: Option<u32> },
    /// The head of a list was read, and marked old if it was new and not empty. `old` is whether it
    /// was old before.
    Take { heads: char, list: usize, first: Option<u32>, old: bool },
    /// The head of a list was set to empty and new.
    Reset { heads: char, list: usize },
    /// A particle's link to the next particle was set to empty.
    Unlink { particle: u32 },
    /// This cell will be checked next, against itself and its contact mask.
    Central { cell: [u32; 2] },
    /// Two particles were tested for contact.
    Test { i: u32, j: u32, touching: bool },
    /// The integerised coordinate of a particle was written to the key array of an axis.
    Key { axis: usize, particle: u32, key: u32 },
    /// A range of places will be split along an axis, with keys below `mid` to the left. `values`
    /// are the bounds of its keys.
    Halve { axis: usize, places: [usize; 2], values: [u32; 2], mid: u32 },
    /// Two places were exchanged: their particles, and the keys for this axis and later ones.
    Swap { axis: usize, places: [usize; 2] },
    /// A range of places was split along an axis, and its right part begins at place `middle`.
    Halved { axis: usize, places: [usize; 2], middle: usize },
    /// A binary search for a cell compared the keys at place `compared`, and keeps `places`.
    Kept { cell: [u32; 2], compared: usize, places: [usize; 2] },
    /// The range of places with a cell's particles was found.
    Found { cell: [u32; 2], places: [usize; 2] },
    /// A node of the tree was visited. The search continues in its half `half`, or in both halves
    /// if that is `None`.
    Node { node: u32, half: Option<usize> },
    /// A node was created as this half of its parent.
    Made { node: u32, parent: u32, half: usize },
    /// The particle was put on the list of a leaf, before `next`, which was the first particle of
    /// the list. The head of the list is in this half of the node.
    Leaf { node: u32, half: usize, cell: [u32; 2], particle: u32, next: Option<u32> },
    /// A descent of the tree to a cell ended at the cell's first particle.
    Descended { cell: [u32; 2], first: Option<u32> },
}

/// A part of an algorithm.
#[allow(missing_docs, reason = "the variants name their fields")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// All particles are put on the lists of their rows.
    Rows,
    /// The particles of this central row and of the row below are put on lists of their columns.
    CentralRow { row: u32 },
    /// A loop over the particles of the central row finds the row's cells.
    Columns,
    /// The lists of columns of both rows are emptied.
    RemoveColumns,
    /// The lists of rows are emptied.
    RemoveRows,
    /// All particles are put on the lists of their cells.
    Cells,
    /// The non-empty cells are found and checked for contacts.
    Search,
    /// The lists of the cells are emptied.
    RemoveCells,
    /// The arrays that will be sorted are filled.
    Fill,
    /// The arrays are sorted.
    Sort,
    /// All particles are inserted in the tree; `halvings` is how often each axis is halved.
    Tree { halvings: u32 },
    /// The tree is traversed, leaf by leaf.
    Walk,
}

/// Returns the column and the row of a cell.
#[inline(always)]
pub fn plane<const D: usize>(cell: [u32; D]) -> [u32; 2] {
    std::array::from_fn(|k| cell.get(k).copied().unwrap_or(0))
}
