//! Column names that only look like sizes, and columns in different units.

use anyhow::ensure;

use super::{Column, Columns};
use crate::Notice;
use crate::columns::units::{known, split, suffixed};
use crate::raw::lines::short;

/// Names of columns next to which r or d is not a size; the doubtful name and its likely meaning.
const BESIDE: [(&[&str], &str, &str); 5] = [
    (&["g", "b"], "r", "red, beside g and b"),
    (&["ra", "dec"], "r", "a magnitude or a distance, beside ra and dec"),
    (&["ra", "dec"], "d", "a distance, beside ra and dec"),
    (&["g"], "r", "red or a magnitude, beside g"),
    (&["b", "v"], "r", "a magnitude, beside b and v"),
];

pub(crate) fn of_size<S: AsRef<str>>(name: &str, names: &[S]) -> Option<String> {
    let plain = |name: &str| split(name).0.to_ascii_lowercase();
    let (size, names) = (plain(name), names.iter().map(|name| plain(name.as_ref())));
    let names: Vec<String> = names.collect();
    let is_there = |beside: &&str| names.iter().any(|name| name == beside);
    let (.., what) = BESIDE.iter().find(|(all, of, _)| *of == size && all.iter().all(is_there))?;
    let key = if size == "d" { "d" } else { "r" };
    Some(format!(
        "'{0}' may be a size or {what}; if it is the size of the particles, give --columns \
         {key}={0}, otherwise --columns r=NAME or --radius R",
        short(name)
    ))
}

impl Columns {
    pub(super) fn one_unit(&mut self) -> anyhow::Result<()> {
        let used = |meaning: &Column| !matches!(meaning, Column::Other | Column::Id);
        let places = (0..self.meaning.len()).filter(|&k| used(&self.meaning[k]));
        let units: Vec<(usize, Option<&str>)> =
            places.map(|k| (k, unit_of(&self.names[k]))).collect();
        let is_axis = |k: usize| matches!(self.meaning[k], Column::Axis(_));
        let mut in_unit = units.iter().filter_map(|&(k, unit)| Some((k, unit?)));
        let of_any = in_unit.clone().next();
        let Some((first, unit)) = in_unit.find(|(k, _)| is_axis(*k)).or(of_any) else {
            return Ok(());
        };
        let (mut powers, mut notices) = (vec![0; self.meaning.len()], Vec::new());
        let first = short(&self.names[first]);
        for &(k, other) in units.iter().filter(|(_, other)| *other != Some(unit)) {
            let name = short(&self.names[k]);
            let words = match (other, known(unit), other.and_then(known)) {
                (Some(_), Some((family, power)), Some((of, from))) => {
                    ensure!(
                        family == of,
                        "'{first}' and '{name}' are in different units, which no power of ten \
                         turns \
                         into each other; write both in one unit, or take the units out of the \
                         names"
                    );
                    powers[k] = from - power;
                    if powers[k] == 0 {
                        continue;
                    }
                    let power = powers[k];
                    format!("'{name}' is multiplied by 1e{power}, to be in the unit of '{first}'")
                }
                (Some(_), ..) => format!(
                    "'{first}' and '{name}' are read as in one unit; if they are not, write them \
                     in one"
                ),
                (None, ..) => format!("'{name}' names no unit, and is read in that of '{first}'"),
            };
            notices.push(Notice::Assumed(words));
        }
        if powers.iter().any(|power| *power != 0) {
            self.powers = powers;
        }
        self.notices.extend(notices);
        Ok(())
    }
}

fn unit_of(name: &str) -> Option<&str> {
    split(name).1.or_else(|| suffixed(name).map(|(_, unit)| unit))
}
