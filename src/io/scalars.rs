//! Numbers as binary files hold them: type, width and byte order; read in pieces, so that no
//! promise of a header asks for memory.

use anyhow::{bail, ensure};
use nalgebra::Point;

use crate::io::RadiusSource;
use crate::io::lines::Source;
use crate::io::particles::Column;
use crate::io::room::room;

/// A type of number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Kind {
    /// By the names of VTK (both kinds) and PLY.
    pub fn named(name: &str) -> Option<Kind> {
        Some(match name.to_ascii_lowercase().as_str() {
            "char" | "int8" | "signed_char" => Kind::I8,
            "uchar" | "uint8" | "unsigned_char" => Kind::U8,
            "short" | "int16" => Kind::I16,
            "ushort" | "uint16" | "unsigned_short" => Kind::U16,
            // VTK writes its ids as int in legacy files, whatever they are in memory.
            "int" | "int32" | "vtkidtype" => Kind::I32,
            "uint" | "uint32" | "unsigned_int" => Kind::U32,
            "long" | "int64" | "vtktypeint64" => Kind::I64,
            "ulong" | "uint64" | "unsigned_long" | "vtktypeuint64" => Kind::U64,
            "float" | "float32" => Kind::F32,
            "double" | "float64" => Kind::F64,
            _ => return None,
        })
    }

    /// Bytes.
    pub fn width(self) -> usize {
        match self {
            Kind::I8 | Kind::U8 => 1,
            Kind::I16 | Kind::U16 => 2,
            Kind::I32 | Kind::U32 | Kind::F32 => 4,
            Kind::I64 | Kind::U64 | Kind::F64 => 8,
        }
    }

    /// The number in the first bytes, as a double; whole numbers above 2^53 are rounded. 0 where
    /// there are fewer than [`Kind::width`].
    #[inline]
    pub fn get(self, bytes: &[u8], big: bool) -> f64 {
        macro_rules! get {
            ($type:ty) => {
                bytes.first_chunk().map_or(0.0, |&word| {
                    (if big { <$type>::from_be_bytes(word) } else { <$type>::from_le_bytes(word) })
                        as f64
                })
            };
        }
        match self {
            Kind::I8 => get!(i8),
            Kind::U8 => get!(u8),
            Kind::I16 => get!(i16),
            Kind::U16 => get!(u16),
            Kind::I32 => get!(i32),
            Kind::U32 => get!(u32),
            Kind::I64 => get!(i64),
            Kind::U64 => get!(u64),
            Kind::F32 => get!(f32),
            Kind::F64 => get!(f64),
        }
    }
}

/// Where the numbers of an array go, one after the other.
pub(crate) enum Target {
    Points(Vec<Point<f64, 3>>, [f64; 3], usize),
    Sizes(Vec<f64>, Column, String),
    /// Nobody needs them.
    Nothing,
}

impl Target {
    pub fn points() -> Target {
        Target::Points(Vec::new(), [0.0; 3], 0)
    }

    /// A size, if the name and the number of components are those of one.
    pub fn named(name: &str, components: u64) -> Target {
        match Column::named(name) {
            column @ (Column::Radius | Column::Diameter) if components == 1 => {
                Target::Sizes(Vec::new(), column, name.to_string())
            }
            _ => Target::Nothing,
        }
    }

    /// The next number. The error says what is wrong with it, and of which particle.
    pub fn push(&mut self, value: f64) -> anyhow::Result<()> {
        match self {
            Target::Points(points, point, k) => {
                ensure!(
                    value.is_finite(),
                    "point {} (from 0): {} is {value}; it must be finite",
                    points.len(),
                    ["x", "y", "z"][*k]
                );
                point[*k] = value;
                *k = (*k + 1) % 3;
                if *k == 0 {
                    room(points)?;
                    points.push(Point::from(*point));
                }
            }
            Target::Sizes(sizes, column, name) => match column.size(value) {
                Ok(size) => {
                    room(sizes)?;
                    sizes.push(size);
                }
                Err(why) => bail!("point {} (from 0): '{name}': {value} {why}", sizes.len()),
            },
            Target::Nothing => {}
        }
        Ok(())
    }

    /// Takes `count` numbers from the source. False where it ends before.
    pub fn take(
        &mut self,
        source: &mut Source<'_>,
        kind: Kind,
        big: bool,
        count: u64,
    ) -> anyhow::Result<bool> {
        let width = kind.width();
        if matches!(self, Target::Nothing) {
            return source.skip(count.saturating_mul(width as u64));
        }
        let mut piece = [0; 1 << 14];
        let mut left = count;
        while left > 0 {
            let bytes = left.min((piece.len() / width) as u64) as usize * width;
            if !source.fill(&mut piece[..bytes])? {
                return Ok(false);
            }
            for number in piece[..bytes].chunks_exact(width) {
                self.push(kind.get(number, big))?;
            }
            left -= (bytes / width) as u64;
        }
        Ok(true)
    }
}

/// Points and their sizes, as the arrays of a file are read one after the other.
#[derive(Default)]
pub(crate) struct Arrays {
    pub points: Option<Vec<Point<f64, 3>>>,
    sizes: Option<(Vec<f64>, Column, String)>,
}

impl Arrays {
    pub fn keep(&mut self, target: Target, name: &str) -> anyhow::Result<()> {
        match target {
            Target::Points(points, ..) => {
                ensure!(self.points.is_none(), "{name} holds points twice; write one data set");
                self.points = Some(points);
            }
            Target::Sizes(sizes, column, label) => match &self.sizes {
                Some((_, _, other)) => {
                    bail!("{name} holds two arrays of sizes, '{other}' and '{label}'; remove one")
                }
                None => self.sizes = Some((sizes, column, label)),
            },
            Target::Nothing => {}
        }
        Ok(())
    }

    /// Particles, and where their radii come from.
    pub fn particles(self, name: &str) -> anyhow::Result<(crate::io::Particles, RadiusSource)> {
        let Some(points) = self.points else {
            bail!("{name} holds no points; write them as POINTS, or as CSV with a header x,y,z,r")
        };
        let source = match &self.sizes {
            Some((_, Column::Diameter, label)) => RadiusSource::Halved(label.clone()),
            Some((_, _, label)) => RadiusSource::Column(label.clone()),
            None => RadiusSource::Missing,
        };
        Ok((
            crate::io::Particles::from_columns(points, self.sizes.map(|(sizes, ..)| sizes), name)?,
            source,
        ))
    }
}
