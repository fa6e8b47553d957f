//! The ways to be wrong, each one mistake that somebody has made or could make.

use contactbench::detect::book::mask;

ways! {
    // Particles.
    /// The last particle is left out.
    DropsLastElement,
    /// The first particle is left out.
    DropsFirstElement,
    /// Particles of radius 0 are left out.
    DropsPoints,
    /// Particle numbers are kept in a byte.
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
    /// Across cells a pair is tested only where i < j.
    OrderedAcross,
    /// A particle that has a contact is not tested further.
    OneContactEach,
    /// A particle keeps so many contacts, as in a table of neighbours.
    ContactsEach(usize) in [32, 100],
    /// What is in neighbouring cells is reported untested.
    Untested,

    // The contact test.
    /// < instead of <=.
    Strict,
    /// A rounded root: sqrt(d²) <= ri + rj in f64.
    RoundedRoot,
    /// |p|² + |q|² - 2p·q in f64.
    ExpandedForm,
    /// Differences of coordinates that were rounded to f32.
    SinglePrecisionTest,
    /// d² <= s²(1 + 10^-12).
    RelativeTolerance,
    /// d <= s + 10^-9.
    AbsoluteTolerance,
    /// ri² + rj² for (ri + rj)².
    SumOfSquares,
    /// The largest radius for all.
    LargestRadius,
    /// Particles at one place are taken for one particle.
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
    /// The edge is the largest diameter, also where rounding accepts more.
    EdgeWithoutSlack,

    // The number of a cell.
    /// Int(x / d) without the origin, as an unsigned number: -1 is 2^32 - 1, and not beside 0.
    Unsigned,
    /// Numbers in f32, from the origin.
    SinglePrecisionCells,
    /// Numbers in f32, from zero.
    SinglePrecisionFromZero,
    /// Numbers are kept in so many bits; those of neighbours are not wrapped.
    Bits(u32) in [8, 16, 21],
    /// Which cells are done is kept by numbers of so many bits.
    DoneByBits(u32) in [16, 21],
    /// Numbers are the bits of a double, so that 0 and -0 differ.
    ZerosDiffer,
    /// No domain is refused, however many cells it has.
    NeverRefuses,

    // Visiting cells.
    /// The last cell along this axis (0: x, 1: the last one) is not visited.
    LastUnvisited(usize) in [0, 1],
    /// The first cell along this axis is not looked at as a neighbour.
    FirstUnseen(usize) in [0, 1],
    /// In this dimension, cell k of the mask is left out.
    MaskWithout([usize; 2]) in masks(),
    /// In this dimension, cell k of the mask is the mirror of the cell after it.
    MaskRepeats([usize; 2]) in masks(),

    // Capacity.
    /// At most so many particles in a cell.
    Capacity(usize) in [32, 100, 256, 1024],
    /// The number of particles in a cell is kept in a byte.
    ByteCount,

    // State.
    /// Lists are not emptied.
    StaleLists,
    /// Where N is as before, the grid is.
    StaleGrid,
    /// Where N is as before, cell numbers are.
    StaleNumbers,
    /// Where N and the box are as before, the pairs are.
    StalePairs,
    /// The largest diameter is that of the first call.
    StaleReach,

    // The hash.
    /// Particles of all cells in a bucket are taken for those of the cell looked for.
    BucketsUncompared,
    /// A bucket holds the cell that came first, other cells are lost.
    BucketsOfOneCell,

    // The sweep.
    /// It stops where the second coordinates are too far apart.
    BreakOnWrongAxis,
    /// It stops at particles exactly at reach.
    BreakAtReach,
    /// It looks at so many particles that follow.
    Window(usize) in [32],
    /// Its order is that of x in f32.
    SinglePrecisionOrder,
    /// It stops by a difference in f32.
    SinglePrecisionBreak,
    ;

    // Changes that look wrong and are not.
    /// The grid, right.
    Grid,
    /// The spatial hash, right.
    Hash,
    /// The sweep along x, right.
    Sweep,
    /// Cell k of the mask is replaced by its mirror: the pair of cells comes up from the other
    /// side.
    Mirrored([usize; 2]) in masks(),
    /// Numbers of so many bits, neighbours wrapped, too: a torus, on which distant cells share a
    /// list and are told apart by the test.
    Torus(u32) in [8, 21],
    /// Numbers above this are taken for it: particles of far cells share the last one.
    Clamped(i64) in [40],
}

impl Way {
    /// The algorithm that is changed: [`Way::Grid`], [`Way::Hash`] or [`Way::Sweep`].
    pub fn algorithm(self) -> Way {
        use Way::*;
        match self {
            Hash | BucketsUncompared | BucketsOfOneCell => Hash,
            Sweep | BreakOnWrongAxis | BreakAtReach | Window(_) | SinglePrecisionOrder
            | SinglePrecisionBreak => Sweep,
            _ => Grid,
        }
    }

    /// The dimension in which it differs from its algorithm, if it is only one.
    pub fn dim(self) -> Option<usize> {
        match self {
            Way::MaskWithout([dim, _]) | Way::MaskRepeats([dim, _]) | Way::Mirrored([dim, _]) => {
                Some(dim)
            }
            _ => None,
        }
    }
}

/// The cells of the masks: dimension and place.
fn masks() -> impl Iterator<Item = [usize; 2]> {
    let cells = |dim, len| (0..len).map(move |k| [dim, k]);
    cells(2, mask::PLANE.len()).chain(cells(3, mask::SPACE.len()))
}
