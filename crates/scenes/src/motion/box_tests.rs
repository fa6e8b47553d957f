use super::tests::{coordinates, edges, motion, scene};
use super::*;
use contactbench_ground::scene::Lattice;

pub(super) const BOXES: [&str; 6] = [
    "loose:dim=2,n=60,fraction=0.4,periodic=true",
    "loose:dim=2,n=60,fraction=0.4,periodic=true,tilt=0.4,offset=7",
    "loose:dim=2,n=60,fraction=0.4,periodic=x",
    "loose:dim=3,n=60,fraction=0.3,periodic=true,tilt=-2.3",
    "loose:dim=3,n=60,fraction=0.3,periodic=xz",
    "loose:dim=3,n=60,fraction=0.3,periodic=y,tilt=0.3",
];

pub(super) fn goes() -> [MotionKind; 5] {
    [
        MotionKind::Rest,
        MotionKind::Drift,
        MotionKind::Shear,
        MotionKind::Jitter,
        MotionKind::Brownian,
    ]
}

fn lattice(given: &Given) -> Lattice {
    given.lattice.unwrap()
}

/// Returns the fractional coordinates along a vector of the box.
fn fractions(given: &Given, v: usize) -> Vec<f64> {
    let (dim, lattice) = (given.scene.dim(), lattice(given));
    let (dual, origin) = (lattice.dual(v), lattice.origin());
    let of = |at: &[f64]| (0..dim).map(|k| dual[k] * (at[k] - origin[k])).sum();
    coordinates(given).chunks(dim).map(of).collect()
}

#[test]
fn particles_stay_in_the_box_and_between_walls() {
    for text in BOXES {
        let scene = scene(text);
        let repeats = lattice(&scene).periodic();
        let dim = scene.scene.dim();
        for kind in goes().into_iter().filter(|&kind| kind != MotionKind::Rest) {
            let mut frames = Frames::new(&scene, motion(kind, 0.4)).unwrap();
            let mut spread = [false; 3];
            for k in [1, 10, 301] {
                let frame = frames.at(k).unwrap();
                assert_eq!(lattice(&frame).periodic(), repeats);
                for v in (0..dim).filter(|&v| repeats[v]) {
                    let fractions = fractions(&frame, v);
                    let inside = |x: &f64| (-1e-9..=1.0 + 1e-9).contains(x);
                    assert!(fractions.iter().all(inside), "{text} {kind:?} {k} {v}");
                    let most = fractions.iter().fold(0.0, |most: f64, x| most.max(*x));
                    spread[v] |= most > 0.9;
                }
                let walls = matches!(kind, MotionKind::Drift | MotionKind::Brownian);
                // Without a tilt, the periodic vectors lie along axes.
                for axis in
                    (0..dim).filter(|&axis| walls && !repeats[axis] && !text.contains("tilt"))
                {
                    let edges = |given: &Given| edges(&coordinates(given), axis, dim);
                    let ([low, high], [least, most]) = (edges(&scene), edges(&frame));
                    let inside = low - 1e-9 <= least && most <= high + 1e-9;
                    assert!(inside, "{text} {kind:?} {k} {axis}");
                    assert!(most > low + 0.8 * (high - low), "{text} {kind:?}");
                }
            }
            assert!((0..dim).all(|v| spread[v] == repeats[v]), "{text} {kind:?} {spread:?}");
        }
    }
}

