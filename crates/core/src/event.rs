//! What a detector does, step by step, for probes that show it ([`crate::probe::Probe::note`]).
//!
//! The detectors of the book make events: `nbs` for discs, `screening`, `sorting` and
//! `binary-tree`. An event is made by the very statement that does what it names, and only where a
//! probe asks for it: with [`crate::probe::Silent`] and [`crate::probe::Tally`] nothing of this is
//! compiled.
//!
//! Particles, lists, places and nodes count from 0, cells from 1 as in [`crate::filter::cells`]. An
//! event names the first two axes of a cell in space.

/// Something that happened. In all events `particle`, `i` and `j` are particles, `cell` is column
/// and row, `heads` the letter of an array of heads, `list` a place in it and `first` what stands
/// there; `places` are the first place and the one after the last.
#[allow(missing_docs, reason = "fields have one meaning in all events")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// A part of the algorithm begins.
    Begin(Part),
    /// A loop over particles has come to this one.
    Visit { particle: u32 },
    /// The particle was put on a list, before `next`, which was first.
    Push { heads: char, list: usize, particle: u32, next: Option<u32> },
    /// A head was looked at.
    Look { heads: char, list: usize, first: Option<u32> },
    /// A head was looked at, and marked old if it was new and not empty; `old`: it was marked
    /// before.
    Take { heads: char, list: usize, first: Option<u32>, old: bool },
    /// A head was set back to empty and new.
    Reset { heads: char, list: usize },
    /// A particle's link was set back to empty.
    Unlink { particle: u32 },
    /// This cell is to be checked against itself and its contact mask.
    Central { cell: [u32; 2] },
    /// Two particles were tested for contact.
    Test { i: u32, j: u32, touching: bool },
    /// An integerised coordinate was written into the array of keys of an axis, at the place that
    /// has the particle's number before the sort.
    Key { axis: usize, particle: u32, key: u32 },
    /// A range of places is about to be split along an axis: keys below `mid` go left. No key of
    /// the range is below the first of `values` or above the second.
    Halve { axis: usize, places: [usize; 2], values: [u32; 2], mid: u32 },
    /// What stands at two places was exchanged, keys of this axis and later ones and particles.
    Swap { axis: usize, places: [usize; 2] },
    /// A range of places was parted along an axis; the right part begins at `middle`.
    Halved { axis: usize, places: [usize; 2], middle: usize },
    /// A binary search has compared the keys at a place.
    Compare { place: usize },
    /// The places of a cell's particles are known.
    Found { cell: [u32; 2], places: [usize; 2] },
    /// A node of the tree was visited; the search goes on to this half of it, or to both.
    Node { node: u32, half: Option<usize> },
    /// A node was made, in this half of its parent.
    Made { node: u32, parent: u32, half: usize },
    /// The particle was put on the list of a leaf, whose head is in this half of the node, before
    /// `next`, which was first.
    Leaf { node: u32, half: usize, cell: [u32; 2], particle: u32, next: Option<u32> },
    /// A descent to a cell has ended at its first particle.
    Descended { cell: [u32; 2], first: Option<u32> },
}

/// A part of an algorithm.
#[allow(missing_docs, reason = "the variants name their fields")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// All particles are put on y-lists.
    Rows,
    /// This row is central: its particles, and those of the row below, are put on x-lists.
    CentralRow { row: u32 },
    /// A loop over the particles of the central row finds its cells.
    Columns,
    /// Both sets of x-lists are emptied.
    RemoveColumns,
    /// The y-lists are emptied.
    RemoveRows,
    /// All particles are put on the lists of their cells.
    Cells,
    /// The cells that are not empty are found and checked.
    Search,
    /// The lists of the cells are emptied.
    RemoveCells,
    /// The arrays to be sorted are filled.
    Fill,
    /// They are sorted.
    Sort,
    /// All particles are put into the tree; each axis is halved this often.
    Tree { halvings: u32 },
    /// The tree is walked over, from leaf to leaf.
    Walk,
}

/// Column and row of a cell.
#[inline(always)]
pub fn plane<const D: usize>(cell: [u32; D]) -> [u32; 2] {
    std::array::from_fn(|k| cell.get(k).copied().unwrap_or(0))
}
