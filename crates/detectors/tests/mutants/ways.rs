//! The mistakes of the mutants, each made in some code or easy to make.

use contactbench_detectors::book::mask;

ways! {
    // Mistakes with particles.
    /// The last particle is left out.
    DropsLastElement,
    /// The first particle is left out.
    DropsFirstElement,
    /// Particles of radius 0 are left out.
    DropsPoints,
    /// Particle numbers are stored in a byte.
    ByteElements,

    // Mistakes with pairs.
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

    // Mistakes in the contact test.
    /// Contacts are tested with < instead of <=.
    Strict,
    /// The test is sqrt(d²) <= ri + rj in f64, with a rounded root.
    RoundedRoot,
    /// Squared distances are computed as |p|² + |q|² - 2p·q in f64.
    ExpandedForm,
    /// Coordinates are rounded to f32 before the test.
    SinglePrecisionTest,
    /// The test has a relative tolerance: d² <= s²(1 + 10^-12), s = ri + rj.
    RelativeTolerance,
    /// The test has an absolute tolerance: d <= ri + rj + 10^-9.
    AbsoluteTolerance,
    /// The limit on the squared distance is ri² + rj² instead of (ri + rj)².
    SumOfSquares,
    /// All particles get the largest radius.
    LargestRadius,
    /// Particles with the same centre are not in contact.
    SkipsCoincident,

    // Mistakes in the edge of a cell.
    /// Cells have no margin for rounding, like those of the book.
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

    // Mistakes in the number of a cell.
    /// Cell numbers are int(x / d) without the origin, and unsigned: -1 becomes 2^32 - 1, which is
    /// not beside 0.
    Unsigned,
    /// Cell numbers are computed in f32, from the origin.
    SinglePrecisionCells,
    /// Cell numbers are computed in f32, from zero.
    SinglePrecisionFromZero,
    /// Cell numbers have this many bits; those of neighbours are not wrapped.
    Bits(u32) in [8, 16, 21],
    /// Visited cells are marked by cell numbers of this many bits.
    DoneByBits(u32) in [16, 21],
    /// Cell numbers are the bits of a double, so that 0 and -0 differ.
    ZerosDiffer,
    /// Grids with any number of cells are accepted.
    NeverRefuses,

    // Mistakes in visiting cells.
    /// The last cell along this axis (0: x, 1: the last axis) is not visited.
    LastUnvisited(usize) in [0, 1],
    /// The first cell along this axis is not tested as a neighbour.
    FirstUnseen(usize) in [0, 1],
    /// In 2D or 3D, as given, cell k of the mask is left out.
    MaskWithout([usize; 2]) in masks(),
    /// In 2D or 3D, as given, cell k of the mask is the mirror of the cell after it.
    MaskRepeats([usize; 2]) in masks(),

    // Limits of capacity.
    /// A cell holds at most this many particles.
    Capacity(usize) in [32, 100, 256, 1024],
    /// The number of particles in a cell is stored in a byte.
    ByteCount,

    // Mistakes with state of earlier calls.
    /// Lists of an earlier call are not emptied.
    StaleLists,
    /// The grid of the last call is kept if N is unchanged.
    StaleGrid,
    /// Cell numbers of the last call are kept if N is unchanged.
    StaleNumbers,
    /// Pairs of the last call are kept if N and the grid are unchanged.
    StalePairs,
    /// The reach is that of the first call.
    StaleReach,

    // Mistakes in the spatial hash.
    /// All particles in a bucket count as those of the wanted cell.
    BucketsUncompared,
    /// A bucket keeps the list of its first cell only.
    BucketsOfOneCell,

    // Mistakes in the sweep.
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
    /// In 2D or 3D, as given, cell k of the mask is replaced by its mirror.
    Mirrored([usize; 2]) in masks(),
    /// Cell numbers have this many bits and wrap, so that distant cells share a list.
    Torus(u32) in [8, 21],
    /// Cell numbers above this one are clamped to it.
    Clamped(i64) in [40],
}

impl Way {
    /// Returns the algorithm that is changed: [`Way::Grid`], [`Way::Hash`] or [`Way::Sweep`].
    pub fn algorithm(self) -> Way {
        use Way::*;
        match self {
            Hash | BucketsUncompared | BucketsOfOneCell => Hash,
            Sweep | BreakOnWrongAxis | BreakAtReach | Window(_) | SinglePrecisionOrder
            | SinglePrecisionBreak => Sweep,
            _ => Grid,
        }
    }

    /// Returns the dimension (2 or 3) to which the change is limited, if any.
    pub fn dim(self) -> Option<usize> {
        match self {
            Way::MaskWithout([dim, _]) | Way::MaskRepeats([dim, _]) | Way::Mirrored([dim, _]) => {
                Some(dim)
            }
            _ => None,
        }
    }
}

/// Iterates over all cells of the contact masks: the dimension and the index in the mask.
fn masks() -> impl Iterator<Item = [usize; 2]> {
    let cells = |dim, len| (0..len).map(move |k| [dim, k]);
    cells(2, mask::PLANE.len()).chain(cells(3, mask::SPACE.len()))
}
