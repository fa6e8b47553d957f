//! Fuzzing: any bytes describe a scene, often a hard one, on which detectors must be right.
//!
//! Random coordinates are never tangent and rarely near each other. So most particles are placed on
//! a lattice of small whole numbers, exactly a diameter from an earlier particle, or some units in
//! the last place from such a position. Few have arbitrary f64 coordinates, subnormal or huge. The
//! first four bytes apply to all particles:
//!
//! | byte | meaning |
//! |---|---|
//! | 0 | bit 0: 3D; bit 1: a radius per particle; bit 2: detectors keep buffers between calls |
//! | 1 | the unit, a power of two: mostly 2^-8 to 2^7, otherwise any |
//! | 2 | the offset of lattices from the origin, up to 15·2^60 units |
//! | 3 | the radius: 1/2 to 16 half units, one of some odd lengths, or 0 |
//!
//! After these four bytes, each particle has one byte that chooses how it is placed, and the bytes
//! that this method needs. Particles are added until the bytes end.

use crate::check::numbers::Numbers;
use contactbench_ground::scene::AnyScene;

const MOST: usize = 64;

/// Legs and hypotenuse of whole-number right triangles; those in a plane come first.
const PYTHAGOREAN: [([f64; 3], f64); 8] = [
    ([3.0, 4.0, 0.0], 5.0),
    ([5.0, 12.0, 0.0], 13.0),
    ([8.0, 15.0, 0.0], 17.0),
    ([20.0, 21.0, 0.0], 29.0),
    ([1.0, 2.0, 2.0], 3.0),
    ([2.0, 3.0, 6.0], 7.0),
    ([1.0, 4.0, 8.0], 9.0),
    ([2.0, 6.0, 9.0], 11.0),
];

type Bytes<'a> = std::iter::Copied<std::slice::Iter<'a, u8>>;

fn double(bytes: &mut Bytes<'_>) -> Option<f64> {
    let bits = (0..8).try_fold(0, |bits, k| Some(bits | u64::from(bytes.next()?) << (8 * k)))?;
    Some(f64::from_bits(bits))
}

struct Maker<'a> {
    bytes: Bytes<'a>,
    mixed: bool,
    unit: f64,
    offset: f64,
    radius: f64,
    numbers: Numbers,
}

#[derive(Clone, Copy)]
struct Next {
    /// The first byte of the particle. Its lowest three bits choose the method of placing it.
    how: u8,
    dim: usize,
    /// Position of the earlier particle beside which this one is placed, or the offset.
    beside: [f64; 3],
    /// Distance of the centres at which this particle and the earlier one just touch.
    contact: f64,
}

