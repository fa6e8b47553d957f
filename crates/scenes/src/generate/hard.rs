//! `hard`: a case of the hard-case catalogue, [`crate::hard`].
//!
//! ```text
//!   case = every-neighbour   ->   o|o   o/o  ...
//! ```
//!
//! The case decides the number of particles. n = 0 accepts any number; another n must equal the
//! case's number. The scene is the last step; [`crate::spec::Spec::history`] returns the steps
//! before it. If the order of the particles matters, `order = generated` keeps it.

use crate::generate::Inputs;
use crate::generate::table::{Generator, ParameterKind, REQUIRED, parameter};
use crate::hard;
use contactbench_io::Given;

pub const NAME: &str = "hard";

pub const GENERATOR: Generator = Generator {
    name: NAME,
    summary: "a named case on which detectors go wrong; contactbench list hard-cases",
    own_n: true,
    params: &[&[parameter("case", ParameterKind::Case, REQUIRED, "the name of the case")]],
    make: |inputs| {
        let Some(given) = steps(inputs)?.pop() else {
            anyhow::bail!("the hard case '{}' has no steps", inputs.text("case")?)
        };
        inputs.own_n(given)
    },
    ..Generator::PLAIN
};

pub fn steps(inputs: &Inputs<'_>) -> anyhow::Result<Vec<Given>> {
    hard::find(inputs.text("case")?)?.steps(inputs.dim)
}
