//! NumPy npy, versions 1 to 3: f64 or f32 in either byte order, in C or Fortran order.
//!
//! | shape | columns |
//! |---|---|
//! | (N, 2) | x, y |
//! | (N, 3) | x, y, z; or x, y, radius if the options give two dimensions |
//! | (N, 4) | x, y, z, radius |
//! | (frames, N, 2 to 4) | the same for each frame |
//!
//! Format: <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>.

mod frames;
mod header;

use anyhow::{Context, anyhow, bail, ensure};

use crate::columns::Column;
use crate::options::Options;
use crate::particles::Particles;
use crate::raw::lines::Source;
use crate::raw::room::{numbered, room};
use crate::types::RadiusSource;
pub use frames::frames;
pub use header::MAGIC;
pub(crate) use header::{Header, any_header, header, shape, write_header};

pub fn particles(
    source: &mut Source<'_>,
    header: &mut Header,
    options: Options,
) -> anyhow::Result<(Particles, RadiusSource)> {
    let name = source.name;
    let rows = header.rows;
    let Some(columns @ 2..=4) = header.columns else {
        bail!(
            "{name}: the shape is {}; it must be (N, 2 to 4): x, y, z, radius",
            shape(&header.sizes)
        )
    };
    let (real, kind) = (header.is_real(), &header.descr);
    ensure!(real, "{name}: the type {kind} is not read; convert with .astype('f8')");
    numbered(rows, "particles").with_context(|| name.to_string())?;
    let (dim, has_radii) = match (columns, options.dim) {
        (2, _) => (2, false),
        (3, Some(2)) => (2, true),
        (3, _) => (3, false),
        _ => (3, true),
    };
    let mut particles = Particles::new(dim, has_radii);
    // An array with fewer rows than parts is kept whole.
    let part = options.part.filter(|[_, parts]| rows >= *parts);
    let kept = part.map_or(0..rows, |[k, parts]| rows * k / parts..rows * (k + 1) / parts);
    particles.first = part.map(|_| kept.start);
    header.pieces(source, rows, columns, |first, numbers| {
        for (row, numbers) in (first..).zip(numbers.chunks_exact(columns)) {
            for (k, &value) in numbers.iter().enumerate() {
                let column = if k == dim { Column::Radius } else { Column::Axis(k) };
                column.value(value).map_err(|why| {
                    anyhow!("{name}: particle {row} (from 0): {} {value} {why}", column.words())
                })?;
            }
        }
        let last = first + (numbers.len() / columns) as u64;
        let row = |row: u64| (row.clamp(first, last) - first) as usize * columns;
        particles.extend(&numbers[row(kept.start)..row(kept.end)], columns)
    })?;
    let last = RadiusSource::Column(format!("last of {columns} columns"));
    Ok((particles, if has_radii { last } else { RadiusSource::Missing }))
}

pub fn list(
    source: &mut Source<'_>,
    header: &mut Header,
    label: &str,
    column: Column,
) -> anyhow::Result<Vec<f64>> {
    let mut list = Vec::new();
    let name = source.name;
    header.values(source, header.count(), |row, value| {
        let value = column.value(value).map_err(|why| {
            anyhow!("{name}: particle {row} (from 0): a number of '{label}' {why}")
        })?;
        room(&mut list)?;
        list.push(value);
        Ok(())
    })?;
    Ok(list)
}

pub fn zip(axes: [Option<Vec<f64>>; 3], name: &str) -> anyhow::Result<Particles> {
    let [Some(x), Some(y), z] = axes else {
        bail!("{name}: arrays x and y of the same length are needed")
    };
    ensure!(
        y.len() == x.len() && z.as_ref().is_none_or(|z| z.len() == x.len()),
        "{name}: x, y and z differ in length"
    );
    let mut particles = Particles::new(2 + usize::from(z.is_some()), false);
    for (k, (&x, &y)) in x.iter().zip(&y).enumerate() {
        particles.push([x, y, z.as_ref().map_or(0.0, |z| z[k])], 0.0, 0)?;
    }
    Ok(particles)
}
