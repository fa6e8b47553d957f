//! Realised statistics.
