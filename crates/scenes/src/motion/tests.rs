use super::box_tests::{BOXES, goes};
use super::*;
use crate::spec::Spec;
use contactbench_ground::scene::{Real, array};
use contactbench_ground::with_scene;
use contactbench_terms::mix::splitmix64;

pub(super) fn scene(text: &str) -> Given {
    Spec::parse(text).unwrap().given().unwrap()
}

pub(super) fn coordinates(given: &Given) -> Vec<f64> {
    with_scene!(&given.scene, scene => {
        scene.centres().iter().flat_map(|at| array(at).map(|x| x.wide())).collect()
    })
}

pub(super) fn motion(kind: MotionKind, speed: f64) -> Motion {
    Motion { kind, speed, seed: 1 }
}

/// Returns the lowest and the highest coordinate along an axis.
pub(super) fn edges(all: &[f64], axis: usize, dim: usize) -> [f64; 2] {
    let along = || all.iter().skip(axis).step_by(dim).copied();
    [along().min_by(f64::total_cmp), along().max_by(f64::total_cmp)].map(Option::unwrap)
}

/// Returns the longest displacement of a particle between two frames; the diameter is 1.
fn longest(a: &Given, b: &Given, dim: usize) -> f64 {
    let (a, b) = (coordinates(a), coordinates(b));
    let displacements = a
        .chunks(dim)
        .zip(b.chunks(dim))
        .map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt());
    displacements.fold(0.0, f64::max)
}

/// Returns scenes in open space and in boxes, each with a motion that it supports.
fn moving() -> impl Iterator<Item = (Given, MotionKind)> {
    let open = ["loose:dim=2,n=150", "packed:dim=3,n=120"];
    let open = open.into_iter().flat_map(|text| MotionKind::ALL.map(|kind| (scene(text), kind)));
    let boxed = BOXES.into_iter().flat_map(|text| goes().map(|kind| (scene(text), kind)));
    open.chain(boxed)
}

#[test]
fn frame_k_does_not_depend_on_the_frames_asked_for_before() {
    for (scene, kind) in moving() {
        let of = |k: u64| Frames::new(&scene, motion(kind, 0.05)).unwrap().at(k).unwrap();
        let mut frames = Frames::new(&scene, motion(kind, 0.05)).unwrap();
        for k in [0, 1, 2, 250, 7, 0, 251] {
            assert_eq!(frames.at(k).unwrap(), of(k), "{kind:?} {k}");
        }
        assert_eq!((of(0).scene, of(0).lattice), (scene.scene.clone(), scene.lattice), "{kind:?}");
    }
}

/// No bit of the positions may change, because records identify scenes and motions by name.
#[test]
fn frames_have_the_same_bits_on_every_machine() {
    let digest = |given: &Given| {
        let vectors = given.lattice.map(|lattice| *lattice.vectors());
        let all = coordinates(given).into_iter().chain(vectors.into_iter().flatten().flatten());
        all.fold(0, |sum, x| splitmix64(sum ^ x.to_bits()))
    };
    let at = |text: &str, kind: MotionKind, k: u64| {
        digest(&Frames::new(&scene(text), motion(kind, 0.1)).unwrap().at(k).unwrap())
    };
    let lines = include_str!("hashes.txt").lines().skip(1);
    for line in lines.map(|line| line.split(' ').collect::<Vec<_>>()) {
        let Motion { kind, .. } = line[1].parse().unwrap();
        let found = at(line[0], kind, line[2].parse().unwrap());
        assert_eq!(format!("{found:#018x}"), line[3], "{line:?}");
    }
}

