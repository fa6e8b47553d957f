use super::*;
use contactbench_detectors::oracle::random;
use contactbench_detectors::tracker;
use contactbench_ground::scene::{AnyScene, Lattice};
use contactbench_scenes::motion::{Frames, Motion, MotionKind};
use contactbench_scenes::spec::Spec;

const LIMIT: u64 = 1 << 26;

fn given<const D: usize>(centres: Vec<[f64; D]>, radius: f64, lattice: Lattice) -> Given {
    Given::in_box(AnyScene::at(centres, radius).unwrap(), lattice).unwrap()
}

fn square(edge: f64) -> Lattice {
    Lattice::along_axes([edge, edge, 1.0], [true, true, false]).unwrap()
}

fn followed(frames: &[Given], trackers: &[&str]) -> Followed {
    checked(frames, trackers, Check::All)
}

fn checked(frames: &[Given], trackers: &[&str], check: Check) -> Followed {
    let trackers: Vec<TrackerSpec> =
        trackers.iter().map(|text| tracker::parse(text).unwrap()).collect();
    let question = Question {
        trackers: &trackers,
        arithmetic: Arithmetic::Exact,
        frames: u64::MAX,
        memory_limit: LIMIT,
        check,
    };
    follow(|k| Ok(frames.get(k as usize).cloned()), &question).unwrap()
}

/// Returns the first `count` frames of a motion that starts at the scene of the spec `text`.
fn motion(text: &str, count: u64, motion: Motion) -> Vec<Given> {
    let scene = Spec::parse(text).unwrap().given().unwrap();
    let mut frames = Frames::new(&scene, motion).unwrap();
    (0..count).map(|k| frames.at(k).unwrap()).collect()
}

/// Tests detection in every frame, lists that must not miss contacts, and a list that may.
#[test]
fn trackers_are_held_to_the_truth_in_boxes_that_move_or_stay() {
    let trackers = [
        "every-step(nbs)",
        "verlet(nbs,skin=0.3)",
        "verlet(streamed-nbs,skin=auto)",
        "verlet(nbs,skin=0.02,rule=every-6)",
    ];
    let mut missed = 0;
    for text in [
        "loose:dim=2,n=70,fraction=0.5,periodic=true",
        "loose:dim=2,n=4,fraction=0.6,periodic=true,tilt=0.4",
        "loose:dim=2,n=70,fraction=0.5,periodic=x",
        "loose:dim=3,n=60,fraction=0.4,periodic=true,tilt=-0.3",
        "loose:dim=3,n=3,fraction=0.6,periodic=true,tilt=2.4",
        "loose:dim=3,n=60,fraction=0.4,periodic=yz,size-ratio=3",
    ] {
        for kind in [
            MotionKind::Rest,
            MotionKind::Drift,
            MotionKind::Shear,
            MotionKind::Jitter,
            MotionKind::Brownian,
        ] {
            let frames = motion(text, 19, Motion { kind, speed: 0.11, seed: 3 });
            let Followed { moved, trackers, .. } = followed(&frames, &trackers);
            assert_eq!(moved.frames, 19, "{text} {kind:?}");
            let changes = moved.born + moved.ended;
            assert!(
                moved.contacts > 19 && (changes > 0) == (kind != MotionKind::Rest),
                "{text} {kind:?}"
            );
            for it in &trackers {
                assert_eq!((&it.refused, it.spurious), (&None, 0), "{text} {kind:?} {}", it.spec);
                assert_eq!(it.reported + it.late.missed, moved.contacts, "{text} {}", it.spec);
                assert!(!it.is_safe || it.late.missed == 0, "{text} {kind:?} {}", it.spec);
            }
            missed += trackers[3].late.missed;
        }
    }
    assert!(missed > 500, "{missed}");
}

