//! The columns of a table that hold the two particles and the image of the second.

use anyhow::{Context, ensure};

use crate::pairs::{List, push};
use crate::raw::lines::{Lines, listed, number, short, shown, whole};
use crate::types::assumed;

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
    /// Columns with the value that a row must have to be read, and the option that names both.
    only: Vec<(usize, String)>,
    left_out: u64,
}

impl Columns {
    /// Finds the columns by name, or uses the `chosen` ones, which may be numbers from 1. A chosen
    /// `COLUMN=VALUE` limits the rows. Returns `None` if no pair is found.
    pub fn named(
        names: &[String],
        chosen: &[&str],
        place: impl Fn() -> String,
    ) -> anyhow::Result<Option<Columns>> {
        let at = |label: &str| names.iter().position(|name| name.eq_ignore_ascii_case(label));
        let by_number = |label: &str| label.parse::<usize>().ok()?.checked_sub(1);
        let (mut places, mut only) = (Vec::new(), Vec::new());
        for text in chosen {
            let (label, value) = text.split_once('=').unzip();
            let label = label.unwrap_or(text);
            let found = at(label).or_else(|| by_number(label).filter(|&k| k < names.len()));
            let k = found.with_context(|| {
                format!("{}: there is no column '{label}' among {}", place(), listed(names))
            })?;
            match value {
                Some(_) => only.push((k, text.to_string())),
                None => places.push(k),
            }
        }
        if let [i, j, image @ ..] = &places[..] {
            let (pair, image, count) = ([*i, *j], image.to_vec(), usize::MAX);
            return Ok(Some(Columns { pair, image, count, only, ..Columns::default() }));
        }
        let mut pairs = PAIRS.iter().map(|[i, j]| at(i).zip(at(j)));
        let Some((i, j)) = pairs.find_map(|pair| pair).or_else(|| of_one_compute(names)) else {
            return Ok(None);
        };
        let image: Vec<usize> = ["sx", "sy", "sz"].iter().map_while(|name| at(name)).collect();
        ensure!(image.len() != 1, "{}: an image has sx, sy and, for spheres, sz", place());
        let mut columns = Columns { pair: [i, j], image, ..Columns::bare(names.len()) };
        let limits = |k: &usize| only.iter().any(|(column, _)| column == k);
        let is_used =
            |k: &usize| columns.pair.contains(k) || columns.image.contains(k) || limits(k);
        columns.others = (0..names.len()).filter(|k| !is_used(k)).collect();
        columns.ids = names[i].eq_ignore_ascii_case("id1");
        Ok(Some(Columns { names: names.to_vec(), only, ..columns }))
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
        let has = |(k, text): &(usize, String)| {
            let cell = cells.get(*k).copied().unwrap_or_default();
            let value = text.split_once('=').unwrap_or_default().1.as_bytes();
            cell == value || number(cell).is_some_and(|cell| number(value) == Some(cell))
        };
        if !self.only.iter().all(has) {
            self.left_out += 1;
            return Ok(());
        }
        let whole_at = |k: usize, what: &str| {
            let found = cells.get(k).copied().unwrap_or_default();
            whole(found).with_context(|| {
                let (place, found) = (lines.place(), shown(found));
                let remedy = if self.pair.contains(&k) { REMEDY } else { "" };
                format!("{place}: column {}: '{found}' is not the number of {what}{remedy}", k + 1)
            })
        };
        let pair = [whole_at(self.pair[0], "a particle")?, whole_at(self.pair[1], "a particle")?];
        let mut image = [0; 3];
        for (&k, to) in self.image.iter().zip(&mut image) {
            *to = whole_at(k, "an image")?;
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
        if self.left_out > 0 {
            let options: Vec<&str> = self.only.iter().map(|(_, text)| &**text).collect();
            let (left_out, rows) = (self.left_out, self.left_out + list.pairs.len() as u64);
            let options = options.join(",");
            list.notices.push(assumed!("{options} leaves out {left_out} of {rows} rows"));
        }
        list.unnamed = self.others.iter().any(|&k| k >= self.names.len());
    }
}

fn of_one_compute(names: &[String]) -> Option<(usize, usize)> {
    let first = names.iter().position(|name| name.ends_with("[1]"))?;
    let second = names[first].replace("[1]", "[2]");
    Some((first, names.iter().position(|name| *name == second)?))
}
