//! `settled`: particles placed one after the other, the largest first, with a limit on overlaps.
//!
//! ```text
//!   +------------------+
//!   |  .---.  o   . o  |
//!   | /     \ .  .--.  |      the large ones find room while there is much of it,
//!   | \     / o |    | |      the small ones fill what is left
//!   |  '---' .   '--' .|
//!   +------------------+
//! ```
//!
//! This is random sequential addition (Feder 1980, doi:10.1016/0022-5193(80)90358-6) by falling
//! radius. Centres are uniform in a square or cube with a corner at the origin, whose volume is
//! that of all particles over `fraction`. A centre is drawn again if the particle would overlap an
//! earlier one (or its image in a periodic box) by more than `overlap` of the sum of their radii,
//! as computed in f64. Particles may extend over the border.
//!
//! Without overlap, one size fills up to about 0.54 of a square and 0.38 of a cube; several sizes
//! fill more. The generator fails after 100,000 draws for one particle, or 1,000 draws per particle
//! on average, and reports the fraction reached. It also fails if the largest particle would
//! overlap its own image by more than allowed.

use anyhow::ensure;

use crate::generate::boxes::{Repeats, boxed};
use crate::generate::draw::Draw;
use crate::generate::sizes::unit_radii;
use crate::generate::table::{Generator, ParameterKind, parameter};
use crate::generate::{Inputs, OF_PARTICLES, assemble, box_edge, fraction, room};
use contactbench_ground::scene::{AnyScene, Scene};
use contactbench_io::Given;

pub const GENERATOR: Generator = Generator {
    name: "settled",
    summary: "random places with limited overlap, the largest particles first",
    params: &[
        OF_PARTICLES,
        &[
            fraction("0.3"),
            parameter(
                "overlap",
                ParameterKind::SHARE,
                "0.05",
                "largest overlap of two particles, over the sum of their radii",
            ),
        ],
    ],
    make: |inputs| if inputs.dim == 2 { make::<2>(inputs) } else { make::<3>(inputs) },
    ..Generator::PLAIN
};

/// Maximum number of draws: for one particle, then per particle on average.
const TRIES: u64 = 100_000;
const TRIES_EACH: u64 = 1_000;
/// Ratio of the largest radius of a layer to that of the next.
const STEP: f64 = 2.0;
/// Maximum number of cells of a layer, per particle.
const CELLS: f64 = 4.0;
const NONE: u32 = u32::MAX;

