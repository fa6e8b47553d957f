use super::*;
use crate::generate::tests::{ascending_radii as radii, make};
use crate::stats::hash;

const SAND: &str = concat!(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."), "/examples/sand.csv");

/// The volume of particles below each sieve size is the percentage of the curve.
#[test]
fn particles_pass_the_sieves_as_the_curve_requires() {
    let text = std::fs::read_to_string(SAND).unwrap();
    let curve: Vec<[f64; 2]> = text.lines().filter_map(point).collect();
    assert_eq!(curve.len(), 6);
    for dim in [2, 3] {
        let radii = radii(&format!("loose:dim={dim},n=400000,sizes=grading,grading={SAND}"));
        assert_eq!((radii[0], radii[399_999]), (0.05, 1.0));
        let volume = |r: &f64| r.powi(dim);
        let all: f64 = radii.iter().map(volume).sum();
        for [size, percent] in &curve {
            let passing: f64 = radii.iter().take_while(|&&r| 2.0 * r <= *size).map(volume).sum();
            let found = 100.0 * passing / all;
            assert!((found - percent).abs() < 0.5, "{dim}D, {size} mm: {found}, not {percent}");
        }
    }
}

/// A straight curve has equal volumes in each octave, so the number density is r^(-d - 1).
#[test]
fn a_straight_line_is_a_power() {
    for (dim, exponent) in [(2, -3), (3, -4)] {
        let line = radii(&format!("loose:dim={dim},n=5000,sizes=grading,grading=1 0,40 100"));
        let power =
            radii(&format!("loose:dim={dim},n=5000,sizes=power,exponent={exponent},size-ratio=40"));
        for (a, b) in line.iter().zip(power) {
            assert!((a / b - 1.0).abs() < 1e-9, "{dim}D: {a} {b}");
        }
    }
}

#[test]
fn a_gap_in_the_curve_is_a_gap_in_the_sizes() {
    let found = radii("packed:n=3000,sizes=grading,grading=1 0,2 0,4 50,16 50,32 100,64 100");
    // Sizes are from 2 to 4 and from 16 to 32; 32 becomes r.
    let (fine, coarse) = (0.0625..=0.125, 0.5..=1.0);
    assert!(found.iter().all(|r| fine.contains(r) || coarse.contains(r)));
    assert_eq!((found[0], found[2999]), (0.0625, 1.0));
    assert!(found[2900] <= 0.125 && found[2990] >= 0.5);
    assert_eq!(radii("packed:n=1,sizes=grading,grading=1 0,2 100"), [1.0]);
    assert!(make("packed:n=0,sizes=grading,grading=1 0,2 100").is_empty());
    let wide = radii("loose:dim=3,n=1000,sizes=grading,grading=1e-50 0,1e50 100");
    assert!(wide.iter().all(|r| (1e-100..=1.0).contains(r)) && wide[999] == 1.0);
}

/// Radii have the same bits on every machine, from a file and from its points.
#[test]
fn the_bits_are_fixed() {
    let scene = make(&format!("loose:dim=3,n=1000,sizes=grading,grading={SAND}"));
    let points = "0.1 0,0.2 12,0.425 38,0.85 71,1.18 86,2 100";
    assert_eq!(scene, make(&format!("loose:dim=3,n=1000,sizes=grading,grading={points}")));
    assert_eq!(hash(&scene.into()), "0xb7e3b8fdc4884511");
}
