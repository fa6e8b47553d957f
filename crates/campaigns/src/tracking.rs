//! Tests moving scenes of every kind in every arithmetic; each frame is compared with its truth.

use contactbench_detectors::oracle;
use contactbench_detectors::table;
use contactbench_detectors::table::{DetectorSpec, Entry, Role, TABLE};
use contactbench_detectors::tracker::TrackerSpec;
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::detect::Options;
use contactbench_ground::pairs::normalise::normalise;
use contactbench_ground::scene::AnyScene;
use contactbench_lists::track::{Rule, Skin};
use contactbench_scenes::motion::{Frames, Motion, MotionKind};
use contactbench_scenes::spec::Spec;

use crate::draw::Draw;
use crate::{CONTROL, Counts, Plan, Totals, What, in_batches};

pub const RULES: [Rule; 3] = [Rule::TopTwo, Rule::HalfSkin, Rule::Summed];
const LIMIT: u64 = 1 << 28;

/// Packed, loose and clustered scenes, with one size and with many, and far from the origin.
const SCENES: [&str; 6] = [
    "packed:",
    "packed:size-ratio=4,",
    "packed:offset=1000,",
    "loose:fraction=0.4,",
    "loose:fraction=0.3,size-ratio=10,",
    "clustered:per-cluster=20,size-ratio=2,",
];

const SKINS: [Skin; 7] = [
    Skin::Auto,
    Skin::Diameters(0.0),
    Skin::Diameters(0.003),
    Skin::Diameters(0.03),
    Skin::Diameters(0.1),
    Skin::Diameters(0.3),
    Skin::Diameters(1.0),
];

/// Runs all trackers on moving scenes. Motions, dimensions and arithmetics are used in turn;
/// everything else is random.
pub fn trackers(plan: Plan) -> Totals {
    let detectors = detectors();
    // A batch has every motion in both dimensions and each arithmetic.
    in_batches(plan, 2 * Arithmetic::SAFE.len() * MotionKind::ALL.len(), |piece| {
        let mut draw = Draw::new(plan.seed, piece as u64);
        let mut turns = piece;
        let mut turn = |n: usize| {
            let now = turns % n;
            turns /= n;
            now
        };
        let kind = MotionKind::ALL[turn(MotionKind::ALL.len())];
        let dim = 2 + turn(2);
        let arithmetic = Arithmetic::SAFE[turn(Arithmetic::SAFE.len())];
        let frames = frames(kind, dim, arithmetic, &mut draw);
        let verlet = |detector: &DetectorSpec, skin, rule| TrackerSpec::Verlet {
            detector: detector.clone(),
            skin,
            rule,
        };
        let mut specs = Vec::new();
        for detector in &detectors {
            specs.push(TrackerSpec::EveryStep(detector.clone()));
            specs.extend(RULES.map(|rule| verlet(detector, draw.one_of(&SKINS), rule)));
        }
        specs.push(verlet(&detectors[0], Skin::Diameters(0.03), Rule::Every(10)));
        let mut table = Totals::default();
        specs.iter().for_each(|spec| add(&mut table, spec, &frames, arithmetic));
        table
    })
}

/// Returns the detectors whose answers must be right, without twins.
pub(crate) fn right() -> impl Iterator<Item = &'static Entry> {
    TABLE.iter().filter(|it| it.must_be_right() && !matches!(it.role, Role::Twin(_)))
}

pub(crate) fn detectors() -> Vec<DetectorSpec> {
    let names = right().map(|entry| entry.name).chain(["binary-tree:tree=kept"]);
    names.map(|name| table::parse(name).expect("names of the table are read")).collect()
}

/// Returns frames in order or, occasionally, shuffled. Shuffled frames make lists useless, but no
/// contact may be missed.
fn frames(
    kind: MotionKind,
    dim: usize,
    arithmetic: Arithmetic,
    draw: &mut Draw,
) -> Vec<StoredFrame> {
    let scene = draw.one_of(&SCENES);
    let text = format!("{scene}dim={dim},n={},seed={}", 2 + draw.below(200), draw.below(1 << 20));
    let speed = 10f64.powf(-4.0 * draw.unit());
    let motion = Motion { kind, speed, seed: draw.bits() };
    let count = 5 + draw.below(26) as usize;
    let scene = Spec::parse(&text).and_then(|spec| spec.make());
    let scene = scene.expect("scenes of these generators can be made");
    let mut moving = Frames::new(&scene.into(), motion).expect("these scenes can move");
    let mut order: Vec<usize> = (0..count).collect();
    if draw.once_in(4) {
        order = draw.order(count);
    }
    let frame = |k: usize| {
        let given = moving.at(k as u64).expect("nothing flies far in so few frames");
        StoredFrame::new(&given.scene, arithmetic).expect("coordinates fit every arithmetic")
    };
    order.into_iter().map(frame).collect()
}

/// A frame as stored for an arithmetic, and its touching pairs.
pub(crate) struct StoredFrame {
    pub scene: AnyScene<'static>,
    pub truth: Vec<[u32; 2]>,
}

impl StoredFrame {
    /// Stores a frame; returns `None` if the arithmetic cannot store it.
    pub fn new(scene: &AnyScene<'_>, arithmetic: Arithmetic) -> Option<StoredFrame> {
        let scene = scene.stored(arithmetic).ok()?;
        let truth = oracle::truth_as_stored(&scene, arithmetic.test(), LIMIT).ok()?.pairs;
        Some(StoredFrame { scene, truth })
    }
}

/// Runs a tracker over all frames and counts the results.
pub(crate) fn add(
    table: &mut Totals,
    spec: &TrackerSpec,
    frames: &[StoredFrame],
    arithmetic: Arithmetic,
) {
    let mut tracker = spec.make(Options { memory_limit: LIMIT, threads: 1 });
    let (mut counts, mut pairs) = (Counts::default(), Vec::new());
    for StoredFrame { scene, truth } in frames {
        counts.add(What::Frames, 1);
        counts.add(What::Pairs, truth.len() as u64);
        pairs.clear();
        match tracker.step(scene, arithmetic.test(), None, &mut pairs) {
            Ok(step) => counts.add(What::Built, u64::from(step.built)),
            Err(_) => {
                counts.add(What::Refused, 1);
                continue;
            }
        }
        normalise(&mut pairs);
        let errors = oracle::compare(&pairs, truth, scene);
        counts.add(What::Missed, errors.missed);
        counts.add(What::Spurious, errors.spurious);
        counts.add(What::Duplicate, errors.duplicate);
        counts.add(What::Itself, errors.self_pairs);
    }
    let kind = match spec {
        TrackerSpec::Verlet { rule, .. } if spec.may_miss() => format!("{rule}{CONTROL}"),
        TrackerSpec::Verlet { skin: Skin::Auto, .. } => "skin=auto".to_owned(),
        TrackerSpec::Verlet { rule, .. } => rule.to_string(),
        other => other.parts().0.to_owned(),
    };
    table.add(&kind, arithmetic.name(), counts);
}
