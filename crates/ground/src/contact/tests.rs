use std::cmp::Ordering;

use nalgebra::Point;

use super::*;
use crate::limits::refusal::Refusal;
use crate::probe::{Op, Tally};
use crate::scene::{AnyScene, Radii, Real, Scene, Stored};

struct Touch(Tally);
impl<const D: usize> WithParticles<f64, D> for &mut Touch {
    type Output = Result<bool, Refusal>;
    fn call<B: Particles<f64, D>>(self, particles: B) -> Self::Output {
        Ok(particles.touch(0, 1, &mut self.0))
    }
}

fn touch<const D: usize>(centres: [[f64; D]; 2], radii: [f64; 2], test: Test) -> (bool, u64) {
    let centres: Vec<_> = centres.into_iter().map(Point::from).collect();
    let mut answer = None;
    for uniform in [true, false] {
        if uniform && radii[0] != radii[1] {
            continue;
        }
        let radii =
            if uniform { Radii::Uniform(radii[0]) } else { Radii::Each(radii.to_vec().into()) };
        let scene = Scene::new(centres.clone(), radii).unwrap();
        let mut probe = Touch(Tally::default());
        let this = (with_particles(&scene, test, &mut probe).unwrap(), probe.0.get(Op::ExactTest));
        assert_eq!(*answer.get_or_insert(this), this);
        let mut tally = Tally::default();
        let any = any_particles(&scene, test).unwrap().touch(0, 1, &mut tally);
        assert_eq!((any, tally.get(Op::ExactTest)), this);
    }
    answer.unwrap()
}

#[test]
fn tangency_is_contact_and_one_ulp_apart_is_not() {
    for (x, y) in [(3.0, 4.0), (5.0, 12.0), (0.0, 7.0)] {
        let d = f64::hypot(x, y);
        assert_eq!(touch([[0.0, 0.0], [x, y]], [d / 2.0, d / 2.0], Test::Exact), (true, 1));
        assert!(touch([[0.0, 0.0], [x, y]], [d / 4.0, d * 0.75], Test::Exact).0);
        assert_eq!(touch([[0.0, 0.0], [x, y]], [d / 2.0, d / 2.0], Test::Open), (false, 1));
        assert!(touch([[0.0, 0.0], [x, y.next_down()]], [d / 2.0, d / 2.0], Test::Open).0);
        assert!(!touch([[0.0, 0.0], [x, y.next_up()]], [d / 2.0, d / 2.0], Test::Exact).0);
        assert!(touch([[0.0, 0.0], [x, y.next_down()]], [d / 2.0, d / 2.0], Test::Exact).0);
    }
    assert!(touch([[0.0, 0.0, 0.0], [2.0, 3.0, 6.0]], [3.5, 3.5], Test::Exact).0);
    assert_eq!(touch([[0.0, 0.0], [3.0, 0.0]], [1.0, 1.0], Test::Exact), (false, 0));
    assert_eq!(touch([[0.0, 0.0], [1.0, 0.0]], [1.0, 1.0], Test::Exact), (true, 0));
}

struct Reach;
impl<T: Real, const D: usize> WithParticles<T, D> for Reach {
    type Output = Result<(bool, f64), Refusal>;
    fn call<B: Particles<T, D>>(self, particles: B) -> Self::Output {
        Ok((particles.touch(0, 1, &mut crate::probe::Silent), particles.reach()))
    }
}

