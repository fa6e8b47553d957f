//! The table of formats: the one place where they are registered, and how they are told apart.

mod csv;
mod dump;
mod gsd;
pub mod gzip;
mod lammps;
mod mercury;
pub mod npy;
pub(super) mod npz;
mod ply;
pub(crate) mod unread;
mod vtk;
mod vtp;
pub mod xml;
mod xyz;

use anyhow::{bail, ensure};
pub(crate) use csv::names_a_frame;

use crate::frames::{Once, Reader};
use crate::lines::{Source, number, words};
use crate::pairs::fstat;
use crate::{About, Notice, Options, Particles};

/// A format of particle files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// Columns, separated by comma, semicolon, tab or blanks; YADE's text files
    Csv,
    /// XYZ and extended XYZ
    Xyz,
    /// LAMMPS and LIGGGHTS dump
    Dump,
    /// LAMMPS data
    LammpsData,
    /// MercuryDPM .data
    Mercury,
    /// NumPy array
    Npy,
    /// NumPy archive of arrays
    Npz,
    /// VTK legacy, text or binary
    Vtk,
    /// VTK XML: .vtp and .vtu
    Vtp,
    /// PLY, text or binary
    Ply,
    /// GSD of HOOMD
    Gsd,
}

impl std::str::FromStr for Format {
    type Err = String;

    fn from_str(text: &str) -> Result<Format, String> {
        <Format as clap::ValueEnum>::from_str(text, true)
            .map_err(|_| format!("it must be one of {}", names()))
    }
}

/// One line of the table.
pub struct Entry {
    /// Its name on the command line.
    pub format: Format,
    /// Its name for people.
    pub name: &'static str,
    /// Endings of file names.
    pub endings: &'static [&'static str],
    /// With what every such file begins, for messages; empty where anything may stand first.
    pub begins: &'static str,
    tells: fn(&[u8]) -> bool,
    read: Read,
}

/// Particles, and what was understood.
type Loaded = (Particles, About);

/// How a format is read.
enum Read {
    /// A file is one frame.
    Whole(fn(Source<'_>, Options) -> anyhow::Result<Loaded>),
    /// It may have several.
    Frames(for<'a> fn(Source<'a>, Options) -> Box<dyn Reader<Loaded> + 'a>),
}

impl Entry {
    /// The frames of a file of this format.
    pub fn open<'a>(&self, source: Source<'a>, options: Options) -> Box<dyn Reader<Loaded> + 'a> {
        match self.read {
            Read::Whole(read) => Box::new(Once::new(move || read(source, options))),
            Read::Frames(open) => open(source, options),
        }
    }
}

/// All formats. The first whose bytes tell is taken.
pub static FORMATS: [Entry; 11] = [
    Entry {
        format: Format::Npy,
        name: "NumPy",
        endings: &["npy"],
        begins: "\\x93NUMPY; write it with numpy.save",
        tells: |head| head.starts_with(npy::MAGIC),
        read: Read::Frames(npy::frames),
    },
    Entry {
        format: Format::Npz,
        name: "NumPy npz",
        endings: &["npz"],
        begins: "PK; write it with numpy.savez",
        tells: |head| head.starts_with(b"PK\x03\x04") || head.starts_with(b"PK\x05\x06"),
        read: Read::Frames(npz::frames),
    },
    Entry {
        format: Format::Dump,
        name: "LAMMPS dump",
        endings: &["dump", "lammpstrj"],
        begins: "ITEM:",
        tells: |head| head.starts_with(b"ITEM:"),
        read: Read::Frames(dump::frames),
    },
    Entry {
        format: Format::Vtk,
        name: "VTK legacy",
        endings: &["vtk"],
        begins: "# vtk",
        tells: |head| head.starts_with(b"# vtk DataFile"),
        read: Read::Whole(vtk::read),
    },
    Entry {
        format: Format::Vtp,
        name: "VTK XML",
        endings: &["vtp", "vtu"],
        begins: "<?xml or <VTKFile",
        tells: |head| head.trim_ascii_start().starts_with(b"<"),
        read: Read::Whole(vtp::read),
    },
    Entry {
        format: Format::Ply,
        name: "PLY",
        endings: &["ply"],
        begins: "ply",
        tells: |head| head.starts_with(b"ply\n") || head.starts_with(b"ply\r"),
        read: Read::Whole(ply::read),
    },
    Entry {
        format: Format::LammpsData,
        name: "LAMMPS data",
        endings: &["lmp"],
        begins: "",
        tells: lammps::tells,
        read: Read::Whole(lammps::read),
    },
    Entry {
        format: Format::Mercury,
        name: "MercuryDPM data",
        endings: &[],
        begins: "",
        tells: mercury::tells,
        read: Read::Frames(mercury::frames),
    },
    Entry {
        format: Format::Xyz,
        name: "XYZ",
        endings: &["xyz", "extxyz"],
        begins: "",
        tells: |_| false,
        read: Read::Frames(xyz::frames),
    },
    Entry {
        format: Format::Csv,
        name: "CSV",
        endings: &["csv", "tsv"],
        begins: "",
        tells: |_| false,
        read: Read::Frames(csv::frames),
    },
    Entry {
        format: Format::Gsd,
        name: "GSD",
        endings: &["gsd"],
        begins: "the bytes of GSD; write it with HOOMD or the Python package gsd",
        tells: |head| head.starts_with(gsd::MAGIC),
        read: Read::Frames(gsd::frames),
    },
];

