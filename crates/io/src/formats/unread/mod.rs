//! Formats that are known and not read: what each is called, by what it is known, and the way out.

use anyhow::bail;

use crate::lines::{number, words};

/// One line of the table.
pub(crate) struct Unread {
    /// With its article, for messages.
    pub name: &'static str,
    tells: fn(&[u8]) -> bool,
    way: &'static str,
}

const ASE: &str = "convert it to extended XYZ with ASE (python: ase.io.write('p.xyz', \
                   ase.io.read('FILE'))), and give --radius";
const MESH: &str = "a mesh has corners, not particles; write the particles' centres and radii as \
                      CSV with a header x,y,z,r";
const ARRAYS: &str = "write its arrays of positions and radii from Python with numpy.savez (x, y, \
                      z, r)";
const TABLE: &str = "export it as CSV with a header x,y,z,r";
const UNPACK: &str = "unpack it first";
const CUSTOM: &str = "write a text dump of style custom with id x y z radius";

/// All of them. The first that fits is named.
pub(crate) static UNREAD: &[Unread] = &[
    // Packed files.
    Unread { name: "compressed with bzip2", tells: |b| b.starts_with(b"BZh"), way: UNPACK },
    Unread { name: "compressed with xz", tells: |b| b.starts_with(b"\xfd7zXZ\0"), way: UNPACK },
    Unread { name: "compressed with lzma", tells: |b| b.starts_with(b"]\0\0"), way: UNPACK },
    Unread { name: "compressed with zstd", tells: |b| b.starts_with(b"(\xb5/\xfd"), way: UNPACK },
    Unread { name: "compressed with lz4", tells: |b| b.starts_with(b"\x04\"M\x18"), way: UNPACK },
    Unread { name: "compressed with compress", tells: |b| b.starts_with(b"\x1f\x9d"), way: UNPACK },
    Unread { name: "a 7z archive", tells: |b| b.starts_with(b"7z\xbc\xaf\x27\x1c"), way: UNPACK },
    Unread { name: "a rar archive", tells: |b| b.starts_with(b"Rar!\x1a"), way: UNPACK },
    Unread { name: "a tar archive", tells: |b| b.get(257..262) == Some(b"ustar"), way: UNPACK },
    Unread {
        name: "an Excel workbook",
        tells: |b| {
            let first = |name: &[u8]| zipped(b).is_some_and(|it| it.starts_with(name));
            first(b"[Content_Types]") || first(b"xl/") || b.starts_with(b"\xd0\xcf\x11\xe0")
        },
        way: TABLE,
    },
    Unread {
        name: "a zip archive whose first file is not a NumPy array",
        tells: |b| zipped(b).is_some_and(|name| !name.ends_with(b".npy")),
        way: UNPACK,
    },
    // Binary files.
    Unread { name: "an HDF5 file", tells: |b| b.starts_with(b"\x89HDF\r\n"), way: ARRAYS },
    Unread {
        name: "a NetCDF file",
        tells: |b| [&b"CDF\x01"[..], b"CDF\x02", b"CDF\x05"].iter().any(|m| b.starts_with(m)),
        way: ARRAYS,
    },
    Unread { name: "a MATLAB file", tells: |b| b.starts_with(b"MATLAB "), way: TABLE },
    Unread { name: "a pickle of Python", tells: |b| matches!(b, [0x80, 2..=5, ..]), way: ARRAYS },
    Unread { name: "a Parquet file", tells: |b| b.starts_with(b"PAR1"), way: TABLE },
    Unread {
        name: "an Arrow or Feather file",
        tells: |b| b.starts_with(b"ARROW1") || b.starts_with(b"FEA1"),
        way: TABLE,
    },
    Unread { name: "an SQLite database", tells: |b| b.starts_with(b"SQLite format"), way: TABLE },
    Unread { name: "a trajectory of ASE", tells: |b| b.starts_with(b"- of Ulm"), way: ASE },
    Unread { name: "a DCD file", tells: |b| b.get(4..8) == Some(b"CORD"), way: ASE },
    Unread { name: "an XTC file", tells: |b| b.starts_with(b"\0\0\x07\xcb"), way: ASE },
    Unread { name: "a TRR file", tells: |b| b.starts_with(b"\0\0\x07\xc9"), way: ASE },
    Unread {
        name: "a binary restart of LAMMPS",
        tells: |b| b.starts_with(b"LammpS RestartT"),
        way: "write a data file: lmp -restart2data FILE p.data",
    },
    Unread {
        name: "a binary dump of LAMMPS",
        tells: |b| b.get(8..12) == Some(b"DUMP"),
        way: "turn it into text with LAMMPS's binary2txt, or write a text dump",
    },
    Unread { name: "a LAS or LAZ point cloud", tells: |b| b.starts_with(b"LASF"), way: TABLE },
    Unread {
        name: "UTF-16 text",
        tells: |b| b.starts_with(b"\xff\xfe") || b.starts_with(b"\xfe\xff"),
        way: "save it as UTF-8: iconv -f UTF-16 -t UTF-8 FILE",
    },
    Unread { name: "a PDF", tells: |b| b.starts_with(b"%PDF"), way: TABLE },
    Unread {
        name: "a picture",
        tells: |b| b.starts_with(b"\x89PNG") || b.starts_with(b"\xff\xd8\xff"),
        way: "give the particles that were drawn",
    },
    Unread { name: "a glTF mesh", tells: |b| b.starts_with(b"glTF"), way: MESH },
    Unread { name: "a binary STL mesh", tells: stl, way: MESH },
    // Texts.
    Unread {
        name: "a pointer of Git LFS",
        tells: |b| b.starts_with(b"version https://git-lfs"),
        way: "the file itself comes with: git lfs pull",
    },
    Unread {
        name: "a web page",
        tells: |b| {
            let start = b.trim_ascii_start().to_ascii_lowercase();
            start.starts_with(b"<!doctype html") || start.starts_with(b"<html")
        },
        way: "the address gave a page in place of the file; download the file itself",
    },
    Unread { name: "a JSON file", tells: json, way: TABLE },
    Unread {
        name: "a LAMMPS dump of style yaml",
        tells: |b| b.starts_with(b"---") && has(b, b"natoms:"),
        way: CUSTOM,
    },
    Unread { name: "a YAML file", tells: |b| lines(b).next() == Some(b"---"), way: TABLE },
    Unread { name: "a PDB file", tells: pdb, way: ASE },
    Unread {
        name: "a CIF file",
        tells: |b| {
            let first = lines(b).find(|line| !line.is_empty() && !line.starts_with(b"#"));
            first.is_some_and(|line| line.starts_with(b"data_") && words(line).count() == 1)
        },
        way: ASE,
    },
    Unread { name: "a GROMACS file (gro)", tells: gro, way: ASE },
    Unread {
        name: "a topology of GROMACS (itp, top)",
        tells: itp,
        way: "it has no coordinates; convert the .gro file beside it to extended XYZ with ASE",
    },
    Unread {
        name: "a restart file of MercuryDPM",
        tells: |b| b.starts_with(b"restart_version"),
        way: "give the .data file beside it, which has the same particles",
    },
    Unread {
        name: "a table of TrackMate with four header rows",
        tells: |b| {
            let mut heads = lines(b);
            let first = heads.next().is_some_and(|line| has(line, b"POSITION_X"));
            first && heads.next().is_some_and(|line| has(line, b"Spot ID"))
        },
        way: "leave out the three rows behind the first (sed 2,4d FILE), and give --columns \
              id=ID,x=POSITION_X,y=POSITION_Y,z=POSITION_Z,r=RADIUS",
    },
    Unread { name: "a VASP file (POSCAR)", tells: poscar, way: ASE },
    Unread {
        name: "an AtomEye file (cfg)",
        tells: |b| b.starts_with(b"Number of particles"),
        way: ASE,
    },
    Unread {
        name: "a point cloud of PCL (pcd)",
        tells: |b| {
            b.starts_with(b"# .PCD")
                || b.starts_with(b"VERSION") && lines(b).any(|line| line.starts_with(b"FIELDS "))
        },
        way: TABLE,
    },
    Unread {
        name: "a file of Kratos (mdpa)",
        tells: |b| b.starts_with(b"Begin ") && words(b).nth(1).is_some_and(|w| w.len() > 4),
        way: "write its nodes and their RADIUS as CSV with a header x,y,z,r",
    },
    Unread {
        name: "a geometry of ESyS-Particle (geo)",
        tells: |b| b.starts_with(b"LSMGeometry"),
        way: "write the lines between BeginParticles and EndParticles as CSV with a header \
              x,y,z,r",
    },
    Unread {
        name: "an STL mesh",
        tells: |b| b.starts_with(b"solid") && has(b, b"facet"),
        way: MESH,
    },
    Unread { name: "an OBJ mesh", tells: obj, way: MESH },
    Unread { name: "an OFF mesh", tells: |b| lines(b).next() == Some(b"OFF"), way: MESH },
];

