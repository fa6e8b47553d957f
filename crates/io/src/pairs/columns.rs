//! The columns of a table that hold the two particles and the image of the second.

use anyhow::{Context, ensure};

use crate::pairs::{List, push};
use crate::raw::lines::{Lines, listed, short, shown, whole};

const PAIRS: [[&str; 2]; 5] =
    [["i", "j"], ["patom1", "patom2"], ["natom1", "natom2"], ["id1", "id2"], ["first", "second"]];
const REMEDY: &str = "; name the columns of the two particles with --pairs-columns I,J, or fix \
                      the line";

#[derive(Clone, Default)]
pub(super) struct Columns {
    pub pair: [usize; 2],
    pub image: Vec<usize>,
    ids: bool,
    others: Vec<usize>,
    /// Names of the columns; columns without names have none here.
    names: Vec<String>,
    count: usize,
}

impl Columns {
    /// Finds the columns by name, or uses the `chosen` ones, which may be numbers from 1. Returns
    /// `None` if no pair is found.
    pub fn named(
        names: &[String],
        chosen: &[&str],
        place: impl Fn() -> String,
    ) -> anyhow::Result<Option<Columns>> {
        let at = |label: &str| names.iter().position(|name| name.eq_ignore_ascii_case(label));
        if !chosen.is_empty() {
            let by_number = |label: &str| label.parse::<usize>().ok()?.checked_sub(1);
            let mut places = Vec::new();
            for label in chosen {
                let found = at(label).or_else(|| by_number(label).filter(|&k| k < names.len()));
                places.push(found.with_context(|| {
                    format!("{}: there is no column '{label}' among {}", place(), listed(names))
                })?);
            }
            let image = places.split_off(2);
            let pair = [places[0], places[1]];
            let count = usize::MAX;
            return Ok(Some(Columns { pair, image, count, ..Columns::default() }));
        }
        let mut pairs = PAIRS.iter().map(|[i, j]| at(i).zip(at(j)));
        let Some((i, j)) = pairs.find_map(|pair| pair).or_else(|| of_one_compute(names)) else {
            return Ok(None);
        };
        let image: Vec<usize> = ["sx", "sy", "sz"].iter().map_while(|name| at(name)).collect();
        ensure!(image.len() != 1, "{}: an image has sx, sy and, for spheres, sz", place());
        let mut columns = Columns { pair: [i, j], image, ..Columns::bare(names.len()) };
        let is_used = |k: &usize| columns.pair.contains(k) || columns.image.contains(k);
        columns.others = (0..names.len()).filter(|k| !is_used(k)).collect();
        columns.ids = names[i].eq_ignore_ascii_case("id1");
        Ok(Some(Columns { names: names.to_vec(), ..columns }))
    }

    /// Takes the first two of `count` unnamed columns as the pair.
    pub fn bare(count: usize) -> Columns {
        Columns { pair: [0, 1], others: (2..count).collect(), count, ..Columns::default() }
    }

    pub fn known(&mut self, column: usize) {
        self.others.retain(|&k| k != column);
    }

    pub fn push(
        &mut self,
        lines: &Lines<'_>,
        cells: &[&[u8]],
        list: &mut List,
    ) -> anyhow::Result<()> {
        let number = |k: usize, what: &str| {
            let found = cells.get(k).copied().unwrap_or_default();
            whole(found).with_context(|| {
                let (place, found) = (lines.place(), shown(found));
                let remedy = if self.pair.contains(&k) { REMEDY } else { "" };
                format!("{place}: column {}: '{found}' is not the number of {what}{remedy}", k + 1)
            })
        };
        let pair = [number(self.pair[0], "a particle")?, number(self.pair[1], "a particle")?];
        let mut image = [0; 3];
        for (&k, to) in self.image.iter().zip(&mut image) {
            *to = number(k, "an image")?;
        }
        let image = (!self.image.is_empty()).then_some(image);
        self.others.extend(self.count..cells.len());
        self.count = self.count.max(cells.len());
        push(list, pair, image, || lines.place())
    }

    pub fn end(self, list: &mut List) {
        list.flat = self.image.len() == 2;
        list.named_ids = self.ids;
        if !self.image.is_empty() {
            list.images.get_or_insert_default();
        }
        let name = |&k: &usize| self.names.get(k).map_or((k + 1).to_string(), |name| short(name));
        list.others = self.others.iter().map(name).collect();
        list.unnamed = self.others.iter().any(|&k| k >= self.names.len());
    }
}

fn of_one_compute(names: &[String]) -> Option<(usize, usize)> {
    let first = names.iter().position(|name| name.ends_with("[1]"))?;
    let second = names[first].replace("[1]", "[2]");
    Some((first, names.iter().position(|name| *name == second)?))
}
