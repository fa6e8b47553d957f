use std::cmp::Ordering;

use nalgebra::Point;

use super::*;
use crate::probe::{Op, Tally};
use crate::refusal::Refusal;
use crate::scene::{Radii, Real, Scene, Stored};

struct Touch(Tally);
impl<const D: usize> WithBodies<f64, D> for &mut Touch {
    type Output = Result<bool, Refusal>;
    fn call<B: Bodies<f64, D>>(self, bodies: B) -> Self::Output {
        Ok(bodies.touch(0, 1, &mut self.0))
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
        let this = (with_bodies(&scene, test, &mut probe).unwrap(), probe.0.get(Op::ExactTest));
        assert_eq!(*answer.get_or_insert(this), this);
        let mut tally = Tally::default();
        let any = any_bodies(&scene, test).unwrap().touch(0, 1, &mut tally);
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
        assert!(!touch([[0.0, 0.0], [x, y.next_up()]], [d / 2.0, d / 2.0], Test::Exact).0);
        assert!(touch([[0.0, 0.0], [x, y.next_down()]], [d / 2.0, d / 2.0], Test::Exact).0);
    }
    assert!(touch([[0.0, 0.0, 0.0], [2.0, 3.0, 6.0]], [3.5, 3.5], Test::Exact).0);
    assert_eq!(touch([[0.0, 0.0], [3.0, 0.0]], [1.0, 1.0], Test::Exact), (false, 0));
    assert_eq!(touch([[0.0, 0.0], [1.0, 0.0]], [1.0, 1.0], Test::Exact), (true, 0));
}

#[test]
fn the_exact_test_holds_where_squares_overflow_or_underflow() {
    assert!(touch([[0.0, 0.0], [1e-200, 0.0]], [1e-200, 1e-200], Test::Exact).0);
    assert!(!touch([[0.0, 0.0], [3e-200, 0.0]], [1e-200, 1e-200], Test::Exact).0);
    assert!(touch([[-1e200, 0.0], [1e200, 0.0]], [1e200, 1e200], Test::Exact).0);
    assert!(!touch([[-1e200, 0.0], [1.1e200, 0.0]], [1e200, 1e200], Test::Exact).0);
    assert!(touch([[f64::MAX, 0.0], [-f64::MAX, 0.0]], [f64::MAX, f64::MAX], Test::Exact).0);
}

struct Reach;
impl<T: Real, const D: usize> WithBodies<T, D> for Reach {
    type Output = Result<(bool, f64), Refusal>;
    fn call<B: Bodies<T, D>>(self, bodies: B) -> Self::Output {
        Ok((bodies.touch(0, 1, &mut crate::probe::Silent), bodies.reach()))
    }
}

/// Rounded arithmetic accepts couples that are apart; the reach covers them. The couples are
/// those one step from not being accepted.
#[test]
fn the_reach_covers_what_rounding_accepts() {
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
        // Bisection on the bits of x: couples at (0, 0) and (x, x).
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

#[test]
fn rounded_arithmetic_refuses_what_it_cannot_square() {
    let scene = Scene::<f64, 2>::new(vec![Point::from([0.0, 0.0])], Radii::Uniform(1e200)).unwrap();
    let refusal = with_bodies(&scene, Test::Rounded, &mut Touch(Tally::default()));
    assert!(matches!(refusal, Err(Refusal::Overflow { .. })));
}
