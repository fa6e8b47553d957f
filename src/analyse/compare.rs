//! Two records beside each other: cell by cell, what must be the same (pairs, counts, bytes, outcomes), and how the times differ.

use std::collections::{BTreeMap, BTreeSet};

use super::interval::{Blocks, COVERAGE, Interval};
use super::keyed::{MACHINE, keyed};
use super::place::place;
use super::unpaired;
use super::value::{Cell, FIELDS, Key, cells};
use crate::contact::Arithmetic;
use crate::harness::record::{Outcome, Pass, Row};

/// How times are compared.
#[derive(Clone, Debug)]
pub struct Options {
    /// A difference within this share is none.
    pub band: f64,
    /// Times are taken as multiples of this detector's in the same block.
    pub against: Option<String>,
    /// Why times without a reference cannot be judged (two machines), if so.
    pub machines: Option<String>,
    /// Why no times can be judged (two kinds of builds), if so.
    pub builds: Option<String>,
}

/// What came of the times of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Judgement {
    /// B takes more: the whole interval lies beyond the band.
    Slower,
    /// B takes less.
    Faster,
    /// The interval is neither within the band nor beyond it; or there are too few blocks.
    Undecided,
    /// The whole interval lies within the band.
    Equal,
    /// Not of one machine, or not of one kind of build; or the detector that it is taken against has no times.
    NotJudged,
}

impl Judgement {
    /// The word in tables.
    pub fn name(self) -> &'static str {
        match self {
            Judgement::Slower => "slower",
            Judgement::Faster => "faster",
            Judgement::Undecided => "undecided",
            Judgement::Equal => "equal",
            Judgement::NotJudged => "not judged",
        }
    }
}

/// The times of a cell on both sides.
#[derive(Clone, Debug)]
pub struct Timing {
    /// Median nanoseconds per detection in A.
    pub a_ns: f64,
    /// The same in B.
    pub b_ns: f64,
    /// B over A; with a reference, each first divided by the reference's time in the same block.
    pub ratio: Interval,
    /// The verdict.
    pub judgement: Judgement,
    /// Why nothing else can be said; empty where all is said.
    pub note: String,
}

/// Something that must be the same and is not.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Change {
    /// `digest`, `list_push`, `peak_bytes`, `outcome (time)`, ...
    pub what: String,
    /// In A.
    pub a: String,
    /// In B.
    pub b: String,
}

/// A cell of either record.
#[derive(Clone, Debug)]
pub struct Compared {
    /// `nbs, packed, 3D, n = 1000, ...`: all that tells it from other cells.
    pub place: String,
    /// Which cell.
    pub key: Key,
    /// What must be the same and is not.
    pub changes: Vec<Change>,
    /// Why there is nothing to compare, if so: it stands in one record only, or was not available.
    pub absent: Option<String>,
    /// What only one of them has measured of the cell: a run was cut short.
    pub lacks: Vec<String>,
    /// The times, where both have some.
    pub timing: Option<Timing>,
}

/// A record, cell by cell.
struct Side {
    cells: BTreeMap<Key, Cell>,
    /// The fingerprints of the pairs: one, unless answers differ.
    digests: BTreeMap<Key, BTreeSet<String>>,
}

impl Side {
    fn new(rows: &[Row]) -> Side {
        let mut digests: BTreeMap<Key, BTreeSet<String>> = BTreeMap::new();
        for (key, row) in keyed(rows) {
            if let Some(digest) = &row.digest {
                digests.entry(key).or_default().insert(digest.clone());
            }
        }
        Side { cells: cells(rows).into_iter().map(|cell| (cell.key.clone(), cell)).collect(), digests }
    }

    /// The detector that a cell's times are divided by: on the same scene, in the same arithmetic if it can be, with as few threads as there are.
    fn reference(&self, key: &Key, name: &str) -> Option<&Cell> {
        let scene = |key: &Key| key.clone().without("detector").without("arithmetic").without("threads");
        let wanted = scene(key);
        let known = self.cells.values().filter(|cell| cell.key.detector == name && cell.time().is_some() && scene(&cell.key) == wanted);
        known.min_by_key(|cell| (cell.key.arithmetic != key.arithmetic, cell.key.arithmetic != Arithmetic::Exact.name(), cell.key.threads))
    }
}

