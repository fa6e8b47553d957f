//! The picture: title, circles, box, pairs, numbers, legend.

use crate::draw::particles::{Particle, Particles};
use crate::draw::plane::{Circle, Plane};
use crate::draw::{Look, Pairs};
use crate::{px, segment};
use contactbench_ground::periodic::{ImagePair, Periodic};
use contactbench_io::boxes::{along, outside};
use contactbench_terms::number::wrap;
use contactbench_terms::text;

/// Maximum width and height of the drawing, its margin, and the least width of a picture, in
/// pixels.
const MOST: [f64; 2] = [960.0, 720.0];
const MARGIN: f64 = 14.0;
const NARROWEST: f64 = 450.0;
/// Height of a line of text, and width of a letter of the title and of another letter, in pixels.
const LINE: f64 = 20.0;
const LETTERS: [f64; 2] = [11.0, 8.0];
/// Width of a mark in the legend, in pixels.
const MARK: f64 = 44.0;
/// Smallest radius in pixels at which a circle can be seen among others.
const SEEN: f64 = 6.0;
/// Number of lines or circles from which they are thin.
const CROWD: usize = 3000;
/// Maximum number of particles whose numbers are shown.
const LABELLED: usize = 60;

const CONTACT: &str = "#0b5394";
const MISSED: &str = "#d11507";
const SPURIOUS: &str = "#e07b00";

pub struct Sheet<'a> {
    pub periodic: &'a Periodic<'a>,
    pub particles: &'a Particles,
    pub plane: &'a Plane,
    pub pairs: &'a Pairs,
    pub look: &'a Look,
    /// Pair whose neighbourhood alone is drawn; `None` for the whole scene.
    pub detail: Option<[u32; 2]>,
}

/// Conversion from the plane of the scene to pixels. The y axis points up in the scene and down on
/// the page.
struct Scale {
    low: [f64; 2],
    factor: f64,
    corner: [f64; 2],
    size: [f64; 2],
}

impl Scale {
    /// Fits a rectangle into [`MOST`] below `top` pixels.
    fn new([low, high]: [[f64; 2]; 2], top: f64) -> Scale {
        let extent = [0, 1].map(|k| high[k] - low[k]);
        let fits = |k: usize| if extent[k] > 0.0 { MOST[k] / extent[k] } else { f64::INFINITY };
        // The scale of a single point is arbitrary.
        let factor = Some(fits(0).min(fits(1))).filter(|it| it.is_finite()).unwrap_or(MOST[1]);
        let drawn = extent.map(|x| x * factor);
        let size = [(drawn[0] + 2.0 * MARGIN).max(NARROWEST), drawn[1] + 4.0 * MARGIN];
        let corner = [0.5 * (size[0] - drawn[0]), top + 0.5 * (size[1] + drawn[1])];
        Scale { low, factor, corner, size }
    }

    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [
            self.corner[0] + (x - self.low[0]) * self.factor,
            self.corner[1] - (y - self.low[1]) * self.factor,
        ]
    }

    fn length(&self, length: f64) -> f64 {
        length * self.factor
    }
}

/// Returns whether a pair is too small to be seen in a picture of the whole scene.
pub fn too_small(plane: &Plane, [i, j]: [u32; 2]) -> bool {
    let scale = Scale::new(plane.bounds(&[]), 0.0);
    let radii = [i, j].map(|k| plane.circle(k).map_or(f64::INFINITY, |circle| circle.r));
    scale.length(radii[0].min(radii[1])) < SEEN
}

/// Returns lines of text with their first at `y`, wrapped to `width` pixels, and the y below them.
fn texts(words: &str, [x, mut y]: [f64; 2], width: f64, letter: f64, look: &str) -> (String, f64) {
    let mut svg = String::new();
    for line in wrap(words, ((width - x) / letter) as usize) {
        let ([x, at], line) = ([x, y].map(px), text::html(&line));
        svg += &format!("<text x=\"{x}\" y=\"{at}\"{look}>{line}</text>\n");
        y += LINE;
    }
    (svg, y)
}

