//! Events: the single steps of a detector, for probes that show them
//! ([`crate::probe::Probe::note`]).
//!
//! Detectors of the book emit events: `nbs` for discs, `screening`, `sorting` and `binary-tree`.
//! The statement that performs a step also emits its event, and only if the probe requests events:
//! with [`crate::probe::Silent`] and [`crate::probe::Tally`] no such code is compiled.
//!
//! Particles, lists, places and nodes count from 0, cells from 1 as in [`crate::filter::cells`]. In
//! three dimensions an event has the first two axes of a cell.

/// A step of a detector. In all events `particle`, `i` and `j` are particles, `cell` is column and
/// row, `heads` the letter of an array of heads, `list` an index in it and `first` its value;
/// `places` are the first place and the one after the last.
#[allow(missing_docs, reason = "fields have one meaning in all events")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// A part of the algorithm begins.
    Begin(Part),
    /// A loop over particles reached this particle.
    Visit { particle: u32 },
    /// The particle was put on a list, before its previous first particle `next`.
    Push { heads: char, list: usize, particle: u32, next: Option<u32> },
    /// A head was read.
    Look { heads: char, list: usize, first: Option<u32> },
    /// A head was read, and marked old if it was new and not empty; `old` is its mark before.
    Take { heads: char, list: usize, first: Option<u32>, old: bool },
    /// A head was set to empty and new.
    Reset { heads: char, list: usize },
    /// A particle's link was set to empty.
    Unlink { particle: u32 },
    /// This cell is next to be checked against itself and its contact mask.
    Central { cell: [u32; 2] },
    /// Two particles were tested for contact.
    Test { i: u32, j: u32, touching: bool },
    /// An integerised coordinate was written to the key array of an axis, at the index of the
    /// particle.
    Key { axis: usize, particle: u32, key: u32 },
    /// A range of places will be split along an axis, keys below `mid` to the left. `values` are
    /// the bounds of its keys.
    Halve { axis: usize, places: [usize; 2], values: [u32; 2], mid: u32 },
    /// Two places were exchanged: particles and the keys of this axis and later ones.
    Swap { axis: usize, places: [usize; 2] },
    /// A range of places was split along an axis; the right part begins at `middle`.
    Halved { axis: usize, places: [usize; 2], middle: usize },
    /// A binary search compared the keys at a place.
    Compare { place: usize },
    /// The places of a cell's particles were found.
    Found { cell: [u32; 2], places: [usize; 2] },
    /// A node of the tree was visited; the search continues in this half of it, or in both.
    Node { node: u32, half: Option<usize> },
    /// A node was created in this half of its parent.
    Made { node: u32, parent: u32, half: usize },
    /// The particle was put on the list of a leaf, whose head is in this half of the node, before
    /// its previous first particle `next`.
    Leaf { node: u32, half: usize, cell: [u32; 2], particle: u32, next: Option<u32> },
    /// A descent to a cell ended at the cell's first particle.
    Descended { cell: [u32; 2], first: Option<u32> },
}

/// A part of an algorithm.
#[allow(missing_docs, reason = "the variants name their fields")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// All particles are put on y-lists.
    Rows,
    /// The particles of this central row and of the row below are put on x-lists.
    CentralRow { row: u32 },
    /// A loop over the particles of the central row finds its cells.
    Columns,
    /// Both sets of x-lists are emptied.
    RemoveColumns,
    /// The y-lists are emptied.
    RemoveRows,
    /// All particles are put on the lists of their cells.
    Cells,
    /// The non-empty cells are found and checked.
    Search,
    /// The lists of the cells are emptied.
    RemoveCells,
    /// The arrays to be sorted are filled.
    Fill,
    /// The arrays are sorted.
    Sort,
    /// All particles are inserted in the tree; each axis is halved this often.
    Tree { halvings: u32 },
    /// The tree is traversed, leaf by leaf.
    Walk,
}

/// Returns column and row of a cell.
#[inline(always)]
pub fn plane<const D: usize>(cell: [u32; D]) -> [u32; 2] {
    std::array::from_fn(|k| cell.get(k).copied().unwrap_or(0))
}