/// Compares two records of the same machine each, or of the same several. Cells come in the order of keys, those of one record only included.
pub fn compare(a: &[Row], b: &[Row], options: &Options) -> Vec<Compared> {
    let (a, b) = (Side::new(a), Side::new(b));
    let keys: BTreeSet<&Key> = a.cells.keys().chain(b.cells.keys()).collect();
    let swept = swept(&keys);
    let compared = |key: &Key| {
        let mut cell =
            Compared { place: place(key, &swept), key: key.clone(), changes: Vec::new(), absent: None, lacks: Vec::new(), timing: None };
        let (Some(of_a), Some(of_b)) = (a.cells.get(key), b.cells.get(key)) else {
            cell.absent = Some(format!("only in {}", if a.cells.contains_key(key) { "A" } else { "B" }));
            return cell;
        };
        let mut missing = [("A", of_a), ("B", of_b)].into_iter().filter(|(_, side)| side.overall().0 == Outcome::Unavailable);
        // Of what was available in neither, nothing is missing.
        if let (Some((name, side)), None) = (missing.next(), missing.next()) {
            cell.absent = Some(format!("unavailable in {name}: {}", side.overall().1));
            return cell;
        }
        if of_a.stats.scene_hash != of_b.stats.scene_hash {
            // All else follows from that.
            cell.changes.push(Change { what: "scene".into(), a: of_a.stats.scene_hash.clone(), b: of_b.stats.scene_hash.clone() });
            return cell;
        }
        cell.changes = changes(of_a, of_b);
        let digests = [&a, &b].map(|side| side.digests.get(key));
        if let [Some(of_a), Some(of_b)] = digests
            && of_a != of_b
        {
            let text = |digests: &BTreeSet<String>| digests.iter().cloned().collect::<Vec<_>>().join(" and ");
            cell.changes.push(Change { what: "digest".into(), a: text(of_a), b: text(of_b) });
        }
        cell.timing = timing(&a, of_a, &b, of_b, options);
        // What an outcome explains is said by the outcome.
        if cell.changes.is_empty() {
            cell.lacks = lacks(of_a, of_b, cell.timing.is_some());
        }
        cell
    };
    keys.into_iter().map(compared).collect()
}

/// All fields but the parameters that are the same wherever the scene is.
fn swept(keys: &BTreeSet<&Key>) -> Vec<String> {
    let mut values: BTreeMap<(&str, u32, &str), BTreeSet<String>> = BTreeMap::new();
    for key in keys {
        for (name, value) in &key.params {
            values.entry((&key.scene, key.dim, name)).or_default().insert(value.to_string());
        }
    }
    let params: BTreeSet<&str> = values.iter().filter(|(key, values)| values.len() > 1 || key.2 == MACHINE).map(|(key, _)| key.2).collect();
    let differs = |name: &str| keys.iter().map(|key| key.field(name)).collect::<BTreeSet<_>>().len() > 1;
    let rarely = ["experiment", "order", "seed", "threads"];
    let first = ["detector", "arithmetic", "scene", "dim", "n"];
    let others = FIELDS.into_iter().filter(|name| rarely.contains(name) && differs(name));
    first.into_iter().chain(params).chain(others).map(String::from).collect()
}

/// Outcomes, contacts, counts and bytes that differ. What one side did not measure, because it ended otherwise, is said by the outcome.
fn changes(a: &Cell, b: &Cell) -> Vec<Change> {
    let mut found = Vec::new();
    let mut note = |what: &str, a: String, b: String| {
        if a != b {
            found.push(Change { what: what.to_string(), a, b });
        }
    };
    for pass in Pass::ALL {
        if let (Some((of_a, _)), Some((of_b, _))) = (a.passes.get(&pass), b.passes.get(&pass)) {
            let word = format!("{pass:?}").to_lowercase();
            note(&format!("outcome ({word})"), of_a.name().into(), of_b.name().into());
        }
    }
    if let (Some(of_a), Some(of_b)) = (a.contacts, b.contacts) {
        note("contacts", of_a.to_string(), of_b.to_string());
    }
    if let (Some(of_a), Some(of_b)) = (&a.counts, &b.counts) {
        // An operation that a version does not know yet has happened no time.
        let names: BTreeSet<&String> = of_a.keys().chain(of_b.keys()).collect();
        let count = |counts: &BTreeMap<String, u64>, name: &str| counts.get(name).copied().unwrap_or(0).to_string();
        names.into_iter().for_each(|name| note(name, count(of_a, name), count(of_b, name)));
    }
    for (name, of_a) in &a.memory {
        if let Some(of_b) = b.memory.get(name) {
            note(name, of_a.to_string(), of_b.to_string());
        }
    }
    found
}