/// Finds, for each radius, the farthest pair that only rounding accepts; the reach must cover it.
#[test]
fn the_reach_covers_pairs_that_rounding_accepts() {
    let mut beyond = 0;
    let radii = (1..2000).map(|k| k as f32 * 0.00137).chain([
        1e-18,
        3e-20,
        1e-22,
        1e-30,
        0.0,
        f32::from_bits(1),
    ]);
    for r in radii {
        let accepted = |x: f32| {
            let scene =
                Scene::new(vec![Point::from([0.0, 0.0]), Point::from([x, x])], Radii::Uniform(r))
                    .unwrap();
            with_stored(&Stored::F32(scene), Test::Rounded, Reach).unwrap()
        };
        // The search bisects the bits of x, for particles at (0, 0) and (x, x).
        let (mut low, mut high) = (0.0f32.to_bits(), (4.0 * r + 1e-3).to_bits());
        while high - low > 1 {
            let middle = low + (high - low) / 2;
            if accepted(f32::from_bits(middle)).0 { low = middle } else { high = middle }
        }
        let x = f64::from(f32::from_bits(low));
        let reach = accepted(x as f32).1;
        let apart =
            |d: f64| exact::compare(&[0.0, 0.0], &[x, x], d / 2.0, d / 2.0) == Ordering::Greater;
        beyond += i32::from(apart(2.0 * f64::from(r)));
        assert!(!apart(reach), "r = {r:e}: accepted at ({x:e}, {x:e}), reach {reach:e}");
    }
    assert!(beyond > 100, "this test must hold couples that only rounding accepts");
}

struct ClassReach;
impl<T: Real, const D: usize> WithParticles<T, D> for ClassReach {
    type Output = Result<(bool, f64), Refusal>;
    fn call<B: Particles<T, D>>(self, particles: B) -> Self::Output {
        let reach = particles.class_reach(particles.radius(0), particles.radius(1));
        Ok((particles.touch(0, 1, &mut crate::probe::Silent), reach))
    }
}

/// Places two particles of different radii at the largest distance that the test accepts. The reach
/// of their classes covers it in every arithmetic, and is far below that of the larger class with
/// itself.
#[test]
fn the_reach_of_two_classes_covers_accepted_pairs() {
    let mut beyond = 0;
    for k in 1..3000u32 {
        let (a, b) = (0.37 * f64::from(k), [1e-3, 0.1, 1.0 / 3.0, 1e-20][k as usize % 4]);
        for arithmetic in [Arithmetic::Exact, Arithmetic::F64, Arithmetic::F32] {
            let accepted = |x: f64| {
                let centres = vec![Point::from([0.0, 0.0]), Point::from([x, 0.0])];
                let scene = Scene::new(centres, Radii::Each(vec![a, b].into())).unwrap();
                let scene = AnyScene::from(scene).stored(arithmetic).unwrap();
                let AnyScene::Plane(scene) = scene else { panic!("made in the plane") };
                let (touch, reach) = with_stored(&scene, arithmetic.test(), ClassReach).unwrap();
                let place = match &scene {
                    Stored::F32(scene) => scene.centres()[1].x.wide(),
                    Stored::F64(scene) => scene.centres()[1].x,
                };
                (touch, reach, place)
            };
            let (mut low, mut high) = ((0.5 * a).to_bits(), (2.0 * (a + b)).to_bits());
            while high - low > 1 {
                let middle = low + (high - low) / 2;
                if accepted(f64::from_bits(middle)).0 { low = middle } else { high = middle }
            }
            let (touch, reach, x) = accepted(f64::from_bits(low));
            assert!(touch && x <= reach, "{a} {b} {arithmetic:?}: {x:e}, reach {reach:e}");
            assert!(reach < 1.5 * a || b > 0.4 * a, "{a} {b} {arithmetic:?}: {reach}");
            beyond += i32::from(x > a + b);
        }
    }
    assert!(beyond > 100, "this test must hold couples beyond the rounded sum: {beyond}");
}

#[test]
fn rounded_arithmetic_refuses_overflowing_squares() {
    let scene = Scene::<f64, 2>::new(vec![Point::from([0.0, 0.0])], Radii::Uniform(1e200)).unwrap();
    let refusal = with_particles(&scene, Test::Rounded, &mut Touch(Tally::default()));
    assert!(matches!(refusal, Err(Refusal::Overflow { .. })));
}
