//! The option `--memory-limit`.

use crate::cli::shared::values;
use contactbench_ground::limits::memory;

#[derive(clap::Args, Clone, Copy, Debug)]
pub struct Limit {
    /// Memory, as in 2GiB [default: 256MiB to 4GiB, by N]
    #[arg(long, value_name = "SIZE", value_parser = values::bytes)]
    memory_limit: Option<u64>,
}

impl Limit {
    /// Returns the limit for a scene with this number of particles.
    pub fn bytes(&self, particles: usize) -> u64 {
        self.memory_limit.unwrap_or_else(|| memory::limit_for(particles))
    }
}
