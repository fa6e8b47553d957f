//! Binary numbers of several types and byte orders.

use crate::raw::lines::among;

macro_rules! kinds {
    ($($kind:ident $type:ty, $codes:literal, $names:literal;)*) => {
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Scalar {
            $($kind),*
        }

        impl Scalar {
            /// Finds a type by its name in VTK.
            pub fn named(name: &str) -> Option<Scalar> {
                let name = name.to_ascii_lowercase();
                let mut all = [$((Scalar::$kind, $names)),*].into_iter();
                all.find(|it| among(it.1, &name)).map(|it| it.0)
            }

            /// Finds a type by its code in NumPy, without byte order.
            pub fn coded(code: &str) -> Option<Scalar> {
                let mut all = [$((Scalar::$kind, $codes)),*].into_iter();
                all.find(|it| among(it.1, code)).map(|it| it.0)
            }

            pub fn width(self) -> usize {
                match self {
                    $(Scalar::$kind => size_of::<$type>(),)*
                }
            }

            /// Converts the first bytes to f64. Whole numbers above 2^53 are rounded; too few bytes
            /// give 0.
            #[inline]
            pub fn get(self, bytes: &[u8], big: bool) -> f64 {
                match (self, big) {
                    $(
                        (Scalar::$kind, true) => {
                            bytes.first_chunk().map_or(0.0, |&it| <$type>::from_be_bytes(it) as f64)
                        }
                        (Scalar::$kind, false) => {
                            bytes.first_chunk().map_or(0.0, |&it| <$type>::from_le_bytes(it) as f64)
                        }
                    )*
                }
            }
        }
    };
}

// Legacy files of VTK write ids as int, whatever their type in memory.
kinds! {
    I8 i8, "i1", "char int8 signed_char";
    U8 u8, "u1 b1", "uchar uint8 unsigned_char";
    I16 i16, "i2", "short int16";
    U16 u16, "u2", "ushort uint16 unsigned_short";
    I32 i32, "i4", "int int32 vtkidtype";
    U32 u32, "u4", "uint uint32 unsigned_int";
    I64 i64, "i8", "long int64 vtktypeint64";
    U64 u64, "u8", "ulong uint64 unsigned_long vtktypeuint64";
    F32 f32, "f4", "float float32";
    F64 f64, "f8", "double float64";
}