/// The errors of a sample are those of all particles that involve a sampled particle.
#[test]
fn a_sample_finds_what_its_particles_miss() {
    let trackers = ["every-step(nbs)", "verlet(nbs,skin=0.02,rule=every-6)"];
    for text in [
        "loose:dim=2,n=600,fraction=0.5",
        "loose:dim=3,n=500,fraction=0.4,size-ratio=3",
        "loose:dim=2,n=400,fraction=0.5,periodic=true,tilt=0.4",
        "loose:dim=3,n=500,fraction=0.4,periodic=yz",
    ] {
        let frames = motion(text, 19, Motion { kind: MotionKind::Drift, speed: 0.11, seed: 3 });
        let n = frames[0].scene.len();
        let all = followed(&frames, &trackers);
        let told = |it: &Followed| {
            let of = |it: &Tracked| (it.late.clone(), it.spurious, it.builds, it.reported);
            (it.moved.clone(), it.trackers.iter().map(of).collect::<Vec<_>>())
        };
        let whole = checked(&frames, &trackers, Check::Sample(n));
        assert_eq!((told(&whole), whole.check), (told(&all), Check::All), "{text}");
        let some = checked(&frames, &trackers, Check::Sample(100));
        assert_eq!(some.check, Check::Sample(100));
        let missed = |it: &Followed| [0, 1].map(|k| it.trackers[k].late.missed);
        let ([_, of_all], [by_safe, of_some]) = (missed(&all), missed(&some));
        assert!(by_safe == 0 && of_some > 0 && of_some < of_all, "{text} {of_some} {of_all}");
        assert!(some.moved.born > 0);
        let chosen = random(n, 100, SEED);
        let of_sample = |pair: &&ImagePair| chosen[pair.i as usize] || chosen[pair.j as usize];
        let of_frame = |frame: &Given| {
            let frame = frame.loaded(Arithmetic::Exact).unwrap();
            let truth = truth::truth(&frame, Arithmetic::Exact, LIMIT).unwrap().pairs;
            truth.iter().filter(of_sample).count() as u64
        };
        assert_eq!(some.moved.contacts, frames.iter().map(of_frame).sum::<u64>(), "{text}");
        let none = checked(&frames, &trackers, Check::None);
        assert_eq!((missed(&none), none.moved.contacts, none.check), ([0, 0], 0, Check::None));
        assert_eq!(none.moved.displacements, all.moved.displacements);
    }
}

#[test]
fn a_contact_that_goes_through_a_face_goes_on() {
    let flight = |k: u32| {
        let x = 0.5 + 0.75 * f64::from(k);
        let at = [[x, 2.0 * x], [x + 0.75, 2.0 * x + 0.5]];
        given(at.map(|at| at.map(|x| x.rem_euclid(8.0))).to_vec(), 0.5, square(8.0))
    };
    let frames: Vec<Given> = (0..60).map(flight).collect();
    let Followed { moved, trackers, .. } = followed(&frames, &["verlet(nbs,rule=every-59)"]);
    assert_eq!([moved.contacts, moved.born, moved.ended], [60, 0, 0]);
    assert!((moved.displacements.longest - 0.75 * 5f64.sqrt()).abs() < 1e-9, "{moved:?}");
    assert_eq!(trackers[0].late.missed, 0, "it was never out of the list");
    // A box is sheared and flipped back, while two particles rest relative to each other.
    let frames: Vec<Given> = (0..60)
        .map(|k| {
            let tilt = 0.3 * f64::from(k);
            let vectors =
                [[8.0, 0.0, 0.0], [tilt - 8.0 * (tilt / 8.0).round(), 8.0, 0.0], [0.0; 3]];
            let lattice = Lattice::new(vectors, [true, true, false], [0.0; 3]).unwrap();
            given(vec![[1.0, 7.75], [(1.25 + tilt).rem_euclid(8.0), 0.5]], 0.5, lattice)
        })
        .collect();
    // The second particle is placed so that its image above the box stays where it is.
    let still: Vec<Given> = frames
        .iter()
        .map(|frame| {
            let lattice = frame.lattice.unwrap();
            let second = 1.25 - lattice.vectors()[1][0];
            given(vec![[1.0, 7.75], [second.rem_euclid(8.0), 0.5]], 0.5, lattice)
        })
        .collect();
    let moved = followed(&still, &[]).moved;
    assert_eq!([moved.contacts, moved.born, moved.ended], [60, 0, 0]);
    assert!(moved.displacements.longest < 0.31, "{moved:?}");
    // In the first of the two motions, the box carries the touching image away, so the contact
    // ends; it begins anew when the next image arrives.
    let moved = followed(&frames, &[]).moved;
    assert!(moved.born > 1 && moved.ended > 1 && moved.displacements.longest < 0.31, "{moved:?}");
}
