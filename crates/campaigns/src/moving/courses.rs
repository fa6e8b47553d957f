//! Scenes in motion, of every kind and in every arithmetic, each frame held to its truth.

use contactbench_core::contact::Arithmetic;
use contactbench_core::detect::table::DetectorSpec;
use contactbench_core::track::{Rule, Skin, TrackerSpec};
use contactbench_scenes::motion::{Frames, Kind, Motion};
use contactbench_scenes::spec::Spec;

use super::{Frame, RULES, Table, follow};
use crate::draw::Draw;

/// Packed, loose and clustered, of one size and of many, and far from zero.
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

/// Course number `index`: kinds of motion, dimensions and arithmetics take turns, all else is
/// drawn.
pub fn run(index: u64, seed: u64, detectors: &[DetectorSpec]) -> Table {
    let mut draw = Draw::new(seed, index);
    let mut turns = index as usize;
    let mut turn = |n: usize| {
        let now = turns % n;
        turns /= n;
        now
    };
    let kind = Kind::ALL[turn(Kind::ALL.len())];
    let dim = 2 + turn(2);
    let arithmetic = Arithmetic::SAFE[turn(Arithmetic::SAFE.len())];
    let frames = frames(kind, dim, arithmetic, &mut draw);
    let verlet = |detector: &DetectorSpec, skin: Skin, rule: Rule| TrackerSpec::Verlet {
        detector: detector.clone(),
        skin,
        rule,
    };
    let mut trackers = Vec::new();
    for detector in detectors {
        trackers.push(TrackerSpec::EveryStep(detector.clone()));
        for rule in RULES {
            let skin = SKINS[draw.below(SKINS.len() as i64) as usize];
            trackers.push(verlet(detector, skin, rule));
        }
    }
    trackers.push(verlet(&detectors[0], Skin::Diameters(0.03), Rule::Every(10)));
    let mut table = Table::default();
    for spec in trackers {
        table.add(&spec, arithmetic, follow(&spec, &frames, arithmetic));
    }
    table
}

/// Frames in their order or, once in a while, in any: what is kept is then of no use, and nothing
/// may be missed all the same.
fn frames(kind: Kind, dim: usize, arithmetic: Arithmetic, draw: &mut Draw) -> Vec<Frame> {
    let scene = SCENES[draw.below(SCENES.len() as i64) as usize];
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
        Frame::new(&given.scene, arithmetic).expect("coordinates fit every arithmetic")
    };
    order.into_iter().map(frame).collect()
}
