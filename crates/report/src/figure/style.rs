//! One colour and one marker per detector, the same in every figure of a report.
//!
//! The first colours are those of Okabe and Ito, which people with a common colour blindness can
//! distinguish. The others come from Okabe and Ito and from Tol, and differ in lightness. Markers
//! keep a figure readable in grey print. Controls are grey, thin and dashed.
//!
//! The name of a detector decides which style it prefers, so that it usually looks the same in all
//! reports. If the style is taken, the detector gets the next free one. Detectors without
//! parameters choose first.

use std::collections::{BTreeMap, BTreeSet};

use contactbench_record::cells::Cell;
use contactbench_record::record::id::{OVER, split_subject};
use contactbench_record::record::row::Outcome;

pub type Colour = (u8, u8, u8);
pub const WHITE: Colour = (255, 255, 255);
pub const INK: Colour = (40, 40, 40);
pub const FAINT: Colour = (110, 110, 110);
pub const GRID: Colour = (228, 228, 228);
pub const FRAME: Colour = (170, 170, 170);
/// Colour of lines at the N where the coordinates outgrow a cache.
pub const CACHE: Colour = (170, 160, 200);
pub const CACHE_NAME: Colour = (115, 100, 160);
pub const CONTROL: Colour = (150, 150, 150);
/// Background of the strip that marks cells without a value.
pub const STRIP: Colour = (246, 246, 244);

pub fn ink_on(ground: Colour) -> Colour {
    let (r, g, b) = (u32::from(ground.0), u32::from(ground.1), u32::from(ground.2));
    if 299 * r + 587 * g + 114 * b > 140_000 { INK } else { WHITE }
}

contactbench_terms::named! {
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Marker {
        Circle = "circle",
        Square = "square",
        Up = "up",
        Down = "down",
        Diamond = "diamond",
        Cross = "cross",
        Plus = "plus",
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Style {
    pub colour: Colour,
    pub marker: Marker,
    pub control: bool,
}

const PALETTE: [(Colour, Marker); 15] = [
    ((0, 0, 0), Marker::Square),
    ((230, 159, 0), Marker::Up),
    ((86, 180, 233), Marker::Diamond),
    ((0, 158, 115), Marker::Down),
    ((213, 94, 0), Marker::Circle),
    ((0, 80, 200), Marker::Circle),
    ((204, 121, 167), Marker::Square),
    ((136, 34, 85), Marker::Cross),
    ((160, 0, 230), Marker::Down),
    ((178, 161, 0), Marker::Plus),
    ((51, 34, 136), Marker::Up),
    ((140, 110, 70), Marker::Diamond),
    ((0, 114, 178), Marker::Cross),
    ((204, 102, 119), Marker::Plus),
    ((90, 140, 90), Marker::Diamond),
];
/// Styles of the rules of trackers, by the beginning of the rule's name.
const RULES: [(&str, Colour, Marker); 5] = [
    ("top-two", (0, 158, 115), Marker::Circle),
    ("half-skin", (86, 180, 233), Marker::Square),
    ("summed", (51, 34, 136), Marker::Up),
    ("lammps-", (230, 159, 0), Marker::Diamond),
    ("every-", (213, 94, 0), Marker::Down),
];
/// Style of `skin=auto`. No detector has it, because figures show both.
const AUTO: (&str, Colour, Marker) = ("auto", (0, 0, 0), Marker::Down);

#[derive(Clone, Debug, Default)]
pub struct Styles(BTreeMap<String, Style>);

impl Styles {
    pub fn new<'a>(cells: impl Iterator<Item = &'a Cell>) -> Styles {
        let mut subjects: BTreeMap<String, bool> = BTreeMap::new();
        for cell in cells {
            // Figures name a tracker without its skin, too.
            let names = [cell.id.subject(), cell.id.subject_without(&["skin"])];
            subjects.extend(names.map(|name| (name, cell.role.is_control())));
        }
        let mut styles = BTreeMap::new();
        let mut controls = 0;
        let mut subjects = Vec::from_iter(subjects);
        let is_thick = |name: &str| name.contains("skin=") && of_rule(name).is_none();
        subjects.sort_by_key(|(name, _)| (name.contains(':'), is_thick(name)));
        for (name, control) in subjects {
            let key = detector(&name);
            if control {
                controls += 1;
                let marker = if controls % 2 == 1 { Marker::Circle } else { Marker::Cross };
                styles.insert(name, Style { colour: CONTROL, marker, control });
            } else if !styles.contains_key(&key) {
                let style = free(&key, &styles);
                styles.insert(key, style);
            }
        }
        Styles(styles)
    }

    /// Returns the style of a detector. A detector that [`Styles::new`] did not get has the style
    /// that its name prefers.
    pub fn get(&self, name: &str) -> Style {
        let known = self.0.get(name).or_else(|| self.0.get(&detector(name)));
        known.copied().unwrap_or_else(|| free(&detector(name), &BTreeMap::new()))
    }
}

/// Returns the style that a name prefers, or the next one whose colour is free. Without a free
/// colour, it is the next free pair of colour and marker.
fn free(name: &str, taken: &BTreeMap<String, Style>) -> Style {
    let first = preferred(name);
    let colours = (first..PALETTE.len()).chain(0..first).map(of_place);
    let mut colours = of_rule(name).into_iter().chain(colours);
    let has_colour = |style: &Style| taken.values().any(|other| other.colour == style.colour);
    let mut others = (PALETTE.len()..PALETTE.len() * Marker::ALL.len()).map(of_place);
    let free = colours.find(|style| !has_colour(style));
    free.or_else(|| others.find(|style| taken.values().all(|other| other != style)))
        .unwrap_or_else(|| of_place(first))
}

/// Returns the style at a palette index; past the end, colours repeat with other markers.
fn of_place(place: usize) -> Style {
    let (round, (colour, own)) = (place / PALETTE.len(), PALETTE[place % PALETTE.len()]);
    let first = Marker::ALL.iter().position(|marker| *marker == own).unwrap_or(0);
    Style { colour, marker: Marker::ALL[(first + round) % Marker::ALL.len()], control: false }
}

/// Returns the palette index that a name prefers, from its FNV-1a hash.
fn preferred(name: &str) -> usize {
    let step = |hash: u32, byte: u8| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193);
    (name.bytes().fold(0x811c_9dc5, step) >> 8) as usize % PALETTE.len()
}

