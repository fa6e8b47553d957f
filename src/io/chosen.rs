//! Which columns of a text hold what, where the user says so: `x=3,y=4,z=5,r=rad`.

use std::str::FromStr;

use anyhow::{bail, ensure};

use crate::io::lines::listed;
use crate::io::particles::{Column, Columns};

/// A column by its number from 1 or by its name, for some of x, y, z, r, d and id.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Chosen([Option<Which>; KEYS.len()]);

/// What columns may be chosen for.
const KEYS: [(&str, Column); 6] = [
    ("x", Column::Axis(0)),
    ("y", Column::Axis(1)),
    ("z", Column::Axis(2)),
    ("r", Column::Radius),
    ("d", Column::Diameter),
    ("id", Column::Id),
];

/// A short text: UTF-8, filled up with zeros.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Word([u8; Word::LONGEST]);

impl Word {
    const LONGEST: usize = 32;

    /// Without the blanks around it; an error if it is empty or too long.
    pub fn new(text: &str) -> Result<Word, String> {
        let text = text.trim();
        let mut bytes = [0; Word::LONGEST];
        match bytes.get_mut(..text.len()) {
            Some([]) => Err("a name or value is empty".into()),
            Some(place) => {
                place.copy_from_slice(text.as_bytes());
                Ok(Word(bytes))
            }
            None => Err(format!("'{text}' has more than {} bytes", Word::LONGEST)),
        }
    }

    /// As it was.
    pub fn text(&self) -> String {
        String::from_utf8_lossy(&self.0).trim_end_matches('\0').to_string()
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
            Which::Name(name) => name.text(),
        }
    }
}

impl FromStr for Chosen {
    type Err = String;

    fn from_str(text: &str) -> Result<Chosen, String> {
        let mut chosen = Chosen::default();
        for piece in text.split(',') {
            let form = "write what each column holds, as in x=3,y=4,z=5,r=6 or x=px,y=py,d=size";
            let Some((key, value)) = piece.split_once('=') else {
                return Err(format!("'{piece}' is not of the form x=3; {form}"));
            };
            let (key, value) = (key.trim(), value.trim());
            let known = KEYS.iter().position(|(name, _)| *name == key);
            let Some(k) = known else {
                return Err(format!("'{key}' is not one of x, y, z, r, d, id; {form}"));
            };
            if chosen.0[k].is_some() {
                return Err(format!("{key} is given twice; leave one out"));
            }
            chosen.0[k] = Some(match value.parse() {
                Ok(0) => return Err(format!("{key}=0: columns are counted from 1")),
                Ok(number) => Which::Number(number),
                Err(_) if value.is_empty() => return Err(format!("{key} has no column; {form}")),
                Err(_) => Word::new(value).map(Which::Name).map_err(|_| {
                    format!(
                        "{key}: a name of more than {} bytes; give the column's number",
                        Word::LONGEST
                    )
                })?,
            });
        }
        if chosen.0[0].is_none() || chosen.0[1].is_none() {
            return Err("x and y are needed, as in x=3,y=4".into());
        }
        Ok(chosen)
    }
}

impl Chosen {
    /// The columns with this meaning and no other.
    pub(crate) fn apply(&self, mut columns: Columns, place: &str) -> anyhow::Result<Columns> {
        columns.meaning.fill(Column::Other);
        for ((key, meaning), which) in KEYS.iter().zip(&self.0) {
            let Some(which) = which else { continue };
            let found = match *which {
                Which::Number(number) => {
                    while columns.or_more && columns.names.len() < number.min(1 << 16) {
                        columns.names.push(format!("column {}", columns.names.len() + 1));
                        columns.meaning.push(Column::Other);
                    }
                    Some(number - 1).filter(|&k| k < columns.names.len())
                }
                Which::Name(_) => {
                    let name = which.text();
                    columns.names.iter().position(|known| known.trim() == name)
                }
            };
            let Some(k) = found else {
                bail!(
                    "{place}: {key}={}: there is no such column; there are {}: {}",
                    which.text(),
                    columns.names.len(),
                    listed(&columns.names)
                );
            };
            ensure!(
                columns.meaning[k] == Column::Other,
                "{place}: {key}={}: that column is taken for something else already",
                which.text()
            );
            columns.meaning[k] = *meaning;
        }
        Ok(columns)
    }
}

