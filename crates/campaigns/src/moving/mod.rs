//! The campaign: which bodies move and how, who follows them, and what came of it.

pub mod couples;
pub mod courses;

use std::collections::BTreeMap;
use std::ops::AddAssign;

use crate::draw::{Draw, Sphere};
use contactbench_core::contact::Arithmetic;
use contactbench_core::detect::Options;
use contactbench_core::detect::table::{self, DetectorSpec, Role, TABLE};
use contactbench_core::oracle;
use contactbench_core::scene::{AnyScene, Scene};
use contactbench_core::sink::normalise;
use contactbench_core::track::{Rule, Skin, TrackerSpec};
use contactbench_scenes::motion::Kind;
use couples::Couple;
use rayon::prelude::*;

/// The rules that miss nothing.
pub const RULES: [Rule; 3] = [Rule::TopTwo, Rule::HalfSkin, Rule::Summed];

/// Half-skin by a comparison that is rounded: it misses nothing but by rounding.
const NEARLY: Rule = Rule::Lammps { delay: 0, every: 1, check: true };

/// What is to be done.
#[derive(Clone, Copy)]
pub struct Plan {
    /// Contacts in frames, each counted for every tracker that is to report it; at least so many.
    pub pair_steps: u64,
    pub seed: u64,
}

/// How often each happened.
#[derive(Clone, Copy, Default, Debug)]
pub struct Counts {
    /// Frames given to a tracker.
    pub frames: u64,
    /// Of those, frames in which it built its list.
    pub built: u64,
    /// Contacts in them.
    pub pair_steps: u64,
    /// Of those, not reported.
    pub missed: u64,
    /// Pairs reported that do not touch, or twice.
    pub wrong: u64,
    /// Frames that were refused.
    pub refused: u64,
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Counts) {
        self.frames += other.frames;
        self.built += other.built;
        self.pair_steps += other.pair_steps;
        self.missed += other.missed;
        self.wrong += other.wrong;
        self.refused += other.refused;
    }
}

/// Counts by kind of tracker and arithmetic, and how many couples of each family came into touch
/// that were not listed at first.
#[derive(Default)]
pub struct Table {
    pub lines: BTreeMap<(String, &'static str), Counts>,
    pub came: BTreeMap<&'static str, u64>,
}

impl Table {
    fn add(&mut self, spec: &TrackerSpec, arithmetic: Arithmetic, counts: Counts) {
        *self.lines.entry((kind(spec), arithmetic.name())).or_default() += counts;
    }

    fn and(mut self, other: Table) -> Table {
        for (key, counts) in other.lines {
            *self.lines.entry(key).or_default() += counts;
        }
        for (name, came) in other.came {
            *self.came.entry(name).or_default() += came;
        }
        self
    }

    /// Of the trackers that promise to miss nothing, or of the others.
    pub fn total(&self, safe: bool) -> Counts {
        let mut sum = Counts::default();
        let lines = self.lines.iter().filter(|((kind, _), _)| kind.ends_with(CONTROL) != safe);
        lines.for_each(|(_, counts)| sum += *counts);
        sum
    }

    /// What must not be: contacts that were missed against the promise, pairs that do not touch,
    /// and frames that were refused.
    pub fn errors(&self) -> u64 {
        let (safe, control) = (self.total(true), self.total(false));
        safe.missed + safe.wrong + safe.refused + control.wrong + control.refused
    }