impl<'a> Maker<'a> {
    fn new(data: &'a [u8]) -> Option<Maker<'a>> {
        let mut bytes = data.iter().copied();
        let (form, unit, offset, radius) =
            (bytes.next()?, bytes.next()?, bytes.next()?, bytes.next()?);
        let unit =
            if unit < 200 { i32::from(unit % 16) - 8 } else { (i32::from(unit) - 200) * 38 - 1060 };
        let unit = libm::scalbn(1.0, unit);
        let offset = unit * libm::scalbn(f64::from(offset & 15), i32::from(offset >> 4) * 4);
        let radius = match radius {
            255 => 0.0,
            // These radii have a full mantissa, so that sums are rounded.
            192.. => unit * f64::from(radius) / 300.0,
            _ => unit * f64::from(radius % 32 + 1) * 0.5,
        };
        let numbers = Numbers { dim: 2 + usize::from(form & 1), values: Vec::new() };
        Some(Maker { bytes, mixed: form & 2 != 0, unit, offset, radius, numbers })
    }

    fn radius(&mut self) -> Option<f64> {
        if !self.mixed {
            return Some(self.radius);
        }
        let code = self.bytes.next()?;
        let last = self.numbers.values.last().copied().unwrap_or(self.radius);
        Some(match code % 8 {
            0..=2 => self.radius * [1.0, 0.5, 2.0][usize::from(code % 8)],
            3 => self.unit * f64::from(code / 8) * 0.25,
            4 => last,
            5 => nudged(last, i32::from(code / 8 % 7) - 3).max(0.0),
            6 => self.radius * libm::scalbn(1.0, i32::from(code / 8) - 16),
            _ if code == 255 => double(&mut self.bytes)?,
            _ => 0.0,
        })
    }

    fn particle(&mut self) -> Option<()> {
        let how = self.bytes.next()?;
        let radius = self.radius()?;
        let (dim, stride, n) = (self.numbers.dim, self.numbers.stride(), self.numbers.len());
        let mut next = Next { how, dim, beside: [self.offset; 3], contact: 2.0 * radius };
        if n > 0 && matches!(how % 8, 1 | 2 | 3 | 7) {
            let other = &self.numbers.values[usize::from(self.bytes.next()?) % n * stride..];
            next.beside[..dim].copy_from_slice(&other[..dim]);
            next.contact = radius + other[dim];
        }
        let mut place = self.place(next)?;
        if matches!(how % 8, 0 | 1 | 2 | 7) {
            let axis = usize::from(how >> 6) % dim;
            let steps = [0, 0, 0, 1, -1, 2, -2, 3][usize::from(how >> 3) % 8];
            place[axis] = nudged(place[axis], steps);
        }
        self.numbers.values.extend_from_slice(&place[..dim]);
        self.numbers.values.push(radius);
        Some(())
    }

    fn place(&mut self, Next { how, dim, beside, contact }: Next) -> Option<[f64; 3]> {
        let (offset, unit, diameter) = (self.offset, self.unit, 2.0 * self.radius);
        let signed = |size: f64, plus: bool| if plus { size } else { -size };
        match how % 8 {
            1 => {
                let (code, mut place) = (self.bytes.next()?, beside);
                place[usize::from(code / 2) % dim] += signed(contact, code & 1 == 0);
                Some(place)
            }
            2 => {
                let code = usize::from(self.bytes.next()?);
                let (legs, hypotenuse) = PYTHAGOREAN[code % if dim == 2 { 4 } else { 8 }];
                self.each(dim, |_, axis| {
                    // In 2D, the two legs may be swapped; in 3D, they rotate among the axes.
                    let step = legs[(axis + code / 64) % dim] * (contact / hypotenuse);
                    Some(beside[axis] + signed(step, code >> (3 + axis) & 1 == 0))
                })
            }
            3 => self.each(dim, |bytes, axis| {
                Some(nudged(beside[axis], i32::from(bytes.next()? % 7) - 3))
            }),
            4 => self.each(dim, |bytes, _| double(bytes)),
            // Subnormal numbers, and somewhat larger ones.
            5 => self.each(dim, |bytes, _| {
                let code = bytes.next()?;
                let size = f64::from_bits(u64::from(code / 2));
                Some(signed(libm::scalbn(size, i32::from(how >> 3) * 4), code & 1 == 0))
            }),
            6 if how >= 128 => self.each(dim, |bytes, _| {
                let code = bytes.next()?;
                let exponent = i32::from(code / 4) * 18 - 110;
                let size = libm::scalbn(1.0 + f64::from(code % 4), exponent);
                Some(signed(if code < 252 { size } else { f64::MAX }, how & 8 == 0))
            }),
            // Whole diameters from an earlier particle are where textbook grids have cell borders.
            7 => self.each(dim, |bytes, axis| {
                Some(beside[axis] + f64::from(bytes.next()? as i8) * diameter)
            }),
            _ => self.each(dim, |bytes, _| Some(offset + f64::from(bytes.next()? as i8) * unit)),
        }
    }

    fn each(
        &mut self,
        dim: usize,
        mut number: impl FnMut(&mut Bytes<'_>, usize) -> Option<f64>,
    ) -> Option<[f64; 3]> {
        let mut place = [self.offset; 3];
        for (axis, x) in place[..dim].iter_mut().enumerate() {
            *x = number(&mut self.bytes, axis)?;
        }
        Some(place)
    }
}

pub fn nudged(x: f64, steps: i32) -> f64 {
    (0..steps.abs()).fold(x, |x, _| if steps > 0 { x.next_up() } else { x.next_down() })
}

/// Builds the scene that the bytes describe. Returns `None` if there are too few bytes or the
/// numbers are not valid. Panics if `Scene::new` refuses a valid scene or accepts an invalid one.
pub fn scene_from_bytes(data: &[u8]) -> Option<AnyScene<'static>> {
    let mut maker = Maker::new(data)?;
    while maker.numbers.len() < MOST && maker.particle().is_some() {}
    let numbers = &maker.numbers;
    let valid =
        |(k, x): (usize, &f64)| x.is_finite() && (k % numbers.stride() != numbers.dim || *x >= 0.0);
    let valid =
        (maker.mixed || maker.radius.is_finite()) && numbers.values.iter().enumerate().all(valid);
    // Equal radii are not merged, because detectors have separate code for a radius per particle.
    let scene = match maker.mixed {
        true => numbers.scene_of(numbers.radii().collect::<Vec<_>>()),
        false => numbers.scene_of(maker.radius),
    };
    assert!(scene.is_ok() == valid, "valid: {valid}, but {:?} for {numbers:?}", scene.err());
    scene.ok()
}
