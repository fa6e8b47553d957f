//! Binary numbers of several types and byte orders. They are read in blocks, so that a false header
//! cannot reserve memory.

use anyhow::{bail, ensure};
use nalgebra::Point;

use crate::particles::Column;
use crate::raw::arrays::Cells;
use crate::raw::lines::{Source, among, short};
use crate::raw::room::{room, room_for};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
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
    pub fn named(name: &str) -> Option<Kind> {
        Some(match name.to_ascii_lowercase().as_str() {
            "char" | "int8" | "signed_char" => Kind::I8,
            "uchar" | "uint8" | "unsigned_char" => Kind::U8,
            "short" | "int16" => Kind::I16,
            "ushort" | "uint16" | "unsigned_short" => Kind::U16,
            // Legacy files of VTK write ids as int, whatever their type in memory.
            "int" | "int32" | "vtkidtype" => Kind::I32,
            "uint" | "uint32" | "unsigned_int" => Kind::U32,
            "long" | "int64" | "vtktypeint64" => Kind::I64,
            "ulong" | "uint64" | "unsigned_long" | "vtktypeuint64" => Kind::U64,
            "float" | "float32" => Kind::F32,
            "double" | "float64" => Kind::F64,
            _ => return None,
        })
    }

    pub fn width(self) -> usize {
        match self {
            Kind::I8 | Kind::U8 => 1,
            Kind::I16 | Kind::U16 => 2,
            Kind::I32 | Kind::U32 | Kind::F32 => 4,
            Kind::I64 | Kind::U64 | Kind::F64 => 8,
        }
    }

    /// Converts the first bytes to f64. Whole numbers above 2^53 are rounded; too few bytes give 0.
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

pub enum Target {
    Points(Vec<Point<f64, 3>>, [f64; 3], usize),
    Sizes(Size),
    Indices(Indices),
    Types(Cells),
    /// Number of points that are copies of other points.
    Ghosts(u64),
    Ids(Ids),
    Nothing,
}

pub struct Size {
    pub values: Vec<f64>,
    pub column: Column,
    pub label: String,
    /// Whether there is one value per cell instead of one per point.
    pub of_cells: bool,
}

#[derive(Clone)]
pub struct Ids {
    pub label: String,
    /// The ids; `None` if a number is not whole or not exact in f64.
    values: Option<Vec<i64>>,
    /// Whether the array is named like a column of ids, or was chosen.
    sure: bool,
}

impl Ids {
    const NAMES: &str = "ids globalid globalids globalpointids globalnodeid globalnodeids";

    pub fn is_named(label: &str, column: Column) -> bool {
        column == Column::Id || among(Ids::NAMES, &label.to_ascii_lowercase())
    }

    pub fn new(label: &str, column: Column) -> Ids {
        Ids { label: label.into(), values: Some(Vec::new()), sure: column == Column::Id }
    }

    pub fn push(&mut self, value: f64) -> anyhow::Result<()> {
        let is_whole = value.fract() == 0.0 && value.abs() < 9e15;
        self.values = self.values.take().filter(|_| is_whole);
        if let Some(values) = &mut self.values {
            room(values)?;
            values.push(value as i64);
        }
        Ok(())
    }

    pub fn append(&mut self, more: Ids) -> anyhow::Result<()> {
        self.values = match (self.values.take(), more.values) {
            (Some(mut all), Some(more)) => {
                room_for(&mut all, more.len())?;
                all.extend(more);
                Some(all)
            }
            _ => None,
        };
        Ok(())
    }

    /// Returns the ids of `n` particles, preferably from a column of ids. Other arrays named like
    /// ids are used if no number repeats, because each piece of a file may count from 0.
    pub fn of(mut all: Vec<Ids>, n: usize) -> Option<Vec<i64>> {
        let differ = |values: &[i64]| {
            let mut seen = values.to_vec();
            seen.sort_unstable();
            seen.windows(2).all(|two| two[0] != two[1])
        };
        all.sort_by_key(|ids| !ids.sure);
        all.into_iter()
            .filter(|ids| ids.sure || ids.values.as_deref().is_some_and(differ))
            .filter_map(|ids| ids.values)
            .find(|values| values.len() == n)
    }
}

/// The points of cells. Only whether cell k is point k alone is checked.
#[derive(Clone, Copy)]
pub(crate) struct Indices {
    pub seen: u64,
    pub in_order: bool,
    /// Whether each cell starts with its number of points.
    pub counted: bool,
}

impl Target {
    pub fn points() -> Target {
        Target::Points(Vec::new(), [0.0; 3], 0)
    }

    pub fn indices(counted: bool) -> Target {
        Target::Indices(Indices { seen: 0, in_order: true, counted })
    }

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
            Target::Sizes(Size { values, column, label, of_cells }) => match column.size(value) {
                Ok(size) => {
                    room(values)?;
                    values.push(size);
                }
                Err(why) => {
                    let what = if *of_cells { "cell" } else { "point" };
                    bail!("{what} {} (from 0): '{}': {value} {why}", values.len(), short(label))
                }
            },
            Target::Indices(Indices { seen, in_order, counted }) => {
                let expected = match (*counted, *seen % 2) {
                    (true, 0) => 1,
                    (true, _) => *seen / 2,
                    (false, _) => *seen,
                };
                *in_order &= value == expected as f64;
                *seen += 1;
            }
            Target::Types(cells) => cells.push(value),
            Target::Ghosts(ghosts) => *ghosts += u64::from(value != 0.0),
            Target::Ids(ids) => ids.push(value)?,
            Target::Nothing => {}
        }
        Ok(())
    }

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