    /// As text.
    pub fn text(&self) -> String {
        let mut text = format!(
            "{:24} {:8} {:>11} {:>11} {:>13} {:>6}\n",
            "tracker", "numbers", "frames", "built", "pair-steps", "missed"
        );
        for ((kind, arithmetic), Counts { frames, built, pair_steps, missed, .. }) in &self.lines {
            text += &format!(
                "{kind:24} {arithmetic:8} {frames:>11} {built:>11} {pair_steps:>13} {missed:>6}\n"
            );
        }
        text
    }
}

/// After the name of a rule that may miss contacts, and must be seen to.
const CONTROL: &str = " (control)";

fn kind(spec: &TrackerSpec) -> String {
    match spec {
        TrackerSpec::Verlet { rule, .. } if spec.may_miss() => format!("{rule}{CONTROL}"),
        TrackerSpec::Verlet { skin: Skin::Auto, .. } => "skin=auto".to_owned(),
        TrackerSpec::Verlet { rule, .. } => rule.to_string(),
        TrackerSpec::EveryStep(_) => "every-step".to_owned(),
    }
}

/// A frame as an arithmetic stores it, and the pairs that touch in it.
pub struct Frame {
    pub scene: AnyScene<'static>,
    pub truth: Vec<[u32; 2]>,
}

impl Frame {
    /// None if the arithmetic cannot store it.
    fn new(scene: &AnyScene<'_>, arithmetic: Arithmetic) -> Option<Frame> {
        let scene = scene.stored(arithmetic).ok()?;
        let truth = oracle::truth_as_stored(&scene, arithmetic.test(), LIMIT).ok()?.pairs;
        Some(Frame { scene, truth })
    }
}

/// Bytes for lists.
const LIMIT: u64 = 1 << 28;

/// A tracker through all frames.
pub fn follow(spec: &TrackerSpec, frames: &[Frame], arithmetic: Arithmetic) -> Counts {
    let mut tracker = spec.make(Options { memory_limit: LIMIT, threads: 1 });
    let (mut counts, mut pairs) = (Counts::default(), Vec::new());
    for Frame { scene, truth } in frames {
        counts.frames += 1;
        counts.pair_steps += truth.len() as u64;
        pairs.clear();
        match tracker.step(scene, arithmetic.test(), None, &mut pairs) {
            Ok(step) => counts.built += u64::from(step.built),
            Err(_) => {
                counts.refused += 1;
                continue;
            }
        }
        normalise(&mut pairs);
        let errors = oracle::compare(&pairs, truth, scene);
        counts.missed += errors.missed;
        counts.wrong += errors.spurious + errors.duplicate + errors.self_pairs;
    }
    counts
}

/// Detectors that must be right; a twin is the same code again.
fn detectors() -> Vec<DetectorSpec> {
    let right = TABLE.iter().filter(|it| it.must_be_right() && !matches!(it.role, Role::Twin(_)));
    right.map(|entry| table::parse(entry.name).expect("names of the table are read")).collect()
}

/// Scenes in motion, all trackers in every frame.
pub fn courses(plan: Plan) -> Table {
    let detectors = detectors();
    in_batches(plan, |index| courses::run(index, plan.seed, &detectors))
}

/// Couples at the limit of the skin.
pub fn couples(plan: Plan) -> Table {
    let (plane, space) = (Sphere::<2>::made(), Sphere::<3>::made());
    let detectors = detectors();
    in_batches(plan, |index| {
        let mut draw = Draw::new(plan.seed, 1 << 62 | index);
        let mut table = Table::default();
        for turn in 0..COUPLES {
            let by = &detectors[(COUPLES * index + turn) as usize % detectors.len()];
            match draw.once_in(2) {
                true => couple(&Couple::new(&plane, &mut draw), by, &mut draw, &mut table),
                false => couple(&Couple::new(&space, &mut draw), by, &mut draw, &mut table),
            }
        }
        table
    })
}

/// In a piece of work.
const COUPLES: u64 = 200;

fn couple<const D: usize>(
    couple: &Couple<D>,
    detector: &DetectorSpec,
    draw: &mut Draw,
    table: &mut Table,
) where
    AnyScene<'static>: From<Scene<'static, f64, D>>,
{
    *table.came.entry(couple.name).or_default() += couple.came() as u64;
    let all = 0..couple.frame_count();
    let exact: Vec<Frame> =
        all.clone().map(|k| Frame { scene: couple.scene(k), truth: couple.touching(k) }).collect();
    let rounded = [Arithmetic::F32, Arithmetic::F32Cell, Arithmetic::F64][draw.below(3) as usize];
    let rounded_frames: Option<Vec<Frame>> =
        all.map(|k| Frame::new(&couple.scene(k), rounded)).collect();
    let mut give = |frames: &[Frame], arithmetic: Arithmetic| {
        for rule in RULES.into_iter().chain([NEARLY]) {
            let skin = Skin::Diameters(couple.skin);
            let spec = TrackerSpec::Verlet { detector: detector.clone(), skin, rule };
            table.add(&spec, arithmetic, follow(&spec, frames, arithmetic));
        }
    };
    give(&exact, Arithmetic::Exact);
    if let Some(frames) = rounded_frames {
        give(&frames, rounded);
    }
}

/// Runs pieces in parallel until there are enough pair-steps of trackers that miss nothing.
fn in_batches(plan: Plan, piece: impl Fn(u64) -> Table + Sync) -> Table {
    // Every motion in either dimension and each arithmetic.
    const BATCH: u64 = 8 * Kind::ALL.len() as u64;
    let mut sum = Table::default();
    let mut batch = 0;
    while sum.total(true).pair_steps < plan.pair_steps {
        let pieces = (batch * BATCH..(batch + 1) * BATCH).into_par_iter().map(&piece);
        sum = sum.and(pieces.reduce(Table::default, Table::and));
        batch += 1;
    }
    sum
}