impl Sheet<'_> {
    pub fn svg(&self) -> String {
        let Sheet { plane, detail, .. } = self;
        let lattice = self.periodic.lattice();
        let whole = lattice.repeats() && detail.is_none();
        let outline = if whole { plane.outline(lattice) } else { Vec::new() };
        let bounds = plane.bounds(&outline);
        let width = Scale::new(bounds, 0.0).size[0];
        let bold = " font-size=\"16\" font-weight=\"bold\"";
        let (title, y) = texts(&self.look.title, [MARGIN, 22.0], width, LETTERS[0], bold);
        let grey = " fill=\"#555\"";
        let (subtitle, top) = texts(&self.subtitle(), [MARGIN, y], width, LETTERS[1], grey);
        let scale = Scale::new(bounds, top - LINE);
        let mut picture = format!("{title}{subtitle}{}", self.circles(&scale));
        if !outline.is_empty() {
            let points = outline.iter().map(|point| scale.at(*point).map(px).join(","));
            let points = points.collect::<Vec<_>>().join(" ");
            picture += &format!("<polygon points=\"{points}\" fill=\"none\" stroke=\"#555\"/>\n");
        }
        let (pairs, y) = self.pairs(&scale, top + scale.size[1], width);
        picture += &pairs;
        let own = plane.circles().filter(|circle| !self.body(circle).is_image());
        if own.count() <= LABELLED {
            picture += &self.numbers(&scale);
        }
        let (w, h, title) = (px(width), px(y), text::html(&self.look.title));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 \
             {w} {h}\" font-family=\"DejaVu Sans, Verdana, sans-serif\" font-size=\"13\" \
             fill=\"#222\">\n<title>{title}</title>\n<rect width=\"{w}\" height=\"{h}\" \
             fill=\"#fff\"/>\n{picture}</svg>\n"
        )
    }

    /// Draws the pairs, and the legend at `y`. Returns the y below it.
    fn pairs(&self, scale: &Scale, mut y: f64, width: f64) -> (String, f64) {
        let Pairs { contacts, duplicates, spurious, missed } = self.pairs;
        let look = |colour: &str, width: &str, dash: &str| {
            let line = format!("stroke=\"{colour}\" stroke-width=\"{width}\"");
            format!("{line} stroke-dasharray=\"{dash}\" fill=\"none\"")
        };
        let thin = if contacts.len() > CROWD { "0.5" } else { "2" };
        let mut svg = String::new();
        for (all, look, meaning) in [
            (contacts, look(CONTACT, thin, "none"), "contacts"),
            (duplicates, look(SPURIOUS, "3", "2 4"), "reported more than once"),
            (spurious, look(SPURIOUS, "3", "none"), "spurious: reported, but apart"),
            (missed, look(MISSED, "3", "9 5"), "missed: touching, but not reported"),
        ] {
            if !all.is_empty() {
                let (lines, drawn) = self.lines(scale, all);
                let of =
                    if drawn < all.len() { format!(" of {}", all.len()) } else { String::new() };
                let (words, mark) = (format!("{meaning}: {drawn}{of}"), px(y - 5.0));
                let (row, below) = texts(&words, [MARGIN + MARK, y], width, LETTERS[1], "");
                svg += &format!("<path d=\"{lines}\" {look}/>\n");
                svg += &format!("<path d=\"M{MARGIN} {mark}h32\" {look}/>\n{row}");
                y = below;
            }
        }
        (svg, y)
    }

    fn subtitle(&self) -> String {
        let (scene, lattice) = (self.periodic.scene(), self.periodic.lattice());
        let count = scene.len();
        let mut words = format!("{count} {}", if scene.dim() == 2 { "discs" } else { "spheres" });
        if lattice.repeats() {
            let centres = self.particles.all[..count].iter().map(|body| body.centre);
            let outside = outside(centres, lattice).len();
            let axes = along(lattice.periodic());
            words += &format!(" in a box periodic along {axes}, {outside} outside it");
        }
        if let Some(slice) = self.plane.slice {
            words += &format!(", slice {} = {}", slice.name(), slice.at);
        }
        if let Some(pair) = self.detail {
            let [i, j] = pair.map(|body| self.particles.all[body as usize].particle);
            words += &format!(", around {i} and {j}: the worst error");
        }
        words
    }

    fn body(&self, circle: &Circle) -> &Particle {
        &self.particles.all[circle.id as usize]
    }

    /// Draws the particles, and above them the images: pale and dashed.
    fn circles(&self, scale: &Scale) -> String {
        let circles = self.plane.circles();
        let rim = if circles.clone().count() > CROWD { "0.2" } else { "1" };
        let mut groups = [String::new(), String::new()];
        for circle in circles {
            // Points and very small discs are dots.
            let ([x, y], r) = (scale.at(circle.at).map(px), scale.length(circle.r).max(0.8));
            groups[usize::from(self.body(circle).is_image())] +=
                &format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{}\"/>\n", px(r));
        }
        let [own, images] = groups;
        format!(
            "<g fill=\"#dde6f0\" stroke=\"#73859c\" stroke-width=\"{rim}\">\n{own}</g>\n<g \
             fill=\"#f6f3ea\" stroke=\"#b3a987\" stroke-dasharray=\"4 3\">\n{images}</g>\n"
        )
    }

    /// Returns the lines of pairs whose ends are both in the plane, and the number of these pairs.
    fn lines(&self, scale: &Scale, pairs: &[ImagePair]) -> (String, usize) {
        let (mut path, mut drawn) = (String::new(), 0);
        for pair in pairs {
            let ends = |[a, b]: [u32; 2]| Some([self.plane.circle(a)?, self.plane.circle(b)?]);
            let before = path.len();
            for [a, b] in self.particles.lines(*pair).filter_map(ends) {
                let (from, to) = (scale.at(a.at), scale.at(b.at));
                if from != to {
                    segment(&mut path, from, to);
                    continue;
                }
                // A particle paired with itself, or two at one place, get a ring of two arcs.
                let r = (0.6 * scale.length(a.r)).max(4.0);
                let (left, right, y, r) = (px(from[0] - r), px(from[0] + r), px(from[1]), px(r));
                path += &format!("M{left} {y}A{r} {r} 0 1 0 {right} {y}A{r} {r} 0 1 0 {left} {y}");
            }
            drawn += usize::from(path.len() > before);
        }
        (path, drawn)
    }

    fn numbers(&self, scale: &Scale) -> String {
        let number = |circle: &Circle| {
            let ([x, y], body) = (scale.at(circle.at), self.body(circle));
            let size = (0.8 * scale.length(circle.r)).clamp(8.0, 17.0);
            let ([x, y, size], k) = ([x, y + 0.36 * size, size].map(px), body.particle);
            let pale = if body.is_image() { " fill=\"#8a8167\"" } else { "" };
            format!("<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\"{pale}>{k}</text>\n")
        };
        format!(
            "<g text-anchor=\"middle\" font-weight=\"bold\" stroke=\"#fff\" stroke-width=\"3\" \
             stroke-linejoin=\"round\" paint-order=\"stroke\">\n{}</g>\n",
            self.plane.circles().map(number).collect::<String>()
        )
    }
}