fn entry(format: Format) -> &'static Entry {
    // The table has an entry for every format: a test holds it to that.
    FORMATS.iter().find(|entry| entry.format == format).unwrap_or(&FORMATS[0])
}

/// The format of a file that begins with `head`.
pub fn find(
    head: &[u8],
    name: &str,
    ending: &str,
    options: Options,
) -> anyhow::Result<&'static Entry> {
    let entry = told(head, name, ending, options)?;
    ensure!(
        entry.format == Format::Csv || !options.columns.is_some_and(|chosen| chosen.by_frame()),
        "{name}: frame= in --columns belongs to tables, and this is {}; leave it out",
        entry.name
    );
    ensure!(
        entry.format != Format::Gsd || options.columns.is_none(),
        "{name}: {} has one array of diameters; leave out --columns",
        entry.name
    );
    Ok(entry)
}

fn told(head: &[u8], name: &str, ending: &str, options: Options) -> anyhow::Result<&'static Entry> {
    if let Some(format) = options.format {
        return Ok(entry(format));
    }
    unread::refuse(head, name, None)?;
    ensure!(
        ending != "fstat" && !fstat::tells(head, true),
        "{name} is a contact list of MercuryDPM (fstat); give it to verify --pairs, and the .data \
         file beside it for the particles"
    );
    let ended = FORMATS.iter().find(|entry| entry.endings.contains(&ending));
    // A name that says csv or xyz is believed: what tells data files could stand in columns, too.
    let believed = ended.filter(|entry| matches!(entry.format, Format::Csv | Format::Xyz));
    let strict = |entry: &&Entry| {
        believed.is_none() || !entry.begins.is_empty() && entry.format != Format::Vtp
    };
    if let Some(entry) = FORMATS.iter().filter(strict).find(|entry| (entry.tells)(head)) {
        return Ok(entry);
    }
    if let Some(entry) = ended.filter(|entry| !entry.begins.is_empty()) {
        bail!("{name} is not a {} file: it does not begin with {}", entry.name, entry.begins);
    }
    ensure!(
        !head.contains(&0),
        "{name} is binary, in no format that is known; write its particles as npy, or as CSV with \
         a header x,y,z,r (--format takes one of {})",
        names()
    );
    if let Some(entry) = believed {
        return Ok(entry);
    }
    let counted = words(head.split(|&b| b == b'\n').next().unwrap_or_default())
        .map(number)
        .collect::<Vec<_>>();
    let whole = |x: f64| x >= 0.0 && x.fract() == 0.0;
    Ok(entry(if matches!(counted[..], [Some(n)] if whole(n)) { Format::Xyz } else { Format::Csv }))
}

/// All names, for messages.
fn names() -> String {
    format_names().collect::<Vec<_>>().join(", ")
}

/// The names of the formats on the command line.
pub fn format_names() -> impl Iterator<Item = String> {
    let values =
        FORMATS.iter().filter_map(|entry| clap::ValueEnum::to_possible_value(&entry.format));
    values.map(|value| value.get_name().to_string())
}

/// Returns a notice if an unused column or array may tell frames apart, judging by its name. Dumps
/// and similar formats have frames of their own.
pub(crate) fn maybe_frames(format: &str, unused: &[String]) -> Option<Notice> {
    let table = format == "CSV" || format == "YADE text";
    let arrays = ["NumPy", "PLY"].iter().any(|name| format.starts_with(name));
    (table || arrays).then(|| csv::maybe_frames(unused, table)).flatten()
}
