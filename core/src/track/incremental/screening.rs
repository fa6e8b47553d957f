//! `incremental(screening)`: the list of every cell stays.
//!
//! Memory: `4(nx·ny[·nz] + 4N)` bytes, where the number of a cell takes eight.

use super::lists::{Lists, Standing};
use crate::contact::Bodies;
use crate::detect::Refusal;
use crate::detect::book::list::{Heads, Links};
use crate::detect::book::mask;
use crate::detect::book::screening::{Screening, offsets};
use crate::filter::Cells;
use crate::probe::Probe;
use crate::scene::Real;
use crate::sink::Sink;

pub(super) type Plane = Standing<Screening, 2, 1>;
pub(super) type Space = Standing<Screening, 3, 1>;

macro_rules! lists_of_cells {
    ($dim:literal, $mask:expr) => {
        impl Lists<$dim, 1> for Screening {
            const NAME: &'static str = "incremental(screening)";
            type List = usize;

            fn list(cells: &Cells<$dim>, position: [f64; $dim], probe: &mut impl Probe) -> usize {
                cells.place(position, probe)
            }

            fn bytes(cells: &Cells<$dim>, n: usize) -> u64 {
                Screening::bytes(cells, n)
            }

            fn prepare(&mut self, cells: &Cells<$dim>, n: usize) -> Result<(), Refusal> {
                self.prepare(cells, n)
            }

            fn lists(&mut self) -> (&mut Heads, &mut Links<1>) {
                self.lists()
            }

            fn search<T: Real>(
                &mut self,
                bodies: &impl Bodies<T, $dim>,
                cells: &Cells<$dim>,
                cell: usize,
                first: u32,
                probe: &mut impl Probe,
                sink: &mut impl Sink,
            ) {
                self.check(bodies, cell, first, offsets(cells, $mask), probe, sink);
            }
        }
    };
}

lists_of_cells!(2, mask::PLANE);
lists_of_cells!(3, mask::SPACE);
