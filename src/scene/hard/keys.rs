//! Cell numbers that overflow or collide.
//!
//! ```text
//!   (ix, iy) -> ix + iy·2^b
//! ```
//!
//! Cells (2^b, 0) and (0, 1) have one key; with it go lists, marks and neighbours.

use crate::scene::hard::build::*;
use crate::scene::hard::{Allowed, Case, Expect, Group};

const KEYS: Case = Case::in_group(Group::Keys);

pub const CASES: &[Case] = &[
    Case {
        name: "two-couples-1e9-apart",
        reason: "10^9 cells per axis: arrays of heads need gigabytes, products of cell numbers 64 \
                 bits",
        source: "rapier#396",
        expect: Expect::Contacts([2, 2]),
        allows: &[Allowed::Memory],
        make: |dim| two_couples(dim, 1e9),
        ..KEYS
    },
    Case {
        name: "two-couples-1e12-apart",
        reason: "10^12 cells per axis: no cell number fits 32 bits, nor a product of two 64",
        source: "rapier#396",
        expect: Expect::Contacts([2, 2]),
        allows: &[Allowed::Domain],
        make: |dim| two_couples(dim, 1e12),
        ..KEYS
    },
    Case {
        name: "two-couples-1e300-apart",
        reason: "a cast of 10^300 to an integer saturates, wraps or is undefined, by language",
        source: "rapier#396",
        expect: Expect::Contacts([2, 2]),
        allows: &[Allowed::Domain],
        make: |dim| two_couples(dim, 1e300),
        ..KEYS
    },
    Case {
        name: "just-below-2-to-31-cells",
        reason: "the largest domain whose cell numbers fit a signed 32-bit integer",
        expect: Expect::Contacts([2, 2]),
        allows: &[Allowed::Memory],
        make: |dim| two_couples(dim, two_to(31) - 64.0),
        ..KEYS
    },
    Case {
        name: "just-above-2-to-31-cells",
        reason: "cell numbers wrap to negative in a signed 32-bit integer; cells a few millionths \
                 wider do not help yet",
        expect: Expect::Contacts([2, 2]),
        allows: &[Allowed::Domain],
        make: |dim| two_couples(dim, two_to(31) + two_to(15)),
        ..KEYS
    },
    Case {
        name: "two-to-the-32-cells",
        reason: "cell numbers of both couples are equal modulo 2^32",
        expect: Expect::Contacts([2, 2]),
        allows: &[Allowed::Domain],
        make: |dim| two_couples(dim, two_to(32)),
        ..KEYS
    },
    Case {
        name: "thin-diagonal",
        reason: "couples on the diagonal of a box of 10^5 cells per axis: nearly all of up to \
                 10^15 cells are empty",
        expect: Expect::Contacts([100, 100]),
        allows: &[Allowed::Memory],
        make: |dim| {
            let places = (0..100).flat_map(|k| {
                [[1000.0 * f64::from(k); 3], plus([1000.0 * f64::from(k); 3], 0.5, [1.0; 3])]
            });
            uniform(dim, &places.collect::<Vec<_>>(), 0.5)
        },
        ..KEYS
    },
    Case {
        name: "product-over-2-to-32",
        reason: "66,000 cells per axis: ix + iy·nx overflows 32 bits, and the last couple has the \
                 place of one in the middle",
        expect: Expect::Contacts([3, 3]),
        allows: &[Allowed::Memory],
        make: |dim| {
            let at = |x: f64, y: f64| [[x, y, y], [x + 0.5, y, y]];
            // 66,000² exceeds 2^32 by about 61,032,704, which is row 924.
            uniform(dim, &[at(0.0, 0.0), at(50_000.0, 924.0), at(65_999.0, 66_000.0)].concat(), 0.5)
        },
        ..KEYS
    },
    Case {
        name: "keys-of-16-bits",
        reason: "with 16 bits per axis, cells 2^16 apart are taken for one: as done already, or \
                 as neighbours along the next axis",
        expect: Expect::Contacts([ALIAS_CONTACTS, ALIAS_CONTACTS]),
        allows: &[Allowed::Memory],
        make: |dim| aliases(dim, two_to(16)),
        ..KEYS
    },
    Case {
        name: "keys-of-21-bits",
        reason: "as keys-of-16-bits, where each axis has 21 bits of 64",
        expect: Expect::Contacts([ALIAS_CONTACTS, ALIAS_CONTACTS]),
        allows: &[Allowed::Memory],
        make: |dim| aliases(dim, two_to(21)),
        ..KEYS
    },
    Case {
        name: "chains-across-2-to-16",
        reason: "chains at the 2^16th cell of each axis and at the first: wrapped numbers of 16 \
                 bits break the one, or take it for the other",
        expect: Expect::Contacts([2 * 2 * 63, 3 * 2 * 63]),
        allows: &[Allowed::Memory],
        make: |dim| chains(dim, two_to(16)),
        ..KEYS
    },
    Case {
        name: "chains-across-2-to-21",
        reason: "as chains-across-2-to-16, where each axis has 21 bits of 64",
        expect: Expect::Contacts([2 * 2 * 63, 3 * 2 * 63]),
        allows: &[Allowed::Memory],
        make: |dim| chains(dim, two_to(21)),
        ..KEYS
    },
    Case {
        name: "single-precision-keys",
        reason: "cell numbers above 2^24 are even in f32: a neighbour's number is that of the \
                 cell itself, or of the one after it",
        expect: Expect::Contacts([63, 63]),
        allows: &[Allowed::Memory],
        make: |dim| {
            let mut places = vec![[0.0; 3], [100.0; 3]];
            places.extend((0..64).map(|k| {
                std::array::from_fn(|axis| {
                    if axis + 1 == dim as usize { two_to(24) + f64::from(k) } else { 50.0 }
                })
            }));
            uniform(dim, &places, 0.5)
        },
        ..KEYS
    },
    Case {
        name: "one-hash-bucket",
        reason: "clumps 1024 cells apart: hashes of products and exclusive or, modulo a power of \
                 two, put them into the same buckets",
        expect: Expect::Contacts([9 * lattice_contacts(2, 3, 1), 27 * lattice_contacts(3, 3, 1)]),
        allows: &[Allowed::Memory],
        make: |dim| {
            let clump = lattice(dim, 3, |k| k);
            let places = lattice(dim, 3, |k| 1024.0 * k).into_iter().flat_map(|corner| {
                clump.iter().map(move |&place| plus(corner, 1.0, place)).collect::<Vec<_>>()
            });
            uniform(dim, &places.collect::<Vec<_>>(), 0.5)
        },
        ..KEYS
    },
    Case {
        name: "neighbours-in-one-bucket",
        reason: "a full block of cells in a hash table smaller than the block: neighbour cells \
                 share buckets, and pairs come twice",
        expect: of_lattice([24, 10], 3),
        make: |dim| {
            uniform(dim, &lattice(dim, by_dim(dim, [24, 10]), |k| k), by_dim(dim, [0.75, 0.875]))
        },
        ..KEYS
    },
];

