//! The table of formats, and the choice of a format for a file.

mod csv;
mod dump;
mod gsd;
pub mod gzip;
mod lammps;
mod mercury;
pub mod npy;
pub(super) mod npz;
mod ply;
pub(super) mod unread;
mod vtk;
mod vtp;
pub mod xml;
mod xyz;

use anyhow::{bail, ensure};
pub(crate) use csv::names_a_frame;

use crate::frames::{Once, Reader};
use crate::pairs::fstat;
use crate::raw::lines::{Source, number, words};
use crate::{Loaded, Notice, Options};

pub struct Format {
    pub key: &'static str,
    /// Contents of a file in this format, for the help.
    pub help: &'static str,
    pub name: &'static str,
    pub endings: &'static [&'static str],
    /// The start of every such file, for messages; empty if files may start with anything.
    pub begins: &'static str,
    tells: fn(&[u8]) -> bool,
    read: Read,
}

enum Read {
    Whole(fn(Source<'_>, Options) -> anyhow::Result<Loaded>),
    Frames(fn(Source<'_>, Options) -> Opened<'_>),
}

pub type Opened<'a> = Box<dyn Reader<Loaded> + 'a>;

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
}

impl PartialEq for Format {
    fn eq(&self, other: &Format) -> bool {
        self.key == other.key
    }
}

impl std::fmt::Debug for Format {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.key)
    }
}

impl std::str::FromStr for &'static Format {
    type Err = String;

    fn from_str(text: &str) -> Result<&'static Format, String> {
        let all = || FORMATS.iter().map(|format| format.key).collect::<Vec<_>>().join(", ");
        let found = FORMATS.iter().find(|format| format.key.eq_ignore_ascii_case(text));
        found.ok_or_else(|| format!("it must be one of {}", all()))
    }
}

impl Format {
    pub fn open<'a>(&self, source: Source<'a>, options: Options) -> Opened<'a> {
        match self.read {
            Read::Whole(read) => Box::new(Once::new(move || read(source, options))),
            Read::Frames(open) => open(source, options),
        }
    }
}

/// All formats, in the order in which their `tells` is tried.
pub static FORMATS: [Format; 11] = [
    Format {
        key: "npy",
        help: "NumPy array",
        name: "NumPy",
        endings: &["npy"],
        begins: "\\x93NUMPY; write it with numpy.save",
        tells: |head| head.starts_with(npy::MAGIC),
        read: Read::Frames(npy::frames),
    },
    Format {
        key: "npz",
        help: "NumPy archive of arrays",
        name: "NumPy npz",
        endings: &["npz"],
        begins: "PK; write it with numpy.savez",
        tells: |head| head.starts_with(b"PK\x03\x04") || head.starts_with(b"PK\x05\x06"),
        read: Read::Frames(npz::frames),
    },
    Format {
        key: "dump",
        help: "LAMMPS and LIGGGHTS dump",
        name: "LAMMPS dump",
        endings: &["dump", "lammpstrj"],
        begins: "ITEM:",
        tells: |head| head.starts_with(b"ITEM:"),
        read: Read::Frames(dump::frames),
    },
    Format {
        key: "vtk",
        help: "VTK legacy, text or binary",
        name: "VTK legacy",
        endings: &["vtk"],
        begins: "# vtk",
        tells: |head| head.starts_with(b"# vtk DataFile"),
        read: Read::Whole(vtk::read),
    },
    Format {
        key: "vtp",
        help: "VTK XML: .vtp and .vtu",
        name: "VTK XML",
        endings: &["vtp", "vtu"],
        begins: "<?xml or <VTKFile",
        tells: |head| head.trim_ascii_start().starts_with(b"<"),
        read: Read::Whole(vtp::read),
    },
    Format {
        key: "ply",
        help: "PLY, text or binary",
        name: "PLY",
        endings: &["ply"],
        begins: "ply",
        tells: |head| head.starts_with(b"ply\n") || head.starts_with(b"ply\r"),
        read: Read::Whole(ply::read),
    },
    Format {
        key: "lammps-data",
        help: "LAMMPS data",
        name: "LAMMPS data",
        endings: &["lmp"],
        begins: "",
        tells: lammps::tells,
        read: Read::Whole(lammps::read),
    },
    Format {
        key: "mercury",
        help: "MercuryDPM .data",
        name: "MercuryDPM data",
        endings: &[],
        begins: "",
        tells: mercury::tells,
        read: Read::Frames(mercury::frames),
    },
    Format {
        key: "xyz",
        help: "XYZ and extended XYZ",
        name: "XYZ",
        endings: &["xyz", "extxyz"],
        begins: "",
        tells: |_| false,
        read: Read::Frames(xyz::frames),
    },
    Format {
        key: "csv",
        help: "Columns, separated by comma, semicolon, tab or blanks; YADE's text files",
        name: "CSV",
        endings: &["csv", "tsv"],
        begins: "",
        tells: |_| false,
        read: Read::Frames(csv::frames),
    },
    Format {
        key: "gsd",
        help: "GSD of HOOMD",
        name: "GSD",
        endings: &["gsd"],
        begins: "the bytes of GSD; write it with HOOMD or the Python package gsd",
        tells: |head| head.starts_with(gsd::MAGIC),
        read: Read::Frames(gsd::frames),
    },
];