/// What one side has measured and the other has not.
fn lacks(a: &Cell, b: &Cell, timed: bool) -> Vec<String> {
    let mut found = Vec::new();
    let mut see = |what: &str, a: bool, b: bool| {
        if a != b {
            found.push(format!("{what} only in {}", if a { "A" } else { "B" }));
        }
    };
    for pass in Pass::ALL {
        see(&format!("the {} pass", format!("{pass:?}").to_lowercase()), a.passes.contains_key(&pass), b.passes.contains_key(&pass));
    }
    see("times", a.time().is_some(), b.time().is_some());
    see("contacts", a.contacts.is_some(), b.contacts.is_some());
    see("counts", a.counts.is_some(), b.counts.is_some());
    let names: BTreeSet<&str> = a.memory.keys().chain(b.memory.keys()).copied().collect();
    names.into_iter().for_each(|name| see(name, a.memory.contains_key(name), b.memory.contains_key(name)));
    if !timed && a.time().is_some() && b.time().is_some() {
        found.push("no times in blocks of both".into());
    }
    found
}

fn timing(a: &Side, of_a: &Cell, b: &Side, of_b: &Cell, options: &Options) -> Option<Timing> {
    let (a_ns, b_ns) = (of_a.time()?.median, of_b.time()?.median);
    let plain = |cell: &Cell| cell.times.values().map(|&t| t as f64).collect::<Vec<_>>();
    let (mut values, mut note) = ((plain(of_a), plain(of_b)), options.builds.clone());
    match &options.against {
        Some(name) if *name == of_a.key.detector => note = note.or(Some("it is the reference".into())),
        Some(name) => match (a.reference(&of_a.key, name), b.reference(&of_b.key, name)) {
            (Some(to_a), Some(to_b)) if to_a.key == to_b.key => {
                values = (quotients(&of_a.times, &to_a.times), quotients(&of_b.times, &to_b.times));
            }
            _ => note = note.or(Some(format!("{name} has no times on this scene in both"))),
        },
        None => note = note.or(options.machines.clone()),
    }
    let ratio = unpaired::ratio(&values.0, &values.1)?;
    let judgement = if note.is_some() { Judgement::NotJudged } else { judge(&ratio, options.band) };
    let few = || format!("too few blocks: {} and {}", values.0.len(), values.1.len());
    let note = note.unwrap_or_else(|| if ratio.coverage < COVERAGE { few() } else { String::new() });
    Some(Timing { a_ns, b_ns, ratio, judgement, note })
}

/// Within a block both met the same state of the machine.
fn quotients(times: &Blocks, to: &Blocks) -> Vec<f64> {
    times.iter().filter_map(|(block, &time)| Some(time as f64 / to.get(block).filter(|&&to| to > 0).copied()? as f64)).collect()
}

/// The whole interval decides, or nothing does.
fn judge(ratio: &Interval, band: f64) -> Judgement {
    let (low, high) = (1.0 / (1.0 + band), 1.0 + band);
    if ratio.coverage < COVERAGE {
        Judgement::Undecided
    } else if low <= ratio.low && ratio.high <= high {
        Judgement::Equal
    } else if ratio.low > high {
        Judgement::Slower
    } else if ratio.high < low {
        Judgement::Faster
    } else {
        Judgement::Undecided
    }
}

#[cfg(test)]
mod tests {
    use super::super::fake::Lab;
    use super::*;

    fn options() -> Options {
        Options { band: 0.05, against: None, machines: None, builds: None }
    }

    /// 15 times about `base`, with some scatter.
    fn times(base: u64) -> Vec<u64> {
        (0..15).map(|k| base + base * (k * 7 % 15) / 1000).collect()
    }

    fn lab(nbs: u64, sweep: u64) -> Lab {
        let mut lab = Lab::new("e", "packed");
        lab.detector("nbs").count(&[("list_push", 40)]).memory(1000, 900).time(&times(nbs));
        lab.detector("sweep").count(&[("list_push", 0)]).memory(500, 500).time(&times(sweep));
        lab
    }

    fn judgements(a: &Lab, b: &Lab, options: &Options) -> Vec<(String, Judgement)> {
        let cells = compare(&a.rows(), &b.rows(), options);
        assert!(cells.iter().all(|cell| cell.changes.is_empty() && cell.absent.is_none()), "{cells:?}");
        cells.into_iter().map(|cell| (cell.key.detector, cell.timing.unwrap().judgement)).collect()
    }

