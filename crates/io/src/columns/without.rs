//! Contacts left out by a column of the particles: `type=2`, `type=1:2`, or `clumpId=same`.

use std::collections::HashMap;
use std::str::FromStr;

use anyhow::{Context, bail, ensure};

use super::Columns;
use super::chosen::{Word, word};
use crate::raw::lines::{listed, number};
use crate::raw::room::room;
use crate::types::FrameChoice;

/// Leaves out contacts of particles with a given value in a column: all of them, or only contacts
/// with particles of a second value; or contacts of two particles with the same value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Without {
    column: Word,
    rules: &'static [[Option<Word>; 2]],
    same: bool,
}

const MOST: usize = 100;

impl FromStr for Without {
    type Err = String;

    fn from_str(text: &str) -> Result<Without, String> {
        const FORM: &str = "write a column and one or two values, as in type=2 or type=1:2, or \
                            clump=same";
        let (mut columns, mut rules, mut same) = (Vec::new(), Vec::new(), false);
        for piece in text.split(',') {
            let (column, values) = piece.split_once('=').ok_or(FORM)?;
            columns.push(word(column)?);
            if values == "same" {
                same = true;
                continue;
            }
            let values: Vec<Word> = values.split(':').map(word).collect::<Result<_, _>>()?;
            match values[..] {
                [value] => rules.push([Some(value), None]),
                [a, b] => rules.push([Some(a), Some(b)]),
                _ => return Err(format!("'{piece}' has more than two values; {FORM}")),
            }
        }
        match columns.iter().all(|column| *column == columns[0]) && rules.len() <= MOST {
            true => Ok(Without { column: columns[0], rules: rules.leak(), same }),
            false => {
                Err(format!("'{text}' names several columns, or many values; name one column"))
            }
        }
    }
}

impl Without {
    pub fn groups(self, columns: &Columns, place: &str) -> anyhow::Result<Groups> {
        let name = self.column;
        let column = columns.names.iter().position(|known| known.trim() == name);
        let column = column.with_context(|| {
            format!(
                "{place}: --without: there is no column {name} among {}",
                listed(&columns.names)
            )
        })?;
        let alike = self.same.then(HashMap::new);
        let mut groups = Groups { column, alike, ..Groups::default() };
        for rule in self.rules {
            let [a, b] = rule.map(|value| value.map(|value| groups.index(value)));
            groups.rules.extend(a.map(|a| (a, b)));
        }
        Ok(Groups { name, ..groups })
    }
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Groups {
    name: Word,
    pub column: usize,
    /// Named values: the text, and the number if the text is one.
    values: Vec<(Word, Option<f64>)>,
    /// Values whose contacts are left out: with all particles, or with those of a second value.
    rules: Vec<(u8, Option<u8>)>,
    /// For each particle, the index of its value; the number of values if no rule names its value.
    of: Vec<u8>,
    /// The values seen, if contacts of particles with the same value are left out.
    alike: Option<HashMap<Vec<u8>, u32>>,
    /// For each particle, the number of its value; `None` for a particle of no clump or molecule.
    value: Vec<Option<u32>>,
}

impl Groups {
    fn find(&self, cell: &[u8]) -> usize {
        let as_number = number(cell);
        let same = |(text, number): &(Word, Option<f64>)| {
            cell == text.as_bytes() || as_number.is_some() && *number == as_number
        };
        self.values.iter().position(same).unwrap_or(self.values.len())
    }

    /// Returns the index of a named value, which is added if it is new.
    fn index(&mut self, value: Word) -> u8 {
        let index = self.find(value.as_bytes());
        if index == self.values.len() {
            self.values.push((value, number(value.as_bytes())));
        }
        index as u8
    }

    pub fn push(&mut self, cell: &[u8]) -> anyhow::Result<()> {
        room(&mut self.of)?;
        self.of.push(self.find(cell) as u8);
        let Some(alike) = &mut self.alike else { return Ok(()) };
        // YADE writes -1 for a sphere without a clump, and LAMMPS molecule 0 for an atom of none.
        let least = if self.name.starts_with("mol") { 1.0 } else { 0.0 };
        let is_none = number(cell).is_some_and(|value| value < least);
        room(&mut self.value)?;
        let next = alike.len() as u32;
        self.value.push((!is_none).then(|| *alike.entry(cell.to_vec()).or_insert(next)));
        Ok(())
    }

    pub fn leave_out(&self, i: u32, j: u32) -> bool {
        let [a, b] = [i, j].map(|k| self.of[k as usize]);
        let is = |(x, y): (u8, Option<u8>), a, b| a == x && y.is_none_or(|y| b == y);
        let values = [i, j].map(|k| self.value.get(k as usize).copied().flatten());
        values[0].is_some() && values[0] == values[1] && i != j
            || self.rules.iter().any(|&rule| is(rule, a, b) || is(rule, b, a))
    }

    /// Refuses values that no particle has, unless another frame may have them, and columns that
    /// not all particles have.
    pub fn check(&self, particles: usize, frame: FrameChoice, name: &str) -> anyhow::Result<()> {
        ensure!(self.of.len() == particles, "{name}: --without: not all particles have the column");
        let missing = |k: &usize| frame != FrameChoice::All && !self.of.contains(&(*k as u8));
        if let Some(k) = (0..self.values.len()).find(missing) {
            bail!("{name}: no particle has {} {}; look at --without", self.name, self.values[k].0);
        }
        Ok(())
    }
}