pub fn find(
    head: &[u8],
    name: &str,
    ending: &str,
    options: Options,
) -> anyhow::Result<&'static Format> {
    let format = told(head, name, ending, options)?;
    ensure!(
        format.key == "csv" || !options.columns.is_some_and(|chosen| chosen.by_frame()),
        "{name}: frame= in --columns belongs to tables, and this is {}; leave it out",
        format.name
    );
    ensure!(
        format.key != "gsd" || options.columns.is_none(),
        "{name}: {} has one array of diameters; leave out --columns",
        format.name
    );
    Ok(format)
}

fn told(
    head: &[u8],
    name: &str,
    ending: &str,
    options: Options,
) -> anyhow::Result<&'static Format> {
    if let Some(format) = options.format {
        return Ok(format);
    }
    unread::refuse(head, name, None)?;
    ensure!(
        ending != "fstat" && !fstat::tells(head, true),
        "{name} is a contact list of MercuryDPM (fstat); give it to verify --pairs, and the .data \
         file beside it for the particles"
    );
    let ended = FORMATS.iter().find(|format| format.endings.contains(&ending));
    // The endings csv and xyz take precedence, because rows of numbers may look like another
    // format.
    let believed = ended.filter(|format| matches!(format.key, "csv" | "xyz"));
    let strict =
        |format: &&Format| believed.is_none() || !format.begins.is_empty() && format.key != "vtp";
    if let Some(format) = FORMATS.iter().filter(strict).find(|format| (format.tells)(head)) {
        return Ok(format);
    }
    if let Some(format) = ended.filter(|format| !format.begins.is_empty()) {
        bail!("{name} is not a {} file: it does not begin with {}", format.name, format.begins);
    }
    ensure!(
        !head.contains(&0),
        "{name} is binary, in no format that is known; write its particles as npy, or as CSV with \
         a header x,y,z,r (--format takes one of {})",
        FORMATS.iter().map(|format| format.key).collect::<Vec<_>>().join(", ")
    );
    if let Some(format) = believed {
        return Ok(format);
    }
    let counted = words(head.split(|&b| b == b'\n').next().unwrap_or_default())
        .map(number)
        .collect::<Vec<_>>();
    let whole = |x: f64| x >= 0.0 && x.fract() == 0.0;
    let key = if matches!(counted[..], [Some(n)] if whole(n)) { "xyz" } else { "csv" };
    key.parse().map_err(anyhow::Error::msg)
}

/// Returns a notice if the name of an unused column or array hints at frames. Formats with frames
/// of their own need none.
pub(crate) fn maybe_frames(format: &str, unused: &[String]) -> Option<Notice> {
    let table = format == "CSV" || format == "YADE text";
    let arrays = ["NumPy", "PLY"].iter().any(|name| format.starts_with(name));
    (table || arrays).then(|| csv::maybe_frames(unused, table)).flatten()
}
