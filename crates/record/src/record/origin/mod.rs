//! Where rows come from: program, compiler, machine and hardware.

pub mod built;
pub mod hardware;
pub mod machines;
pub mod provenance;
