//! NNLS
