//! Writes contacts as legacy VTK.

use std::fmt::Debug;
use std::io::{self, Write};

use super::line;
use super::row::{Extra, Style, turned};
use contactbench_ground::periodic::{ImagePair, Periodic};
use contactbench_ground::scene::{Real, Scene, array};

/// Writes points with radii, and a line for each contact. A contact across the box gets two lines:
/// from i to the image of j, and from j to the image of i. Images are extra points after the
/// particles, with radius 0 and `image` 1. Discs have z = 0.
pub(super) fn write<T: Real, const D: usize>(
    out: &mut dyn Write,
    contacts: impl ExactSizeIterator<Item = ImagePair>,
    scene: &Scene<'_, T, D>,
    style: &Style<'_>,
) -> io::Result<()> {
    let (n, lattice) = (scene.len(), style.periodic.map(Periodic::lattice));
    let mut lines: Vec<ImagePair> = Vec::new();
    lines.try_reserve(2 * contacts.len()).map_err(|_| io::ErrorKind::OutOfMemory)?;
    for pair in contacts {
        lines.push(pair);
        lines.extend((pair.image != [0; 3]).then(|| turned(pair)));
    }
    let across = lines.iter().filter(|line| line.image != [0; 3]);
    let points = (0..n as u32).map(|k| (k, [0; 3])).chain(across.map(|line| (line.j, line.image)));
    let count = points.clone().count();
    let start = "# vtk DataFile Version 3.0\ncontacts\nASCII\nDATASET POLYDATA";
    writeln!(out, "{start}\nPOINTS {count} double")?;
    for (k, image) in points.clone() {
        let mut place = array(&scene.centres()[k as usize]).map(|x| x.wide());
        let vectors = lattice.iter().flat_map(|it| it.vectors()).zip(image);
        for (vector, times) in vectors.filter(|(_, times)| *times != 0) {
            (0..D).for_each(|k| place[k] += f64::from(times) * vector[k]);
        }
        line(out, place.into_iter().chain((D == 2).then_some(0.0)), " ")?;
    }
    writeln!(out, "LINES {} {}", lines.len(), 3 * lines.len())?;
    let mut next = n..;
    for &ImagePair { i, j, image } in &lines {
        let to = if image == [0; 3] { Some(j as usize) } else { next.next() };
        writeln!(out, "2 {i} {}", to.unwrap_or_default())?;
    }
    writeln!(out, "POINT_DATA {count}")?;
    let radius = |(k, image): (u32, [i32; 3])| match image {
        [0, 0, 0] => scene.radius(k as usize).wide(),
        _ => 0.0,
    };
    scalars(out, "radius double", points.clone().map(radius))?;
    if lattice.is_some() {
        scalars(out, "image int", points.clone().map(|(_, image)| u8::from(image != [0; 3])))?;
    }
    if style.by_id || style.has(Extra::Ids) {
        scalars(out, "id long", points.clone().map(|(k, _)| style.id(k)))?;
    }
    if style.has(Extra::Count) {
        scalars(out, "contacts int", points.map(|(k, _)| style.count(k)))?;
    }
    if style.has(Extra::Overlap) || style.has(Extra::Normal) {
        writeln!(out, "CELL_DATA {}", lines.len())?;
    }
    if style.has(Extra::Overlap) {
        scalars(out, "overlap double", lines.iter().map(|&line| style.overlap(line)[0]))?;
        scalars(out, "depth double", lines.iter().map(|&line| style.overlap(line)[1]))?;
    }
    if style.has(Extra::Normal) {
        writeln!(out, "VECTORS normal double")?;
        lines.iter().try_for_each(|&it| line(out, style.normal(it).into_iter(), " "))?;
    }
    Ok(())
}

fn scalars(
    out: &mut dyn Write,
    name: &str,
    mut values: impl Iterator<Item = impl Debug>,
) -> io::Result<()> {
    writeln!(out, "SCALARS {name} 1\nLOOKUP_TABLE default")?;
    values.try_for_each(|value| writeln!(out, "{value:?}"))
}
