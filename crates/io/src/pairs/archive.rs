//! Contact lists in npz archives: arrays `i` and `j` of whole numbers, named like the columns of a
//! table, or one array of pairs, such as `edge_index` of shape (2, pairs). Images are arrays `sx`,
//! `sy`, `sz`, or [one array](IMAGES) of shape (pairs, 2) or (pairs, 3).

use anyhow::{Context, bail, ensure};

use super::array::Array;
use super::columns::Columns;
use super::list::List;
use super::{MATRIX, RowReader, push};
use crate::formats::npy::{self, Header};
use crate::formats::npz;
use crate::frames::{Choice, Reader};
use crate::raw::lines::{Source, exact, listed, short};
use crate::raw::room::room;
use crate::types::FrameChoice;

/// Names of images in ASE, in codes for learned potentials, and in NequIP.
const IMAGES: [&str; 4] = ["S", "unit_shifts", "cell_shifts", "edge_cell_shift"];

#[derive(Default)]
struct Arrays {
    names: Vec<String>,
    columns: Vec<Vec<i64>>,
    others: Vec<String>,
    /// Two-dimensional arrays, each with its name and its list, or the reason why it is not a list.
    tables: Vec<(String, anyhow::Result<List>)>,
}

pub(super) fn read(mut source: Source<'_>, chosen: &[&str]) -> anyhow::Result<List> {
    let mut arrays = Arrays::default();
    npz::members(&mut source, |member, name| arrays.member(member, name))?;
    arrays.finish(source.name, chosen)
}

impl Arrays {
    fn member(&mut self, mut source: Source<'_>, name: &str) -> anyhow::Result<()> {
        let Some(label) = name.strip_suffix(".npy").map(str::to_string) else { return Ok(()) };
        let Ok(mut header) = npy::header(&mut source) else { return Ok(()) };
        match header.columns {
            None => {
                match columns(&mut source, &mut header, 1, |_| 0)?.and_then(|mut it| it.pop()) {
                    Some(column) => {
                        self.names.push(label);
                        self.columns.push(column);
                    }
                    None => self.others.push(label),
                }
            }
            Some(count @ 2..=3) if IMAGES.contains(&&*label) => {
                let of = columns(&mut source, &mut header, count, |k| k % count)?;
                let place = || format!("{}: an image is not a whole number", source.name);
                self.columns.extend(of.with_context(place)?);
                self.names.extend(["sx", "sy", "sz"].into_iter().take(count).map(String::from));
            }
            Some(count) if label == "edge_index" && header.rows == 2 => {
                let of = columns(&mut source, &mut header, 2, |k| k / count)?;
                let place =
                    || format!("{}: edge_index has a number that is not whole", source.name);
                self.columns.extend(of.with_context(place)?);
                self.names.extend(["i", "j"].map(String::from));
            }
            Some(_) => {
                let mut array = RowReader::new(Array::behind(source, header));
                let list = array.next(&mut Choice::new(FrameChoice::Only, false));
                self.tables.push((label, list.map(Option::unwrap_or_default)));
            }
        }
        Ok(())
    }

    fn finish(mut self, name: &str, chosen: &[&str]) -> anyhow::Result<List> {
        let place = || name.to_string();
        let named = match chosen.is_empty() || !self.names.is_empty() {
            true => Columns::named(&self.names, chosen, place)?,
            false => None,
        };
        let Some(columns) = named else { return self.table(name) };
        let framed = self.names.iter().any(|it| ["frame", "step", "timestep"].contains(&&**it));
        ensure!(!framed, "{name}: pairs of several frames are read from CSV, with a column frame");
        let pair @ [i, j] = columns.pair;
        let all = columns.image.iter().chain(&pair);
        let n = self.columns[i].len();
        for &k in all {
            let (other, found) = (short(&self.names[k]), self.columns[k].len());
            ensure!(found == n, "{name}: '{other}' has {found} numbers, and there are {n} pairs");
        }
        let mut list = List { format: "NumPy npz", ..List::default() };
        for row in 0..n {
            let mut numbers = [0; 3];
            let of = columns.image.iter().map(|&k| self.columns[k][row]);
            numbers.iter_mut().zip(of).for_each(|(to, from)| *to = from);
            let pair = [self.columns[i][row], self.columns[j][row]];
            let image = (!columns.image.is_empty()).then_some(numbers);
            push(&mut list, pair, image, || format!("{name}: pair {row}"))?;
        }
        columns.end(&mut list);
        let tables = self.tables.iter().map(|(label, _)| label);
        list.others.extend(self.others.iter().chain(tables).map(|name| short(name)));
        Ok(list)
    }

    fn table(&mut self, name: &str) -> anyhow::Result<List> {
        let good = self.tables.iter().filter(|(_, list)| list.is_ok()).count();
        let all: Vec<&str> = self.tables.iter().map(|(label, _)| &**label).collect();
        ensure!(good <= 1, "{name}: several arrays may hold the pairs: {}; keep one", listed(&all));
        let which = self.tables.iter().position(|(_, list)| list.is_ok() || good == 0);
        let Some(k) = which else {
            let mut all = std::mem::take(&mut self.names);
            all.append(&mut self.others);
            bail!("{name} has no arrays i and j, and none (pairs, 2); there are: {}", listed(&all))
        };
        let (label, list) = self.tables.swap_remove(k);
        let list = list?;
        if let Some(k) = self.columns.iter().position(|counts| is_padded(&list, counts)) {
            let counts = short(&self.names[k]);
            bail!(
                "{name}: each row of '{label}' has the neighbours of one particle, whose number is \
                 in '{counts}'; {MATRIX}"
            )
        }
        Ok(List { format: "NumPy npz", ..list })
    }
}

/// Whether each row of a list has as many numbers as `counts` states, followed by one number that
/// is the same everywhere: the padding of a matrix of neighbours.
fn is_padded(list: &List, counts: &[i64]) -> bool {
    let images = list.images.as_deref();
    let width = 2 + images.map_or(0, |_| if list.flat { 2 } else { 3 });
    let cells = |k: usize| {
        let image = images.map_or([0; 3], |images| images[k].map(i64::from));
        list.pairs[k].into_iter().chain(image).take(width)
    };
    let fits = |count: &i64| usize::try_from(*count).is_ok_and(|count| count <= width);
    let behind = |k: usize| cells(k).skip(counts[k] as usize);
    let padding = || (0..counts.len()).flat_map(behind);
    counts.len() == list.pairs.len()
        && counts.iter().all(fits)
        && padding().next().is_some_and(|first| padding().all(|other| other == first))
}

/// Reads an array into `count` columns; `of` is the column of a number. `None` if a number is not
/// whole.
fn columns(
    source: &mut Source<'_>,
    header: &mut Header,
    count: usize,
    of: impl Fn(usize) -> usize,
) -> anyhow::Result<Option<Vec<Vec<i64>>>> {
    let mut columns = vec![Vec::new(); count];
    let mut are_whole = true;
    header.values(source, header.frame_size(), |k, value| {
        let column = &mut columns[of(k as usize)];
        are_whole &= exact(value).is_some();
        room(column)?;
        column.push(value as i64);
        Ok(())
    })?;
    Ok(are_whole.then_some(columns))
}
