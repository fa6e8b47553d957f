//! The lines of the picture: contacts, and what a list got wrong.

use super::{CROWD, Sheet};
use crate::draw::pairs::NEAR;
use crate::{px, segment};
use contactbench_core::periodic::{ImagePair, depth};

const CONTACT: &str = "#0b5394";
const ACROSS: &str = "#0f8577";
const TANGENT: &str = "#7b2d8e";

/// Marks of one kind where pairs are tangent, and the number of those pairs.
#[derive(Default)]
struct Marks {
    at: Vec<[f64; 2]>,
    pairs: usize,
}

impl Sheet<'_> {
    /// The lines of a pair of which both ends are on the sheet: the bodies, and their centres.
    fn seen(&self, pair: ImagePair) -> Vec<([u32; 2], [[f64; 2]; 2])> {
        let at = |body: u32| Some(self.page.at(self.plane.circle(body)?.at));
        let ends = |[a, b]: [u32; 2]| Some(([a, b], [at(a)?, at(b)?]));
        self.bodies.lines(pair).filter_map(ends).collect()
    }

    fn count(&self, pairs: &[ImagePair]) -> usize {
        pairs.iter().filter(|pair| !self.seen(**pair).is_empty()).count()
    }

    pub(super) fn contacts(&mut self) {
        let mut lines = [const { String::new() }; 2];
        let (mut seen, mut all, mut drawn) = ([0; 2], [0; 2], 0);
        let (mut tangents, mut nearly, mut apart) =
            (Marks::default(), Marks::default(), String::new());
        for &pair in &self.pairs.contacts {
            let (ends, across) = (self.seen(pair), usize::from(pair.image != [0; 3]));
            all[across] += 1;
            seen[across] += usize::from(!ends.is_empty());
            drawn += ends.len();
            ends.iter().for_each(|(_, [a, b])| segment(&mut lines[across], *a, *b));
            match depth(self.periodic, pair) {
                0.0 => self.mark(&mut tangents, &ends),
                depth if depth < NEAR => self.mark(&mut nearly, &ends),
                _ => {}
            }
        }
        for &pair in &self.pairs.near {
            let ends = self.seen(pair);
            ends.iter().for_each(|(_, [a, b])| segment(&mut apart, *a, *b));
            self.mark(&mut nearly, &ends);
        }
        let (width, small, rim) =
            if drawn > CROWD { ("0.5", 1.2, "0.6") } else { ("1.8", 3.5, "1.6") };
        for (across, lines) in lines.into_iter().enumerate() {
            let colour = [CONTACT, ACROSS][across];
            let line = format!("stroke=\"{colour}\" stroke-width=\"{width}\" fill=\"none\"");
            if !lines.is_empty() {
                self.body += &format!("<path d=\"{lines}\" {line}/>\n");
            }
            let (seen, all) = (seen[across], all[across]);
            let of = match self.plane.slice {
                Some(_) => format!(" of {all}, those with both spheres in the slice"),
                None => String::new(),
            };
            let meaning = match across {
                0 => format!("contacts: {seen}{of}"),
                _ if !self.periodic.lattice().repeats() => continue,
                _ => format!(
                    "contacts across the box: {seen}{of}; each is drawn from both sides, to the \
                     image (dashed, pale) that is touched"
                ),
            };
            self.rows.push((format!("<path d=\"M0 0H32\" {line}/>"), meaning));
        }
        if !apart.is_empty() {
            self.body += &format!(
                "<path d=\"{apart}\" stroke=\"{TANGENT}\" stroke-dasharray=\"1 4\" \
                 stroke-width=\"1.8\" stroke-linecap=\"round\" fill=\"none\"/>\n"
            );
        }
        let about = "nearly tangent: gap (dotted) or overlap under a millionth of the radius";
        for (marks, fill, text) in [(tangents, TANGENT, "exactly tangent"), (nearly, "#fff", about)]
        {
            let look = format!(
                "r=\"{small}\" fill=\"{fill}\" stroke=\"{TANGENT}\" stroke-width=\"{rim}\""
            );
            if !marks.at.is_empty() {
                let meaning = format!("{text}: {}", marks.pairs);
                self.rows.push((format!("<circle cx=\"16\" {look}/>"), meaning));
                self.body.extend(marks.at.iter().map(|[x, y]| {
                    format!("<circle cx=\"{}\" cy=\"{}\" {look}/>\n", px(*x), px(*y))
                }));
            }
        }
    }

    /// Marks the points where the bodies of these lines touch.
    fn mark(&self, marks: &mut Marks, lines: &[([u32; 2], [[f64; 2]; 2])]) {
        marks.pairs += usize::from(!lines.is_empty());
        for &(bodies, [a, b]) in lines {
            let [ri, rj] = bodies.map(|k| self.bodies.all[k as usize].r * self.plane.factor);
            let part = if ri + rj > 0.0 { ri / (ri + rj) } else { 0.5 };
            marks.at.push([0, 1].map(|k| a[k] + (b[k] - a[k]) * part));
        }
    }

    /// Lines that must be seen: what a list got wrong.
    pub(super) fn wrong(&mut self, pairs: &[ImagePair], colour: &str, dash: &str, meaning: &str) {
        if pairs.is_empty() {
            return;
        }
        let dash = match dash {
            "" => String::new(),
            dash => format!(" stroke-dasharray=\"{dash}\""),
        };
        let look = format!("stroke=\"{colour}\" stroke-width=\"3\"{dash} fill=\"none\"");
        let mut lines = String::new();
        for (bodies, [a, b]) in pairs.iter().flat_map(|pair| self.seen(*pair)) {
            if a != b {
                segment(&mut lines, a, b);
                continue;
            }
            // A particle with itself, or two in one place: a ring, as a path of two arcs.
            let r = self.plane.circle(bodies[0]).map_or(0.0, |circle| self.page.length(circle.r));
            let r = (0.6 * r).max(4.0);
            let (left, right, y, r) = (px(a[0] - r), px(a[0] + r), px(a[1]), px(r));
            lines += &format!("M{left} {y}A{r} {r} 0 1 0 {right} {y}A{r} {r} 0 1 0 {left} {y}");
        }
        self.body += &format!("<path d=\"{lines}\" {look}/>\n");
        let (drawn, all) = (self.count(pairs), pairs.len());
        let of = if drawn < all { format!(" of {all}") } else { String::new() };
        self.rows
            .push((format!("<path d=\"M0 0H32\" {look}/>"), format!("{meaning}: {drawn}{of}")));
    }
}
