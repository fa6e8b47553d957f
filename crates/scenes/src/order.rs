use std::str::FromStr;

use rand::seq::SliceRandom;

use crate::generate::draw::shuffler;
use contactbench_ground::scene::{AnyScene, Real, array};
use contactbench_ground::with_scene;
use contactbench_terms::nearest::hint;

contactbench_terms::named! {
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
    pub enum Order {
        #[default]
        Shuffled = "shuffled",
        /// The order in which the generator makes the particles, or that of the file.
        Generated = "generated",
        Morton = "morton",
    }
}

impl FromStr for Order {
    type Err = String;

    fn from_str(text: &str) -> Result<Order, String> {
        let names = Order::ALL.map(Order::name);
        let found = Order::ALL.into_iter().find(|order| order.name() == text.to_lowercase());
        found.ok_or_else(|| {
            let hint = hint(text, names);
            format!("order is '{text}'; it must be shuffled, generated or morton{hint}")
        })
    }
}

/// Returns a random permutation of 0 to n - 1; it depends on `n` and the seed only.
pub fn shuffled(n: usize, seed: u64) -> Vec<u32> {
    let mut order: Vec<u32> = (0..n as u32).collect();
    order.shuffle(&mut shuffler(seed));
    order
}

/// Returns the particles in order along a Morton curve through the smallest cube around all
/// centres. It has 2^32 cells per axis in 2D, 2^21 in 3D. Particles in one cell keep their order.
pub fn morton(scene: &AnyScene<'_>) -> Vec<u32> {
    let mut keys: Vec<(u64, u32)> = with_scene!(scene, scene => {
        let points = || scene.centres().iter().map(|centre| array(centre).map(Real::wide));
        codes(points()).zip(0..).collect()
    });
    keys.sort_unstable();
    keys.into_iter().map(|(_, k)| k).collect()
}

fn codes<const D: usize>(
    points: impl Iterator<Item = [f64; D]> + Clone,
) -> impl Iterator<Item = u64> {
    // Coordinates are halved, so that differences of the largest doubles do not overflow.
    let points = points.map(|point| point.map(|x| 0.5 * x));
    let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
    for point in points.clone() {
        for k in 0..D {
            low[k] = low[k].min(point[k]);
            high[k] = high[k].max(point[k]);
        }
    }
    let edge = (0..D).map(|k| high[k] - low[k]).fold(0.0, f64::max);
    let bits = if D == 2 { 32 } else { 21 };
    let cells = (1u64 << bits) as f64;
    points.map(move |point| {
        let mut code = 0;
        for (k, x) in point.into_iter().enumerate() {
            // The cast saturates, and turns the NaN of 0/0 into 0.
            let cell = (((x - low[k]) / edge * cells) as u64).min((1 << bits) - 1);
            code |= (0..bits).map(|bit| (cell >> bit & 1) << (bit * D + k)).sum::<u64>();
        }
        code
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn morton_order_survives_huge_and_equal_coordinates() {
        let huge = vec![[-1.7e308, 1.7e308], [1.7e308, -1.7e308], [-1.7e308; 2]];
        for (points, order) in
            [(huge, vec![2, 1, 0]), (vec![[5.0, 5.0]; 3], vec![0, 1, 2]), (vec![], vec![])]
        {
            assert_eq!(morton(&AnyScene::at(points, 1.0).unwrap()), order);
        }
    }
}
