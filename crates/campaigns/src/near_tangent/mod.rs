//! The campaign: which rows, how many couples for each, run in parallel, and what came of it.

pub mod boxes;
pub mod counts;
pub mod couples;
pub mod near;
pub mod predicate;
pub mod scenes;
pub mod whole;

use crate::draw::{Draw, Sphere};
use boxes::Shape;
use contactbench_core::contact::Test;
use counts::{Counts, What};
use couples::{Batch, Family};
use rayon::prelude::*;

/// Offsets in diameters: coordinates have at least this magnitude, and less than five times it; 0:
/// about the origin.
pub const OFFSETS: [f64; 5] = [0.0, 1e3, 1e6, 1e9, 1e12];

/// One line of the table.
pub struct Line {
    pub name: &'static str,
    pub dim: usize,
    /// In diameters; of boxes, in their vectors.
    pub offset: f64,
    pub counts: Counts,
}

/// What is to be done.
#[derive(Clone, Copy)]
pub struct Plan {
    /// Couples for the contact test, and decisions (couples times detectors) for the detectors, in
    /// open space and in boxes; about so many, in whole batches and scenes.
    pub pairs: u64,
    pub seed: u64,
    /// The test under trial: exact; the rounded one must be found wrong.
    pub test: Test,
}

/// (family, dimension, offset, share): needles are few, because one in sixteen takes the widest
/// numbers there are.
fn families() -> Vec<(Family, usize, f64, u64)> {
    let mut rows = Vec::new();
    for dim in [2, 3] {
        for family in [Family::Pythagoras, Family::Direction] {
            rows.extend(OFFSETS.map(|offset| (family, dim, offset, 9)));
        }
        rows.extend([(Family::LongSum, dim, 0.0, 9), (Family::Needle, dim, 0.0, 1)]);
    }
    rows
}

/// The contact test on couples.
pub fn predicate(plan: Plan) -> Vec<Line> {
    let (plane, space) = (Sphere::<2>::made(), Sphere::<3>::made());
    let rows = families();
    let shares: u64 = rows.iter().map(|row| row.3).sum();
    let batches = |share: u64| (plan.pairs * share).div_ceil(shares * predicate::BATCH).max(1);
    let counts =
        in_parallel(&rows.iter().map(|row| batches(row.3)).collect::<Vec<_>>(), |row, index| {
            let (family, dim, offset, _) = rows[row];
            let draw = &mut Draw::new(plan.seed, (row as u64) << 40 | index);
            if dim == 2 {
                predicate::run(&Batch::new(family, &plane, offset, index, draw), plan.test, draw)
            } else {
                predicate::run(&Batch::new(family, &space, offset, index, draw), plan.test, draw)
            }
        });
    let line = |((family, dim, offset, _), counts): ((Family, usize, f64, u64), Counts)| Line {
        name: family.name(),
        dim,
        offset,
        counts,
    };
    rows.into_iter().zip(counts).map(line).collect()
}

/// Every detector on scenes of couples.
pub fn detectors(plan: Plan) -> Vec<Line> {
    let (plane, space) = (Sphere::<2>::made(), Sphere::<3>::made());
    let mut rows = Vec::new();
    for dim in [2, 3] {
        for sizes in [false, true] {
            rows.extend(OFFSETS.map(|offset| (sizes, dim, offset)));
        }
    }
    let each = plan.pairs.div_ceil(rows.len() as u64 * scenes::detectors(false).len() as u64);
    let scenes: Vec<u64> = rows
        .iter()
        .map(|row| {
            each.div_ceil(if row.1 == 2 { scenes::couples::<2>() } else { scenes::couples::<3>() })
        })
        .collect();
    let counts = in_parallel(&scenes, |row, index| {
        let (sizes, dim, offset) = rows[row];
        let draw = &mut Draw::new(plan.seed, 1 << 62 | (row as u64) << 40 | index);
        if dim == 2 {
            scenes::Row { sphere: &plane, offset, sizes }.run(index, plan.test, draw)
        } else {
            scenes::Row { sphere: &space, offset, sizes }.run(index, plan.test, draw)
        }
    });
    let name = |sizes| if sizes { "borders, sizes" } else { "borders, one size" };
    rows.into_iter()
        .zip(counts)
        .map(|((sizes, dim, offset), counts)| Line { name: name(sizes), dim, offset, counts })
        .collect()
}