#[test]
fn the_fastest_particle_has_about_the_given_speed() {
    for (text, dim) in [("loose:dim=2,n=2000", 2), ("loose:dim=3,n=2000,diameter=1", 3)] {
        let scene = scene(text);
        for kind in MotionKind::ALL {
            let mut frames = Frames::new(&scene, motion(kind, 0.02)).unwrap();
            let mut most = 0.0f64;
            for k in [0, 1, 57, 600] {
                most = most.max(longest(&frames.at(k).unwrap(), &frames.at(k + 1).unwrap(), dim));
            }
            match kind {
                MotionKind::Rest => assert_eq!(most, 0.0),
                // This is the largest of thousands of displacements, normal along each axis.
                MotionKind::Jitter => assert!((0.06..0.2).contains(&most), "{most}"),
                _ => assert!((0.0185..0.02001).contains(&most), "{kind:?} {most}"),
            }
        }
    }
}

#[test]
fn walls_contain_all_particles_and_layers_keep_their_height() {
    let scene = scene("loose:dim=2,n=300");
    let first = coordinates(&scene);
    for kind in [MotionKind::Drift, MotionKind::Brownian] {
        let mut frames = Frames::new(&scene, motion(kind, 0.7)).unwrap();
        for k in [1, 10, 1000] {
            let frame = coordinates(&frames.at(k).unwrap());
            for axis in 0..2 {
                let ([low, high], [l, h]) = (edges(&first, axis, 2), edges(&frame, axis, 2));
                assert!(low <= l && h <= high, "{kind:?} {k}: {low} {l} {h} {high}");
                assert!(h - l > 0.9 * (high - low), "they spread over the box");
            }
        }
    }
    let sheared = Frames::new(&scene, motion(MotionKind::Shear, 0.7)).unwrap().at(50).unwrap();
    let sheared = coordinates(&sheared);
    let mut both = first.chunks(2).zip(sheared.chunks(2));
    assert!(both.clone().all(|(a, b)| a[1] == b[1]));
    assert!(both.any(|(a, b)| (a[0] - b[0]).abs() > 30.0));
}

#[test]
fn small_scenes_move_unless_they_lack_a_diameter_or_extent() {
    let none = Scene::<f64, 2>::at([], 1.0).unwrap().into();
    for scene in [scene("loose:dim=2,n=1"), scene("loose:dim=3,n=1"), none] {
        for kind in MotionKind::ALL {
            let frame = Frames::new(&scene, motion(kind, 0.5)).unwrap().at(9).unwrap();
            assert_eq!(frame.scene.len(), scene.scene.len(), "{kind:?}");
            assert!(coordinates(&frame).iter().all(|x| x.is_finite()), "{kind:?}");
        }
    }
    let of = |x: f64, r| -> Given { Scene::at([[-x, 0.0], [x, 0.0]], r).unwrap().into() };
    let points =
        Frames::new(&of(1.0, 0.0), motion(MotionKind::Drift, 0.1)).err().unwrap().to_string();
    assert!(points.contains("all radii of this scene are 0"), "{points}");
    assert!(Frames::new(&of(1.0, 0.0), motion(MotionKind::Rest, 0.1)).is_ok());
    let mut wide = Frames::new(&of(1.7e308, 1.0), motion(MotionKind::Drift, 0.1)).unwrap();
    assert!(wide.at(0).is_ok());
    assert!(wide.at(1).unwrap_err().to_string().starts_with("frame 1"));
}

#[test]
fn the_text_of_a_motion_parses_to_itself() {
    for text in ["rest", "drift:speed=0.001,seed=3", "brownian:speed=2,seed=1"] {
        assert_eq!(text.parse::<Motion>().unwrap().to_string(), text);
    }
    let named = |kind: MotionKind| kind.name().parse::<Motion>().is_ok_and(|it| it.kind == kind);
    assert!(
        MotionKind::ALL.into_iter().all(named) && TABLE.lines().count() == MotionKind::ALL.len()
    );
    let gone: Motion = "drum".parse().unwrap();
    let refused = Frames::new(&scene("loose:n=9"), gone).err().unwrap().to_string();
    assert!(refused.starts_with("this program does not make the motion 'drum'"), "{refused}");
    assert_eq!("vortex".parse::<Motion>().unwrap().to_string(), "vortex:speed=0.01,seed=1");
}