/// Refuses a file in one of these formats by its name. `way` is the way out where the file should
/// hold other things than particles.
pub fn refuse(head: &[u8], file: &str, way: Option<&str>) -> anyhow::Result<()> {
    let Some(unread) = UNREAD.iter().find(|unread| (unread.tells)(head)) else { return Ok(()) };
    // What is packed, or not the file at all, may hold either.
    let either = ["a pointer of Git LFS", "a web page", "UTF-16 text"].contains(&unread.name);
    let way = way.filter(|_| unread.way != UNPACK && !either).unwrap_or(unread.way);
    let way = way.replace("FILE", file);
    let read = if unread.name.starts_with("compressed") { "" } else { ", which is not read" };
    bail!("{file} is {}{read}: {way}", unread.name)
}

/// The lines of the beginning, without blanks around them.
fn lines(head: &[u8]) -> impl Iterator<Item = &[u8]> {
    head.split(|&b| b == b'\n').map(<[u8]>::trim_ascii)
}

fn has(head: &[u8], part: &[u8]) -> bool {
    head.windows(part.len()).any(|window| window == part)
}

/// The name of the first file of a zip archive.
fn zipped(head: &[u8]) -> Option<&[u8]> {
    let rest = head.strip_prefix(b"PK\x03\x04")?;
    let length = rest.get(22..24)?;
    rest.get(26..26 + usize::from(u16::from_le_bytes([length[0], length[1]])))
}