fn make<const D: usize>(inputs: &Inputs<'_>) -> anyhow::Result<Given>
where
    AnyScene<'static>: From<Scene<'static, f64, D>>,
{
    let mut draw = Draw::new(inputs.seed);
    let mut radii = unit_radii(inputs, &mut draw)?;
    if let Some(radii) = &mut radii {
        radii.sort_by(|a, b| b.total_cmp(a));
    }
    let fraction = inputs.number("fraction")?;
    let edge = box_edge::<D>(inputs.n, radii.as_deref(), fraction);
    let repeats = Repeats::new(inputs)?.filter(|repeats| repeats.axes != [false; 3]);
    let mut placed = Placed::<D> {
        edge,
        repeats,
        apart: 1.0 - inputs.number("overlap")?,
        centres: room(inputs.n)?,
        next: room(inputs.n)?,
        layers: Vec::new(),
    };
    // The largest diameter is 1, so only images in adjacent boxes can be too near.
    ensure!(
        repeats.is_none() || inputs.n == 0 || edge >= placed.apart,
        "the largest particle overlaps its own image: the edge is {edge:.3} of its diameters"
    );
    let mut images = Vec::new();
    let mut drawn = 0;
    for k in 0..inputs.n {
        let radius = |k: u64| radii.as_ref().map_or(0.5, |radii| radii[k as usize]);
        if placed.layers.last().is_none_or(|layer| radius(k) * STEP <= layer.largest) {
            let of_layer = |&other: &u64| radius(other) * STEP > radius(k);
            placed.begin(radius(k), (k..inputs.n).take_while(of_layer).count())?;
        }
        let mut tries = 0;
        loop {
            let centre = [(); D].map(|()| edge * draw.unit());
            placed.images(centre, radius(k), &mut images);
            let other = |other| radius(u64::from(other));
            if images.iter().all(|&image| placed.has_room(image, radius(k), other)) {
                placed.put(centre);
                break;
            }
            tries += 1;
            drawn += 1;
            ensure!(
                tries < TRIES && drawn < TRIES + TRIES_EACH * inputs.n,
                "no room for particle {k} after {tries} draws: {:.3} is filled, of {fraction}",
                fraction * volume::<D>((0..k).map(radius)) / volume::<D>((0..inputs.n).map(radius))
            );
        }
    }
    let centres = placed.centres.into_iter();
    boxed(inputs, assemble(inputs, centres, radii)?, [edge; D])
}

/// Returns the sum of the particles' volumes, in volumes of a ball of radius 1.
fn volume<const D: usize>(radii: impl Iterator<Item = f64>) -> f64 {
    radii.map(|r| if D == 2 { r * r } else { r * r * r }).sum()
}

/// The placed particles, in one grid with linked lists for each layer (class of sizes).
struct Placed<const D: usize> {
    edge: f64,
    repeats: Option<Repeats>,
    /// Least allowed distance of two particles, in units of the sum of their radii.
    apart: f64,
    centres: Vec<[f64; D]>,
    /// For each particle, the next one in its cell.
    next: Vec<u32>,
    layers: Vec<Layer>,
}

/// The grid of particles with radii from `largest` down to about half of it.
struct Layer {
    largest: f64,
    count: usize,
    /// The particle of each cell that was placed last.
    heads: Vec<u32>,
}

impl<const D: usize> Placed<D> {
    /// Begins a layer whose grid has cells for about `particles` particles.
    fn begin(&mut self, largest: f64, particles: usize) -> anyhow::Result<()> {
        // Cells are a little wider than two radii, so that rounding does not matter.
        let fine = self.edge / (2.000_002 * largest);
        let most = CELLS * particles.max(1) as f64;
        let coarse = if D == 2 { most.sqrt() } else { libm::cbrt(most) };
        let count = fine.min(coarse).max(1.0) as usize;
        let cells = count.pow(D as u32);
        let mut heads = room(cells as u64)?;
        heads.resize(cells, NONE);
        self.layers.push(Layer { largest, count, heads });
        Ok(())
    }

    /// Finds the particle and those of its images that may be too near to a particle in the box.
    fn images(&self, centre: [f64; D], radius: f64, images: &mut Vec<[f64; D]>) {
        images.clear();
        images.push(centre);
        let Some(Repeats { axes, tilt }) = self.repeats else { return };
        let largest = self.layers.first().map_or(0.0, |layer| layer.largest);
        let reach = self.reach(radius, largest);
        // The axis x is last, because images along y are shifted along x.
        for k in (0..D).rev().filter(|&k| axes[k]) {
            for there in 0..images.len() {
                for side in [-1.0, 1.0] {
                    let mut image = images[there];
                    image[k] += side * self.edge;
                    if !(-reach..=self.edge + reach).contains(&image[k]) {
                        continue;
                    }
                    if let (1, Some(tilt)) = (k, tilt) {
                        image[0] += side * tilt * self.edge;
                        if axes[0] {
                            image[0] -= self.edge * (image[0] / self.edge).floor();
                        }
                    }
                    images.push(image);
                }
            }
        }
    }

    /// Returns a distance at which two particles of these radii are never too near.
    fn reach(&self, radius: f64, largest: f64) -> f64 {
        1.000_001 * self.apart * (radius + largest)
    }

    fn has_room(&self, centre: [f64; D], radius: f64, other: impl Fn(u32) -> f64) -> bool {
        self.apart == 0.0
            || self.layers.iter().all(|layer| {
                let reach = self.reach(radius, layer.largest);
                if !centre.iter().all(|x| (-reach..=self.edge + reach).contains(x)) {
                    return true;
                }
                let [low, high] = [-1_isize, 1].map(|step| {
                    centre.map(|x| {
                        layer.cell(x / self.edge).saturating_add_signed(step).min(layer.count - 1)
                    })
                });
                let mut cell = low;
                loop {
                    let mut body = layer.heads[layer.place(&cell)];
                    while body != NONE {
                        let sum = self.apart * (radius + other(body));
                        let square: f64 = self.centres[body as usize]
                            .iter()
                            .zip(centre)
                            .map(|(x, y)| (x - y) * (x - y))
                            .sum();
                        if square < sum * sum {
                            return false;
                        }
                        body = self.next[body as usize];
                    }
                    let Some(k) = (0..D).find(|&k| cell[k] < high[k]) else { return true };
                    cell[k] += 1;
                    cell[..k].copy_from_slice(&low[..k]);
                }
            })
    }

    fn put(&mut self, centre: [f64; D]) {
        let body = self.centres.len() as u32;
        let Some(layer) = self.layers.last_mut() else { return };
        let place = layer.place(&centre.map(|x| layer.cell(x / self.edge)));
        self.next.push(std::mem::replace(&mut layer.heads[place], body));
        self.centres.push(centre);
    }
}

impl Layer {
    /// Returns the index of the cell at the fraction `part` of the edge.
    fn cell(&self, part: f64) -> usize {
        ((part * self.count as f64) as usize).min(self.count - 1)
    }

    fn place(&self, cell: &[usize]) -> usize {
        cell.iter().rev().fold(0, |place, k| place * self.count + k)
    }
}
