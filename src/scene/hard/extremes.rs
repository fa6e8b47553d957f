//! Very large and very small numbers, large offsets.
//!
//! ```text
//!   0 ........................................ 10^15 diameters ........ ooo
//!   2^-1074 .. 2^-537 (squares vanish below) .. 1 .. 2^511 (squares overflow above) .. 2^1024
//! ```

use crate::scene::hard::build::*;
use crate::scene::hard::{Allowed, Case, Expect, Group};

const EXTREMES: Case = Case::in_group(Group::Extremes);

pub const CASES: &[Case] = &[
    Case {
        name: "offset-1e6",
        reason: "touching lattice 10^6 diameters from the origin: f32 has four bits left for the \
                 place in a cell",
        expect: of_lattice(SITES, 1),
        make: |dim| far_lattice(dim, 1e6),
        ..EXTREMES
    },
    Case {
        name: "offset-1e9",
        reason: "touching lattice 10^9 diameters from the origin: in f32 all bodies are at one \
                 place, and p·p rounds",
        expect: of_lattice(SITES, 1),
        make: |dim| far_lattice(dim, 1e9),
        ..EXTREMES
    },
    Case {
        name: "offset-1e12",
        reason: "touching lattice 10^12 diameters from the origin: floor(x / d) does not fit 32 \
                 bits where x - xmin is not taken first",
        expect: of_lattice(SITES, 1),
        make: |dim| far_lattice(dim, 1e12),
        ..EXTREMES
    },
    Case {
        name: "offset-1e15",
        reason: "touching lattice 10^15 diameters from the origin: coordinates are exact, but \
                 have three bits after the point",
        expect: of_lattice(SITES, 1),
        make: |dim| far_lattice(dim, -1e15),
        ..EXTREMES
    },
    Case {
        name: "at-2-to-53",
        reason: "below 2^53 doubles are 1 apart, above it 2: x + 1 = x, so a loop or a box that \
                 grows by d stands still",
        expect: Expect::Contacts([2 * 4, 3 * 4]),
        make: |dim| {
            let line: Vec<f64> =
                [-4.0, -3.0, -2.0, -1.0, 0.0, 2.0, 4.0, 6.0].map(|x| two_to(53) + x).to_vec();
            uniform(dim, &lines(dim, &line, two_to(53) + 100.0), 0.5)
        },
        ..EXTREMES
    },
    Case {
        name: "one-ulp-lattice",
        reason: "bodies one last bit apart at 1, as large as that: any margin relative to the \
                 coordinates joins or splits them all",
        expect: of_lattice(SITES, 1),
        make: |dim| {
            uniform(dim, &lattice(dim, by_dim(dim, SITES), |k| 1.0 + two_to(-52) * k), two_to(-53))
        },
        ..EXTREMES
    },
    Case {
        name: "scale-1e-12",
        reason: "decimal lattice in units of 10^-12: an absolute tolerance of 10^-9 or 10^-12 \
                 joins everything",
        make: |dim| uniform(dim, &lattice(dim, by_dim(dim, SITES), |k| 1e-12 * k), 0.5e-12),
        ..EXTREMES
    },
    Case {
        name: "scale-1e-200",
        reason: "lattice scaled by 2^-664: squares vanish, so that 0 <= 0 accepts every pair in \
                 rounded arithmetic",
        expect: of_lattice(SITES, 1),
        make: |dim| scaled_lattice(dim, two_to(-664)),
        ..EXTREMES
    },
    Case {
        name: "squares-vanish-in-f32",
        reason: "lattice scaled by 2^-80: as scale-1e-200 in f32, whose squares vanish below \
                 2^-75; every pair is in touch there, so cells must be larger than bodies",
        expect: of_lattice(SITES, 1),
        make: |dim| scaled_lattice(dim, two_to(-80)),
        ..EXTREMES
    },
    Case {
        name: "squares-are-subnormal",
        reason: "lattice scaled by 2^-530: squares are subnormal and have 15 bits, and tangency \
                 is lost in them",
        expect: of_lattice(SITES, 1),
        make: |dim| scaled_lattice(dim, two_to(-530)),
        ..EXTREMES
    },
    Case {
        name: "subnormal-coordinates",
        reason: "lattice in units of 2^-1072: 1/d overflows, and flushing to zero makes all \
                 bodies one",
        expect: of_lattice(SITES, 1),
        make: |dim| scaled_lattice(dim, two_to(-1072)),
        ..EXTREMES
    },
    Case {
        name: "least-numbers",
        reason: "radius 2^-1074, spacing 2^-1074: half of it is 0",
        expect: of_lattice(SITES, 4),
        make: |dim| {
            uniform(dim, &lattice(dim, by_dim(dim, SITES), |k| k * two_to(-1074)), two_to(-1074))
        },
        ..EXTREMES
    },
    Case {
        name: "squares-overflow",
        reason: "lattice scaled by 2^600: squares overflow, and ∞ <= ∞ accepts every pair in \
                 rounded arithmetic",
        expect: of_lattice(SITES, 1),
        make: |dim| scaled_lattice(dim, two_to(600)),
        ..EXTREMES
    },
    Case {
        name: "extent-overflows",
        reason: "xmax - xmin is infinite although each coordinate is finite: the number of cells \
                 is ∞ or NaN",
        expect: Expect::Contacts([2 * 2, 3 * 2]),
        allows: &[Allowed::Domain],
        make: |dim| {
            let far = two_to(1023);
            uniform(dim, &lines(dim, &[-far, -0.5 * far, 0.5 * far, far], 0.0), 0.5 * two_to(1022))
        },
        ..EXTREMES
    },
    Case {
        name: "largest-numbers",
        reason: "two bodies at ±MAX of radius MAX touch: difference and sum of radii overflow \
                 alike",
        expect: Expect::Contacts([1, 1]),
        allows: &[Allowed::Domain],
        make: |dim| uniform(dim, &[[f64::MAX, 0.0, 0.0], [-f64::MAX, 0.0, 0.0]], f64::MAX),
        ..EXTREMES
    },
    Case {
        name: "large-beside-least",
        reason: "1 and 2^-1074 in one test: the last bits that decide lie 1074 binary places \
                 below the first",
        expect: Expect::Contacts([2, 2]),
        make: |dim| {
            let least = two_to(-1074);
            // Tangent; apart by a hair across; tangent with a hair across and a hair of radius
            // more.
            each(
                dim,
                &[
                    ([0.0, 0.0, 0.0], 0.5),
                    ([1.0, 0.0, 0.0], 0.5),
                    ([4.0, 0.0, 0.0], 0.5),
                    ([5.0, least, 0.0], 0.5),
                    ([8.0, 0.0, 0.0], 0.5),
                    ([9.0, least, 0.0], 0.5f64.next_up()),
                ],
            )
        },
        ..EXTREMES
    },
];

/// Sites per axis of the lattices here, in 2D and 3D.
const SITES: [u32; 2] = [12, 6];

fn far_lattice(dim: u32, offset: f64) -> Steps {
    uniform(dim, &lattice(dim, by_dim(dim, SITES), |k| offset + k), 0.5)
}

fn scaled_lattice(dim: u32, scale: f64) -> Steps {
    uniform(dim, &lattice(dim, by_dim(dim, SITES), |k| scale * k), 0.5 * scale)
}