/// Relative to the middle, the faces along y move with the given speed. A tilt beyond one half is
/// flipped back.
#[test]
fn a_shear_deforms_the_box() {
    let still = scene("loose:dim=3,n=60,fraction=0.3,periodic=true,tilt=0.4,offset=7");
    let [[x, ..], [xy, y, _], z] = *lattice(&still).vectors();
    let corner = lattice(&still).origin()[1];
    assert!(corner != 0.0);
    let mut frames = Frames::new(&still, motion(MotionKind::Shear, 0.05)).unwrap();
    let (mut flips, mut before) = (0, xy);
    for k in 1..200u32 {
        let frame = frames.at(k.into()).unwrap();
        let [first, second, third] = *lattice(&frame).vectors();
        assert_eq!((first, second[1], third), ([x, 0.0, 0.0], y, z));
        // The lower face stays; particles at the upper face move by 2 · 0.05 diameters per frame.
        let tilt = xy + 0.1 * f64::from(k);
        let whole = (second[0] - tilt) / x;
        assert!((whole - whole.round()).abs() < 1e-9, "{k}: {second:?}");
        assert!(second[0].abs() <= 0.5 * x * (1.0 + 1e-12), "{k}: {second:?}");
        flips += usize::from(second[0] < before);
        before = second[0];
        // Each particle is at an image of the position to which the flow moves it.
        let flow = 0.05 * f64::from(k);
        for (from, to) in coordinates(&still).chunks(3).zip(coordinates(&frame).chunks(3)) {
            assert_eq!(from[1..], to[1..]);
            let there = from[0] + flow * (from[1] - corner) / (0.5 * y);
            let whole = (to[0] - there) / x;
            assert!((whole - whole.round()).abs() < 1e-9, "{k}: {from:?} {to:?}");
        }
    }
    assert!(flips >= 2, "{flips}");
    // If the box is open along y, layers slide and the box does not change.
    let layers = scene("loose:dim=2,n=60,fraction=0.4,periodic=x");
    let slid = Frames::new(&layers, motion(MotionKind::Shear, 0.3)).unwrap().at(50).unwrap();
    assert_eq!(slid.lattice, layers.lattice);
    assert!(coordinates(&slid) != coordinates(&layers));
}

#[test]
fn unsupported_motions_in_boxes_are_refused() {
    for kind in MotionKind::ALL {
        let made = Frames::new(&scene(BOXES[0]), motion(kind, 0.1));
        assert_eq!(made.is_ok(), goes().contains(&kind), "{kind:?}");
        if let Err(error) = made {
            let said = error.to_string();
            let words = format!("{} needs open boundaries", kind.name());
            assert!(said.starts_with(&words) && said.contains("jitter"), "{said}");
        }
    }
    let turned = [[0.0, 9.0, 0.0], [-9.0, 0.0, 0.0], [0.0; 3]];
    let turned = Lattice::new(turned, [true, true, false], [0.0; 3]).unwrap();
    let turned = Given::in_box(scene("loose:n=9").scene, turned).unwrap();
    let said = Frames::new(&turned, motion(MotionKind::Shear, 0.1)).err().unwrap().to_string();
    assert!(said.contains("the first vector has y = 9 and z = 0"), "{said}");
    let mut drift = Frames::new(&turned, motion(MotionKind::Drift, 0.1)).unwrap();
    assert!(fractions(&drift.at(99).unwrap(), 0).iter().all(|x| (-1e-9..1.0 + 1e-9).contains(x)));
    // A file of discs may have a box that is periodic along z.
    let vectors = [[9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [2.5, 3.5, 9.0]];
    let along = |axes| Lattice::new(vectors, axes, [0.0; 3]).unwrap();
    let discs = scene("loose:n=9,periodic=true");
    for kind in goes() {
        let frame = |axes| {
            let discs = Given { lattice: Some(along(axes)), ..discs.clone() };
            Frames::new(&discs, motion(kind, 0.1)).unwrap().at(7).unwrap()
        };
        assert_eq!(frame([true; 3]), frame([true, true, false]), "{kind:?}");
    }
    // Tests scenes without particles, and motions beyond the range of f64.
    for kind in goes() {
        let none = scene("loose:n=0,periodic=true");
        assert_eq!(Frames::new(&none, motion(kind, 0.1)).unwrap().at(3).unwrap().scene.len(), 0);
    }
    let mut far =
        Frames::new(&scene("loose:n=9,periodic=true"), motion(MotionKind::Shear, 1e6)).unwrap();
    assert!(far.at(u64::MAX).is_ok_and(|frame| coordinates(&frame).iter().all(|x| x.is_finite())));
    let huge = Lattice::along_axes([1e150, 1.0, 1.0], [true, true, false]).unwrap();
    let huge = Given::in_box(scene("loose:n=9,diameter=1e300").scene, huge).unwrap();
    let said = Frames::new(&huge, motion(MotionKind::Drift, 1e6)).unwrap().at(1 << 60);
    assert!(format!("{:#}", said.unwrap_err()).starts_with("frame 1152921504606846976; take"));
}
