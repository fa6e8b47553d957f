//! `incremental(nbs)`: the y-lists of Munjiza-NBS stay (in space the z-lists); its x-lists (and
//! y-lists) are of one row, and are made and emptied as they always are.
//!
//! Memory: `4(ny + 2nx + 4N)` bytes in 2D, `4(nz + 2ny + 2nx + 5N)` in 3D.

use super::lists::{Lists, Standing};
use crate::contact::Bodies;
use crate::detect::Refusal;
use crate::detect::book::list::{Heads, Links};
use crate::detect::book::nbs2d::Nbs2d;
use crate::detect::book::nbs3d::Nbs3d;
use crate::filter::Cells;
use crate::probe::Probe;
use crate::scene::Real;
use crate::sink::Sink;

pub(super) type Plane = Standing<Nbs2d, 2, 2>;
pub(super) type Space = Standing<Nbs3d, 3, 3>;

impl Lists<2, 2> for Nbs2d {
    const NAME: &'static str = "incremental(nbs)";
    type List = u32;

    fn list(cells: &Cells<2>, position: [f64; 2], probe: &mut impl Probe) -> u32 {
        cells.index(position[1], 1, probe)
    }

    fn bytes(cells: &Cells<2>, n: usize) -> u64 {
        Nbs2d::bytes(cells, n)
    }

    fn prepare(&mut self, cells: &Cells<2>, n: usize) -> Result<(), Refusal> {
        self.prepare(cells, n)
    }

    fn lists(&mut self) -> (&mut Heads, &mut Links<2>) {
        self.lists()
    }

    fn search<T: Real>(
        &mut self,
        bodies: &impl Bodies<T, 2>,
        cells: &Cells<2>,
        row: usize,
        first: u32,
        probe: &mut impl Probe,
        sink: &mut impl Sink,
    ) {
        self.row(bodies, cells, first, row as u32, probe, sink);
    }
}

impl Lists<3, 3> for Nbs3d {
    const NAME: &'static str = "incremental(nbs)";
    type List = u32;

    fn list(cells: &Cells<3>, position: [f64; 3], probe: &mut impl Probe) -> u32 {
        cells.index(position[2], 2, probe)
    }

    fn bytes(cells: &Cells<3>, n: usize) -> u64 {
        Nbs3d::bytes(cells, n)
    }

    fn prepare(&mut self, cells: &Cells<3>, n: usize) -> Result<(), Refusal> {
        self.prepare(cells, n)
    }

    fn lists(&mut self) -> (&mut Heads, &mut Links<3>) {
        self.lists()
    }

    fn search<T: Real>(
        &mut self,
        bodies: &impl Bodies<T, 3>,
        cells: &Cells<3>,
        layer: usize,
        first: u32,
        probe: &mut impl Probe,
        sink: &mut impl Sink,
    ) {
        self.layer(bodies, cells, first, layer as u32, probe, sink);
    }
}
