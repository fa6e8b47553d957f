//! One colour and one marker per detector, the same in every figure.
//!
//! The colours of the book's detectors are those of Okabe and Ito, which people with any of the
//! common colour blindnesses tell apart; the others were chosen beside them, from Okabe and Ito and
//! from Tol, to differ in lightness where hues can be mistaken. The marker says the same again, so
//! that a figure survives a grey printer. Controls are grey, thin and dashed.

use std::collections::BTreeMap;

use crate::cells::Cell;
use crate::record::id::{OVER, split_contender};

/// Red, green, blue.
pub type Colour = (u8, u8, u8);
/// Text and axes.
pub const INK: Colour = (40, 40, 40);
/// Secondary text.
pub const FAINT: Colour = (110, 110, 110);
/// Grid lines.
pub const GRID: Colour = (228, 228, 228);
/// Lines where data outgrow a cache.
pub const CACHE: Colour = (170, 160, 200);
/// Their names.
pub const CACHE_NAME: Colour = (115, 100, 160);
/// Controls.
pub const CONTROL: Colour = (150, 150, 150);
/// The background of the strip for cells without a value.
pub const STRIP: Colour = (246, 246, 244);

/// A colour of which so much is white, 0 to 1.
pub fn lightened(colour: Colour, white: f64) -> Colour {
    let mix = |c: u8| (f64::from(c) + (255.0 - f64::from(c)) * white) as u8;
    (mix(colour.0), mix(colour.1), mix(colour.2))
}

/// What is read on a ground of this colour: dark letters on light colours.
pub fn ink_on(ground: Colour) -> Colour {
    let (r, g, b) = (u32::from(ground.0), u32::from(ground.1), u32::from(ground.2));
    if 299 * r + 587 * g + 114 * b > 140_000 { INK } else { (255, 255, 255) }
}

/// The shape of a marker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    /// Filled circle.
    Circle,
    /// Filled square.
    Square,
    /// Triangle, point up.
    Up,
    /// Triangle, point down.
    Down,
    /// Square on its corner.
    Diamond,
    /// Diagonal cross.
    Cross,
    /// Upright cross.
    Plus,
}

/// How lines are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Style {
    /// Line and marker.
    pub colour: Colour,
    /// The marker.
    pub marker: Marker,
    /// Drawn thin and dashed.
    pub control: bool,
}

/// The book's detectors, then the others.
const KNOWN: [(&str, Colour, Marker); 12] = [
    ("direct", (0, 0, 0), Marker::Square),
    ("binary-tree", (230, 159, 0), Marker::Up),
    ("screening", (86, 180, 233), Marker::Diamond),
    ("sorting", (0, 158, 115), Marker::Down),
    ("nbs", (213, 94, 0), Marker::Circle),
    ("streamed-nbs", (0, 80, 200), Marker::Circle),
    ("cell-grid", (204, 121, 167), Marker::Square),
    ("hash-grid", (136, 34, 85), Marker::Cross),
    ("hgrid", (160, 0, 230), Marker::Down),
    ("sweep", (178, 161, 0), Marker::Plus),
    ("kd-tree", (51, 34, 136), Marker::Up),
    ("bvh", (140, 110, 70), Marker::Diamond),
];
/// Rules by which trackers build their lists, as their names begin.
const RULES: [(&str, Colour, Marker); 5] = [
    ("top-two", (0, 158, 115), Marker::Circle),
    ("half-skin", (86, 180, 233), Marker::Square),
    ("summed", (51, 34, 136), Marker::Up),
    ("lammps-", (230, 159, 0), Marker::Diamond),
    ("every-", (213, 94, 0), Marker::Down),
];
/// A skin that is found while a list is used.
const AUTO: (&str, Colour, Marker) = ("auto", (230, 159, 0), Marker::Up);
const REST: [Colour; 3] = [(0, 114, 178), (204, 102, 119), (90, 140, 90)];
const MARKERS: [Marker; 5] =
    [Marker::Cross, Marker::Plus, Marker::Diamond, Marker::Square, Marker::Up];

/// The styles of all detectors of a record.
#[derive(Clone, Debug, Default)]
pub struct Styles(BTreeMap<String, Style>);

