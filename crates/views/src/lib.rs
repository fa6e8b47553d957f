//! Pictures of scenes ([`draw`]), and the steps of the book's detectors ([`trace`]).

pub mod draw;
pub mod trace;

use std::fmt::Write;

fn px(x: f64) -> String {
    let mut text = format!("{x:.2}");
    if text.contains('.') {
        text.truncate(text.trim_end_matches('0').trim_end_matches('.').len());
    }
    if text == "-0" { "0".into() } else { text }
}

/// Appends `M x y L x y` to the data of an SVG path.
fn segment(path: &mut String, a: [f64; 2], b: [f64; 2]) {
    let _ = write!(path, "M{} {}L{} {}", px(a[0]), px(a[1]), px(b[0]), px(b[1]));
}

#[cfg(test)]
mod tests {
    #[test]
    fn numbers_are_short() {
        let numbers = [0.0, -0.001, 1.0, 12.5, 100.0, -4.25999].map(super::px);
        assert_eq!(numbers, ["0", "0", "1", "12.5", "100", "-4.26"]);
    }
}
