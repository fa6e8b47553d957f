//! NumPy npy: versions 1 to 3, f64 and f32 of either byte order, C and Fortran order.
//!
//! Shape N x 2: x, y. N x 3: x, y, z, or x, y, radius where the options ask for two dimensions. N x 4: x, y, z, radius.
//! f32 widens without error. Format: <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>.

use std::io::Read;

use anyhow::{Context, bail, ensure};

use super::{Options, Particles, short};

/// The first bytes of every npy file.
pub const MAGIC: &[u8] = b"\x93NUMPY";

/// Longest header read; NumPy's own default limit is 10,000.
const LONGEST_HEADER: usize = 1 << 20;

pub(super) fn read(mut reader: impl Read, name: &str, options: Options) -> anyhow::Result<Particles> {
    let header = header(&mut reader, name)?;
    let Header { rows, columns, .. } = header;
    ensure!(rows <= u64::from(u32::MAX), "{name}: {rows} particles; at most 2^32 - 1 = {} can be numbered: split the file", u32::MAX);
    let rows = usize::try_from(rows).with_context(|| format!("{name}: {rows} particles are more than this machine can address"))?;
    let values = values(&mut reader, &header, rows.saturating_mul(columns), name)?;
    let (dim, has_radii) = match (columns, options.dim) {
        (2, _) => (2, false),
        (3, Some(2)) => (2, true),
        (3, _) => (3, false),
        _ => (3, true),
    };
    let mut particles = Particles::new(dim, has_radii);
    particles.coordinates.reserve_exact(rows * dim);
    for row in 0..rows {
        for column in 0..columns {
            let value = values[if header.fortran { column * rows + row } else { row * columns + column }];
            let axis = || if column == dim { "radius" } else { ["x", "y", "z"][column.min(2)] };
            ensure!(value.is_finite(), "{name}: particle {row} (from 0): {} is {value}; it must be finite: mend or remove the row", axis());
            if column < dim {
                particles.coordinates.push(value);
            } else {
                ensure!(value >= 0.0, "{name}: particle {row} (from 0): the radius {value} is negative; mend or remove the row");
                particles.radii.get_or_insert_default().push(value);
            }
        }
    }
    Ok(particles)
}

/// The numbers in file order. They are read in pieces, so that a false shape cannot ask for more memory than the file has bytes.
fn values(reader: &mut impl Read, header: &Header, count: usize, name: &str) -> anyhow::Result<Vec<f64>> {
    let mut values = Vec::new();
    let mut piece = vec![0; 1 << 16];
    while values.len() < count {
        let wanted = ((count - values.len()).saturating_mul(header.width)).min(piece.len());
        let piece = &mut piece[..wanted];
        if let Err(error) = reader.read_exact(piece) {
            ensure!(error.kind() == std::io::ErrorKind::UnexpectedEof, "cannot read {name}: {error}");
            bail!("{name} ends before the {} x {} numbers that its header announces; write it again", header.rows, header.columns);
        }
        match (header.width, header.big) {
            (8, false) => values.extend(piece.as_chunks().0.iter().map(|&bytes| f64::from_le_bytes(bytes))),
            (8, true) => values.extend(piece.as_chunks().0.iter().map(|&bytes| f64::from_be_bytes(bytes))),
            (_, false) => values.extend(piece.as_chunks().0.iter().map(|&bytes| f64::from(f32::from_le_bytes(bytes)))),
            (_, true) => values.extend(piece.as_chunks().0.iter().map(|&bytes| f64::from(f32::from_be_bytes(bytes)))),
        }
    }
    let more = reader.read(&mut piece[..1]).with_context(|| format!("cannot read {name}"))?;
    ensure!(more == 0, "{name} goes on after the {} x {} numbers that its header announces; write it again", header.rows, header.columns);
    Ok(values)
}

#[derive(Debug)]
struct Header {
    /// Bytes per number: 4 or 8.
    width: usize,
    big: bool,
    fortran: bool,
    rows: u64,
    columns: usize,
}

fn header(reader: &mut impl Read, name: &str) -> anyhow::Result<Header> {
    let torn = || format!("{name}: the npy header is cut off; write the file again");
    let mut start = [0; 8];
    reader.read_exact(&mut start).with_context(torn)?;
    let length = match start[6] {
        1 => {
            let mut length = [0; 2];
            reader.read_exact(&mut length).with_context(torn)?;
            usize::from(u16::from_le_bytes(length))
        }
        2 | 3 => {
            let mut length = [0; 4];
            reader.read_exact(&mut length).with_context(torn)?;
            u32::from_le_bytes(length) as usize
        }
        version => bail!("{name} is npy version {version}; versions 1 to 3 are read: write it with numpy.save"),
    };
    ensure!(length <= LONGEST_HEADER, "{name}: the npy header has {length} bytes; at most {LONGEST_HEADER} are read");
    let mut text = vec![0; length];
    reader.read_exact(&mut text).with_context(torn)?;
    let text = String::from_utf8_lossy(&text).to_string();
    parse(&text).with_context(|| format!("{name}: npy header {}", short(text.trim())))
}

/// Parses the Python dictionary of the header, such as `{'descr': '<f8', 'fortran_order': False, 'shape': (10, 3), }`.
fn parse(text: &str) -> anyhow::Result<Header> {
    let value = |key: &str| -> anyhow::Result<&str> {
        let at = [format!("'{key}'"), format!("\"{key}\"")].iter().find_map(|quoted| Some(text.find(quoted.as_str())? + quoted.len()));
        let rest = text[at.with_context(|| format!("it has no '{key}'"))?..].trim_start();
        Ok(rest.strip_prefix(':').with_context(|| format!("'{key}' has no value"))?.trim_start())
    };
    let descr = value("descr")?;
    let (width, big) = match descr.get(..5).map(|descr| descr.replace('"', "'")).as_deref() {
        Some("'<f8'") => (8, false),
        Some("'<f4'") => (4, false),
        Some("'>f8'") => (8, true),
        Some("'>f4'") => (4, true),
        _ => bail!("the type {} is not read; convert with .astype('f8')", short(descr.split(',').next().unwrap_or_default())),
    };
    let order = value("fortran_order")?;
    let fortran = order.starts_with("True");
    ensure!(fortran || order.starts_with("False"), "fortran_order is neither True nor False");
    let shape = value("shape")?.strip_prefix('(').and_then(|rest| rest.split_once(')')).map(|(shape, _)| shape);
    let shape = shape.context("the shape is not of the form (N, 3)")?;
    let sizes: Option<Vec<u64>> = shape.split(',').map(str::trim).filter(|size| !size.is_empty()).map(|size| size.parse().ok()).collect();
    match sizes.as_deref() {
        Some(&[rows, columns @ 2..=4]) => Ok(Header { width, big, fortran, rows, columns: columns as usize }),
        _ => bail!("the shape is ({}); it must be (N, 2), (N, 3) or (N, 4): x, y, z, and the radius last", short(shape)),
    }
}