/// Particles in boxes are named by images up to so many vectors away.
const AWAY: [i64; 3] = [0, 1_000, 1_000_000];

/// Every detector in boxes that repeat.
pub fn boxes(plan: Plan) -> Vec<Line> {
    let (plane, space) = (Sphere::<2>::made(), Sphere::<3>::made());
    let mut rows = Vec::new();
    for dim in [2, 3] {
        for shape in Shape::ALL {
            rows.extend(AWAY.map(|away| (shape, dim, away)));
        }
    }
    let decisions = rows.len() as u64 * scenes::detectors(true).len() as u64 * boxes::COUPLES;
    let scenes = vec![plan.pairs.div_ceil(decisions); rows.len()];
    let counts = in_parallel(&scenes, |row, index| {
        let (shape, dim, away) = rows[row];
        let draw = &mut Draw::new(plan.seed, 1 << 61 | (row as u64) << 40 | index);
        if dim == 2 {
            boxes::Row { sphere: &plane, shape, away }.run(index, plan.test, draw)
        } else {
            boxes::Row { sphere: &space, shape, away }.run(index, plan.test, draw)
        }
    });
    let line = |((shape, dim, away), counts): ((Shape, usize, i64), Counts)| Line {
        name: shape.name(),
        dim,
        offset: away as f64,
        counts,
    };
    rows.into_iter().zip(counts).map(line).collect()
}

/// Runs so many pieces of every row, in any order, and adds them up by row.
fn in_parallel(pieces: &[u64], run: impl Fn(usize, u64) -> Counts + Sync) -> Vec<Counts> {
    let all: Vec<_> = pieces
        .iter()
        .enumerate()
        .flat_map(|(row, &n)| (0..n).map(move |index| (row, index)))
        .collect();
    let zero = || vec![Counts::default(); pieces.len()];
    let add = |mut left: Vec<Counts>, right: Vec<Counts>| {
        left.iter_mut().zip(right).for_each(|(left, right)| *left += right);
        left
    };
    all.into_par_iter()
        .fold(zero, |mut counts, (row, index)| {
            counts[row] += run(row, index);
            counts
        })
        .reduce(zero, add)
}

/// All lines together.
pub fn total(lines: &[Line]) -> Counts {
    lines.iter().fold(Counts::default(), |mut sum, line| {
        sum += line.counts;
        sum
    })
}

/// The table of a part, as text.
pub fn table(lines: &[Line]) -> String {
    let mut text = format!(
        "{:18} {:>3} {:>7} {:>13} {:>12} {:>12} {:>12} {:>7} {:>7} {:>8} {:>9} {:>6} {:>6}\n",
        "family",
        "dim",
        "offset",
        "decisions",
        "tangent",
        "overlap",
        "apart",
        "exact",
        "missed",
        "spurious",
        "duplicate",
        "other",
        "f64"
    );
    let percent = |part: u64, whole: u64| {
        if whole == 0 {
            "-".to_owned()
        } else {
            format!("{:.1}%", 100.0 * part as f64 / whole as f64)
        }
    };
    let mut line = |name: &str, dim: &str, offset: &str, counts: &Counts| {
        let get = |what| counts.get(what);
        let listed = get(What::Missed) + get(What::Spurious) + get(What::Duplicate);
        text += &format!(
            "{name:18} {dim:>3} {offset:>7} {:>13} {:>12} {:>12} {:>12} {:>7} {:>7} {:>8} {:>9} \
             {:>6} {:>6}\n",
            get(What::Pairs),
            get(What::Tangent),
            get(What::Overlap),
            get(What::Apart),
            percent(get(What::Exact), get(What::Pairs)),
            get(What::Missed),
            get(What::Spurious),
            get(What::Duplicate),
            counts.errors() - listed,
            percent(get(What::RoundedWrong), get(What::Rounded)),
        );
    };
    for Line { name, dim, offset, counts } in lines {
        let offset = if *offset == 0.0 { "0".to_owned() } else { format!("{offset:.0e}") };
        line(name, &dim.to_string(), &offset, counts);
    }
    line("total", "", "", &total(lines));
    text
}
