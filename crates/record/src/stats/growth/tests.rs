use super::*;

const N: [f64; 7] = [100.0, 300.0, 1e3, 3e3, 1e4, 3e4, 1e5];

fn points(f: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    N.iter().map(|&n| (n, f(n))).collect()
}

fn wobble(n: f64) -> f64 {
    1.0 + 0.01 * (n.ln() * 7.3).sin()
}

#[test]
fn laws_are_recognised_exact_and_with_noise() {
    type Law = fn(f64) -> f64;
    let laws: [(Law, Model); 6] = [
        (|n| 4.0 * n, Model::Linear),
        (|n| 4.0 * n + 100.0, Model::Linear),
        (|n| 3.0 * n - 2.0 * n.sqrt(), Model::Linear),
        (|n| n * n.log2(), Model::Linearithmic),
        (|n| 2.0 * n * n.log2() - 2.0 * n, Model::Linearithmic),
        (|n| n * (n - 1.0) / 2.0, Model::Quadratic),
    ];
    for (f, expected) in laws {
        for noisy in [false, true] {
            let choice = choose(&points(|n| f(n) * if noisy { wobble(n) } else { 1.0 }));
            assert_eq!(choice.law, Ok(expected), "{choice:?}");
            assert!(
                choice.scores.iter().all(|s| s.1.is_finite() && s.1 >= 7.0 * (FLOOR * FLOOR).ln())
            );
        }
    }
}

#[test]
fn it_says_why_it_is_undecided() {
    let hundreds = |k: i32| (100.0 * f64::from(k), 100.0 * f64::from(k));
    let trend = " fits best but leaves a trend";
    for (points, doubt) in [
        (points(|n| n.powf(1.5)), "N log N fits best but leaves a trend: exponent 1.500, not "),
        (points(|n| n.powf(1.2)), trend),
        (points(|n| n.powf(0.8)), trend),
        (points(|n| n)[..4].to_vec(), "only 4 distinct N, at least 5 are needed"),
        ((1..=7).map(hundreds).collect(), "N spans only a factor of 7.0, at least 8 is needed"),
        (
            points(|n| n * if (2.0 * n.log10()).round() % 2.0 == 0.0 { 1.0 } else { 2.5 }),
            "N log N fit about equally well",
        ),
        (points(|n| n - 100.0), "a value is not positive"),
        (Vec::new(), "only 0 distinct N"),
    ] {
        let found = choose(&points).law.unwrap_err();
        assert!(found.contains(doubt), "{found}");
    }
    assert!(choose(&points(|n| n * n.log2().sqrt())).law.is_err());
}

#[test]
fn the_last_octaves_tell_a_small_factor_from_a_boundary() {
    let tail = |law, f: fn(f64) -> f64| Tail::new(&points(f), law).unwrap();
    for (law, f) in [
        (Model::Linear, (|n| 13.0 * n - 9.0 * n.powf(2.0 / 3.0)) as fn(f64) -> f64),
        (Model::Linear, |n| 4.0 * n + 100.0),
        (Model::Linearithmic, |n| n * n.log2() - 1.2 * n),
        (Model::Quadratic, |n| n * (n - 1.0) / 2.0),
    ] {
        let found = tail(law, f);
        assert!(!found.is_off() && found.sizes == [3e3, 1e5], "{found:?}");
    }
    for (law, f) in [
        (Model::Linear, (|n| n.powf(1.3)) as fn(f64) -> f64),
        (Model::Linear, |n| n.powf(0.95)),
        (Model::Linearithmic, |n| n.powf(1.05) * n.log2()),
        (Model::Quadratic, |n| n.powf(2.04)),
    ] {
        assert!(tail(law, f).is_off(), "{:?}", tail(law, f));
    }
    assert_eq!(Tail::new(&points(|n| n)[..2], Model::Linear), None);
}

#[test]
fn a_surface_term_is_not_called_n_log_n() {
    // In a block of a lattice, particles at the surface, of order N^(2/3), have fewer contacts.
    let choice = choose(&points(|n| 6.0 * n - 9.0 * n.powf(2.0 / 3.0)));
    assert_ne!(choice.law, Ok(Model::Linearithmic), "{choice:?}");
}

/// The points of the test in `line`, as exponentials.
#[test]
fn the_slope_has_the_textbook_interval() {
    let points = [(1.0, 1.2), (2.0, 1.9), (3.0, 3.2), (4.0, 3.7)];
    let found = slope(&points.map(|(x, y): (f64, f64)| (x.exp(), y.exp()))).unwrap();
    let error = (0.108_f64 / 2.0 / 5.0).sqrt();
    assert!((found.exponent - 0.88).abs() < 1e-9);
    assert!((found.high - 0.88 - 4.30265 * error).abs() < 1e-6, "{found:?}");
}

#[test]
fn student_is_near_the_printed_table() {
    // Degrees of freedom, 97.5% point, relative error.
    for (freedom, printed, error) in [
        (1, 12.7062, 1e-9),
        (2, 4.30265, 1e-9),
        (3, 3.18245, 1.3e-3),
        (4, 2.77645, 5e-4),
        (5, 2.57058, 2e-4),
        (13, 2.16037, 1e-5),
        (1000, 1.96234, 1e-5),
    ] {
        let found = student(freedom) / printed - 1.0;
        assert!(found.abs() <= error, "{freedom}: {found:e}");
    }
}
