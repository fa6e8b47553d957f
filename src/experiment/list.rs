//! One value, or a list of values to sweep over.

use std::fmt;
use std::marker::PhantomData;
use std::ops::Deref;

use serde::de::value::SeqAccessDeserializer;
use serde::de::{Error, IntoDeserializer, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

/// Values to sweep over; in a file, `3` means the same as `[3]`.
#[derive(Clone, Debug, PartialEq)]
pub struct List<T>(pub Vec<T>);

impl<T> Deref for List<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.0
    }
}

impl<T> From<T> for List<T> {
    fn from(value: T) -> List<T> {
        List(vec![value])
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for List<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<List<T>, D::Error> {
        deserializer.deserialize_any(Values(PhantomData))
    }
}

struct Values<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for Values<T> {
    type Value = List<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a value or a list of values")
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<List<T>, E> {
        T::deserialize(value.into_deserializer()).map(List::from)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<List<T>, E> {
        T::deserialize(value.into_deserializer()).map(List::from)
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<List<T>, E> {
        T::deserialize(value.into_deserializer()).map(List::from)
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<List<T>, E> {
        T::deserialize(value.into_deserializer()).map(List::from)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, values: A) -> Result<List<T>, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(values)).map(List)
    }
}
