//! The picture: title, grid, circles, pairs ([`lines`]), numbers, legend.

mod lines;

use crate::draw::bodies::{Bodies, Body};
use crate::draw::outline::{Face, faces};
use crate::draw::page_coordinates::PageCoordinates;
use crate::draw::plane::{Circle, Plane, hull};
use crate::draw::{Highlighted, LABELLED, Look};
use crate::{px, segment};
use contactbench_ground::contact::{Test, any_bodies};
use contactbench_ground::filter::Cells;
use contactbench_ground::periodic::Periodic;
use contactbench_ground::scene::{AnyScene, Real, Scene};
use contactbench_ground::with_scene;
use contactbench_io::boxes::{along, outside};
use contactbench_terms::number::wrap;
use contactbench_terms::text;

/// Maximum width and height of the drawing in pixels, without margins and text.
const MOST: [f64; 2] = [960.0, 720.0];
const HEADER: f64 = 46.0;
const ROW: f64 = 22.0;
/// Line height in pixels: of the title, then of other text.
const TITLE: f64 = 20.0;
const LINE: f64 = 17.0;
/// Widths in pixels: a letter of the title, another letter, and the margins of the legend.
const TITLE_LETTER: f64 = 11.0;
const LETTER: f64 = 8.0;
const LEGEND: f64 = 74.0;
/// Smallest radius in pixels at which a circle can be seen among others.
const SEEN: f64 = 6.0;
/// Number of circles from which circles have no outline and lines are thin.
const CROWD: usize = 3000;
/// Maximum number of grid lines along an axis; more would look like a surface.
const MOST_LINES: f64 = 400.0;

const DISC: &str = "#dde6f0";
const RIM: &str = "#73859c";
const IMAGE: &str = "#f6f3ea";
const IMAGE_RIM: &str = "#b3a987";
const BOX: &str = "#555";
const MISSED: &str = "#d11507";
const SPURIOUS: &str = "#e07b00";

pub struct Sheet<'a> {
    pub periodic: &'a Periodic<'a>,
    pub bodies: &'a Bodies,
    pub plane: &'a Plane,
    pub pairs: &'a Highlighted,
    pub look: &'a Look,
    /// Pair whose neighbourhood alone is drawn; `None` for the whole scene.
    pub detail: Option<[u32; 2]>,
}

struct Picture<'a> {
    sheet: &'a Sheet<'a>,
    page: PageCoordinates,
    /// Rows of the legend below the drawing: a mark and its meaning.
    rows: Vec<(String, String)>,
    body: String,
}

impl Sheet<'_> {
    pub fn svg(&self) -> String {
        let (look, lattice) = (self.look, self.periodic.lattice());
        let view = self.plane.bounds().filter(|_| self.detail.is_some());
        let faces = if lattice.repeats() { faces(self.plane, lattice, view) } else { Vec::new() };
        let corners = faces.iter().flat_map(|face| face.ends).map(|end| [end, end]);
        let bounds = hull(self.plane.bounds().into_iter().chain(corners));
        let bounds = bounds.unwrap_or([[0.0; 2], [1.0; 2]]);
        let width = PageCoordinates::around(bounds, MOST, HEADER).size[0];
        let title = wrap(&look.title, (width / TITLE_LETTER) as usize);
        let subtitle = wrap(&self.subtitle(), (width / LETTER) as usize);
        let header = HEADER + TITLE * (title.len() - 1) as f64 + LINE * (subtitle.len() - 1) as f64;
        let page = PageCoordinates::around(bounds, MOST, header);
        let mut picture = Picture { sheet: self, page, rows: Vec::new(), body: String::new() };
        picture.draw(&faces);
        let Picture { rows, body, .. } = picture;
        let (legend, bottom) = legend(&rows, width, header + page.size[1]);
        let (mut texts, mut y) = (String::new(), 22.0);
        let bold = "font-size=\"16\" font-weight=\"bold\"";
        for line in &title {
            let (at, line) = (px(y), text::html(line));
            texts += &format!("<text x=\"14\" y=\"{at}\" {bold}>{line}</text>\n");
            y += TITLE;
        }
        for line in &subtitle {
            let (at, line) = (px(y - 1.0), text::html(line));
            texts += &format!("<text x=\"14\" y=\"{at}\" fill=\"#555\">{line}</text>\n");
            y += LINE;
        }
        let whole = text::html(&look.title);
        let (w, h) = (px(width), px(bottom + 14.0));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 \
             {w} {h}\" font-family=\"DejaVu Sans, Verdana, sans-serif\" font-size=\"13\" \
             fill=\"#222\">\n<title>{whole}</title>\n<rect width=\"{w}\" height=\"{h}\" \
             fill=\"#fff\"/>\n{texts}{body}{legend}</svg>\n"
        )
    }

    fn subtitle(&self) -> String {
        let (scene, lattice) = (self.periodic.scene(), self.periodic.lattice());
        let count = scene.len();
        let mut said = format!("{count} {}", if scene.dim() == 2 { "discs" } else { "spheres" });
        if lattice.repeats() {
            let centres = self.bodies.all[..count].iter().map(|body| body.centre);
            said += &format!(" in a box periodic along {}", along(lattice.periodic()));
            said += &match outside(centres, lattice).len() {
                0 => String::new(),
                count => format!(", {count} outside it"),
            };
        }
        if let Some(slice) = self.plane.slice {
            said += &format!(", slice {} = {}", slice.name(), slice.at);
            if self.detail.is_none() {
                let met = self.plane.circles().filter(|circle| (circle.id as usize) < count);
                said += &format!(": {} meet it", met.count());
            }
        }
        if let Some(pair) = self.detail {
            let [i, j] = pair.map(|body| self.bodies.all[body as usize].particle);
            said += &format!(", around {i} and {j}: the worst mistake");
        }
        said
    }

    fn body_of(&self, circle: &Circle) -> &Body {
        &self.bodies.all[circle.id as usize]
    }
}