/// A couple at the origin and one at `far` on every axis, each touching along x. Where doubles are
/// too coarse for a touching couple, two bodies at one place.
fn two_couples(dim: u32, far: f64) -> Steps {
    uniform(dim, &[[0.0; 3], [1.0, 0.0, 0.0], [far; 3], [far + 1.0, far, far]], 0.5)
}

/// Contacts of [`aliases`]: along three rows of 22 bodies and between two of them, twice.
const ALIAS_CONTACTS: u64 = 2 * (3 * 21 + 22);

/// Two rows, one above the other, in cells 0 to 15 along x, and a third one, level with the lower,
/// in cells about `period`: across the border where numbers begin again from 0, and on until its
/// cells have the numbers of the first, whether cells are of one diameter or a few millionths
/// wider. Keys with `period` cells per axis confuse it with the upper row. All of it twice: the far
/// row first, and last. A body far up makes an array of all cells impossible.
fn aliases(dim: u32, period: f64) -> Steps {
    let row = |x: f64, y: f64| {
        (0..22).map(move |k| [x + 0.75 * f64::from(k), y, 0.5]).collect::<Vec<_>>()
    };
    let (near, far) = (
        |y: f64| [row(0.0, y + 0.5), row(0.0, y + 1.25)].concat(),
        |y: f64| row(period - 4.0, y + 0.5),
    );
    let corners = vec![[0.0; 3], [0.0, two_to(31) / period, 0.0]];
    uniform(dim, &[corners, far(4.0), near(4.0), near(12.0), far(12.0)].concat(), 0.5)
}

/// Along every axis a chain of 64 touching bodies from 0, and one across `period`: long enough that
/// cells some millionths wider than a diameter, too, have their border with that number within it,
/// and the same numbers modulo `period` as the first chain.
fn chains(dim: u32, period: f64) -> Steps {
    let line: Vec<f64> =
        (0..64).map(f64::from).chain((-40..24).map(|k| period + f64::from(k))).collect();
    uniform(dim, &lines(dim, &line, 200.0), 0.5)
}
