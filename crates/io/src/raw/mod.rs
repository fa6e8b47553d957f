//! Bytes of a file as lines, words and numbers, whatever the format.

pub(super) mod gzip;
pub(super) mod lines;
pub(super) mod room;
pub(super) mod scalars;
