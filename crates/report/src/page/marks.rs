//! Colours and markers of the figures for a page: CSS variables, with lighter colours on a dark
//! background, and small pictures.

use std::fmt::Write as _;

use crate::figure::style::{Colour, Marker, Styles, lightened};

const DARK: Colour = (22, 24, 29);
/// Least contrast of a line with its background: WCAG 2.2, success criterion 1.4.11.
const CONTRAST: f64 = 3.0;

/// Returns the outline of a marker with radius 1 around 0, as an SVG path.
pub fn outline(marker: Marker) -> &'static str {
    match marker {
        Marker::Circle => "M1.1 0A1.1 1.1 0 1 1-1.1 0A1.1 1.1 0 1 1 1.1 0Z",
        Marker::Square => "M-1-1H1V1H-1Z",
        Marker::Up => "M0-1.25L1.2 .9H-1.2Z",
        Marker::Down => "M0 1.25L1.2-.9H-1.2Z",
        Marker::Diamond => "M0-1.35L1.35 0L0 1.35L-1.35 0Z",
        Marker::Cross => "M-1-1L1 1M-1 1L1-1",
        Marker::Plus => "M-1.2 0H1.2M0-1.2V1.2",
    }
}

/// Relative luminance as WCAG defines it, 0 to 1.
fn luminance((r, g, b): Colour) -> f64 {
    let linear = |c: u8| {
        let c = f64::from(c) / 255.0;
        if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    };
    0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b)
}

fn contrast(a: Colour, b: Colour) -> f64 {
    let (a, b) = (luminance(a) + 0.05, luminance(b) + 0.05);
    if a > b { a / b } else { b / a }
}

/// Mixes a colour with white until it has enough contrast with the dark background.
pub fn on_dark(colour: Colour) -> Colour {
    let mixed = |step: u32| lightened(colour, f64::from(step) / 20.0);
    (0..=20).map(mixed).find(|&c| contrast(c, DARK) >= CONTRAST).unwrap_or((255, 255, 255))
}

pub fn hex((r, g, b): Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Returns the colours of detectors 0, 1, ... as `--d0`, `--d1`, ..., for a light and a dark
/// background.
pub fn css(names: &[&str], styles: &Styles) -> String {
    let list = |change: fn(Colour) -> Colour| {
        let entry =
            |(k, name): (usize, &&str)| format!("--d{k}:{};", hex(change(styles.get(name).colour)));
        names.iter().enumerate().map(entry).collect::<String>()
    };
    format!(
        ":root{{{}}}\n@media (prefers-color-scheme:dark){{:root{{{}}}}}",
        list(|c| c),
        list(on_dark)
    )
}

pub fn mark(out: &mut String, index: usize, marker: Marker, (x, y): (f64, f64), radius: f64) {
    let line = matches!(marker, Marker::Cross | Marker::Plus);
    let _ = write!(
        out,
        "<path class=\"{}\" style=\"--c:var(--d{index})\" transform=\"translate({x:.1} {y:.1}) \
         scale({radius})\" d=\"{}\"/>",
        if line { "mark line" } else { "mark" },
        outline(marker)
    );
}

pub fn chip(index: usize, marker: Marker) -> String {
    let mut out = String::from("<svg class=\"chip\" viewBox=\"-7 -7 14 14\" aria-hidden=\"true\">");
    mark(&mut out, index, marker, (0.0, 0.0), 4.0);
    out + "</svg>"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_colour_is_seen_on_dark_ground_and_bright_ones_stay() {
        for r in (0..=255).step_by(51) {
            for g in (0..=255).step_by(51) {
                for b in (0..=255).step_by(51) {
                    assert!(contrast(on_dark((r, g, b)), DARK) >= CONTRAST, "{r} {g} {b}");
                }
            }
        }
        assert_eq!(on_dark((86, 180, 233)), (86, 180, 233));
        assert_ne!(on_dark((0, 0, 0)), (0, 0, 0));
        assert!((contrast((0, 0, 0), (255, 255, 255)) - 21.0).abs() < 1e-9);
    }
}
