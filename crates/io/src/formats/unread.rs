//! Frequent files in formats that are not read, by their first bytes.

use anyhow::bail;

const MAGICS: [(&str, &[u8]); 25] = [
    ("bzip2", b"BZh"),
    ("xz", b"\xfd7zXZ\0"),
    ("zstd", b"(\xb5/\xfd"),
    ("HDF5", b"\x89HDF\r\n"),
    ("NetCDF", b"CDF"),
    ("PLY", b"ply"),
    ("a shape of Rockable", b"<\n"),
    ("EDEM's export", b"EXPORTED DATA"),
    ("MFiX", b"Version 2.0\n==="),
    ("OpenFOAM", b"FoamFile"),
    ("MatrixMarket", b"%%MatrixMarket"),
    ("CIF", b"data_"),
    ("PDB", b"CRYST1"),
    ("PDB", b"HEADER    "),
    ("PDB", b"ATOM      "),
    ("MAT of MATLAB", b"MATLAB 5.0 MAT-file"),
    ("XTC of GROMACS", b"\0\0\x07\xcb"),
    ("TRR of GROMACS", b"\0\0\x07\xc9"),
    ("DCD", b"T\0\0\0CORD"),
    ("XML (VTK, HTML)", b"<"),
    ("JSON", b"{"),
    ("TOML", b"[["),
    ("UTF-16 text", b"\xff\xfe"),
    ("UTF-16 text", b"\xfe\xff"),
    ("a pointer of Git LFS", b"version https://git-lfs"),
];

pub fn refuse(head: &[u8], file: &str) -> anyhow::Result<()> {
    let is_it = |(_, magic): &&(&str, &[u8])| head.trim_ascii_start().starts_with(magic);
    if let Some((name, _)) = MAGICS.iter().find(is_it) {
        bail!("{file} is {name}, which is not read: see docs/FILES.md and docs/PYTHON.md");
    }
    Ok(())
}
