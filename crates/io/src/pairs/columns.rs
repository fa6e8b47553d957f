//! The columns of a table that hold the two particles and the image of the second.

use std::collections::HashMap;

use anyhow::{Context, bail};

use crate::pairs::{List, push};
use crate::raw::lines::{Lines, among, listed, short, shown, whole};

const PAIRS: [[&str; 2]; 5] =
    [["i", "j"], ["patom1", "patom2"], ["natom1", "natom2"], ["id1", "id2"], ["first", "second"]];
/// Names of image columns, before the letter or number of an axis: `sx`, `S_x`, `shift[0]`,
/// `Periodic Image.X`. Compared in lower case, letters and digits only.
const IMAGES: &str =
    "s shift cellshift unitshift unitcellshift image periodicimage pbcshift celloffset";
const AXES: [[&str; 3]; 4] = [["x", "y", "z"], ["a", "b", "c"], ["0", "1", "2"], ["1", "2", "3"]];
/// Columns of whole numbers that are known not to be images.
const HARMLESS: &str = "index type ptype ntype patom natom id";

const REMEDY: &str = "; name the columns of the two particles with --pairs-columns I,J, or fix \
                      the line";

#[derive(Clone, Debug, PartialEq)]
pub struct Other {
    /// The name of the column, or its number from 1.
    pub name: String,
    /// Whether the name of the column shows that it is not an image.
    pub named: bool,
    /// Whether the column could be an image by its name, and because all its numbers are whole.
    pub whole: bool,
}

/// Returns column `k`, which has no name.
pub(super) fn unnamed(k: usize) -> (usize, Other) {
    (k, Other { name: (k + 1).to_string(), named: false, whole: false })
}

#[derive(Clone, Default)]
pub(super) struct Columns {
    pub pair: [usize; 2],
    pub image: Vec<usize>,
    /// Whether the image columns were guessed. A number that is not whole refutes the guess.
    guessed: bool,
    ids: bool,
    others: Vec<(usize, Other)>,
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
        let image = images(names, &place)?;
        let others = (0..names.len()).filter(|k| ![i, j].contains(k) && !image.contains(k));
        let other = |k: usize| {
            let plain = plain(&names[k]);
            let harmless = among(HARMLESS, plain.trim_end_matches(['1', '2']));
            let named = !plain.is_empty() && !among(IMAGES, &plain);
            (k, Other { name: short(&names[k]), named, whole: !harmless })
        };
        let others: Vec<(usize, Other)> = others.map(other).collect();
        let ids = names[i].eq_ignore_ascii_case("id1");
        let (pair, guessed, count) = ([i, j], false, names.len());
        Ok(Some(Columns { pair, image, guessed, ids, others, count }))
    }

    /// Takes the first two of `count` unnamed columns as the pair. The image has 2 or 3 more.
    pub fn bare(count: usize) -> Columns {
        let guessed = [4, 5].contains(&count);
        let image = if guessed { (2..count).collect() } else { Vec::new() };
        let others = if guessed { Vec::new() } else { (2..count).map(unnamed).collect() };
        Columns { pair: [0, 1], image, guessed, ids: false, others, count }
    }

    pub fn known(&mut self, column: usize) {
        self.others.retain(|(k, _)| *k != column);
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
        let read = self.image.iter().zip(&mut image).try_for_each(|(&k, to)| {
            *to = number(k, "an image")?;
            anyhow::Ok(())
        });
        let image = read.map(|()| (!self.image.is_empty()).then_some(image));
        match image.and_then(|image| push(list, pair, image, || lines.place())) {
            Err(_) if self.guessed && !self.image.is_empty() => {
                list.images = None;
                push(list, pair, None, || lines.place())?;
                self.others.extend(self.image.drain(..).map(unnamed));
            }
            read => read?,
        }
        for (k, other) in self.others.iter_mut().filter(|(_, other)| other.whole) {
            other.whole = cells.get(*k).is_some_and(|cell| whole(cell).is_some());
        }
        if cells.len() > self.count {
            self.others.extend((self.count..cells.len()).map(unnamed));
            self.count = cells.len();
        }
        Ok(())
    }

    pub fn end(self, list: &mut List) {
        list.flat = self.image.len() == 2;
        list.named_ids = self.ids;
        list.guessed = self.guessed && !self.image.is_empty();
        if !self.image.is_empty() {
            list.images.get_or_insert_default();
        }
        list.others = self.others.into_iter().map(|(_, other)| other).collect();
    }
}

pub(super) fn is_image(name: &str) -> bool {
    among(IMAGES, &plain(name))
}

/// Returns the letters and digits of a name, in lower case.
fn plain(name: &str) -> String {
    name.chars().filter(|c| c.is_ascii_alphanumeric()).map(|c| c.to_ascii_lowercase()).collect()
}

fn of_one_compute(names: &[String]) -> Option<(usize, usize)> {
    let first = names.iter().position(|name| name.ends_with("[1]"))?;
    let second = names[first].replace("[1]", "[2]");
    Some((first, names.iter().position(|name| *name == second)?))
}

fn images(names: &[String], place: impl Fn() -> String) -> anyhow::Result<Vec<usize>> {
    let mut places = HashMap::new();
    for (k, name) in names.iter().enumerate() {
        places.entry(plain(name)).or_insert(k);
    }
    for axes in AXES {
        for stem in IMAGES.split(' ') {
            let at = axes.map(|axis| places.get(&format!("{stem}{axis}")).copied());
            match at {
                [Some(x), Some(y), Some(z)] => return Ok(vec![x, y, z]),
                [Some(x), Some(y), None] => return Ok(vec![x, y]),
                // A single column such as s1 may hold anything.
                [None, None, None] => {}
                _ if axes != AXES[0] => {}
                _ => bail!("{}: an image has {stem}x, {stem}y and, for spheres, {stem}z", place()),
            }
        }
    }
    Ok(Vec::new())
}
