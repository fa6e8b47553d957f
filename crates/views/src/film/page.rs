//! The page of a film: the first frame as a picture, all frames as numbers, and the script.

use std::fmt::Write;

use serde_json::{Value, json};

use crate::draw::page_coordinates::PageCoordinates;
use crate::draw::plane::bounds;
use crate::film::{Film, Frame};
use crate::player::{self, painted};
use crate::{px, segment};
use contactbench_terms::text;

const MOST: [f64; 2] = [1200.0, 900.0];
/// Units of the page's numbers per pixel; smaller distances cannot be seen.
const FINE: f64 = 32.0;

pub fn html(film: &Film) -> String {
    let (page, first) = (page(film), film.frames.first());
    let radii = first
        .filter(|_| !film.own_radii)
        .map(|first| base64(first.circles.iter().map(|circle| fine(page.length(circle.r)))));
    let data = json!({
        "scale": FINE,
        "slice": film.space,
        "radii": radii,
        "frames": film.frames.iter().map(|frame| numbers(film, frame, &page)).collect::<Vec<_>>(),
    });
    let [discs, contacts, missed] = first.map_or_else(Default::default, |it| picture(it, &page));
    let ([width, height], last) = (page.size.map(px), film.frames.len().saturating_sub(1));
    let values = [
        ("style", colours() + player::STYLE),
        ("player", player::SCRIPT.into()),
        ("scene", format!("0 0 {width} {height}")),
        ("discs", discs),
        ("contacts", contacts),
        ("missed", missed),
        ("line", last.max(1).to_string()),
        ("builds", marks(film, |frame| frame.built, "0V10")),
        ("misses", marks(film, |frame| frame.missed > 0, "5V10")),
        ("last", last.to_string()),
        ("data", player::data(&data)),
        ("summary", text::html(&film.summary())),
        ("title", text::html(&film.title)),
    ];
    text::fill(include_str!("page.html"), &values)
}

fn page(film: &Film) -> PageCoordinates {
    let circles = film.frames.iter().flat_map(|frame| &frame.circles);
    PageCoordinates::around(bounds(circles).unwrap_or([[0.0; 2], [1.0; 2]]), MOST, 0.0)
}

/// Converts pixels to the units of the page's numbers.
fn fine(pixels: f64) -> u16 {
    // The cast saturates.
    (pixels * FINE).round() as u16
}

fn numbers(film: &Film, frame: &Frame, page: &PageCoordinates) -> Value {
    let circles = frame.circles.iter().flat_map(|circle| {
        let [x, y] = page.at(circle.at).map(fine);
        let r = film.own_radii.then(|| fine(page.length(circle.r)));
        [x, y].into_iter().chain(r)
    });
    let pairs = base64(frame.pairs.iter().flatten().copied());
    let &Frame { missed_here, contacts, missed, built, .. } = frame;
    json!([base64(circles), pairs, missed_here, contacts, missed, u8::from(built)])
}

/// Returns the SVG path data of circles, contacts and missed contacts of the first frame.
fn picture(frame: &Frame, page: &PageCoordinates) -> [String; 3] {
    let [mut discs, mut contacts, mut missed] = [const { String::new() }; 3];
    for circle in &frame.circles {
        let ([x, y], r) = (page.at(circle.at), page.length(circle.r).max(0.5));
        let (left, y, r, across) = (px(x - r), px(y), px(r), px(2.0 * r));
        let _ = write!(discs, "M{left} {y}a{r} {r} 0 1 0 {across} 0a{r} {r} 0 1 0 -{across} 0");
    }
    let reported = frame.pairs.len() - frame.missed_here;
    for (k, pair) in frame.pairs.iter().enumerate() {
        let [a, b] = pair.map(|place| page.at(frame.circles[usize::from(place)].at));
        segment(if k < reported { &mut contacts } else { &mut missed }, a, b);
    }
    [discs, contacts, missed]
}

/// Returns a stroke on the time line for each marked frame.
fn marks(film: &Film, is_marked: impl Fn(&Frame) -> bool, stroke: &str) -> String {
    let marked = film.frames.iter().enumerate().filter(|(_, frame)| is_marked(frame));
    marked.map(|(k, _)| format!("M{k} {stroke}")).collect()
}

fn colours() -> String {
    let variables = "{--ground:@ground;--ink:@ink;--line:@line;--disc:@disc;--rim:@rim;\
                     --accent:@accent;--contact:@contact;--missed:@missed}\n";
    let [bright, dark] = [false, true].map(|dark| painted(variables, dark));
    // The media query applies only without JavaScript, which sets the class `js`.
    let wish = format!("@media (prefers-color-scheme:dark){{:root:not(.js){dark}}}\n");
    format!(":root{bright}{wish}:root.dark{dark}")
}

/// Encodes 16-bit numbers in base64, low byte first.
fn base64(numbers: impl Iterator<Item = u16>) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let bytes: Vec<u8> = numbers.flat_map(u16::to_le_bytes).collect();
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let at = |k: usize| u32::from(group.get(k).copied().unwrap_or(0));
        let bits = at(0) << 16 | at(1) << 8 | at(2);
        let letter = |k: usize| LETTERS[(bits >> (18 - 6 * k) & 63) as usize].into();
        // A group of n bytes makes n + 1 letters.
        text.extend((0..4).map(|k| if k <= group.len() { letter(k) } else { '=' }));
    }
    text
}

#[test]
fn numbers_are_written_as_browsers_read_them() {
    for (numbers, text) in [
        (&[][..], ""),
        (&[0x614d], "TWE="),
        (&[0x614d, 0x4d6e], "TWFuTQ=="),
        (&[0x614d, 0x4d6e, 0x6e61], "TWFuTWFu"),
    ] {
        assert_eq!(base64(numbers.iter().copied()), text);
    }
    assert_eq!([-1.0, 1.0, 1e9].map(fine), [0, 32, u16::MAX]);
}
