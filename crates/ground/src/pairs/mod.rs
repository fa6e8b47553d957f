//! Receivers of pairs, lists with a limit, and the order of lists.

pub mod normalise;
pub mod pair_list;
pub mod sink;
