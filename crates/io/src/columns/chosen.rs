//! The option `--columns x=3,y=4,z=5,r=rad`, which assigns columns or arrays of a file.
//!
//! * Coordinates are chosen together: if x and y are given without z, no z is read.
//! * If coordinates or a size are given, no other size is read. If a size alone is given (`r=rad`),
//!   coordinates are found by their names.
//! * `frame=NAME` chooses the column that splits a table into frames; `frame=none` turns splitting
//!   off.
//! * `points=NAME` chooses the array of points in an npz archive.

use std::collections::BTreeSet;
use std::str::FromStr;
use std::sync::{Mutex, PoisonError};

use anyhow::{bail, ensure};

use super::units::split;
use super::{Column, Columns};
use crate::raw::lines::listed;

/// The chosen columns for the keys and frame, each by its number from 1 or by its name.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Chosen {
    columns: [Option<Which>; KEYS.len()],
    frame: Framing,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Framing {
    #[default]
    ByName,
    None,
    By(Which),
}

const KEYS: [(&str, Column); 7] = [
    ("x", Column::Axis(0)),
    ("y", Column::Axis(1)),
    ("z", Column::Axis(2)),
    ("r", Column::Radius),
    ("d", Column::Diameter),
    ("id", Column::Id),
    ("points", Column::Points),
];

/// A name or value. Options are copied often, so each different word is stored once and never
/// freed.
pub type Word = &'static str;

static WORDS: Mutex<BTreeSet<Word>> = Mutex::new(BTreeSet::new());

