//! Writes pairs and scenes to files.
//!
//! | format | pairs | in a periodic box |
//! |---|---|---|
//! | CSV | `i,j` | `i,j,sx,sy[,sz]`, with the image of j |
//! | npy | (pairs, 2), u32 | (pairs, 2 + dim), i32 |
//! | legacy VTK | lines | lines to the image |
//!
//! [`Style`] adds ids and further columns, [`framed()`] the frame. Scenes are written as CSV,
//! extended XYZ or npy. Numbers are the shortest that read back to the same bits. Pairs keep their
//! order; [`contactbench_ground::pairs::normalise::normalise`] gives the usual one.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use anyhow::{Context, bail, ensure};

use crate::formats::npy;
use crate::load::ending;
use crate::particles::Given;
use contactbench_ground::periodic::ImagePair;
use contactbench_ground::scene::{Real, Scene, array};
use contactbench_ground::with_scene;

mod framed;
mod row;
mod vtk;
pub use framed::{Framed, framed, of_file};
pub use row::{Extra, Style, counts};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PairFormat {
    Csv,
    Npy,
    /// Legacy VTK as text: centres with radii, and a line between the centres of each pair.
    Vtk,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SceneFormat {
    Csv,
    Xyz,
    Npy,
}

/// Returns the format for the ending of a pair file. Callers check it before the work starts.
pub fn format(path: &Path) -> anyhow::Result<PairFormat> {
    Ok(match ending(path).as_str() {
        "csv" => PairFormat::Csv,
        "npy" => PairFormat::Npy,
        "vtk" => PairFormat::Vtk,
        _ => bail!("{}: the ending of a file of pairs must be .csv, .npy or .vtk", path.display()),
    })
}

pub fn scene_format(path: &Path) -> anyhow::Result<SceneFormat> {
    Ok(match ending(path).as_str() {
        "csv" => SceneFormat::Csv,
        "xyz" | "extxyz" => SceneFormat::Xyz,
        "npy" => SceneFormat::Npy,
        _ => bail!("{}: the ending of a scene must be .csv, .xyz or .npy", path.display()),
    })
}

pub(crate) fn create(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> anyhow::Result<()> {
    whole(path, write).with_context(|| format!("cannot write {}", path.display()))
}

/// Writes a file completely or not at all. The data go to a temporary file in the same folder,
/// whose name starts with a dot; when complete, it replaces the target. Pipes and devices are
/// written directly.
///
/// # Errors
/// I/O errors, and those of `write`. The target is then unchanged.
pub fn whole<T, E: From<io::Error>>(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> Result<T, E>,
) -> Result<T, E> {
    let fill = |file: &mut File| -> Result<T, E> {
        let mut out = BufWriter::with_capacity(1 << 16, file);
        let done = write(&mut out)?;
        out.flush()?;
        Ok(done)
    };
    // A symbolic link is followed, so that the link itself stays.
    let path = &path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
    let before = std::fs::metadata(path).ok();
    if before.as_ref().is_some_and(|before| !before.is_file()) {
        return fill(&mut File::options().write(true).open(path)?);
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    // If the folder is missing, this error names it; a later error would name the temporary file.
    std::fs::metadata(folder.unwrap_or(Path::new(".")))?;
    let mut prefix = std::ffi::OsString::from(".");
    prefix.push(path.file_name().unwrap_or_default());
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(".part");
    // Temporary files are private by default; this is the usual mode of a new file.
    #[cfg(unix)]
    let new: std::fs::Permissions = std::os::unix::fs::PermissionsExt::from_mode(0o666);
    #[cfg(unix)]
    builder.permissions(new);
    let mut file = builder.tempfile_in(folder.unwrap_or(Path::new(".")))?;
    let part = file.path().to_path_buf();
    unfinished().push(part.clone());
    if let Some(before) = before {
        file.as_file().set_permissions(before.permissions())?;
    }
    let done = fill(file.as_file_mut());
    let done = done.and_then(|done| {
        file.persist(path).map_err(io::Error::from)?;
        Ok(done)
    });
    unfinished().retain(|path| *path != part);
    done
}

/// Paths of temporary files, which a signal would leave behind.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes the temporary files of this process, before a signal ends it.
pub fn remove_unfinished() {
    for path in unfinished().iter() {
        let _ = std::fs::remove_file(path);
    }
}

/// Appends to a file, which is created if needed. The error names the `option` that chooses another
/// file.
pub fn append(path: &Path, text: &str, option: &str) -> anyhow::Result<()> {
    let file = File::options().create(true).append(true).open(path);
    file.and_then(|mut file| file.write_all(text.as_bytes())).with_context(|| {
        format!("cannot append to {}; choose another place with {option}", path.display())
    })
}

pub fn contacts(
    path: Option<&Path>,
    contacts: impl ExactSizeIterator<Item = ImagePair>,
    style: &Style<'_>,
) -> anyhow::Result<()> {
    match path {
        Some(path) if format(path)? == PairFormat::Vtk => create(
            path,
            |out| with_scene!(style.scene, scene => vtk::write(out, contacts, scene, style)),
        ),
        _ => framed(path, false, |out| out.frame(0, style, contacts)),
    }
}

/// Writes a scene to a file whose ending gives the format. Only extended XYZ stores the box.
pub fn scene(path: &Path, given: &Given) -> anyhow::Result<()> {
    let format = scene_format(path)?;
    let (fits, name) = (given.lattice.is_none() || format == SceneFormat::Xyz, path.display());
    ensure!(fits, "{name}: the scene has a periodic box, which only .xyz files store; write .xyz");
    create(path, |out| scene_to(out, format, given))
}

/// Writes a scene; formats other than extended XYZ omit the box.
pub fn scene_to(out: &mut dyn Write, format: SceneFormat, given: &Given) -> io::Result<()> {
    let (n, dim) = (given.scene.len(), given.scene.dim());
    let (before, separator) = match format {
        SceneFormat::Npy => {
            return with_scene!(&given.scene, scene => scene_npy(out, scene, true));
        }
        SceneFormat::Csv => {
            out.write_all(if dim == 2 { b"x,y,r\n" } else { b"x,y,z,r\n" })?;
            ("", ",")
        }
        SceneFormat::Xyz => {
            writeln!(out, "{n}")?;
            if let Some(lattice) = &given.lattice {
                let text = |numbers: &[f64]| {
                    numbers.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(" ")
                };
                let flags = lattice.periodic().map(|yes| if yes { "T" } else { "F" }).join(" ");
                let vectors = text(lattice.vectors().as_flattened());
                let origin = text(&lattice.origin());
                write!(out, "Lattice=\"{vectors}\" pbc=\"{flags}\" Origin=\"{origin}\" ")?;
            }
            writeln!(out, "Properties=species:S:1:pos:R:{dim}:radius:R:1")?;
            ("X ", " ")
        }
    };
    with_scene!(&given.scene, scene => (0..n).try_for_each(|k| {
        out.write_all(before.as_bytes())?;
        line(out, row(scene, k), separator)
    }))
}

fn row<T: Real, const D: usize>(scene: &Scene<'_, T, D>, k: usize) -> impl Iterator<Item = f64> {
    array(&scene.centres()[k]).map(|x| x.wide()).into_iter().chain([scene.radius(k).wide()])
}

fn line(out: &mut dyn Write, row: impl Iterator<Item = f64>, separator: &str) -> io::Result<()> {
    for (k, x) in row.enumerate() {
        // {:?} prints the shortest form that reads back, with an exponent if that is shorter.
        write!(out, "{}{x:?}", if k == 0 { "" } else { separator })?;
    }
    out.write_all(b"\n")
}

pub(crate) fn scene_npy<T: Real, const D: usize>(
    out: &mut dyn Write,
    scene: &Scene<'_, T, D>,
    has_radii: bool,
) -> io::Result<()> {
    let columns = D + usize::from(has_radii);
    npy::write_header(out, "<f8", scene.len(), columns)?;
    (0..scene.len()).try_for_each(|k| {
        row(scene, k).take(columns).try_for_each(|x| out.write_all(&x.to_le_bytes()))
    })
}
