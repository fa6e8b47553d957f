//! Scenes and pairs as files between harness and runners: NumPy npy, which runners in any language
//! can read.

use std::fs::File;
use std::io::{BufReader, BufWriter, Write};
use std::path::Path;

use anyhow::{Context, ensure};

use crate::io::formats::gzip::Unpacking;
use crate::io::formats::npy;
use crate::io::lines::Source;
use crate::io::particles::room;
use crate::io::scalars::Kind;
use crate::scene::{AnyScene, Radii, Real, Scene, array};
use crate::{io, with_scene};

/// Writes centres, and radii as one more column unless they are all the same, as f64. Gives the
/// radius of all particles, if they have the same.
pub fn write_scene(path: &Path, scene: &AnyScene<'_>) -> anyhow::Result<Option<f64>> {
    with_scene!(scene, scene => write(path, scene))
        .with_context(|| format!("cannot write the scene to {}", path.display()))
}

fn write<T: Real, const D: usize>(
    path: &Path,
    scene: &Scene<'_, T, D>,
) -> std::io::Result<Option<f64>> {
    let radius = match scene.radii() {
        Radii::Uniform(r) => Some(r.wide()),
        Radii::Each(_) => None,
    };
    let columns = D + usize::from(radius.is_none());
    let mut file = BufWriter::new(File::create(path)?);
    npy::write_header(&mut file, "<f8", scene.len(), columns)?;
    for (k, centre) in scene.centres().iter().enumerate() {
        for x in array(centre) {
            file.write_all(&x.wide().to_le_bytes())?;
        }
        if radius.is_none() {
            file.write_all(&scene.radius(k).wide().to_le_bytes())?;
        }
    }
    file.flush()?;
    Ok(radius)
}

/// Reads what [`write_scene`] wrote.
pub fn read_scene(
    path: &Path,
    dim: u32,
    n: u64,
    radius: Option<f64>,
) -> anyhow::Result<AnyScene<'static>> {
    let scene = io::scene(path, io::Options { radius, dim: Some(dim), ..io::Options::NONE })?;
    ensure!(
        scene.dim() as u32 == dim && scene.len() as u64 == n,
        "{} holds {} particles in {}D, not {n} in {dim}D",
        path.display(),
        scene.len(),
        scene.dim()
    );
    Ok(scene)
}

/// Reads pairs as a runner writes them: npy, `<u4`, shape (pairs, 2), C order.
pub fn read_pairs(path: &Path) -> anyhow::Result<Vec<[u32; 2]>> {
    let name = path.display().to_string();
    let file = File::open(path).with_context(|| format!("cannot read the pairs {name}"))?;
    let unpacking = Unpacking::default();
    let input = &mut BufReader::new(file);
    let mut source = Source { input, name: &name, unpacking: &unpacking };
    let header = npy::header(&mut source)?;
    let kind = header.kind == Kind::U32 && !header.big && !header.fortran;
    ensure!(
        kind && header.columns == Some(2),
        "{name} holds {} of the shape ({}){}; pairs are '<u4' of the shape (pairs, 2), in C order",
        header.descr,
        header.shape,
        if header.fortran { " in Fortran order" } else { "" }
    );
    let (mut pairs, mut first) = (Vec::new(), 0);
    header.values(&mut source, header.rows.saturating_mul(2), |k, value| {
        // Every u32 is a double.
        if k % 2 == 0 {
            first = value as u32;
        } else {
            room(&mut pairs)?;
            pairs.push([first, value as u32]);
        }
        Ok(())
    })?;
    source.end(&header)?;
    Ok(pairs)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_come_back_and_other_arrays_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pairs.npy");
        let pairs = [[0, 1], [u32::MAX, 7]];
        io::write::pairs(&path, &pairs).unwrap();
        assert_eq!(read_pairs(&path).unwrap(), pairs);
        let whole = std::fs::read(&path).unwrap();
        let refused = |bytes: &[u8], words: &str| {
            std::fs::write(&path, bytes).unwrap();
            let error = format!("{:#}", read_pairs(&path).unwrap_err());
            assert!(error.contains(words), "{error}");
        };
        refused(&whole[..whole.len() - 1], "ends before the 2 x 2 numbers");
        refused(&[&whole[..], &[0; 8]].concat(), "goes on after the 2 x 2 numbers");
        refused(b"i,j\n0,1\n", "not a NumPy file");
        for (kind, words) in [("<u8", "holds '<u8'"), (">u4", "pairs are '<u4'")] {
            let text = String::from_utf8_lossy(&whole[10..128]).replace("<u4", kind);
            refused(&[&whole[..10], text.as_bytes(), &whole[128..]].concat(), words);
        }
    }
}
