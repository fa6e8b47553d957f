//! The lines of the picture: contacts, and the errors of a list.

use super::{CROWD, Picture};
use crate::draw::pairs::NEAR;
use crate::{px, segment};
use contactbench_ground::periodic::{ImagePair, depth};

const CONTACT: &str = "#0b5394";
const ACROSS: &str = "#0f8577";
const TANGENT: &str = "#7b2d8e";

/// Particles of a pair, and their centres on the page.
type Line = ([u32; 2], [[f64; 2]; 2]);

/// Points of contact of tangent pairs of one kind, and the number of these pairs.
#[derive(Default)]
struct Marks {
    at: Vec<[f64; 2]>,
    pairs: usize,
}

#[derive(Default)]
struct Contacts {
    all: usize,
    seen: usize,
    lines: String,
}

impl Picture<'_> {
    /// Returns the lines of a pair whose ends are both on the sheet.
    fn seen(&self, pair: ImagePair) -> Vec<Line> {
        let at = |body: u32| Some(self.page.at(self.sheet.plane.circle(body)?.at));
        let ends = |[a, b]: [u32; 2]| Some(([a, b], [at(a)?, at(b)?]));
        self.sheet.bodies.lines(pair).filter_map(ends).collect()
    }

    pub(super) fn contacts(&mut self) {
        let (pairs, periodic) = (self.sheet.pairs, self.sheet.periodic);
        let (mut contacts, mut drawn) = (<[Contacts; 2]>::default(), 0);
        let (mut tangents, mut nearly, mut apart) =
            (Marks::default(), Marks::default(), String::new());
        for &pair in &pairs.contacts {
            let ends = self.seen(pair);
            let of = &mut contacts[usize::from(pair.image != [0; 3])];
            of.all += 1;
            of.seen += usize::from(!ends.is_empty());
            drawn += ends.len();
            ends.iter().for_each(|(_, [a, b])| segment(&mut of.lines, *a, *b));
            match depth(periodic, pair) {
                0.0 => self.mark(&mut tangents, &ends),
                depth if depth < NEAR => self.mark(&mut nearly, &ends),
                _ => {}
            }
        }
        for &pair in &pairs.near {
            let ends = self.seen(pair);
            ends.iter().for_each(|(_, [a, b])| segment(&mut apart, *a, *b));
            self.mark(&mut nearly, &ends);
        }
        let (width, small, rim) =
            if drawn > CROWD { ("0.5", 1.2, "0.6") } else { ("1.8", 3.5, "1.6") };
        for (across, Contacts { all, seen, lines }) in contacts.iter().enumerate() {
            let colour = [CONTACT, ACROSS][across];
            let look = format!("stroke=\"{colour}\" stroke-width=\"{width}\"");
            self.path(lines, &look);
            let of = match self.sheet.plane.slice {
                Some(_) => format!(" of {all}, those with both spheres in the slice"),
                None => String::new(),
            };
            if across == 0 {
                self.meaning(&look, format!("contacts: {seen}{of}"));
            } else if periodic.lattice().repeats() {
                let how = "each is drawn from both sides, to the image (dashed, pale) that is \
                           touched";
                self.meaning(&look, format!("contacts across the box: {seen}{of}; {how}"));
            }
        }
        let dots = format!(
            "stroke=\"{TANGENT}\" stroke-dasharray=\"1 4\" stroke-width=\"1.8\" \
             stroke-linecap=\"round\""
        );
        self.path(&apart, &dots);
        let about = "nearly tangent: gap (dotted) or overlap under a millionth of the radius";
        for (marks, fill, text) in [(tangents, TANGENT, "exactly tangent"), (nearly, "#fff", about)]
        {
            let look = format!(
                "r=\"{small}\" fill=\"{fill}\" stroke=\"{TANGENT}\" stroke-width=\"{rim}\""
            );
            if !marks.at.is_empty() {
                let meaning = format!("{text}: {}", marks.pairs);
                self.rows.push((format!("<circle cx=\"16\" {look}/>"), meaning));
            }
            for [x, y] in marks.at.iter().map(|at| at.map(px)) {
                self.body += &format!("<circle cx=\"{x}\" cy=\"{y}\" {look}/>\n");
            }
        }
    }

    fn mark(&self, marks: &mut Marks, lines: &[Line]) {
        marks.pairs += usize::from(!lines.is_empty());
        for &(bodies, [a, b]) in lines {
            let sheet = self.sheet;
            let [ri, rj] = bodies.map(|k| sheet.bodies.all[k as usize].r * sheet.plane.factor);
            let part = if ri + rj > 0.0 { ri / (ri + rj) } else { 0.5 };
            marks.at.push([0, 1].map(|k| a[k] + (b[k] - a[k]) * part));
        }
    }

    /// Draws the errors of a list, so that each can be seen.
    pub(super) fn wrong(&mut self, pairs: &[ImagePair], colour: &str, dash: &str, meaning: &str) {
        if pairs.is_empty() {
            return;
        }
        let (mut lines, mut drawn) = (String::new(), 0);
        for pair in pairs {
            let seen = self.seen(*pair);
            drawn += usize::from(!seen.is_empty());
            for (bodies, [a, b]) in seen {
                if a != b {
                    segment(&mut lines, a, b);
                    continue;
                }
                // A particle paired with itself, or two at one place, get a ring of two arcs.
                let circle = self.sheet.plane.circle(bodies[0]);
                let r = circle.map_or(0.0, |circle| self.page.length(circle.r));
                let r = (0.6 * r).max(4.0);
                let (left, right, y, r) = (px(a[0] - r), px(a[0] + r), px(a[1]), px(r));
                lines += &format!("M{left} {y}A{r} {r} 0 1 0 {right} {y}A{r} {r} 0 1 0 {left} {y}");
            }
        }
        let look = format!("stroke=\"{colour}\" stroke-width=\"3\"{dash}");
        self.body += &format!("<path d=\"{lines}\" {look} fill=\"none\"/>\n");
        let all = pairs.len();
        let of = if drawn < all { format!(" of {all}") } else { String::new() };
        self.meaning(&look, format!("{meaning}: {drawn}{of}"));
    }
}
