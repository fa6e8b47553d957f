//! Guesses the periods of a box that no file declares, from listed pairs that are far apart.

use crate::check::verify::compare::FAR;
use contactbench_ground::periodic::{ContactList, ImagePair, Periodic, depth};
use contactbench_scenes::touching::particle;

const ENOUGH: usize = 3;

/// The period along each axis; `None` along axes that no pair crosses.
pub(super) type Periods = [Option<f64>; 3];

/// Returns the periods of a box in which all listed pairs that are far apart touch, and these
/// pairs. `None` if there are fewer than [`ENOUGH`] such pairs, or no box fits them all.
pub(super) fn periods(
    space: &Periodic<'_>,
    listed: &ContactList,
    truth: &ContactList,
) -> Option<(Periods, Vec<[u32; 2]>)> {
    let scene = space.scene();
    let mut far = listed.plain.clone();
    far.dedup();
    let apart = |&[i, j]: &[u32; 2]| depth(space, ImagePair::new(i, j, [0; 3])) < -FAR;
    far.retain(|pair| truth.plain.binary_search(pair).is_err() && apart(pair));
    if far.len() < ENOUGH {
        return None;
    }
    let dim = scene.dim();
    let centres = || (0..scene.len() as u32).map(|k| particle(scene, k).0);
    let mut lengths: Vec<[f64; 2]> = (0..dim)
        .map(|k| {
            let (low, high) = centres()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                    (low.min(x[k]), high.max(x[k]))
                });
            [high - low, f64::INFINITY]
        })
        .collect();
    let mut across = vec![false; dim];
    for &[i, j] in &far {
        let ((a, ra), (b, rb)) = (particle(scene, i), particle(scene, j));
        let reach = (ra + rb) * (1.0 + 1e-9);
        let apart: Vec<f64> = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).collect();
        let beside: f64 = apart.iter().filter(|&&x| x <= reach).map(|x| x * x).sum();
        let square = reach * reach - beside;
        if square < 0.0 || apart.iter().all(|&x| x <= reach) {
            return None;
        }
        for k in (0..dim).filter(|&k| apart[k] > reach) {
            let [low, high] = &mut lengths[k];
            *low = low.max(apart[k] - square.sqrt());
            *high = high.min(apart[k] + square.sqrt());
            if low > high {
                return None;
            }
            across[k] = true;
        }
    }
    // A large period is preferred, because more pairs would touch in a shorter box.
    let length = |k: usize| {
        let [low, high] = *lengths.get(k)?;
        across[k].then(|| short(low, high))
    };
    Some(([0, 1, 2].map(length), far))
}

/// Returns the number in the range with the fewest digits, and the largest one of several.
fn short(low: f64, high: f64) -> f64 {
    let power = high.abs().log10().floor() as i32;
    let rounded = |digits: i32| {
        let step = 10f64.powi(power - digits);
        format!("{:.*e}", digits as usize, (high / step).floor() * step).parse().unwrap_or(high)
    };
    (0..16).map(rounded).find(|&x| low <= x && x <= high).unwrap_or(high)
}
