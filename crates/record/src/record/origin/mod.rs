//! The origin of rows: program, compiler, machine and hardware.

pub mod built;
pub mod hardware;
pub mod machines;
pub mod provenance;
