//! The table of formats: the one place where they are registered, and how they are told apart.

use anyhow::{bail, ensure};

use super::lines::{Source, number, words};
use super::{About, Options, Particles, csv, dump, lammps, mercury, npy, npz, ply, vtk, vtp, xyz};

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
}

impl std::str::FromStr for Format {
    type Err = String;

    fn from_str(text: &str) -> Result<Format, String> {
        <Format as clap::ValueEnum>::from_str(text, true).map_err(|_| format!("it must be one of {}", names()))
    }
}

/// One line of the table.
pub struct Entry {
    /// Its name on the command line.
    pub format: Format,
    /// Endings of file names.
    pub endings: &'static [&'static str],
    /// With what every such file begins, for messages; empty where anything may stand first.
    pub begins: &'static str,
    tells: fn(&[u8]) -> bool,
    pub(super) read: fn(Source<'_>, Options) -> anyhow::Result<(Particles, About)>,
}

/// All formats. The first whose bytes tell is taken.
pub static FORMATS: [Entry; 10] = [
    Entry {
        format: Format::Npy,
        endings: &["npy"],
        begins: "\\x93NUMPY; write it with numpy.save",
        tells: |head| head.starts_with(npy::MAGIC),
        read: npy::read,
    },
    Entry {
        format: Format::Npz,
        endings: &["npz"],
        begins: "PK; write it with numpy.savez",
        tells: |head| head.starts_with(b"PK\x03\x04") || head.starts_with(b"PK\x05\x06"),
        read: npz::read,
    },
    Entry {
        format: Format::Dump,
        endings: &["dump", "lammpstrj"],
        begins: "ITEM:",
        tells: |head| head.starts_with(b"ITEM:"),
        read: dump::read,
    },
    Entry { format: Format::Vtk, endings: &["vtk"], begins: "# vtk", tells: |head| head.starts_with(b"# vtk DataFile"), read: vtk::read },
    Entry {
        format: Format::Vtp,
        endings: &["vtp", "vtu"],
        begins: "<?xml or <VTKFile",
        tells: |head| head.trim_ascii_start().starts_with(b"<"),
        read: vtp::read,
    },
    Entry {
        format: Format::Ply,
        endings: &["ply"],
        begins: "ply",
        tells: |head| head.starts_with(b"ply\n") || head.starts_with(b"ply\r"),
        read: ply::read,
    },
    Entry { format: Format::LammpsData, endings: &["lmp"], begins: "", tells: lammps::tells, read: lammps::read },
    Entry { format: Format::Mercury, endings: &[], begins: "", tells: mercury::tells, read: mercury::read },
    Entry { format: Format::Xyz, endings: &["xyz", "extxyz"], begins: "", tells: |_| false, read: xyz::read },
    Entry { format: Format::Csv, endings: &["csv", "tsv"], begins: "", tells: |_| false, read: csv::read },
];

fn entry(format: Format) -> &'static Entry {
    // The table has an entry for every format: a test holds it to that.
    FORMATS.iter().find(|entry| entry.format == format).unwrap_or(&FORMATS[FORMATS.len() - 1])
}

/// The format of a file that begins with `head`.
pub(super) fn of(head: &[u8], name: &str, ending: &str, options: Options) -> anyhow::Result<&'static Entry> {
    if let Some(format) = options.format {
        return Ok(entry(format));
    }
    let ended = FORMATS.iter().find(|entry| entry.endings.contains(&ending));
    // A name that says csv or xyz is believed: what tells data files could stand in columns, too.
    if let Some(entry) = ended.filter(|entry| entry.begins.is_empty() && matches!(entry.format, Format::Csv | Format::Xyz)) {
        let strict = FORMATS.iter().find(|other| !other.begins.is_empty() && other.format != Format::Vtp && (other.tells)(head));
        return Ok(strict.unwrap_or(entry));
    }
    if let Some(entry) = FORMATS.iter().find(|entry| (entry.tells)(head)) {
        return Ok(entry);
    }
    if let Some(entry) = ended.filter(|entry| !entry.begins.is_empty()) {
        bail!("{name} is no {ending} file: it does not begin with {}", entry.begins);
    }
    ensure!(
        !head.contains(&0),
        "{name} is binary, in no format that is known; write its particles as npy, or as CSV with a header x,y,z,r (--format takes one of {})",
        names()
    );
    let counted = words(head.split(|&b| b == b'\n').next().unwrap_or_default()).map(number).collect::<Vec<_>>();
    let whole = |x: f64| x >= 0.0 && x.fract() == 0.0;
    Ok(entry(if matches!(counted[..], [Some(n)] if whole(n)) { Format::Xyz } else { Format::Csv }))
}

/// All names, for messages.
fn names() -> String {
    let names = FORMATS.iter().filter_map(|entry| clap::ValueEnum::to_possible_value(&entry.format));
    names.map(|value| value.get_name().to_string()).collect::<Vec<_>>().join(", ")
}
