//! How much memory a verb may take.

use crate::cli::shared::values;
use contactbench_core::memory;

/// The memory limit.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct Limit {
    /// Most bytes for a detector's arrays, and for a list of pairs, as in 4GiB (default: 16 KiB
    /// for each particle, at least 256 MiB, at most 4 GiB or a quarter of the machine's memory)
    #[arg(long, value_parser = values::bytes)]
    memory_limit: Option<u64>,
}

impl Limit {
    /// For a scene of so many particles.
    pub fn bytes(&self, particles: usize) -> u64 {
        self.memory_limit.unwrap_or_else(|| memory::limit_for(particles))
    }
}
