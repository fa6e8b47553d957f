//! The counted operations.

crate::named! {
    /// An elementary operation of contact detection.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    #[repr(usize)]
    pub enum Op {
        /// Conversion of one coordinate of one particle to a cell index.
        Integerise = "integerise",
        /// Insertion of a particle into a list.
        ListPush = "list_push",
        /// Step from one particle of a list to the next; reaching the end is not counted.
        ListStep = "list_step",
        /// Reset of a list head or link to "empty".
        ListReset = "list_reset",
        /// Test whether a cell or list is empty or already visited.
        CellProbe = "cell_probe",
        /// Look-up of the cells of a size class that is not the particle's.
        LevelProbe = "level_probe",
        /// Comparison of two keys (integer coordinates) in a sort or a search.
        KeyCompare = "key_compare",
        /// Step of a binary search, which halves a range; also counted as `key_compare`.
        SearchStep = "search_step",
        /// Visit of a tree node.
        NodeVisit = "node_visit",
        /// Move of a particle by a sort.
        Move = "move",
        /// Test of two bounding volumes, except those of single particles.
        BoundTest = "bound_test",
        /// Contact test of two particles.
        ContactTest = "contact_test",
        /// Contact test that needed exact arithmetic because floating point could not decide; also
        /// counted as `contact_test`.
        ExactTest = "exact_test",
        /// Creation of a periodic image of a particle.
        GhostMade = "ghost_made",
        /// Exchange of two neighbours by an insertion sort that repairs the order of an earlier
        /// frame.
        Swap = "swap",
        /// Move of a particle from its list in an earlier frame to another list; also counted as
        /// `list_push`.
        Reinsert = "reinsert",
        /// Update of a bounding box from an earlier frame, because a particle left the box or a box
        /// inside it grew.
        Refit = "refit",
    }
}
