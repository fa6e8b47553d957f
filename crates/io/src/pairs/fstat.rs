//! Contact lists in MercuryDPM `.fstat`: `time i j x y z overlap ...`, with indices from 0 and
//! negative numbers for walls. Each contact of two particles occurs in both directions. Frames
//! start with lines that start with #.

use anyhow::{Context, ensure};

use super::list::List;
use super::push;
use crate::frames::{Choice, Reader, Step};
use crate::raw::lines::{Lines, number, shown, whole, words};
use contactbench_terms::mix::splitmix64;

const FORMAT: &str = "MercuryDPM fstat";

/// Recognises three lines that start with `#`, before lines of 14 numbers. If `strictly`, the lines
/// with `#` must contain numbers.
pub(crate) fn tells(head: &[u8], strictly: bool) -> bool {
    let lines = || head.split(|&b| b == b'\n').map(<[u8]>::trim_ascii);
    let mut data = lines().filter(|line| !line.is_empty() && !line.starts_with(b"#"));
    let row = data.next().unwrap_or_default();
    let numbers = |line: &[u8]| words(line).all(|word| number(word).is_some());
    let begun = lines().take(3).all(|line| line.strip_prefix(b"#").is_some_and(numbers));
    head.starts_with(b"#")
        && words(row).count() >= 13
        && (!strictly
            || begun && numbers(row) && words(row).skip(1).take(2).all(|it| whole(it).is_some()))
}

pub(super) struct Fstat<'a> {
    lines: Lines<'a>,
    /// Whether the current line starts a frame.
    ahead: bool,
}

impl<'a> Fstat<'a> {
    pub fn new(lines: Lines<'a>) -> Fstat<'a> {
        Fstat { lines, ahead: false }
    }

    fn frame(&mut self, list: &mut List, keep: bool) -> anyhow::Result<()> {
        let Fstat { lines, ahead } = self;
        let mut in_header = lines.line().starts_with(b"#");
        loop {
            if lines.line().starts_with(b"#") {
                if !in_header {
                    *ahead = true;
                    return Ok(());
                }
            } else {
                in_header = false;
                if keep {
                    row(lines, list)?;
                }
            }
            if !lines.advance_over_blanks()? {
                return Ok(());
            }
        }
    }
}

impl Reader<List> for Fstat<'_> {
    fn next(&mut self, choice: &mut Choice) -> anyhow::Result<Option<List>> {
        while std::mem::take(&mut self.ahead) || self.lines.advance_over_blanks()? {
            let index = choice.seen;
            let step = choice.begin(|| self.lines.place())?;
            if step == Step::Stop {
                return Ok(None);
            }
            let mut list = List { format: FORMAT, frame: Some(index), ..List::default() };
            self.frame(&mut list, step == Step::Keep)?;
            if step == Step::Keep {
                one_side(&mut list);
                return Ok(Some(list));
            }
        }
        Ok(None)
    }
}

fn row(lines: &Lines<'_>, list: &mut List) -> anyhow::Result<()> {
    let cells: Vec<&[u8]> = words(lines.line()).collect();
    ensure!(
        cells.len() >= 13,
        "{}: {} columns; lines of an .fstat file have 14: is it cut off?",
        lines.place(),
        cells.len()
    );
    let name = |k: usize| {
        whole(cells[k]).with_context(|| {
            let (place, found) = (lines.place(), shown(cells[k]));
            format!("{place}: column {}: '{found}' is not the number of a particle", k + 1)
        })
    };
    let pair = [name(1)?, name(2)?];
    if pair.iter().any(|&k| k < 0) {
        list.walls += 1;
        return Ok(());
    }
    push(list, pair, None, String::new)
}

/// If every contact occurs in both directions, keeps one direction. This is tested by comparing
/// fingerprints of the pairs and of the reversed pairs, which do not depend on order.
fn one_side(list: &mut List) {
    let mix = |i: i64, j: i64| splitmix64(splitmix64(i as u64) ^ j as u64);
    let sum = |sum: [u64; 2], &[i, j]: &[i64; 2]| {
        [sum[0].wrapping_add(mix(i, j)), sum[1].wrapping_add(mix(j, i))]
    };
    let [there, back] = list.pairs.iter().fold([0; 2], sum);
    list.both_sides = there == back && !list.pairs.is_empty();
    if list.both_sides {
        list.pairs.retain(|[i, j]| i <= j);
    }
}
