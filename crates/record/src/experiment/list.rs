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
        match whole(value) {
            Some(value) => self.visit_i64(value),
            None => T::deserialize(value.into_deserializer()).map(List::from),
        }
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<List<T>, E> {
        T::deserialize(value.into_deserializer()).map(List::from)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, values: A) -> Result<List<T>, A::Error> {
        let items = Vec::<Item<T>>::deserialize(SeqAccessDeserializer::new(values))?;
        Ok(List(items.into_iter().map(|item| item.0).collect()))
    }
}

/// The whole number that a float such as `1e6` is.
fn whole(value: f64) -> Option<i64> {
    let exact = value.fract() == 0.0 && value.abs() <= (1u64 << 53) as f64;
    exact.then_some(value as i64)
}

/// One value of a list.
struct Item<T>(T);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Item<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Item<T>, D::Error> {
        deserializer.deserialize_any(OneValue(PhantomData))
    }
}

struct OneValue<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for OneValue<T> {
    type Value = Item<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a value")
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<Item<T>, E> {
        T::deserialize(value.into_deserializer()).map(Item)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Item<T>, E> {
        T::deserialize(value.into_deserializer()).map(Item)
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Item<T>, E> {
        match whole(value) {
            Some(value) => self.visit_i64(value),
            None => T::deserialize(value.into_deserializer()).map(Item),
        }
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<Item<T>, E> {
        T::deserialize(value.into_deserializer()).map(Item)
    }
}

/// For a key with one value: `1e6` is a whole number there, too.
pub fn one<'de, D, T>(deserializer: D) -> Result<T, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de>,
{
    Item::deserialize(deserializer).map(|item| item.0)
}

/// As [`one`], for a key that may be absent.
pub fn some<'de, D, T>(deserializer: D) -> Result<Option<T>, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de>,
{
    one(deserializer).map(Some)
}

/// For a key with a list, where one value may stand without brackets.
pub fn many<'de, D, T>(deserializer: D) -> Result<Vec<T>, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de>,
{
    List::deserialize(deserializer).map(|list| list.0)
}
