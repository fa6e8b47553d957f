//! Binary numbers of several types and byte orders.

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
