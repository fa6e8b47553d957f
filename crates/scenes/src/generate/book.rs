//! `pack-a` to `pack-d`: the packs of the book's four numerical experiments (Munjiza 2004, section
//! 3.8).
//!
//! ```text
//!   pack-a  ooooooo  2D    pack-b  o   o   o  2D    pack-c  o   o   o       pack-d  oo   oo   oo
//!            D                     |<S>|                       S  |  S            D|<S>|       2D
//!           ooooooo                o   o   o                o   o   o               oo   oo   oo
//! ```
//!
//! | pack | between columns | between rows | experiment |
//! |---|---|---|---|
//! | A | D | 2D | I: N varies |
//! | B | S | 2D | II: S varies |
//! | C | S | S | III: S varies |
//! | D | D and S in turn (inferred: the book does not print it) | 2D | IV: S varies |
//!
//! The parameter `s` is S/D. There are ceil(√N) columns; the last row may be incomplete. Column i
//! of packs A to C is at (i·s)·D, of pack D at (⌊i/2⌋·(1 + s) + i mod 2)·D; row j is at (2j)·D or
//! (j·s)·D. Coordinates are exact if s and D are dyadic and no product needs more than 53 bits.
//! Then neighbours are exactly D apart, the largest distance at which discs are in contact.

use crate::generate::table::{Generator, Make, Parameter, ParameterKind, parameter};
use crate::generate::{DIAMETER, Inputs, assemble};
use contactbench_io::Given;

pub const PACK_A: Generator = of_book(
    "pack-a",
    "the book's pack A: columns D apart, rows 2D apart",
    &[&[DIAMETER]],
    |inputs| pack(inputs, |_, i, j| [i, 2.0 * j]),
);

pub const PACK_B: Generator =
    of_book("pack-b", "the book's pack B: columns S apart, rows 2D apart", SPACED, |inputs| {
        pack(inputs, |s, i, j| [i * s, 2.0 * j])
    });

pub const PACK_C: Generator =
    of_book("pack-c", "the book's pack C: columns and rows S apart", SPACED, |inputs| {
        pack(inputs, |s, i, j| [i * s, j * s])
    });

pub const PACK_D: Generator = of_book(
    "pack-d",
    "the book's pack D: columns D and S apart in turn, rows 2D apart",
    SPACED,
    |inputs| {
        pack(inputs, |s, i, j| {
            let pair = (i / 2.0).floor();
            [pair * (1.0 + s) + (i - 2.0 * pair), 2.0 * j]
        })
    },
);

const SPACED: &[&[Parameter]] = &[&[
    DIAMETER,
    parameter("s", ParameterKind::NOT_NEGATIVE, "1", "S/D, the spacing in diameters"),
]];

const fn of_book(
    name: &'static str,
    summary: &'static str,
    params: &'static [&'static [Parameter]],
    make: Make,
) -> Generator {
    Generator { name, dims: &[2], summary, params, make, ..Generator::PLAIN }
}

/// `site` gets the spacing, the column and the row.
fn pack(inputs: &Inputs<'_>, site: fn(f64, f64, f64) -> [f64; 2]) -> anyhow::Result<Given> {
    let s = inputs.number("s").unwrap_or(1.0);
    let root = inputs.n.isqrt();
    let columns = if root * root < inputs.n { root + 1 } else { root.max(1) };
    let centres = (0..inputs.n).map(|k| site(s, (k % columns) as f64, (k / columns) as f64));
    Ok(assemble(inputs, centres, None)?.into())
}
