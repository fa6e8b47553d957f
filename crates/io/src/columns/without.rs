//! Contacts left out by a column of the particles: `type=2`, or `type=1:2`.

use std::str::FromStr;

use anyhow::{Context, bail, ensure};

use super::Columns;
use super::chosen::{Word, word};
use crate::raw::lines::{listed, number};
use crate::raw::room::room;
use crate::types::Frame;

/// Leaves out contacts of particles with a given value in a column: all of them, or only contacts
/// with particles of a second value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Without {
    column: Word,
    /// Values with an index of their own; all others have the index [`MOST`].
    values: [Option<Word>; MOST],
    /// Bit b of `with[a]`: whether contacts between values a and b are left out.
    with: [u16; MOST + 1],
}

const MOST: usize = 8;

impl FromStr for Without {
    type Err = String;

    fn from_str(text: &str) -> Result<Without, String> {
        const FORM: &str = "write a column and one or two values, as in type=2 or type=1:2";
        let mut without: Option<Without> = None;
        for piece in text.split(',') {
            let Some((column, values)) = piece.split_once('=') else {
                return Err(format!("'{piece}' is not of the form type=2; {FORM}"));
            };
            let column = word(column)?;
            let none = Without { column, values: [None; MOST], with: [0; MOST + 1] };
            let without = without.get_or_insert(none);
            if without.column != column {
                return Err(format!("'{text}' names several columns; name one"));
            }
            match values.split(':').collect::<Vec<_>>()[..] {
                [value] => {
                    let a = without.named(value)?;
                    (0..=MOST).for_each(|b| without.leave_out(a, b));
                }
                [a, b] => {
                    let (a, b) = (without.named(a)?, without.named(b)?);
                    without.leave_out(a, b);
                }
                _ => return Err(format!("'{piece}' has more than two values; {FORM}")),
            }
        }
        without.ok_or_else(|| FORM.to_string())
    }
}

impl Without {
    fn named(&mut self, value: &str) -> Result<usize, String> {
        let value = word(value)?;
        let number_of = |word: &Word| number(word.as_bytes());
        let same = |known: &Word| {
            *known == value || number_of(&value).is_some_and(|x| number_of(known) == Some(x))
        };
        let known = |known: &Option<Word>| known.as_ref().is_none_or(same);
        let place = self.values.iter().position(known);
        let place = place.ok_or_else(|| format!("more than {MOST} values are named"))?;
        self.values[place].get_or_insert(value);
        Ok(place)
    }

    fn leave_out(&mut self, a: usize, b: usize) {
        self.with[a] |= 1 << b;
        self.with[b] |= 1 << a;
    }

    pub fn groups(self, columns: &Columns, place: &str) -> anyhow::Result<Groups> {
        let name = self.column;
        let column = columns.names.iter().position(|known| known.trim() == name);
        let column = column.with_context(|| {
            format!(
                "{place}: --without: there is no column {name} among {}",
                listed(&columns.names)
            )
        })?;
        let value = |word: &Word| (word.to_string(), number(word.as_bytes()));
        let values = self.values.iter().flatten().map(value).collect();
        Ok(Groups { without: self, column, values, of: Vec::new() })
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Groups {
    without: Without,
    pub column: usize,
    /// Named values: the text, and the number if the text is one.
    values: Vec<(String, Option<f64>)>,
    of: Vec<u8>,
}

impl Groups {
    pub fn push(&mut self, cell: &[u8]) -> anyhow::Result<()> {
        let as_number = number(cell);
        let same = |(text, number): &(String, Option<f64>)| {
            cell == text.as_bytes() || as_number.is_some() && *number == as_number
        };
        let named = self.values.iter().position(same);
        room(&mut self.of)?;
        self.of.push(named.unwrap_or(MOST) as u8);
        Ok(())
    }

    pub fn leave_out(&self, i: u32, j: u32) -> bool {
        let [a, b] = [i, j].map(|k| usize::from(self.of[k as usize]));
        self.without.with[a] >> b & 1 == 1
    }

    /// Refuses values that no particle has, unless another frame may have them, and columns that
    /// not all particles have.
    pub fn check(&self, particles: usize, frame: Frame, name: &str) -> anyhow::Result<()> {
        ensure!(self.of.len() == particles, "{name}: --without: not all particles have the column");
        for (k, (value, _)) in self.values.iter().enumerate() {
            if frame != Frame::All && !self.of.contains(&(k as u8)) {
                let column = self.without.column;
                bail!("{name}: no particle has {column} {value}; look at --without");
            }
        }
        Ok(())
    }
}