pub fn word(text: &str) -> Result<Word, String> {
    match text.trim() {
        "" => Err("a name or value is empty".into()),
        text => {
            let mut words = WORDS.lock().unwrap_or_else(PoisonError::into_inner);
            Ok(words.get(text).copied().unwrap_or_else(|| {
                let word: Word = Box::leak(text.into());
                words.insert(word);
                word
            }))
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Which {
    Number(usize),
    Name(Word),
}

impl Which {
    fn text(&self) -> String {
        match self {
            Which::Number(number) => number.to_string(),
            Which::Name(name) => name.to_string(),
        }
    }
}

const FORM: &str = "write what each column holds, as in x=3,y=4,z=5,r=6 or x=px,y=py,d=size";

impl FromStr for Which {
    type Err = String;

    fn from_str(value: &str) -> Result<Which, String> {
        match value.parse() {
            Ok(0) => Err("columns are counted from 1".into()),
            Ok(number) => Ok(Which::Number(number)),
            Err(_) => word(value).map(Which::Name),
        }
    }
}

impl FromStr for Chosen {
    type Err = String;

    fn from_str(text: &str) -> Result<Chosen, String> {
        let mut chosen = Chosen::default();
        for piece in text.split(',') {
            let form = || format!("'{piece}' is not of the form x=3; {FORM}");
            let (key, value) = piece.split_once('=').ok_or_else(form)?;
            let (key, value) = (key.trim(), value.trim());
            let which = || value.parse().map_err(|why| format!("{key}={value}: {why}"));
            let twice = if key == "frame" {
                let frame = match value {
                    "none" => Framing::None,
                    _ => Framing::By(which()?),
                };
                std::mem::replace(&mut chosen.frame, frame) != Framing::ByName
            } else {
                let k = KEYS.iter().position(|(name, _)| *name == key);
                let none =
                    || format!("'{key}' is not one of x, y, z, r, d, id, points, frame; {FORM}");
                chosen.columns[k.ok_or_else(none)?].replace(which()?).is_some()
            };
            if twice {
                return Err(format!("{key} is given twice; leave one out"));
            }
        }
        if chosen.axes() && chosen.columns[..2].contains(&None) {
            return Err("x and y are needed together, as in x=3,y=4".into());
        }
        if chosen.columns[3].is_some() && chosen.columns[4].is_some() {
            return Err("r and d are both sizes; leave one out".into());
        }
        Ok(chosen)
    }
}

impl Chosen {
    pub fn axes(&self) -> bool {
        self.columns[..3].iter().any(Option::is_some)
    }

    pub fn sizes(&self) -> bool {
        self.columns[3..5].iter().any(Option::is_some)
    }

    pub fn points(&self) -> bool {
        self.columns[6].is_some()
    }

    pub fn by_frame(&self) -> bool {
        matches!(self.frame, Framing::By(_))
    }

    pub fn one_scene(&self) -> bool {
        matches!(self.frame, Framing::None)
    }

    /// Returns the columns as indices from 0, if coordinates are chosen and all columns are given
    /// by number.
    pub fn numbers(&self) -> Option<Vec<usize>> {
        let places = self.given().map(|(.., which)| match which {
            Which::Number(number) => Some(number - 1),
            Which::Name(_) => None,
        });
        places.collect::<Option<_>>().filter(|_| self.axes())
    }

    fn given(&self) -> impl Iterator<Item = (&'static str, Column, Which)> {
        let given = KEYS.iter().zip(&self.columns);
        given.filter_map(|((key, column), which)| Some((*key, *column, (*which)?)))
    }

    /// Returns the meaning of a column that was not chosen itself, given what was chosen.
    fn beside(&self, named: Column) -> Column {
        let gone = match named {
            Column::Axis(_) => self.axes() || self.points(),
            Column::Radius | Column::Diameter => self.axes() || self.sizes(),
            Column::Id => self.axes() || self.columns[5].is_some(),
            Column::Points | Column::Other => false,
        };
        if gone { Column::Other } else { named }
    }

    /// Returns the meaning of an array or property by its name, for formats without column numbers.
    pub fn meaning(chosen: Option<Chosen>, name: &str) -> Column {
        let named = Column::named(name);
        let Some(chosen) = chosen else { return named };
        let is_it = |which: Which| matches!(which, Which::Name(_)) && which.text() == name.trim();
        let found = chosen.given().find(|(.., which)| is_it(*which));
        found.map_or(chosen.beside(named), |(_, column, _)| column)
    }

    pub fn among<S: AsRef<str>>(&self, names: &[S], place: &str) -> anyhow::Result<()> {
        for (key, column, which) in self.given() {
            let name = which.text();
            self.keeps(Column::named(&name), column, &format!("{place}: {key}={name}"))?;
            let is_there = names.iter().any(|known| known.as_ref().trim() == name);
            let found = matches!(which, Which::Name(_)) && is_there;
            ensure!(found, "{place}: {key}={name}: there is no such array among {}", listed(names));
        }
        Ok(())
    }

    /// Refuses a coordinate that is chosen as something else: its axis would be lost in silence.
    fn keeps(&self, named: Column, chosen: Column, what: &str) -> anyhow::Result<()> {
        let is_axis = |column| matches!(column, Column::Axis(_) | Column::Points);
        ensure!(
            !is_axis(named) || is_axis(chosen) || self.axes(),
            "{what}: that column is the coordinate {}; choose all coordinates, x=NAME,y=NAME, too",
            named.words()
        );
        Ok(())
    }

    pub fn apply(&self, mut columns: Columns, place: &str) -> anyhow::Result<Columns> {
        columns.meaning.iter_mut().for_each(|meaning| *meaning = self.beside(*meaning));
        let mut taken = Vec::new();
        for (key, meaning, which) in self.given() {
            let k = which.find(key, &mut columns, place)?;
            let what = format!("{place}: {key}={}", which.text());
            ensure!(!taken.contains(&k), "{what}: that column is taken for something else already");
            self.keeps(columns.meaning[k], meaning, &what)?;
            taken.push(k);
            columns.meaning[k] = meaning;
        }
        Ok(columns)
    }

    /// Returns the column that splits the rows into frames: the chosen one, otherwise the one that
    /// `by_name` finds. Returns `None` if splitting is turned off.
    pub fn frame(
        chosen: Option<Chosen>,
        columns: &mut Columns,
        place: &str,
        by_name: impl FnOnce(&Columns) -> Option<usize>,
    ) -> anyhow::Result<Option<usize>> {
        match chosen.unwrap_or_default().frame {
            Framing::ByName => Ok(by_name(columns)),
            Framing::None => Ok(None),
            Framing::By(which) => which.find("frame", columns, place).map(Some),
        }
    }
}

impl Which {
    /// Returns the index of the chosen column, which may have no name if lines may have more
    /// columns than there are names.
    fn find(&self, key: &str, columns: &mut Columns, place: &str) -> anyhow::Result<usize> {
        let name = self.text();
        let found: Vec<usize> = match *self {
            Which::Number(number) => {
                while columns.or_more && columns.names.len() < number.min(1 << 16) {
                    columns.names.push(format!("column {}", columns.names.len() + 1));
                    columns.meaning.push(Column::Other);
                }
                (number - 1..number).filter(|&k| k < columns.names.len()).collect()
            }
            Which::Name(_) => {
                let whole = |known: &str| known.trim() == name;
                let plain = |known: &str| split(known).0 == name;
                let places = |is_it: &dyn Fn(&str) -> bool| -> Vec<usize> {
                    (0..columns.names.len()).filter(|&k| is_it(&columns.names[k])).collect()
                };
                Some(places(&whole)).filter(|it| !it.is_empty()).unwrap_or_else(|| places(&plain))
            }
        };
        match found[..] {
            [k] => Ok(k),
            [] => bail!("{place}: {key}={name}: no such column among {}", listed(&columns.names)),
            _ => bail!("{place}: {key}={name}: several columns have that name; give a number"),
        }
    }
}