#[cfg(test)]
mod tests {
    use crate::io::{self, Options};

    fn read(text: &str, ending: &str, columns: &str) -> Result<String, String> {
        let options = Options { columns: Some(columns.parse()?), ids: true, ..Options::NONE };
        io::load_from(text.as_bytes(), "f", ending, options)
            .map(|(particles, _)| {
                let radii = particles.radii.as_ref().map(|radii| radii[0]);
                format!("{:?} {radii:?} {:?}", particles.centre(0), particles.ids())
            })
            .map_err(|error| format!("{error:#}"))
    }

    #[test]
    fn columns_are_chosen_by_name_and_by_number_in_every_text() {
        let ball = "[1.0, 2.0, 3.0] Some(4.0) Some([7])".to_string();
        let csv = "7,1,2,3,4,0\n";
        let numbered = "x=2,y=3,z=4,r=5,id=1";
        assert_eq!(read(csv, "csv", numbered), Ok(ball.clone()));
        let named = format!("n;px;py;pz;size;x\n{}", csv.replace(',', ";"));
        assert_eq!(read(&named, "csv", "x=px,y=py,z=pz,r=size,id=n"), Ok(ball.clone()));
        assert_eq!(read(&named, "csv", numbered), Ok(ball.clone()));
        let blanks = format!("# n px py pz size x\n{}", csv.replace(',', " "));
        assert_eq!(read(&blanks, "csv", "x=px,y=py,z=pz,r=size,id=n"), Ok(ball.clone()));
        let dump = format!(
            "ITEM: NUMBER OF ATOMS\n1\nITEM: ATOMS n px py pz size x\n{}",
            csv.replace(',', " ")
        );
        assert_eq!(read(&dump, "dump", "x=px,y=py,z=pz,r=size,id=n"), Ok(ball.clone()));
        assert_eq!(read(&dump, "dump", numbered), Ok(ball.clone()));
        let xyz = format!("1\n\n{}", csv.replace(',', " "));
        assert_eq!(read(&xyz, "xyz", numbered), Ok(ball.clone()));
        let data = format!("c\n\n1 atoms\n\nAtoms # of mine\n\n{}", csv.replace(',', " "));
        assert_eq!(read(&data, "lmp", numbered), Ok(ball.clone()));
        let mercury = "1 0 0 0 0 9 9 9\n1 2 3 0 0 0 8 0 0 0 0 0 0 0\n";
        assert_eq!(
            read(mercury, "data", "x=1,y=2,z=3,d=7"),
            Ok("[1.0, 2.0, 3.0] Some(4.0) None".into())
        );
    }

    #[test]
    fn what_cannot_be_chosen_is_refused() {
        let csv = "a,b,c\n1,2,3\n";
        for (columns, words) in [
            ("x=1", "x and y are needed"),
            ("x y", "'x y' is not of the form x=3; write what each column holds, as in x=3,y=4"),
            ("x=1,y=2,w=3", "'w' is not one of x, y, z, r, d, id"),
            ("x=0,y=2", "x=0: columns are counted from 1"),
            ("x=1,y=2,x=3", "x is given twice"),
            ("x=1,y=4", "f:1: y=4: there is no such column; there are 3: a b c"),
            ("x=a,y=A", "f:1: y=A: there is no such column"),
            ("x=1,y=a", "f:1: y=a: that column is taken for something else already"),
        ] {
            let error = read(csv, "csv", columns).unwrap_err();
            assert!(error.contains(words), "{columns}: {error}");
        }
        let error = read("\u{93}NUMPY", "csv", "x=1,y=2").unwrap_err();
        assert!(!error.is_empty());
        let error = read("ply\nformat ascii 1.0\n", "ply", "x=1,y=2").unwrap_err();
        assert!(error.contains("columns are chosen in files of text"), "{error}");
    }
}
