//! The table of formats, and the choice of a format for a file.

mod csv;
pub mod dump;
mod gsd;
mod lammps;
pub mod npy;
pub(super) mod npz;
mod poscar;
pub(super) mod unread;
mod vtk;
mod xyz;

use anyhow::{bail, ensure};

use crate::options::{Format, Options, Read};
use crate::raw::lines::Source;

/// A file whose frames are described by its index: a header, a table or a list of its arrays.
struct Indexed<'a, T> {
    source: Source<'a>,
    options: Options,
    /// `None` before the first frame is read.
    index: Option<T>,
    /// Number of the next frame.
    next: u64,
}

impl<'a, T> Indexed<'a, T> {
    fn new(source: Source<'a>, options: Options) -> Indexed<'a, T> {
        Indexed { source, options, index: None, next: 0 }
    }

    /// Moves to the next frame and returns its place, or `None` at the end.
    fn next_of(
        &mut self,
        read: impl FnOnce(&mut Source<'a>) -> anyhow::Result<T>,
        count: impl FnOnce(&T) -> u64,
    ) -> anyhow::Result<Option<String>> {
        let Indexed { source, index, next, .. } = self;
        let index = match index {
            Some(index) => index,
            None => index.insert(read(source)?),
        };
        *next += 1;
        Ok((*next <= count(index)).then(|| format!("{}: frame {}", source.name, *next - 1)))
    }
}

impl std::str::FromStr for &'static Format {
    type Err = String;

    fn from_str(text: &str) -> Result<&'static Format, String> {
        let found = FORMATS.iter().find(|format| format.key.eq_ignore_ascii_case(text));
        found.ok_or_else(|| format!("it must be one of {}", keys()))
    }
}

fn keys() -> String {
    FORMATS.iter().map(|format| format.key).collect::<Vec<_>>().join(", ")
}

macro_rules! formats {
    ($($key:literal $name:literal $endings:expr, $begins:literal, $help:literal,
        $tells:expr, $read:expr;)*) => {
        [$(Format {
            key: $key,
            help: $help,
            name: $name,
            endings: &$endings,
            begins: $begins,
            tells: $tells,
            read: $read,
        }),*]
    };
}

/// All formats, in the order in which their `tells` is tried.
pub static FORMATS: [Format; 9] = formats! {
    "npy" "NumPy" ["npy"], "\\x93NUMPY; write it with numpy.save", "NumPy array",
        |head| head.starts_with(npy::MAGIC), Read::Frames(npy::frames);
    "npz" "NumPy npz" ["npz"], "PK; write it with numpy.savez", "NumPy archive of arrays",
        |head| head.starts_with(b"PK\x03\x04") || head.starts_with(b"PK\x05\x06"),
        Read::Frames(npz::frames);
    "dump" "LAMMPS dump" ["dump", "lammpstrj"], "ITEM:", "LAMMPS and LIGGGHTS dump",
        |head| head.starts_with(b"ITEM:"), Read::Frames(dump::frames);
    "vtk" "VTK legacy" ["vtk"], "# vtk", "VTK legacy, text or binary",
        |head| head.starts_with(b"# vtk DataFile"), Read::Whole(vtk::read);
    "lammps-data" "LAMMPS data" ["lmp"], "", "LAMMPS data",
        lammps::tells, Read::Whole(lammps::read);
    "poscar" "POSCAR" ["poscar", "contcar", "vasp"], "", "POSCAR and CONTCAR of VASP",
        poscar::tells, Read::Whole(poscar::read);
    "xyz" "XYZ" ["xyz", "extxyz"], "", "XYZ and extended XYZ",
        xyz::tells, Read::Frames(xyz::frames);
    "gsd" "GSD" ["gsd"], "the bytes of GSD; write it with HOOMD or the Python package gsd",
        "GSD of HOOMD", |head| head.starts_with(gsd::MAGIC), Read::Frames(gsd::frames);
    "csv" "CSV" ["csv", "tsv"], "",
        "Columns, separated by comma, semicolon, tab or blanks; YADE's text files",
        |head| !head.contains(&0), Read::Frames(csv::frames);
};

/// Returns the format of a file, by the option, else by its first bytes and its ending.
pub fn find(
    head: &[u8],
    name: &str,
    ending: &str,
    options: Options,
) -> anyhow::Result<&'static Format> {
    let format = match options.format {
        Some(format) => format,
        None => detected(head, name, ending)?,
    };
    let chosen = options.columns.unwrap_or_default();
    for (key, only, is_given) in
        [("frame", "csv", chosen.by_frame()), ("points", "npz", chosen.points())]
    {
        ensure!(
            format.key == only || !is_given,
            "{name}: {key}= in --columns belongs to {only}, and this is {}; leave it out",
            format.name
        );
    }
    Ok(format)
}

fn detected(head: &[u8], name: &str, ending: &str) -> anyhow::Result<&'static Format> {
    unread::refuse(head, name)?;
    let ended = FORMATS.iter().find(|format| format.endings.contains(&ending));
    // Rows of numbers may look like another text, so these endings decide among texts.
    let text = ended.filter(|format| matches!(format.key, "csv" | "xyz" | "poscar"));
    let tells =
        |format: &&Format| (format.tells)(head) && (text.is_none() || !format.begins.is_empty());
    let format = FORMATS.iter().find(tells).or(text.filter(|_| !head.contains(&0)));
    match (format, ended) {
        (Some(format), Some(ended)) if format.begins.is_empty() && !ended.begins.is_empty() => {
            bail!("{name} is not a {} file: it does not begin with {}", ended.name, ended.begins)
        }
        (Some(format), _) => Ok(format),
        (None, _) => bail!(
            "{name} is binary, in no known format ({}); write npy, or CSV with a header x,y,z,r",
            keys()
        ),
    }
}
