//! The mistakes of the mutants, each made in some code or easy to make.

use contactbench_core::detect::book::mask;

ways! {
    // Particles.
    /// The last particle is left out.
    DropsLastElement,
    /// The first particle is left out.
    DropsFirstElement,
    /// Particles of radius 0 are left out.
    DropsPoints,
    /// Particle numbers are stored in a byte.
    ByteElements,

    // Pairs.
    /// The last pair found is not reported.
    DropsLastPair,
    /// The last pair found is reported twice.
    RepeatsLastPair,
    /// A particle is tested against itself.
    SelfPairs,
    /// Within a cell each pair is tested from both sides.
    BothOrders,
    /// All neighbouring cells are visited, not half of them.
    FullMask,
    /// Across cells a pair is tested only if i < j.
    OrderedAcross,
    /// A particle with a contact is not tested again.
    OneContactEach,
    /// A particle keeps at most this many contacts.
    ContactsEach(usize) in [32, 100],
    /// Particles in neighbouring cells are reported untested.
    Untested,

    // The contact test.
    /// Contacts are tested with < instead of <=.
    Strict,
    /// A rounded root: sqrt(d²) <= ri + rj in f64.
    RoundedRoot,
    /// |p|² + |q|² - 2p·q in f64.
    ExpandedForm,
    /// Differences of coordinates rounded to f32.
    SinglePrecisionTest,
    /// d² <= s²(1 + 10^-12).
    RelativeTolerance,
    /// d <= s + 10^-9.
    AbsoluteTolerance,
    /// ri² + rj² instead of (ri + rj)².
    SumOfSquares,
    /// All particles get the largest radius.
    LargestRadius,
    /// Particles at one place count as one.
    SkipsCoincident,

    // The size of a cell.
    /// The book's cells, without a margin.
    NoMargin,
    /// The edge is the first particle's diameter.
    EdgeOfFirst,
    /// The edge is the last particle's diameter.
    EdgeOfLast,
    /// The edge is the mean diameter.
    EdgeOfMean,
    /// The edge is the largest radius.
    EdgeHalved,
    /// The edge is the largest diameter, although rounding accepts more.
    EdgeWithoutSlack,

    // The number of a cell.
    /// Cell numbers are int(x / d) without the origin, and unsigned: -1 becomes 2^32 - 1, which is
    /// not beside 0.
    Unsigned,
    /// Cell numbers are computed in f32, from the origin.
    SinglePrecisionCells,
    /// Cell numbers are computed in f32, from zero.
    SinglePrecisionFromZero,
    /// Cell numbers have this many bits; those of neighbours are not wrapped.
    Bits(u32) in [8, 16, 21],
    /// Cells are marked as done by numbers of this many bits.
    DoneByBits(u32) in [16, 21],
    /// Cell numbers are the bits of a double, so that 0 and -0 differ.
    ZerosDiffer,
    /// Grids with any number of cells are accepted.
    NeverRefuses,

    // Visiting cells.
    /// The last cell along this axis (0: x, 1: the last one) is not visited.
    LastUnvisited(usize) in [0, 1],
    /// The first cell along this axis is not tested as a neighbour.
    FirstUnseen(usize) in [0, 1],
    /// In this dimension, cell k of the mask is left out.
    MaskWithout([usize; 2]) in masks(),
    /// In this dimension, cell k of the mask is the mirror of the cell after it.
    MaskRepeats([usize; 2]) in masks(),

    // Capacity.
    /// A cell holds at most this many particles.
    Capacity(usize) in [32, 100, 256, 1024],
    /// The number of particles in a cell is stored in a byte.
    ByteCount,

    // State.
    /// Lists of an earlier call are not emptied.
    StaleLists,
    /// The grid is kept if N is unchanged.
    StaleGrid,
    /// Cell numbers are kept if N is unchanged.
    StaleNumbers,
    /// Pairs are kept if N and the box are unchanged.
    StalePairs,
    /// The largest diameter is that of the first call.
    StaleReach,

    // The hash.
    /// All particles in a bucket count as those of the wanted cell.
    BucketsUncompared,
    /// A bucket keeps the list of its first cell only.
    BucketsOfOneCell,

    // The sweep.
    /// The sweep stops if the second coordinates are too far apart.
    BreakOnWrongAxis,
    /// The sweep stops at particles exactly at reach.
    BreakAtReach,
    /// The sweep tests only this many following particles.
    Window(usize) in [32],
    /// The sweep sorts by x in f32.
    SinglePrecisionOrder,
    /// The sweep stops if a difference computed in f32 exceeds the reach.
    SinglePrecisionBreak,
    ;

    // Changes that look wrong but are not.
    /// The unchanged grid.
    Grid,
    /// The unchanged spatial hash.
    Hash,
    /// The unchanged sweep along x.
    Sweep,
    /// Cell k of the mask is replaced by its mirror.
    Mirrored([usize; 2]) in masks(),
    /// Cell numbers have this many bits and wrap, so that distant cells share a list.
    Torus(u32) in [8, 21],
    /// Cell numbers above this one are clamped to it.
    Clamped(i64) in [40],
}

impl Way {
    /// Returns the changed algorithm: [`Way::Grid`], [`Way::Hash`] or [`Way::Sweep`].
    pub fn algorithm(self) -> Way {
        use Way::*;
        match self {
            Hash | BucketsUncompared | BucketsOfOneCell => Hash,
            Sweep | BreakOnWrongAxis | BreakAtReach | Window(_) | SinglePrecisionOrder
            | SinglePrecisionBreak => Sweep,
            _ => Grid,
        }
    }

    /// Returns the dimension in which this way differs from its algorithm, if only one.
    pub fn dim(self) -> Option<usize> {
        match self {
            Way::MaskWithout([dim, _]) | Way::MaskRepeats([dim, _]) | Way::Mirrored([dim, _]) => {
                Some(dim)
            }
            _ => None,
        }
    }
}

/// Iterates over the cells of the masks: dimension and place.
fn masks() -> impl Iterator<Item = [usize; 2]> {
    let cells = |dim, len| (0..len).map(move |k| [dim, k]);
    cells(2, mask::PLANE.len()).chain(cells(3, mask::SPACE.len()))
}