/// Returns the style of a tracker's rule, if the name has no skin or `skin=auto`.
fn of_rule(name: &str) -> Option<Style> {
    let (_, params) = split_subject(name);
    let text = |key: &str| params.get(key).map(|value| value.to_string());
    let (rule, skin) = (text("rule")?, text("skin"));
    let (_, colour, marker) = match skin.as_deref() {
        None => *RULES.iter().find(|kept| rule.starts_with(kept.0))?,
        Some("auto") => AUTO,
        Some(_) => return None,
    };
    Some(Style { colour, marker, control: false })
}

/// Returns the name that a style belongs to: for a tracker without a rule, that of its detector.
fn detector(name: &str) -> String {
    let (_, params) = split_subject(name);
    match params.get(OVER).filter(|_| !params.contains_key("rule")) {
        Some(over) => over.to_string(),
        None => name.to_string(),
    }
}

/// Returns the letter that marks a cell without a value, and its meaning.
pub fn letter(outcome: Outcome) -> (&'static str, &'static str) {
    match outcome {
        good @ (Outcome::Ok | Outcome::Lossy | Outcome::Control) => ("", good.name()),
        Outcome::Wrong => ("W", "wrong answer"),
        Outcome::Timeout => ("T", "time limit"),
        Outcome::OutOfMemory => ("M", "memory limit"),
        Outcome::Refused => ("R", "refused"),
        Outcome::Unavailable => ("U", "unavailable"),
        Outcome::Crashed => ("C", "crashed"),
    }
}

/// Returns names in the order of the legend, with controls last.
pub fn ranked<'a>(
    cells: impl IntoIterator<Item = &'a Cell>,
    name: impl Fn(&Cell) -> String,
) -> Vec<String> {
    let ranked = cells.into_iter().map(|cell| (cell.role.is_control(), name(cell)));
    ranked.collect::<BTreeSet<_>>().into_iter().map(|(_, name)| name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use contactbench_record::cells;
    use contactbench_record::cells::testing::Lab;

    #[test]
    fn all_names_of_a_record_have_styles_of_their_own() {
        let names: Vec<String> = (0..2 * PALETTE.len()).map(|k| format!("detector-{k}")).collect();
        let mut lab = Lab::new("e", "packed");
        names.iter().chain(&["every-step(detector-3)".to_string()]).for_each(|name| {
            lab.detector(name).time(&[1]);
        });
        let styles = Styles::new(cells::cells(&lab.rows()).iter());
        for (k, name) in names.iter().enumerate() {
            let style = styles.get(name);
            assert!(!style.control && names[..k].iter().all(|other| styles.get(other) != style));
        }
        assert_eq!(styles.get("every-step(detector-3)"), styles.get("detector-3"));
    }

    #[test]
    fn rules_of_a_figure_have_colours_of_their_own() {
        let mut lab = Lab::new("e", "packed");
        let rule = |rule: &str, skin| format!("verlet(streamed-nbs,rule={rule}{skin})");
        lab.detector("every-step(streamed-nbs)").time(&[1]);
        let rules = ["top-two", "every-20", "lammps-10-1-yes", "lammps-1-0-no", "summed"];
        rules.iter().for_each(|name| _ = lab.detector(&rule(name, ",skin=0.1")).time(&[1]));
        lab.detector(&rule("top-two", ",skin=auto")).time(&[1]);
        let styles = Styles::new(cells::cells(&lab.rows()).iter());
        let mut names = Vec::from(rules.map(|name| rule(name, "")));
        names.extend(["every-step(streamed-nbs)".into(), rule("top-two", ",skin=auto")]);
        let colours: BTreeSet<Colour> = names.iter().map(|name| styles.get(name).colour).collect();
        assert_eq!(colours.len(), names.len());
    }
}
