//! Known formats that are not supported: how they are recognised, and the remedy for each.

use anyhow::bail;

use crate::raw::lines::{number, words};

const ASE: &str = "convert it to extended XYZ with ASE (python: ase.io.write('p.xyz', \
                   ase.io.read('FILE'))), and give --radius";
const MESH: &str = "a mesh has corners, not particles; write the particles' centres and radii as \
                      CSV with a header x,y,z,r";
const ARRAYS: &str = "write its arrays of positions and radii from Python with numpy.savez (x, y, \
                      z, r)";
const TABLE: &str = "export it as CSV with a header x,y,z,r";
const RUN: &str = "if it is an experiment: contactbench run FILE";
const PLAIN: &str = "save it as plain text";
const SEPARATOR: &str = "remove its first line: sed 1d FILE > p.csv";
const PICTURE: &str = "give the particles that were drawn";
const UNPACK: &str = "unpack it first";
const CUSTOM: &str = "write a text dump of style custom with id x y z radius";
const RESTART: &str = "write a data file: lmp -restart2data FILE p.data";
const BINARY: &str = "turn it into text with LAMMPS's binary2txt, or write a text dump";
const UTF_8: &str = "save it as UTF-8: iconv -f UTF-16 -t UTF-8 FILE";
const LFS: &str = "the file itself comes with: git lfs pull";
const PAGE: &str = "the address gave a page in place of the file; download the file itself";
const TOPOLOGY: &str = "it has no coordinates; convert the .gro file beside it to extended XYZ \
                        with ASE";
const MERCURY: &str = "give the .data file beside it, which has the same particles";
const TRACKMATE: &str = "leave out the three rows behind the first (sed 2,4d FILE), and give \
                         --columns id=ID,x=POSITION_X,y=POSITION_Y,z=POSITION_Z,r=RADIUS";
const KRATOS: &str = "write its nodes and their RADIUS as CSV with a header x,y,z,r";
const ESYS: &str = "write the lines between BeginParticles and EndParticles as CSV with a header \
                    x,y,z,r";

/// Formats recognised by bytes at a fixed offset: name with its article, offset, bytes, remedy.
const BYTES: [(&str, usize, &[u8], &str); 38] = [
    ("compressed with bzip2", 0, b"BZh", UNPACK),
    ("compressed with xz", 0, b"\xfd7zXZ\0", UNPACK),
    ("compressed with lzma", 0, b"]\0\0", UNPACK),
    ("compressed with zstd", 0, b"(\xb5/\xfd", UNPACK),
    ("compressed with lz4", 0, b"\x04\"M\x18", UNPACK),
    ("compressed with compress", 0, b"\x1f\x9d", UNPACK),
    ("a 7z archive", 0, b"7z\xbc\xaf\x27\x1c", UNPACK),
    ("a rar archive", 0, b"Rar!\x1a", UNPACK),
    ("a tar archive", 257, b"ustar", UNPACK),
    ("an Excel workbook", 0, b"\xd0\xcf\x11\xe0", TABLE),
    ("an HDF5 file", 0, b"\x89HDF\r\n", ARRAYS),
    ("a NetCDF file", 0, b"CDF\x01", ARRAYS),
    ("a NetCDF file", 0, b"CDF\x02", ARRAYS),
    ("a NetCDF file", 0, b"CDF\x05", ARRAYS),
    ("a MATLAB file", 0, b"MATLAB ", TABLE),
    ("a Parquet file", 0, b"PAR1", TABLE),
    ("an Arrow or Feather file", 0, b"ARROW1", TABLE),
    ("an Arrow or Feather file", 0, b"FEA1", TABLE),
    ("an SQLite database", 0, b"SQLite format", TABLE),
    ("a trajectory of ASE", 0, b"- of Ulm", ASE),
    ("a DCD file", 4, b"CORD", ASE),
    ("an XTC file", 0, b"\0\0\x07\xcb", ASE),
    ("a TRR file", 0, b"\0\0\x07\xc9", ASE),
    ("a binary restart of LAMMPS", 0, b"LammpS RestartT", RESTART),
    ("a binary dump of LAMMPS", 8, b"DUMP", BINARY),
    ("a LAS or LAZ point cloud", 0, b"LASF", TABLE),
    ("UTF-16 text", 0, b"\xff\xfe", UTF_8),
    ("UTF-16 text", 0, b"\xfe\xff", UTF_8),
    ("a PDF", 0, b"%PDF", TABLE),
    ("a rich text document (rtf)", 0, b"{\\rtf", PLAIN),
    ("a picture", 0, b"\x89PNG", PICTURE),
    ("a picture", 0, b"\xff\xd8\xff", PICTURE),
    ("a glTF mesh", 0, b"glTF", MESH),
    ("a pointer of Git LFS", 0, b"version https://git-lfs", LFS),
    ("a restart file of MercuryDPM", 0, b"restart_version", MERCURY),
    ("an AtomEye file (cfg)", 0, b"Number of particles", ASE),
    ("a point cloud of PCL (pcd)", 0, b"# .PCD", TABLE),
    ("a geometry of ESyS-Particle (geo)", 0, b"LSMGeometry", ESYS),
];