impl Styles {
    /// Names that have no style of their own get the remaining ones in alphabetical order.
    pub fn new<'a>(cells: impl Iterator<Item = &'a Cell>) -> Styles {
        let mut styles: BTreeMap<String, Style> = BTreeMap::new();
        let contenders: BTreeMap<String, bool> =
            cells.map(|cell| (cell.id.contender(), cell.role.is_control())).collect();
        let (mut others, mut controls) = (0, 0);
        for (name, control) in contenders {
            let style = if control {
                controls += 1;
                Style {
                    colour: CONTROL,
                    marker: if controls % 2 == 1 { Marker::Circle } else { Marker::Cross },
                    control: true,
                }
            } else if let Some(style) = kept_for(&name) {
                style
            } else {
                others += 1;
                let (colour, marker) =
                    (REST[(others - 1) % REST.len()], MARKERS[(others - 1) % MARKERS.len()]);
                Style { colour, marker, control: false }
            };
            styles.insert(name, style);
        }
        Styles(styles)
    }

    /// Colours for the contenders of a map: first their own, then of all others those that are
    /// farthest from the ones before.
    pub fn of_map(&self, names: &[String]) -> Vec<Colour> {
        let mut taken: Vec<Colour> = Vec::new();
        let mut own = |name: &String| {
            let style = Some(self.get(name)).filter(|style| !style.control)?;
            let free = !taken.contains(&style.colour);
            free.then(|| taken.push(style.colour)).map(|()| style.colour)
        };
        let found: Vec<Option<Colour>> = names.iter().map(&mut own).collect();
        let all: Vec<Colour> = KNOWN.iter().skip(1).map(|it| it.1).chain(REST).collect();
        let mut farthest = || {
            let room = |a: &&Colour| taken.iter().map(|b| apart(**a, *b)).min().unwrap_or(255);
            let colour = all.iter().max_by_key(room).copied().unwrap_or(INK);
            taken.push(colour);
            colour
        };
        found.into_iter().map(|own| own.unwrap_or_else(&mut farthest)).collect()
    }

    /// The style of a detector; grey for names that were not announced.
    pub fn get(&self, name: &str) -> Style {
        let known = self.0.get(name).copied().or_else(|| kept_for(name));
        known.unwrap_or(Style { colour: CONTROL, marker: Marker::Plus, control: true })
    }
}

/// How far two colours are from each other: the largest of three differences.
fn apart(a: Colour, b: Colour) -> u8 {
    a.0.abs_diff(b.0).max(a.1.abs_diff(b.1)).max(a.2.abs_diff(b.2))
}

/// The style that is kept for a detector, or for the rule of a tracker where its skin does not
/// matter.
fn kept_for(name: &str) -> Option<Style> {
    let (name, params) = split_contender(name);
    let text = |key: &str| params.get(key).map(|value| value.to_string());
    let known = |name: &str| KNOWN.iter().find(|known| known.0 == name);
    let found = match (text(OVER), text("rule")) {
        (None, _) if params.is_empty() => known(&name),
        (Some(over), None) if name != "incremental" => known(&over),
        (Some(over), None) if params.len() == 1 => {
            return known(&over).map(|&(_, colour, _)| Style {
                colour,
                marker: Marker::Cross,
                control: false,
            });
        }
        (Some(_), Some(rule)) => match text("skin") {
            None => RULES.iter().find(|kept| rule.starts_with(kept.0)),
            Some(skin) => (skin == "auto").then_some(&AUTO),
        },
        _ => None,
    };
    found.map(|&(_, colour, marker)| Style { colour, marker, control: false })
}

/// The place of a detector in legends: the book's order, then others, then controls.
pub fn rank(cell: &Cell) -> usize {
    let other = if cell.role.is_control() { 99 } else { 50 };
    KNOWN.iter().position(|known| known.0 == cell.id.contender()).unwrap_or(other)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells;
    use crate::cells::testing::Lab;
    use crate::detect::table::{Role, TABLE};

    #[test]
    fn trackers_over_one_detector_are_told_apart_on_a_map() {
        let names = ["every-step(nbs)", "nbs", "verlet(bvh)", "verlet(nbs)"].map(String::from);
        let colours = Styles::default().of_map(&names);
        assert_eq!((colours[0], colours[2]), ((213, 94, 0), (140, 110, 70)));
        for (k, &a) in colours.iter().enumerate() {
            assert!(colours[..k].iter().all(|&b| apart(a, b) >= 60), "{colours:?}");
        }
    }

    #[test]
    fn every_detector_has_a_style_of_its_own() {
        // New detectors have one of the rest, until they are given one that is kept for them.
        let detectors: Vec<&str> = TABLE
            .iter()
            .filter(|entry| entry.role == Role::Detector)
            .map(|entry| entry.name)
            .collect();
        let mut lab = Lab::new("e", "packed");
        detectors.iter().for_each(|name| {
            lab.detector(name).time(&[1]);
        });
        let styles = Styles::new(cells::cells(&lab.rows()).iter());
        for (k, name) in detectors.iter().enumerate() {
            let of = |name: &str| styles.get(name);
            assert!(
                !of(name).control
                    && detectors[..k].iter().all(|other| of(other).colour != of(name).colour),
                "{name}"
            );
        }
        for (k, a) in KNOWN.iter().enumerate() {
            assert!(KNOWN[..k].iter().all(|b| apart(a.1, b.1) >= 45), "{}", a.0);
            assert!(REST.iter().all(|&b| apart(a.1, b) >= 30), "{}", a.0);
        }
    }
}