/// A count of triangles, each of 50 bytes, of which the last two are 0, behind 80 bytes.
fn stl(head: &[u8]) -> bool {
    let zero = |k: usize| head.get(84 + 50 * k + 48..84 + 50 * k + 50) == Some(&[0, 0]);
    let unit = |k: usize| {
        let at = |axis: usize| {
            let bytes = head.get(84 + 50 * k + 4 * axis..)?.first_chunk()?;
            Some(f32::from_le_bytes(*bytes))
        };
        let normal = [at(0), at(1), at(2)].map(|x| x.unwrap_or(f32::NAN));
        let square: f32 = normal.iter().map(|x| x * x).sum();
        (square - 1.0).abs() < 1e-3
    };
    // The bytes of other binary files are no unit vectors, five times.
    (0..5).all(|k| zero(k) && unit(k))
}

fn json(head: &[u8]) -> bool {
    let mut rest = head.trim_ascii_start().iter().filter(|b| !b.is_ascii_whitespace());
    let (first, second) = (rest.next(), rest.next());
    match first {
        Some(b'{') => matches!(second, Some(b'"' | b'}')),
        Some(b'[') => matches!(second, Some(b'[' | b'{' | b'"' | b']')),
        _ => false,
    }
}

/// A record of fixed columns stands first.
fn pdb(head: &[u8]) -> bool {
    let records: [&[u8]; 9] = [
        b"HEADER    ",
        b"TITLE     ",
        b"COMPND   ",
        b"REMARK ",
        b"CRYST1 ",
        b"MODEL     ",
        b"ATOM  ",
        b"HETATM",
        b"EXPDTA    ",
    ];
    let first = head.split(|&b| b == b'\n').next().unwrap_or_default();
    // Titles and models are short; a line of atoms is not.
    let least = if first.starts_with(b"ATOM") || first.starts_with(b"HETATM") { 21 } else { 10 };
    first.len() >= least && records.iter().any(|record| first.starts_with(record))
}

/// A title, a number, and lines of which columns 21 to 44 are three numbers with a point.
fn gro(head: &[u8]) -> bool {
    let mut lines = head.split(|&b| b == b'\n').map(<[u8]>::trim_ascii_end);
    let (_, count, atom) = (lines.next(), lines.next(), lines.next().unwrap_or_default());
    let is_count = |line: &[u8]| {
        let line = line.trim_ascii();
        !line.is_empty() && line.iter().all(u8::is_ascii_digit)
    };
    let numbers = atom.get(20..44).unwrap_or_default();
    let residue = atom.get(..5).unwrap_or_default();
    let name = atom.get(5..10).unwrap_or_default();
    count.is_some_and(is_count)
        && is_count(residue)
        && name.iter().any(u8::is_ascii_alphabetic)
        && words(numbers).count() == 3
        && words(numbers).all(|word| word.contains(&b'.') && number(word).is_some())
}

/// A section in brackets, behind comments.
fn itp(head: &[u8]) -> bool {
    let first = lines(head).find(|line| !matches!(line, [] | [b';' | b'#', ..]));
    let name = |line: &[u8]| line.strip_prefix(b"[")?.strip_suffix(b"]").map(<[u8]>::to_vec);
    let is_word = |name: Vec<u8>| {
        let name = name.trim_ascii();
        !name.is_empty() && name.iter().all(|b| b.is_ascii_alphabetic() || *b == b'_')
    };
    first.and_then(name).is_some_and(is_word)
}

/// A title, a scale, three vectors, names, counts, and how the coordinates are meant.
fn poscar(head: &[u8]) -> bool {
    let lines: Vec<&[u8]> = lines(head).take(9).collect();
    let numbers = |k: usize| {
        let words: Vec<&[u8]> = words(lines.get(k).copied().unwrap_or_default()).collect();
        let all = words.iter().all(|word| number(word).is_some());
        (all && !words.is_empty()).then_some(words.len())
    };
    let meant = |k: usize| {
        let first = lines.get(k).and_then(|line| line.first());
        matches!(first, Some(b'D' | b'd' | b'C' | b'c' | b'K' | b'k' | b'S' | b's'))
    };
    let cell = numbers(1) == Some(1) && (2..5).all(|k| numbers(k) == Some(3));
    cell && (numbers(5).is_some() && meant(6) || numbers(6).is_some() && meant(7))
}

/// Two corners, each behind a v.
fn obj(head: &[u8]) -> bool {
    let corner = |line: &[u8]| {
        let rest = line.strip_prefix(b"v ").unwrap_or_default();
        words(rest).count() >= 3 && words(rest).all(|word| number(word).is_some())
    };
    lines(head).filter(|line| corner(line)).take(2).count() == 2
}

#[cfg(test)]
mod tests;
