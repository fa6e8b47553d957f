//! The elementary operations that are counted.

macro_rules! operations {
    ($($(#[$doc:meta])* $op:ident = $name:literal,)*) => {
        /// An elementary operation of contact detection.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(usize)]
        pub enum Op {
            $($(#[$doc])* $op,)*
        }

        impl Op {
            /// All operations, in the order of their indices.
            pub const ALL: [Op; [$($name),*].len()] = [$(Op::$op),*];

            /// The name used in records and claims.
            pub fn name(self) -> &'static str {
                match self {
                    $(Op::$op => $name,)*
                }
            }
        }
    };
}

operations! {
    /// One coordinate of one particle turned into a cell index.
    Integerise = "integerise",
    /// A particle put on a list.
    ListPush = "list_push",
    /// A step from one particle of a list to the next (the step that finds the end is not counted).
    ListStep = "list_step",
    /// A head or a link set back to "empty".
    ListReset = "list_reset",
    /// A look at the head of a cell or list, to see whether it is empty or already visited.
    CellProbe = "cell_probe",
    /// A look at cells of another class of sizes than the body's own.
    LevelProbe = "level_probe",
    /// A comparison of two keys (integerised coordinates), in a sort or a search.
    KeyCompare = "key_compare",
    /// A visit to a node of a tree.
    NodeVisit = "node_visit",
    /// A particle moved by a sort.
    Move = "move",
    /// A test of two bounding volumes other than the bodies' own.
    BoundTest = "bound_test",
    /// A contact test of two bodies.
    ContactTest = "contact_test",
    /// A contact test that floating point could not decide and exact arithmetic did (also counted
    /// as a contact test).
    ExactTest = "exact_test",
    /// An image of a particle made, so that a periodic box becomes a scene.
    GhostMade = "ghost_made",
    /// Two neighbours exchanged by an insertion sort that repairs the order of an earlier frame.
    Swap = "swap",
    /// A particle taken out of the list of an earlier frame and put on another (also counted as put
    /// on a list).
    Reinsert = "reinsert",
    /// A box of an earlier frame made again, because bodies have left it or a box in it has grown.
    Refit = "refit",
}
