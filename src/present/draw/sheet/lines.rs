//! The lines of the picture: contacts, and what a list got wrong.

use super::{CROWD, Sheet};
use crate::periodic;
use crate::present::draw::pairs::{NEAR, depth_of};
use crate::present::svg::{px, segment};
use crate::scene::Real;
use crate::with_scene;

const CONTACT: &str = "#0b5394";
const ACROSS: &str = "#0f8577";
const TANGENT: &str = "#7b2d8e";

impl Sheet<'_> {
    /// How many contacts pairs of bodies show: one across the box is there from both sides.
    fn count(&self, pairs: impl Iterator<Item = [u32; 2]>) -> usize {
        match self.boxed {
            None => pairs.count(),
            Some(boxed) => {
                let mut contacts: Vec<_> =
                    pairs.map(|pair| (boxed.contact(pair), pair[0] > pair[1])).collect();
                contacts.sort_unstable();
                // A repeated one counts as often as it is there from either side.
                contacts
                    .chunk_by(|a, b| a.0 == b.0)
                    .map(|same| {
                        if same[0].0.image == [0; 3] { same.len() } else { same.len().div_ceil(2) }
                    })
                    .sum()
            }
        }
    }

    /// Centres of a pair on the sheet, if both are there.
    fn ends(&self, [i, j]: [u32; 2]) -> Option<[[f64; 2]; 2]> {
        Some([self.page.at(self.flat.circle(i)?.at), self.page.at(self.flat.circle(j)?.at)])
    }

    pub(super) fn contacts(&mut self) {
        let (mut lines, mut tangents, mut nearly, mut apart) =
            ([const { String::new() }; 2], Vec::new(), Vec::new(), String::new());
        let mut drawn = 0;
        for &pair in &self.pairs.contacts {
            let Some([a, b]) = self.ends(pair) else { continue };
            drawn += 1;
            segment(&mut lines[usize::from(self.is_image(pair[1]))], a, b);
            let depth = match self.boxed {
                Some(boxed) => periodic::depth(boxed.periodic, boxed.contact(pair)),
                None => depth_of(self.scene, pair),
            };
            if depth == 0.0 {
                tangents.push((pair, self.between(pair, a, b)));
            } else if depth < NEAR {
                nearly.push((pair, self.between(pair, a, b)));
            }
        }
        for &pair in &self.pairs.near {
            let Some([a, b]) = self.ends(pair) else { continue };
            segment(&mut apart, a, b);
            nearly.push((pair, self.between(pair, a, b)));
        }
        let width = if drawn > CROWD { "0.5" } else { "1.8" };
        let dotted = format!(
            "stroke=\"{TANGENT}\" stroke-dasharray=\"1 4\" stroke-width=\"1.8\" \
             stroke-linecap=\"round\" fill=\"none\""
        );
        let contacts = self.pairs.contacts.iter().copied();
        for (across, lines) in lines.into_iter().enumerate() {
            let colour = [CONTACT, ACROSS][across];
            let line = format!("stroke=\"{colour}\" stroke-width=\"{width}\" fill=\"none\"");
            if !lines.is_empty() {
                self.body += &format!("<path d=\"{lines}\" {line}/>\n");
            }
            let such =
                contacts.clone().filter(|pair| usize::from(self.is_image(pair[1])) == across);
            let (seen, all) = (
                self.count(such.clone().filter(|pair| self.ends(*pair).is_some())),
                self.count(such),
            );
            let of = match self.flat.slice {
                Some(_) => format!(" of {all}, those with both spheres in the slice"),
                None => String::new(),
            };
            let meaning = match across {
                0 => format!("contacts: {seen}{of}"),
                _ if self.boxed.is_none() => continue,
                _ => format!(
                    "contacts across the box: {seen}{of}; each is drawn from both sides, to the \
                     image (dashed, pale) that is touched"
                ),
            };
            self.rows.push((format!("<path d=\"M0 0H32\" {line}/>"), meaning));
        }
        if !apart.is_empty() {
            self.body += &format!("<path d=\"{apart}\" {dotted}/>\n");
        }
        let (small, crowd) =
            (if drawn > CROWD { 1.2 } else { 3.5 }, if drawn > CROWD { "0.6" } else { "1.6" });
        for (marks, fill, text) in [
            (tangents, TANGENT, "exactly tangent"),
            (
                nearly,
                "#fff",
                "nearly tangent: gap (dotted) or overlap under a millionth of the radius",
            ),
        ] {
            let look = format!(
                "r=\"{small}\" fill=\"{fill}\" stroke=\"{TANGENT}\" stroke-width=\"{crowd}\""
            );
            if !marks.is_empty() {
                self.rows.push((
                    format!("<circle cx=\"16\" {look}/>"),
                    format!("{text}: {}", self.count(marks.iter().map(|(pair, _)| *pair))),
                ));
                self.body.extend(marks.iter().map(|(_, [x, y])| {
                    format!("<circle cx=\"{}\" cy=\"{}\" {look}/>\n", px(*x), px(*y))
                }));
            }
        }
    }

    /// The point where two bodies that are nearly tangent are so.
    fn between(&self, [i, j]: [u32; 2], a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
        let radius = |k: u32| {
            with_scene!(self.scene, scene => scene.radius(k as usize).wide()) * self.flat.factor
        };
        let (ri, rj) = (radius(i), radius(j));
        let part = if ri + rj > 0.0 { ri / (ri + rj) } else { 0.5 };
        [0, 1].map(|k| a[k] + (b[k] - a[k]) * part)
    }

    /// Lines that must be seen: what a list got wrong.
    pub(super) fn wrong(&mut self, pairs: &[[u32; 2]], colour: &str, dash: &str, meaning: &str) {
        if pairs.is_empty() {
            return;
        }
        let look = format!(
            "stroke=\"{colour}\" stroke-width=\"3\" stroke-dasharray=\"{dash}\" fill=\"none\""
        );
        let look = if dash.is_empty() { look.replace(" stroke-dasharray=\"\"", "") } else { look };
        let mut lines = String::new();
        for &pair in pairs {
            let Some([a, b]) = self.ends(pair) else { continue };
            if a == b {
                // A particle with itself, or two in one place: a ring, as a path of two arcs.
                let r = (0.6
                    * self.flat.circle(pair[0]).map_or(0.0, |circle| self.page.length(circle.r)))
                .max(4.0);
                let (left, right, y, r) = (px(a[0] - r), px(a[0] + r), px(a[1]), px(r));
                lines += &format!("M{left} {y}A{r} {r} 0 1 0 {right} {y}A{r} {r} 0 1 0 {left} {y}");
            } else {
                segment(&mut lines, a, b);
            }
        }
        self.body += &format!("<path d=\"{lines}\" {look}/>\n");
        let seen = pairs.iter().copied().filter(|pair| self.ends(*pair).is_some());
        let (drawn, all) = (self.count(seen), self.count(pairs.iter().copied()));
        let of = if drawn < all { format!(" of {all}") } else { String::new() };
        self.rows
            .push((format!("<path d=\"M0 0H32\" {look}/>"), format!("{meaning}: {drawn}{of}")));
    }
}
