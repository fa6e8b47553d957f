//! Frequent files in formats that are not read, by their first bytes.

use anyhow::bail;

const MAGICS: [(&str, &[u8]); 12] = [
    ("bzip2", b"BZh"),
    ("xz", b"\xfd7zXZ\0"),
    ("zstd", b"(\xb5/\xfd"),
    ("HDF5", b"\x89HDF\r\n"),
    ("NetCDF", b"CDF"),
    ("PLY", b"ply"),
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
