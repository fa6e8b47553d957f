//! How deep two bodies overlap.
/// The overlap of two bodies over their mean radius, negative for a gap; as f64 gives it.
pub fn depth<const D: usize>(a: &[f64; D], b: &[f64; D], ra: f64, rb: f64) -> f64 {
    let d: f64 = (0..D).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum::<f64>().sqrt();
    2.0 * (ra + rb - d) / (ra + rb)
}
