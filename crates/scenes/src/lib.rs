//! The scenes that detectors get: generators, hard cases, motion, and statistics of scenes.

pub mod doubts;
pub mod generate;
pub mod hard;
pub mod motion;
pub mod neighbours;
pub mod order;
pub mod origin;
pub mod spec;
pub mod stats;
pub mod touching;

pub use contactbench_core::scene::*;
pub use contactbench_io::Given;

#[cfg(test)]
mod tests {
    use nalgebra::Point;

    use super::*;
    use contactbench_core::contact::Arithmetic;
    use contactbench_core::oracle;

    /// Offsets of the centres from their cells are exact in f32 wherever the scene lies, so
    /// `f32-cell` must find the exact contacts.
    #[test]
    fn coordinates_by_cells_do_not_depend_on_the_offset() {
        for (offset, edge) in [
            (0.0, 1.0),
            (-3.75, 0.125),
            (1e9, 1.0),
            (-(2f64.powi(40)), 3.0),
            (0.0, 2f64.powi(-900)),
        ] {
            let centres: Vec<Point<f64, 2>> = (0..400)
                .map(|k| {
                    Point::from([f64::from(k % 20), f64::from(k / 20)].map(|x| offset + edge * x))
                })
                .collect();
            let scene: AnyScene<'_> =
                Scene::new(centres, Radii::Uniform(edge / 2.0)).unwrap().into();
            let exact = oracle::truth(&scene, Arithmetic::Exact).unwrap();
            assert_eq!(exact.pairs.len(), 2 * 20 * 19, "{offset} {edge}");
            assert_eq!(
                oracle::truth(&scene, Arithmetic::F32Cell).unwrap().digest,
                exact.digest,
                "{offset} {edge}"
            );
        }
    }
}
