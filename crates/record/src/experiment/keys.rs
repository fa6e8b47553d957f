//! Lists the TOML keys of a type. serde passes the names of all fields or variants to the
//! deserializer, which records them and then fails.

use serde::Deserialize;
use serde::de::value::Error;
use serde::de::{self, DeserializeSeed, Deserializer, IntoDeserializer, Visitor};

type Names = &'static [&'static str];

pub fn fields<'de, T: Deserialize<'de>>() -> Names {
    ask::<T>(None)
}

pub fn variant_fields<'de, T: Deserialize<'de>>(variant: &'static str) -> Names {
    ask::<T>(Some(variant))
}

fn ask<'de, T: Deserialize<'de>>(variant: Option<&'static str>) -> Names {
    let mut names: Names = &[];
    // This always fails, because the deserializer provides no value.
    let _ = T::deserialize(Ask { variant, names: &mut names });
    names
}

struct Ask<'a> {
    variant: Option<&'static str>,
    names: &'a mut Names,
}

fn asked<T>() -> Result<T, Error> {
    Err(de::Error::custom("only the names were asked for"))
}

impl<'de> Deserializer<'de> for Ask<'_> {
    type Error = Error;

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Error> {
        asked()
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        fields: Names,
        _: V,
    ) -> Result<V::Value, Error> {
        *self.names = fields;
        asked()
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        variants: Names,
        visitor: V,
    ) -> Result<V::Value, Error> {
        if self.variant.is_some() {
            return visitor.visit_enum(self);
        }
        *self.names = variants;
        asked()
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option
        unit unit_struct newtype_struct seq tuple tuple_struct map identifier ignored_any
    }
}

impl<'de> de::EnumAccess<'de> for Ask<'_> {
    type Error = Error;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, Self), Error> {
        let name = self.variant.unwrap_or_default();
        Ok((seed.deserialize(name.into_deserializer())?, self))
    }
}

impl<'de> de::VariantAccess<'de> for Ask<'_> {
    type Error = Error;

    fn unit_variant(self) -> Result<(), Error> {
        asked()
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Error> {
        seed.deserialize(self)
    }

    fn tuple_variant<V: Visitor<'de>>(self, _: usize, _: V) -> Result<V::Value, Error> {
        asked()
    }

    fn struct_variant<V: Visitor<'de>>(self, fields: Names, _: V) -> Result<V::Value, Error> {
        *self.names = fields;
        asked()
    }
}
