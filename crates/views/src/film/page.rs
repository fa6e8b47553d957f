//! The page: the first frame as a picture, all frames as numbers, and what draws them.

use std::fmt::Write;

use serde_json::{Value, json};

use crate::draw::page_coordinates::PageCoordinates;
use crate::draw::plane::bounds;
use crate::film::{Film, Frame};
use crate::player::{self, painted};
use crate::{px, segment};
use contactbench_terms::text;

const MOST: [f64; 2] = [1200.0, 900.0];
/// Numbers of the page for a pixel: what is finer is not seen.
const FINE: f64 = 32.0;
pub fn html(film: &Film) -> String {
    let page = page(film);
    let data = json!({
        "scale": FINE,
        "slice": film.space,
        "radii": if film.own_radii { Value::Null } else { film.frames.first().map(|first| {
            base64(first.circles.iter().map(|circle| fine(page.length(circle.r))))
        }).into() },
        "frames": film.frames.iter().map(|frame| numbers(film, frame, &page)).collect::<Vec<_>>(),
    });
    // In a script nothing but its end tag must be avoided.
    let data = data.to_string().replace("</", "<\\/");
    let [discs, contacts, missed] =
        film.frames.first().map_or_else(Default::default, |first| picture(first, &page));
    let [width, height] = page.size.map(px);
    let last = film.frames.len().saturating_sub(1);
    let summary = text::html(&film.summary());
    include_str!("page.html")
        .replace("@@STYLE@@", &format!("{}{}", colours(), player::STYLE))
        .replace("@@PLAYER@@", player::SCRIPT)
        .replace("@@SCENE@@", &format!("0 0 {width} {height}"))
        .replace("@@DISCS@@", &discs)
        .replace("@@CONTACTS@@", &contacts)
        .replace("@@MISSED@@", &missed)
        .replace("@@LINE@@", &last.max(1).to_string())
        .replace("@@BUILDS@@", &marks(film, |frame| frame.built, 0, 10))
        .replace("@@MISSES@@", &marks(film, |frame| frame.missed > 0, 5, 10))
        .replace("@@LAST@@", &last.to_string())
        .replace("@@DATA@@", &data)
        // Last, so that a name cannot be taken for a place.
        .replace("@@SUMMARY@@", &summary)
        .replace("@@TITLE@@", &text::html(&film.title))
}

/// Around the circles of all frames.
fn page(film: &Film) -> PageCoordinates {
    let circles = film.frames.iter().flat_map(|frame| &frame.circles);
    PageCoordinates::around(bounds(circles).unwrap_or([[0.0; 2], [1.0; 2]]), MOST, 0.0)
}

/// A length of the page as the data have it.
fn fine(pixels: f64) -> u16 {
    // What is out of range stops at the end of it.
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

/// The first frame as data of paths: circles, contacts, and what was missed of those.
fn picture(frame: &Frame, page: &PageCoordinates) -> [String; 3] {
    let [mut discs, mut contacts, mut missed] = [const { String::new() }; 3];
    for circle in &frame.circles {
        let ([x, y], r) = (page.at(circle.at), page.length(circle.r).max(0.5));
        let (left, y, r, across) = (px(x - r), px(y), px(r), px(2.0 * r));
        // Writing to a string cannot fail.
        let _ = write!(discs, "M{left} {y}a{r} {r} 0 1 0 {across} 0a{r} {r} 0 1 0 -{across} 0");
    }
    let reported = frame.pairs.len() - frame.missed_here;
    for (k, pair) in frame.pairs.iter().enumerate() {
        let [a, b] = pair.map(|place| page.at(frame.circles[usize::from(place)].at));
        segment(if k < reported { &mut contacts } else { &mut missed }, a, b);
    }
    [discs, contacts, missed]
}

/// Strokes on the line of time, from `top` to `bottom`.
fn marks(film: &Film, is_marked: impl Fn(&Frame) -> bool, top: u32, bottom: u32) -> String {
    let marked = film.frames.iter().enumerate().filter(|(_, frame)| is_marked(frame));
    marked.map(|(k, _)| format!("M{k} {top}V{bottom}")).collect()
}

fn colours() -> String {
    let variables = "{--ground:@ground;--ink:@ink;--line:@line;--disc:@disc;--rim:@rim;\
                     --accent:@accent;--contact:@contact;--missed:@missed}\n";
    let [bright, dark] = [false, true].map(|dark| painted(variables, dark));
    // Without JavaScript nobody says that it is dark.
    let wish = format!("@media (prefers-color-scheme:dark){{:root:not(.js){dark}}}\n");
    format!(":root{bright}{wish}:root.dark{dark}")
}

/// Numbers of 16 bits, the low byte first, in base64.
fn base64(numbers: impl Iterator<Item = u16>) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let bytes: Vec<u8> = numbers.flat_map(u16::to_le_bytes).collect();
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let at = |k: usize| u32::from(group.get(k).copied().unwrap_or(0));
        let bits = at(0) << 16 | at(1) << 8 | at(2);
        for k in 0..4 {
            // A group of n bytes has n + 1 letters.
            match k <= group.len() {
                true => text.push(LETTERS[(bits >> (18 - 6 * k) & 63) as usize].into()),
                false => text.push('='),
            }
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
