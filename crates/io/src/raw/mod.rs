//! Bytes of a file as lines, words and numbers, whatever the format.

pub(super) mod arrays;
pub(super) mod lines;
pub(super) mod room;
pub(super) mod scalars;