/// Draws the rows of the legend, and returns the y of their lower end.
fn legend(rows: &[(String, String)], width: f64, mut y: f64) -> (String, f64) {
    let most = ((width - LEGEND) / LETTER) as usize;
    let mut legend = String::new();
    for (mark, meaning) in rows {
        legend += &format!("<g transform=\"translate(16 {})\">{mark}", px(y + 0.5 * ROW));
        for (k, line) in wrap(meaning, most).iter().enumerate() {
            let at = px(5.0 + LINE * k as f64);
            legend += &format!("<text x=\"44\" y=\"{at}\">{}</text>", text::html(line));
            y += if k == 0 { ROW } else { LINE };
        }
        legend += "</g>\n";
    }
    (legend, y)
}

impl Picture<'_> {
    fn draw(&mut self, faces: &[Face]) {
        let Sheet { pairs, look, plane, .. } = self.sheet;
        if look.grid {
            self.grid();
        }
        self.circles();
        self.faces(faces);
        self.contacts();
        self.wrong(
            &pairs.duplicates,
            SPURIOUS,
            " stroke-dasharray=\"2 4\"",
            "reported more than once",
        );
        self.wrong(&pairs.spurious, SPURIOUS, "", "spurious: reported, but apart");
        let missed = "missed: touching, but not reported";
        self.wrong(&pairs.missed, MISSED, " stroke-dasharray=\"9 5\"", missed);
        let own = plane.circles().filter(|circle| !self.sheet.body_of(circle).is_image());
        if look.labels.unwrap_or(own.count() <= LABELLED) {
            self.labels();
        }
    }

    fn path(&mut self, lines: &str, look: &str) {
        if !lines.is_empty() {
            self.body += &format!("<path d=\"{lines}\" {look} fill=\"none\"/>\n");
        }
    }

    fn meaning(&mut self, look: &str, meaning: String) {
        self.rows.push((format!("<path d=\"M0 0H32\" {look} fill=\"none\"/>"), meaning));
    }

    fn circles(&mut self) {
        let circles = self.sheet.plane.circles();
        let crowd = circles.clone().count() > CROWD;
        // Points and very small discs are dots.
        let least = if crowd { 0.5 } else { 1.6 };
        for (images, fill, rim, dash) in
            [(true, IMAGE, IMAGE_RIM, "\" stroke-dasharray=\"4 3"), (false, DISC, RIM, "")]
        {
            let look = if crowd { String::new() } else { format!(" stroke=\"{rim}{dash}\"") };
            let (mut discs, mut dots) = (String::new(), String::new());
            let such = |circle: &&Circle| self.sheet.body_of(circle).is_image() == images;
            for circle in circles.clone().filter(such) {
                let ([x, y], r) = (self.page.at(circle.at).map(px), self.page.length(circle.r));
                if r < least {
                    dots += &format!("M{x} {y}h0");
                } else {
                    discs += &format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{}\"/>\n", px(r));
                }
            }
            if !images || !discs.is_empty() {
                self.body += &format!("<g fill=\"{fill}\"{look}>\n{discs}</g>\n");
            }
            let width = px(2.0 * least);
            let look =
                format!("stroke=\"{rim}\" stroke-width=\"{width}\" stroke-linecap=\"round\"");
            self.path(&dots, &look);
        }
    }

    fn faces(&mut self, faces: &[Face]) {
        for (repeats, look, meaning) in [
            (true, "stroke-width=\"1.6\"", "faces of the box"),
            (false, "stroke-width=\"1.2\" stroke-dasharray=\"2 5\"", "open faces of the box"),
        ] {
            let mut lines = String::new();
            for face in faces.iter().filter(|face| face.repeats == repeats) {
                let [a, b] = face.ends.map(|end| self.page.at(end));
                segment(&mut lines, a, b);
            }
            if !lines.is_empty() {
                let look = format!("stroke=\"{BOX}\" {look}");
                self.path(&lines, &look);
                self.meaning(&look, meaning.into());
            }
        }
    }

    fn labels(&mut self) {
        let mut texts = String::new();
        for circle in self.sheet.plane.circles() {
            let [x, y] = self.page.at(circle.at);
            let size = (0.8 * self.page.length(circle.r)).clamp(8.0, 17.0);
            let body = self.sheet.body_of(circle);
            let pale = if body.is_image() { " fill=\"#8a8167\"" } else { "" };
            let ([x, y, size], k) = ([x, y + 0.36 * size, size].map(px), body.particle);
            texts += &format!("<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\"{pale}>{k}</text>\n");
        }
        self.body += &format!(
            "<g text-anchor=\"middle\" font-weight=\"bold\" stroke=\"#fff\" stroke-width=\"3\" \
             stroke-linejoin=\"round\" paint-order=\"stroke\">\n{texts}</g>\n"
        );
    }

    fn grid(&mut self) {
        let plane = self.sheet.plane;
        let Some((origin, edge)) = cells(self.sheet.periodic.scene()) else { return };
        let Some([low, high]) = plane.bounds() else { return };
        let edge_here = edge * plane.factor;
        if (0..2).any(|k| (high[k] - low[k]) / edge_here > MOST_LINES) {
            let meaning = format!("the cells of edge {edge:e} are too many to be seen");
            return self.rows.push((String::new(), meaning));
        }
        let mut lines = String::new();
        for k in 0..2 {
            let first = origin[plane.axes[k]] * plane.factor;
            let numbers = ((low[k] - first) / edge_here).ceil() as i64
                ..=((high[k] - first) / edge_here).floor() as i64;
            for number in numbers {
                let at = first + number as f64 * edge_here;
                let (mut a, mut b) = (low, high);
                (a[k], b[k]) = (at, at);
                segment(&mut lines, self.page.at(a), self.page.at(b));
            }
        }
        let look = "stroke=\"#b9b9b0\" stroke-width=\"1\"";
        self.body += &format!("<path d=\"{lines}\" {look} fill=\"none\"/>\n");
        self.meaning(look, format!("cells of edge {edge}, as detectors use them"));
    }
}

/// Returns whether a pair is too small to be seen in a picture of the whole scene.
pub fn too_small(plane: &Plane, [i, j]: [u32; 2]) -> bool {
    let Some(bounds) = plane.bounds() else { return false };
    let page = PageCoordinates::around(bounds, MOST, HEADER);
    let radii = [i, j].map(|k| plane.circle(k).map_or(f64::INFINITY, |circle| circle.r));
    page.length(radii[0].min(radii[1])) < SEEN
}

/// Returns the lowest corner and the edge length of a detector's cells; `None` without cells.
fn cells(scene: &AnyScene<'_>) -> Option<(Vec<f64>, f64)> {
    fn corner<T: Real, const D: usize>(scene: &Scene<'_, T, D>) -> Option<(Vec<f64>, f64)> {
        let cells = Cells::new(&any_bodies(scene, Test::Exact).ok()?).ok()?;
        Some((cells.origin().to_vec(), cells.edge()))
    }
    with_scene!(scene, scene => corner(scene))
}
