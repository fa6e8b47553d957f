//! What a detector does, step by step, for probes that show it ([`crate::probe::Probe::note`]).
//!
//! The detectors of the book tell it: `nbs` for discs, `screening`, `sorting` and `binary-tree`. An
//! event is made by the very statement that does what it tells, and only where a probe asks for it:
//! with [`crate::probe::Silent`] and [`crate::probe::Tally`] nothing of this is compiled.
//!
//! Particles, lists, places and nodes count from 0, cells from 1 as in [`crate::filter::cells`]. Of
//! cells in space the first two axes are told.

/// Something that happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// A part of the algorithm begins.
    Begin(Part),
    /// A loop over particles has come to this one.
    Visit {
        /// The particle.
        particle: u32,
    },
    /// The particle was put on a list, before the one that was first.
    Push {
        /// The letter of the array of heads.
        heads: char,
        /// The number of the list in it.
        list: usize,
        /// The particle.
        particle: u32,
        /// The one that was first.
        next: Option<u32>,
    },
    /// A head was looked at.
    Look {
        /// The letter of the array of heads.
        heads: char,
        /// The number of the list in it.
        list: usize,
        /// What is there.
        first: Option<u32>,
    },
    /// A head was looked at, and marked old if it was new and not empty.
    Take {
        /// The letter of the array of heads.
        heads: char,
        /// The number of the list in it.
        list: usize,
        /// What is there.
        first: Option<u32>,
        /// Was it marked before?
        old: bool,
    },
    /// A head was set back to empty and new.
    Reset {
        /// The letter of the array of heads.
        heads: char,
        /// The number of the list in it.
        list: usize,
    },
    /// A particle's link was set back to empty.
    Unlink {
        /// The particle.
        particle: u32,
    },
    /// This cell is to be checked against itself and its contact mask.
    Central {
        /// Column and row.
        cell: [u32; 2],
    },
    /// Two particles were tested for contact.
    Test {
        /// One.
        i: u32,
        /// The other.
        j: u32,
        /// Do they touch?
        touching: bool,
    },
    /// An integerised coordinate was written into an array of keys.
    Key {
        /// The axis.
        axis: usize,
        /// The particle, and its place before the sort.
        particle: u32,
        /// The integerised coordinate.
        key: u32,
    },
    /// A range of places is to be parted by a value.
    Halve {
        /// The axis whose keys are compared.
        axis: usize,
        /// First place and the one after the last.
        places: [usize; 2],
        /// No key is below the first or above the second.
        values: [u32; 2],
        /// Keys below go left.
        mid: u32,
    },
    /// What stands at two places was exchanged, keys of this axis and later ones and particles.
    Swap {
        /// The axis whose keys are compared.
        axis: usize,
        /// The places.
        places: [usize; 2],
    },
    /// A range of places was parted.
    Halved {
        /// The axis whose keys were compared.
        axis: usize,
        /// First place and the one after the last.
        places: [usize; 2],
        /// Where the right part begins.
        middle: usize,
    },
    /// A binary search has compared the keys at a place.
    Compare {
        /// The place.
        place: usize,
    },
    /// The places of a cell's particles are known.
    Found {
        /// Column and row.
        cell: [u32; 2],
        /// First place and the one after the last.
        places: [usize; 2],
    },
    /// A node of the tree was visited.
    Node {
        /// The node.
        node: u32,
        /// The half to go on to; none if both are taken.
        half: Option<usize>,
    },
    /// A node was made.
    Made {
        /// The node.
        node: u32,
        /// Its parent.
        parent: u32,
        /// Which half of it.
        half: usize,
    },
    /// The particle was put on the list of a leaf, before the one that was first.
    Leaf {
        /// The node that holds the head.
        node: u32,
        /// In which of its places.
        half: usize,
        /// Column and row.
        cell: [u32; 2],
        /// The particle.
        particle: u32,
        /// The one that was first.
        next: Option<u32>,
    },
    /// A descent to a cell has ended.
    Descended {
        /// Column and row.
        cell: [u32; 2],
        /// The first particle there.
        first: Option<u32>,
    },
}

/// A part of an algorithm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// All particles are put on y-lists.
    Rows,
    /// This row is central: its particles, and those of the row below, are put on x-lists.
    CentralRow {
        /// The row.
        row: u32,
    },
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
    /// All particles are put into the tree.
    Tree {
        /// How often each axis is halved.
        halvings: u32,
    },
    /// The tree is walked over, from leaf to leaf.
    Walk,
}

/// Column and row of a cell.
#[inline(always)]
pub fn plane<const D: usize>(cell: [u32; D]) -> [u32; 2] {
    std::array::from_fn(|k| cell.get(k).copied().unwrap_or(0))
}