/// A format recognised by a function: name with its article, function, remedy. The first match
/// counts.
type Form = (&'static str, fn(&[u8]) -> bool, &'static str);
const FORMS: [Form; 22] = [
    ("an Excel workbook", excel, TABLE),
    (
        "a zip archive whose first file is not a NumPy array",
        |b| zipped(b).is_some_and(|name| !name.ends_with(b".npy")),
        UNPACK,
    ),
    ("a pickle of Python", |b| matches!(b, [0x80, 2..=5, ..]), ARRAYS),
    ("a binary STL mesh", stl, MESH),
    ("a web page", page, PAGE),
    ("UTF-16 text", utf_16, UTF_8),
    ("a table whose first line is Excel's sep=", |b| b.starts_with(b"sep="), SEPARATOR),
    ("a TOML file", toml, RUN),
    ("a JSON file", json, TABLE),
    ("a LAMMPS dump of style yaml", |b| b.starts_with(b"---") && has(b, b"natoms:"), CUSTOM),
    ("a YAML file", |b| lines(b).next() == Some(b"---"), TABLE),
    ("a PDB file", pdb, ASE),
    ("a CIF file", cif, ASE),
    ("a GROMACS file (gro)", gro, ASE),
    ("a topology of GROMACS (itp, top)", itp, TOPOLOGY),
    ("a table of TrackMate with four header rows", trackmate, TRACKMATE),
    ("a VASP file (POSCAR)", poscar, ASE),
    (
        "a point cloud of PCL (pcd)",
        |b| b.starts_with(b"VERSION") && lines(b).any(|line| line.starts_with(b"FIELDS ")),
        TABLE,
    ),
    (
        "a file of Kratos (mdpa)",
        |b| b.starts_with(b"Begin ") && words(b).nth(1).is_some_and(|w| w.len() > 4),
        KRATOS,
    ),
    ("an STL mesh", |b| b.starts_with(b"solid") && has(b, b"facet"), MESH),
    ("an OBJ mesh", obj, MESH),
    ("an OFF mesh", |b| lines(b).next() == Some(b"OFF"), MESH),
];

#[cfg(test)]
pub fn names() -> impl Iterator<Item = &'static str> {
    BYTES.iter().map(|it| it.0).chain(FORMS.iter().map(|it| it.0))
}

/// Refuses a file in one of these formats, by name. `remedy` replaces the remedy if the file should
/// not hold particles.
pub fn refuse(head: &[u8], file: &str, remedy: Option<&str>) -> anyhow::Result<()> {
    let begins = |at: usize, bytes: &[u8]| head.get(at..).is_some_and(|it| it.starts_with(bytes));
    let mut bytes = BYTES.iter().filter(|(_, at, bytes, _)| begins(*at, bytes));
    let mut forms = FORMS.iter().filter(|(_, tells, _)| tells(head));
    let bytes = bytes.next().map(|&(name, .., out)| (name, out));
    let form = || forms.next().map(|&(name, _, out)| (name, out));
    let Some((name, out)) = bytes.or_else(form) else { return Ok(()) };
    // Some remedies, such as unpacking, also fit a file that should not hold particles.
    let remedy = remedy
        .filter(|_| ![UNPACK, LFS, PAGE, UTF_8, PLAIN, SEPARATOR].contains(&out))
        .unwrap_or(out);
    let remedy = remedy.replace("FILE", file);
    let read = if name.starts_with("compressed") { "" } else { ", which is not read" };
    bail!("{file} is {name}{read}: {remedy}")
}

