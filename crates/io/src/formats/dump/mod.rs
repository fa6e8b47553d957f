//! LAMMPS and LIGGGHTS dumps: frames of `ITEM:` sections. `ITEM: ATOMS` names the columns, in any
//! order.
//!
//! * Coordinates are `x y z`, else unwrapped `xu yu zu`, else scaled `xs ys zs` or `xsu ysu zsu`.
//!   Scaled ones become lengths as lo + s (hi - lo), rounded three times. In a tilted (triclinic)
//!   box they become lo + xs a + ys b + zs c, rounded at every step.
//! * The size is a column `radius` or `diameter` (or `r`, `d`). Particles keep the order of the
//!   file, not of their ids.
//! * In the header of the box, `pp ff ff` gives the periodic axes; dumps before 2010 lack it. `xy
//!   xz yz` announces a tilted box, whose bounds are those of its bounding box. `abc origin`
//!   announces three free vectors and the corner.
//!
//! Format: <https://docs.lammps.org/dump.html>, <https://docs.lammps.org/Howto_triclinic.html>.

mod header;

use anyhow::{Context, ensure};

use crate::columns::{Column, Columns};
use crate::frames::Framed;
use crate::options::{Opened, Options};
use crate::particles::{Loaded, Particles};
use crate::raw::lines::{Lines, Source};
use crate::rows::Rows;
use crate::types::{About, Declared, Notice};
pub(crate) use header::{Header, Headers};

pub fn frames(source: Source<'_>, options: Options) -> Opened<'_> {
    let headers = Headers::new(Lines::new(source), "ATOMS");
    Box::new(Dump { headers, options, header: Header::default() })
}

struct Dump<'a> {
    headers: Headers<'a>,
    options: Options,
    header: Header,
}

impl Framed for Dump<'_> {
    fn begin(&mut self) -> anyhow::Result<Option<String>> {
        let next = self.headers.next(self.options.boundaries)?;
        let place = next.as_ref().map(|header| header.place.clone());
        self.header = next.unwrap_or_default();
        Ok(place)
    }

    fn frame(&mut self, keep: bool) -> anyhow::Result<Option<Loaded>> {
        let (header, lines) = (&mut self.header, &mut self.headers.lines);
        let mut kept = keep.then(|| atoms(header, self.options)).transpose()?;
        for k in 0..header.n {
            let of = "atoms that its header announces: it is cut off, or still being written";
            lines.row(k, header.n, of)?;
            let Some((rows, scaled)) = &mut kept else { continue };
            rows.push(lines.line(), lines)?;
            if let (true, Some(bounds)) = (*scaled, &header.bounds) {
                scale_last(bounds, &mut rows.particles).with_context(|| lines.place())?;
            }
        }
        let Some((rows, _)) = kept else { return Ok(None) };
        let (particles, about) = rows.read("LAMMPS dump");
        let Header { bounds: declared, step, time, .. } = std::mem::take(header);
        Ok(Some((particles, About { declared, step, time, ..about })))
    }

    fn has_feed(&self) -> bool {
        self.headers.lines.ended()
    }
}

/// Returns the reader of a frame's rows, and whether their coordinates are scaled by the box.
fn atoms(header: &Header, options: Options) -> anyhow::Result<(Rows, bool)> {
    let Header { names, place, bounds, .. } = header;
    let named = !names.trim().is_empty();
    ensure!(named, "{place}: no columns are named; write 'ITEM: ATOMS id type x y z' or xs ys zs");
    let mut columns = Columns::named(names.split_whitespace()).chosen(place, options.columns)?;
    let kind = axes(&mut columns, options.axes_chosen(), place)?;
    let mut particles = columns.particles(place, options)?;
    let scaled = kind.starts_with('s');
    let has_box = !scaled || bounds.is_some();
    ensure!(has_box, "{place}: xs is scaled by the box, and there is no 'ITEM: BOX BOUNDS'");
    let assumed = [
        (scaled, "coordinates scaled by the box (xs): turned into lengths, which are rounded"),
        (
            kind.ends_with('u'),
            "unwrapped coordinates: particles may be outside the box, and contacts across open \
             boundaries are left out",
        ),
    ];
    let assumed = assumed.into_iter().filter(|(holds, _)| *holds);
    particles.notices.extend(assumed.map(|(_, words)| Notice::Assumed(words.into())));
    Ok((Rows { columns, particles }, scaled))
}

/// Finds the columns of one kind of coordinates, and returns the suffix of their names: empty, u
/// (unwrapped), s (scaled) or su.
fn axes(columns: &mut Columns, chosen: bool, place: &str) -> anyhow::Result<&'static str> {
    let Columns { names, meaning, .. } = columns;
    let at = |name: &str| names.iter().position(|other| other.eq_ignore_ascii_case(name));
    // A chosen column `xs` holds scaled coordinates, too.
    let is_x = |k: usize| !chosen || meaning[k] == Column::Axis(0);
    let kinds = ["", "u", "s", "su"].into_iter();
    let kind = kinds.clone().find(|kind| at(&format!("x{kind}")).is_some_and(is_x)).unwrap_or("");
    if chosen {
        return Ok(kind);
    }
    let axes = ["x", "y", "z"].map(|axis| format!("{axis}{kind}"));
    let other = kinds.map(|kind| format!("z{kind}")).find(|z| at(z).is_some());
    let of_one_kind = at(&axes[2]).is_some() || other.is_none();
    ensure!(of_one_kind, "{place}: z is not of the same kind as '{}'; write x y z", axes[0]);
    for (meaning, name) in meaning.iter_mut().zip(names) {
        match axes.iter().position(|axis| axis.eq_ignore_ascii_case(name)) {
            Some(k) => *meaning = Column::Axis(k),
            None if matches!(meaning, Column::Axis(_)) => *meaning = Column::Other,
            None => {}
        }
    }
    Ok(kind)
}

/// Replaces the last particle's fractions of the box by lengths.
pub(super) fn scale_last(bounds: &Declared, particles: &mut Particles) -> anyhow::Result<()> {
    let Declared { vectors: Some(vectors), origin, .. } = bounds else { return Ok(()) };
    let last = particles.len() - 1;
    let scaled = particles.centre(last);
    for axis in 0..3 {
        // Terms of 0 are left out to avoid rounding, and NaN from 0 times infinity.
        let terms = scaled.iter().zip(vectors).filter(|(_, vector)| vector[axis] != 0.0);
        let length = terms.fold(origin[axis], |sum, (s, vector)| sum + s * vector[axis]);
        ensure!(length.is_finite(), "the position is not finite once it is scaled by the box");
        particles.set(last, axis, length);
    }
    Ok(())
}
