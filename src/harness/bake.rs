//! Scenes and pairs as files between harness and runners: NumPy npy, which runners in any language can read.

use std::io::Write;
use std::path::Path;

use anyhow::{Context, ensure};

use super::protocol::Request;
use crate::contact::array;
use crate::read;
use crate::scene::{AnyScene, Radii, Scene};
use crate::with_scene;

/// Writes centres, and radii as one more column unless they are all the same, as f64. Gives the radius for the `load` request.
pub fn write(path: &Path, scene: &AnyScene<'_>) -> anyhow::Result<Option<f64>> {
    with_scene!(scene, scene => write_scene(path, scene)).with_context(|| format!("cannot write the scene to {}", path.display()))
}

/// Writes a scene, and gives the request that makes a runner read it.
pub fn load(path: &Path, scene: &AnyScene<'_>) -> anyhow::Result<Request> {
    let radius = write(path, scene)?;
    Ok(Request::Load { path: path.to_path_buf(), dim: scene.dim() as u32, n: scene.len() as u64, radius })
}

fn write_scene<T: crate::contact::Real, const D: usize>(path: &Path, scene: &Scene<'_, T, D>) -> anyhow::Result<Option<f64>> {
    let radius = match scene.radii() {
        Radii::Uniform(r) => Some(r.wide()),
        Radii::Each(_) => None,
    };
    let columns = D + usize::from(radius.is_none());
    let mut file = std::io::BufWriter::new(std::fs::File::create(path)?);
    file.write_all(&header("<f8", scene.len(), columns))?;
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

/// Reads what [`write()`] wrote.
pub fn read(path: &Path, dim: u32, n: u64, radius: Option<f64>) -> anyhow::Result<AnyScene<'static>> {
    let scene = read::scene(path, read::Options { radius, dim: Some(dim), ..read::Options::NONE })?;
    ensure!(
        scene.dim() as u32 == dim && scene.len() as u64 == n,
        "{} holds {} elements in {}D, not {n} in {dim}D",
        path.display(),
        scene.len(),
        scene.dim()
    );
    Ok(scene)
}

/// Writes pairs as they are.
pub fn write_pairs(path: &Path, pairs: &[[u32; 2]]) -> anyhow::Result<()> {
    read::write::pairs(path, pairs)
}

/// Reads pairs: npy, `<u4`, shape (pairs, 2).
pub fn read_pairs(path: &Path) -> anyhow::Result<Vec<[u32; 2]>> {
    let bytes = std::fs::read(path).with_context(|| format!("cannot read the pairs {}", path.display()))?;
    ensure!(bytes.starts_with(b"\x93NUMPY\x01") && bytes.len() >= 10, "{} is not an npy file, version 1", path.display());
    let data = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    ensure!(bytes.len() >= data && (bytes.len() - data) % 8 == 0, "{} is cut off", path.display());
    ensure!(String::from_utf8_lossy(&bytes[10..data]).contains("<u4"), "{} does not hold little-endian u32", path.display());
    let word = |b: &[u8]| u32::from_le_bytes([b[0], b[1], b[2], b[3]]);
    Ok(bytes[data..].chunks_exact(8).map(|b| [word(&b[..4]), word(&b[4..])]).collect())
}

/// The header of an npy file, version 1.
pub fn header(kind: &str, rows: usize, columns: usize) -> Vec<u8> {
    let mut text = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({rows}, {columns}), }}");
    while (10 + text.len() + 1) % 64 != 0 {
        text.push(' ');
    }
    text.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((text.len() as u16).to_le_bytes());
    bytes.extend(text.as_bytes());
    bytes
}