fn lines(head: &[u8]) -> impl Iterator<Item = &[u8]> {
    head.split(|&b| b == b'\n').map(<[u8]>::trim_ascii)
}

fn has(head: &[u8], part: &[u8]) -> bool {
    head.windows(part.len()).any(|window| window == part)
}

fn zipped(head: &[u8]) -> Option<&[u8]> {
    let rest = head.strip_prefix(b"PK\x03\x04")?;
    let length = rest.get(22..24)?;
    rest.get(26..26 + usize::from(u16::from_le_bytes([length[0], length[1]])))
}

fn excel(head: &[u8]) -> bool {
    zipped(head).is_some_and(|it| it.starts_with(b"[Content_Types]") || it.starts_with(b"xl/"))
}

fn page(head: &[u8]) -> bool {
    let start = head.trim_ascii_start().to_ascii_lowercase();
    start.starts_with(b"<!doctype html") || start.starts_with(b"<html")
}

fn cif(head: &[u8]) -> bool {
    let first = lines(head).find(|line| !line.is_empty() && !line.starts_with(b"#"));
    first.is_some_and(|line| line.starts_with(b"data_") && words(line).count() == 1)
}

fn trackmate(head: &[u8]) -> bool {
    let mut heads = lines(head);
    let first = heads.next().is_some_and(|line| has(line, b"POSITION_X"));
    first && heads.next().is_some_and(|line| has(line, b"Spot ID"))
}

/// Recognises binary STL: an 80-byte title, a count, and triangles of 50 bytes that end with two
/// zero bytes.
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
    // Five unit normals in a row are unlikely in other binary files.
    (0..5).all(|k| zero(k) && unit(k))
}

/// Recognises UTF-16 without a byte order mark: characters of ASCII, each beside a zero byte.
fn utf_16(head: &[u8]) -> bool {
    let plain = |byte: u8| byte.is_ascii_graphic() || byte.is_ascii_whitespace();
    let pairs = head.as_chunks::<2>().0;
    let all = |letter: usize| {
        pairs.iter().take(16).all(|pair| plain(pair[letter]) && pair[1 - letter] == 0)
    };
    pairs.len() >= 4 && (all(0) || all(1))
}

/// Recognises TOML by a table in double brackets, or a key with a text.
fn toml(head: &[u8]) -> bool {
    let is_name = |name: &[u8]| {
        !name.is_empty() && name.iter().all(|b| b.is_ascii_alphanumeric() || b"_-.".contains(b))
    };
    let first = lines(head).find(|line| !matches!(line, [] | [b'#', ..])).unwrap_or_default();
    let table = first.strip_prefix(b"[[").and_then(|rest| rest.strip_suffix(b"]]"));
    let mut key = first.splitn(2, |&b| b == b'=').map(<[u8]>::trim_ascii);
    table.is_some_and(|name| is_name(name) && !name[0].is_ascii_digit())
        || key.next().is_some_and(is_name) && key.next().is_some_and(|it| it.starts_with(b"\""))
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

fn pdb(head: &[u8]) -> bool {
    let records =
        "HEADER    |TITLE     |COMPND   |REMARK |CRYST1 |MODEL     |ATOM  |HETATM|EXPDTA    ";
    let first = head.split(|&b| b == b'\n').next().unwrap_or_default();
    // A title may be short, but a line of an atom is long.
    let least = if first.starts_with(b"ATOM") || first.starts_with(b"HETATM") { 21 } else { 10 };
    first.len() >= least && records.split('|').any(|it| first.starts_with(it.as_bytes()))
}

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

fn itp(head: &[u8]) -> bool {
    let first = lines(head).find(|line| !matches!(line, [] | [b';' | b'#', ..]));
    let name = |line: &[u8]| line.strip_prefix(b"[")?.strip_suffix(b"]").map(<[u8]>::to_vec);
    let is_word = |name: Vec<u8>| {
        let name = name.trim_ascii();
        !name.is_empty() && name.iter().all(|b| b.is_ascii_alphabetic() || *b == b'_')
    };
    first.and_then(name).is_some_and(is_word)
}

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

fn obj(head: &[u8]) -> bool {
    let corner = |line: &[u8]| {
        let rest = line.strip_prefix(b"v ").unwrap_or_default();
        words(rest).count() >= 3 && words(rest).all(|word| number(word).is_some())
    };
    lines(head).filter(|line| corner(line)).take(2).count() == 2
}
