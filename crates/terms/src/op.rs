//! The elementary operations that are counted.

/// An elementary operation of contact detection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Op {
    /// One coordinate of one particle turned into a cell index.
    Integerise,
    /// A particle put on a list.
    ListPush,
    /// A step from one particle of a list to the next (the step that finds the end is not counted).
    ListStep,
    /// A head or a link set back to "empty".
    ListReset,
    /// A look at the head of a cell or list, to see whether it is empty or already visited.
    CellProbe,
    /// A look at cells of another class of sizes than the body's own.
    LevelProbe,
    /// A comparison of two keys (integerised coordinates), in a sort or a search.
    KeyCompare,
    /// A visit to a node of a tree.
    NodeVisit,
    /// A particle moved by a sort.
    Move,
    /// A test of two bounding volumes other than the bodies' own.
    BoundTest,
    /// A contact test of two bodies.
    ContactTest,
    /// A contact test that floating point could not decide and exact arithmetic did (also counted
    /// as a contact test).
    ExactTest,
    /// An image of a particle made, so that a periodic box becomes a scene.
    GhostMade,
    /// Two neighbours exchanged by an insertion sort that repairs the order of an earlier frame.
    Swap,
    /// A particle taken out of the list of an earlier frame and put on another (also counted as put
    /// on a list).
    Reinsert,
    /// A box of an earlier frame made again, because bodies have left it or a box in it has grown.
    Refit,
}

impl Op {
    /// All operations, in the order of their indices.
    pub const ALL: [Op; 16] = [
        Op::Integerise,
        Op::ListPush,
        Op::ListStep,
        Op::ListReset,
        Op::CellProbe,
        Op::LevelProbe,
        Op::KeyCompare,
        Op::NodeVisit,
        Op::Move,
        Op::BoundTest,
        Op::ContactTest,
        Op::ExactTest,
        Op::GhostMade,
        Op::Swap,
        Op::Reinsert,
        Op::Refit,
    ];

    /// The name used in records and claims.
    pub fn name(self) -> &'static str {
        match self {
            Op::Integerise => "integerise",
            Op::ListPush => "list_push",
            Op::ListStep => "list_step",
            Op::ListReset => "list_reset",
            Op::CellProbe => "cell_probe",
            Op::LevelProbe => "level_probe",
            Op::KeyCompare => "key_compare",
            Op::NodeVisit => "node_visit",
            Op::Move => "move",
            Op::BoundTest => "bound_test",
            Op::ContactTest => "contact_test",
            Op::ExactTest => "exact_test",
            Op::GhostMade => "ghost_made",
            Op::Swap => "swap",
            Op::Reinsert => "reinsert",
            Op::Refit => "refit",
        }
    }
}