    #[test]
    fn times_are_judged_by_the_whole_interval() {
        use Judgement::{Equal, Faster, NotJudged, Slower, Undecided};
        let of = |nbs, sweep, options: &Options| {
            let found = judgements(&lab(100_000, 200_000), &lab(nbs, sweep), options);
            assert_eq!([&*found[0].0, &*found[1].0], ["nbs", "sweep"]);
            [found[0].1, found[1].1]
        };
        assert_eq!(of(100_500, 300_000, &options()), [Equal, Slower]);
        assert_eq!(of(105_000, 100_000, &options()), [Undecided, Faster]);
        assert_eq!(of(105_000, 100_000, &Options { band: 0.5, ..options() }), [Equal, Faster]);
        // The machine has become half as fast: against nbs nothing has changed.
        let against = Options { against: Some("nbs".into()), machines: Some("two".into()), ..options() };
        assert_eq!(of(200_000, 400_000, &against), [NotJudged, Equal]);
        assert_eq!(of(200_000, 200_000, &against), [NotJudged, Faster]);
        assert_eq!(of(200_000, 400_000, &Options { machines: Some("two machines".into()), ..options() }), [NotJudged; 2]);
        assert_eq!(of(200_000, 200_000, &Options { builds: Some("debug".into()), ..against }), [NotJudged; 2]);
        assert_eq!(of(200_000, 200_000, &Options { against: Some("bvh".into()), ..options() }), [NotJudged; 2]);
    }

    #[test]
    fn few_blocks_decide_nothing() {
        let few = |time| {
            let mut lab = Lab::new("e", "packed");
            lab.time(&[time, time + 1, time + 2]);
            lab
        };
        let cells = compare(&few(100).rows(), &few(900).rows(), &options());
        let timing = cells[0].timing.as_ref().unwrap();
        assert_eq!((timing.judgement, timing.note.as_str()), (Judgement::Undecided, "too few blocks: 3 and 3"));
        assert!((timing.ratio.median - 901.0 / 101.0).abs() < 0.05, "shown all the same: {timing:?}");
    }

    #[test]
    fn whatever_must_be_the_same_is_named() {
        let a = lab(100, 200).rows();
        let changed = |change: fn(&mut Row)| {
            let mut b = a.clone();
            b.iter_mut().for_each(change);
            let cells = compare(&a, &b, &options());
            cells
                .iter()
                .flat_map(|cell| cell.changes.iter().map(|c| format!("{}: {} {} -> {}", cell.key.detector, c.what, c.a, c.b)))
                .collect::<Vec<_>>()
        };
        assert!(changed(|_| ()).is_empty());
        let nbs = |row: &Row| row.detector == "nbs";
        assert!(nbs(&a[0]));
        let one: fn(&mut Row) = |row| row.counts.values_mut().for_each(|count| *count += 1);
        assert_eq!(changed(one), ["nbs: list_push 40 -> 41", "sweep: list_push 0 -> 1"]);
        let unknown: fn(&mut Row) =
            |row| row.counts = row.counts.iter().filter(|count| *count.1 > 0).map(|(k, v)| (k.clone(), *v)).collect();
        assert!(changed(unknown).is_empty(), "an operation that did not happen need not be named");
        assert_eq!(changed(|row| row.peak_bytes = row.peak_bytes.map(|b| b.min(900))), ["nbs: peak_bytes 1000 -> 900"]);
        assert_eq!(
            changed(|row| if row.detector == "sweep" && row.pass == Pass::Time {
                row.digest = Some("0x01".into())
            }),
            ["sweep: digest 0x00 -> 0x00 and 0x01"]
        );
        assert_eq!(
            changed(|row| if row.detector == "sweep" && row.pass == Pass::Count {
                row.outcome = Outcome::Wrong
            }),
            ["sweep: outcome (count) ok -> wrong"]
        );
        assert_eq!(changed(|row| row.stats.scene_hash = "0x2".into()), ["nbs: scene  -> 0x2", "sweep: scene  -> 0x2"]);
    }

    #[test]
    fn cells_of_one_side_and_unavailable_ones_are_absent() {
        let (a, mut b) = (lab(100, 200), Lab::new("e", "packed"));
        b.time(&times(100)).detector("sweep").fail(Pass::Count, Outcome::Unavailable, "not installed");
        b.detector("bvh").time(&times(7));
        let absent: Vec<_> = compare(&a.rows(), &b.rows(), &options()).into_iter().map(|cell| (cell.key.detector, cell.absent)).collect();
        let some = |text: &str| Some(text.to_string());
        assert_eq!(
            absent,
            [("bvh".into(), some("only in B")), ("nbs".into(), None), ("sweep".into(), some("unavailable in B: not installed"))]
        );
    }
}
