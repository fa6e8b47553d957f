//! Scene and pair files exchanged between harness and runners, as NumPy npy.

use std::fs::File;
use std::io::{BufReader, BufWriter, Write};
use std::path::Path;

use anyhow::{Context, bail, ensure};

use crate as io;
use crate::formats::npy;
use crate::raw::gzip::Unpacking;
use crate::raw::lines::Source;
use crate::raw::room::room;
use crate::raw::scalars::Scalar;
use crate::write::{create, scene_npy};
use contactbench_ground::periodic::{ContactList, ImagePair};
use contactbench_ground::scene::{AnyScene, Radii, Real};
use contactbench_ground::with_scene;

/// Writes centres as f64, and radii as one more column unless all are equal. Returns the common
/// radius.
pub fn write_scene(path: &Path, scene: &AnyScene<'_>) -> anyhow::Result<Option<f64>> {
    let write = || {
        let mut file = BufWriter::new(File::create(path)?);
        let radius = with_scene!(scene, scene => {
            let radius = match scene.radii() {
                Radii::Uniform(r) => Some(r.wide()),
                Radii::Each(_) => None,
            };
            scene_npy(&mut file, scene, radius.is_none())?;
            radius
        });
        file.flush()?;
        std::io::Result::Ok(radius)
    };
    write().with_context(|| format!("cannot write the scene to {}", path.display()))
}

pub fn read_scene(
    path: &Path,
    dim: u32,
    n: u64,
    radius: Option<f64>,
) -> anyhow::Result<AnyScene<'static>> {
    let scene = io::scene(path, io::Options { radius, dim: Some(dim), ..io::Options::NONE })?;
    let (count, axes) = (scene.len() as u64, scene.dim() as u32);
    ensure!(
        (count, axes) == (n, dim),
        "{} holds {count} particles in {axes}D, not {n} in {dim}D",
        path.display()
    );
    Ok(scene)
}

pub fn write_contacts(
    path: &Path,
    contacts: impl ExactSizeIterator<Item = ImagePair>,
    box_dim: Option<usize>,
) -> anyhow::Result<()> {
    let kind = if box_dim.is_some() { "<i4" } else { "<u4" };
    let images = box_dim.unwrap_or(0);
    create(path, |out| {
        npy::write_header(out, kind, contacts.len(), 2 + images)?;
        for ImagePair { i, j, image } in contacts {
            out.write_all([i.to_le_bytes(), j.to_le_bytes()].as_flattened())?;
            image[..images].iter().try_for_each(|s| out.write_all(&s.to_le_bytes()))?;
        }
        Ok(())
    })
}

/// Reads the contacts that a runner wrote: npy `<u4` of shape (pairs, 2), C order. In a box: `<i4`
/// of shape (pairs, 2 + dim); the last columns are the image of the second particle.
pub fn read_contacts(path: &Path, box_dim: Option<usize>) -> anyhow::Result<ContactList> {
    let name = path.display().to_string();
    let (kind, descr) = if box_dim.is_some() { (Scalar::I32, "<i4") } else { (Scalar::U32, "<u4") };
    let columns = 2 + box_dim.unwrap_or(0);
    let file = File::open(path).with_context(|| format!("cannot read the pairs {name}"))?;
    let (input, unpacking) = (&mut BufReader::new(file), &Unpacking::default());
    let mut source = Source { input, name: &name, unpacking };
    let mut header = npy::header(&mut source)?;
    let fits = header.kind == kind && !header.big && !header.fortran;
    ensure!(
        fits && header.columns == Some(columns),
        "{name} holds {}; pairs are '{descr}' of the shape (pairs, {columns}), in C order",
        header.words()
    );
    let mut contacts = ContactList::default();
    header.pieces(&mut source, header.rows, columns, |_, numbers| {
        for row in numbers.chunks_exact(columns) {
            // f64 holds every i32 and u32 exactly.
            let [Ok(i), Ok(j)] = [row[0], row[1]].map(|k| u32::try_from(k as i64)) else {
                bail!("{name} has the pair {},{}; particles are numbered from 0", row[0], row[1]);
            };
            let mut image = [0; 3];
            image.iter_mut().zip(&row[2..]).for_each(|(image, s)| *image = *s as i32);
            if image == [0; 3] {
                room(&mut contacts.plain)?;
                contacts.plain.push([i, j]);
            } else {
                room(&mut contacts.shifted)?;
                contacts.shifted.push(ImagePair::new(i, j, image));
            }
        }
        Ok(())
    })?;
    source.end(&header)?;
    Ok(contacts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_come_back_and_other_arrays_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pairs.npy");
        let pairs = [[0, 1], [u32::MAX, 7]];
        write_contacts(&path, pairs.iter().map(|&[i, j]| ImagePair { i, j, image: [0; 3] }), None)
            .unwrap();
        assert_eq!(read_contacts(&path, None).unwrap().plain, pairs);
        let whole = std::fs::read(&path).unwrap();
        let refused = |bytes: &[u8], words: &str| {
            std::fs::write(&path, bytes).unwrap();
            let error = format!("{:#}", read_contacts(&path, None).map(drop).unwrap_err());
            assert!(error.contains(words), "{error}");
        };
        refused(&whole[..whole.len() - 1], "ends before the (2, 2) numbers");
        refused(&[&whole[..], &[0; 8]].concat(), "goes on after the (2, 2) numbers");
        refused(b"i,j\n0,1\n", "not a NumPy file");
        for (kind, words) in [("<u8", "type '<u8'"), (">u4", "pairs are '<u4'")] {
            let text = String::from_utf8_lossy(&whole[10..128]).replace("<u4", kind);
            refused(&[&whole[..10], text.as_bytes(), &whole[128..]].concat(), words);
        }
    }
}
