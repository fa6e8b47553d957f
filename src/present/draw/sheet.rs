//! The picture: title, grid, circles, pairs ([`lines`]), numbers, legend.

mod lines;

use crate::check::listed::particle;
use crate::contact::{Test, any_bodies};
use crate::filter::Cells;
use crate::io::boxes::{along, outside};
use crate::number::wrap;
use crate::present::draw::flat::Flat;
use crate::present::draw::outline::{Face, faces};
use crate::present::draw::page_coordinates::PageCoordinates;
use crate::present::draw::pairs::Highlighted;
use crate::present::draw::{Boxed, LABELLED, Look};
use crate::present::escape;
use crate::present::svg::{px, segment};
use crate::scene::{AnyScene, Real, Scene};
use crate::with_scene;

/// The most pixels of the drawing, without margins and text.
const MOST: [f64; 2] = [960.0, 720.0];
const HEADER: f64 = 46.0;
const ROW: f64 = 22.0;
/// From one line of the title to the next, and from one of other text.
const TITLE: f64 = 20.0;
const LINE: f64 = 17.0;
/// Pixels that a letter takes, in the title and elsewhere; and the left and right of the legend.
const TITLE_LETTER: f64 = 11.0;
const LETTER: f64 = 8.0;
const LEGEND: f64 = 74.0;
/// Circles with a smaller radius than this many pixels are not seen among others.
const SEEN: f64 = 6.0;
/// From here on, circles have no outline and lines are thin.
const CROWD: usize = 3000;
/// More grid lines than this along an axis are a surface.
const MOST_LINES: f64 = 400.0;

const DISC: &str = "#dde6f0";
const RIM: &str = "#73859c";
/// The images of particles in a box, and the box.
const IMAGE: &str = "#f6f3ea";
const IMAGE_RIM: &str = "#b3a987";
const BOX: &str = "#555";
const MISSED: &str = "#d11507";
const SPURIOUS: &str = "#e07b00";

/// A picture to be drawn.
pub struct Sheet<'a> {
    scene: &'a AnyScene<'a>,
    flat: &'a Flat,
    pairs: &'a Highlighted,
    look: &'a Look,
    /// Where it repeats: its box, and which bodies are images.
    boxed: Option<&'a Boxed<'a>>,
    faces: Vec<Face>,
    page: PageCoordinates,
    /// The lines of the title.
    title: Vec<String>,
    /// What lies under it.
    subtitle: Vec<String>,
    /// The pixels of both.
    header: f64,
    /// Rows below the drawing: a mark, and what it means.
    rows: Vec<(String, String)>,
    body: String,
}

impl<'a> Sheet<'a> {
    /// An empty sheet, large enough.
    pub fn new(
        scene: &'a AnyScene<'a>,
        flat: &'a Flat,
        pairs: &'a Highlighted,
        look: &'a Look,
        detail: Option<[u32; 2]>,
        boxed: Option<&'a Boxed<'a>>,
    ) -> Sheet<'a> {
        let view = flat.bounds().filter(|_| detail.is_some());
        let faces = boxed.map_or(Vec::new(), |boxed| faces(flat, boxed.periodic.lattice(), view));
        let bounds = around(flat, &faces).unwrap_or([[0.0; 2], [1.0; 2]]);
        let width = PageCoordinates::around(bounds, MOST, HEADER).size[0];
        let bodies = if scene.dim() == 2 { "discs" } else { "spheres" };
        let own = |body: u32| boxed.is_none_or(|boxed| boxed.body(body) == (body, [0; 3]));
        let met = flat.circles.iter().filter(|circle| own(circle.id)).count();
        let slice = flat.slice.map(|slice| {
            let meet = if detail.is_none() { format!(": {met} meet it") } else { String::new() };
            format!(", slice {} = {}{meet}", ["x", "y", "z"][slice.axis], slice.at)
        });
        let name = |body: u32| boxed.map_or(body, |boxed| boxed.body(body).0);
        let detail = detail.map(|pair| {
            let [i, j] = pair.map(name);
            format!(", around {i} and {j}: the worst mistake")
        });
        let repeats = boxed.map(|boxed| {
            let (scene, lattice) = (boxed.periodic.scene(), boxed.periodic.lattice());
            let centre = |k: u32| {
                let centre = particle(scene, k).0;
                std::array::from_fn(|axis| centre.get(axis).copied().unwrap_or(0.0))
            };
            let outside = match outside((0..scene.len() as u32).map(centre), lattice).len() {
                0 => String::new(),
                count => format!(", {count} outside it"),
            };
            format!(" in a box that repeats along {}{outside}", along(lattice.periodic()))
        });
        let subtitle = [repeats, slice, detail].map(Option::unwrap_or_default).concat();
        let count = boxed.map_or(scene.len(), |boxed| boxed.periodic.scene().len());
        let subtitle = format!("{count} {bodies}{subtitle}");
        let title = wrap(&look.title, (width / TITLE_LETTER) as usize);
        let subtitle = wrap(&subtitle, (width / LETTER) as usize);
        let header = HEADER + TITLE * (title.len() - 1) as f64 + LINE * (subtitle.len() - 1) as f64;
        let page = PageCoordinates::around(bounds, MOST, header);
        let (rows, body) = (Vec::new(), String::new());
        Sheet { scene, flat, pairs, look, boxed, faces, page, title, subtitle, header, rows, body }
    }

    /// Draws it.
    pub fn draw(mut self) -> String {
        if self.look.grid {
            self.grid();
        }
        self.circles();
        self.faces();
        self.contacts();
        let pairs = self.pairs;
        self.wrong(&pairs.duplicates, SPURIOUS, "2 4", "reported more than once");
        self.wrong(&pairs.spurious, SPURIOUS, "", "spurious: reported, but apart");
        self.wrong(&pairs.missed, MISSED, "9 5", "missed: touching, but not reported");
        let own = self.flat.circles.iter().filter(|circle| !self.is_image(circle.id)).count();
        if self.look.labels.unwrap_or(own <= LABELLED) {
            self.labels();
        }
        self.finish()
    }

    fn finish(self) -> String {
        let Sheet { look, page, title, subtitle, header, rows, body, .. } = self;
        let width = page.size[0];
        let most = ((width - LEGEND) / LETTER) as usize;
        let mut legend = String::new();
        let mut y = header + page.size[1];
        for (mark, text) in rows {
            legend += &format!("<g transform=\"translate(16 {})\">{mark}", px(y + 0.5 * ROW));
            for (k, line) in wrap(&text, most).iter().enumerate() {
                let at = px(5.0 + LINE * k as f64);
                legend += &format!("<text x=\"44\" y=\"{at}\">{}</text>", escape::html(line));
                y += if k == 0 { ROW } else { LINE };
            }
            legend += "</g>\n";
        }
        let height = y + 14.0;
        let (mut texts, mut y) = (String::new(), 22.0);
        for line in &title {
            let bold = "font-size=\"16\" font-weight=\"bold\"";
            let line = escape::html(line);
            texts += &format!("<text x=\"14\" y=\"{}\" {bold}>{line}</text>\n", px(y));
            y += TITLE;
        }
        for line in &subtitle {
            let (at, line) = (px(y - 1.0), escape::html(line));
            texts += &format!("<text x=\"14\" y=\"{at}\" fill=\"#555\">{line}</text>\n");
            y += LINE;
        }
        let whole = escape::html(&look.title);
        let (w, h) = (px(width), px(height));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 \
             {w} {h}\" font-family=\"DejaVu Sans, Verdana, sans-serif\" font-size=\"13\" \
             fill=\"#222\">\n<title>{whole}</title>\n<rect width=\"{w}\" height=\"{h}\" \
             fill=\"#fff\"/>\n{texts}{body}{legend}</svg>\n"
        )
    }

    fn circles(&mut self) {
        let crowd = self.flat.circles.len() > CROWD;
        // Points, and discs too small to be seen, are dots.
        let least = if crowd { 0.5 } else { 1.6 };
        for (images, fill, rim) in [
            (true, IMAGE, format!("{IMAGE_RIM}\" stroke-dasharray=\"4 3")),
            (false, DISC, RIM.into()),
        ] {
            let look = if crowd { String::new() } else { format!(" stroke=\"{rim}\"") };
            let (mut discs, mut dots) = (String::new(), String::new());
            let circles = &self.flat.circles;
            for circle in circles.iter().filter(|circle| self.is_image(circle.id) == images) {
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
            if !dots.is_empty() {
                let (width, rim) = (px(2.0 * least), if images { IMAGE_RIM } else { RIM });
                self.body += &format!(
                    "<path d=\"{dots}\" stroke=\"{rim}\" stroke-width=\"{width}\" \
                     stroke-linecap=\"round\" fill=\"none\"/>\n"
                );
            }
        }
    }

    /// Is the body an image of a particle?
    fn is_image(&self, body: u32) -> bool {
        self.boxed.is_some_and(|boxed| boxed.body(body) != (body, [0; 3]))
    }

    /// The outline of the box.
    fn faces(&mut self) {
        for (repeats, look, meaning) in [
            (true, "stroke-width=\"1.6\"", "faces of the box"),
            (false, "stroke-width=\"1.2\" stroke-dasharray=\"2 5\"", "open faces of the box"),
        ] {
            let mut lines = String::new();
            for face in self.faces.iter().filter(|face| face.repeats == repeats) {
                let [a, b] = face.ends.map(|end| self.page.at(end));
                segment(&mut lines, a, b);
            }
            if !lines.is_empty() {
                let look = format!("stroke=\"{BOX}\" {look} fill=\"none\"");
                self.body += &format!("<path d=\"{lines}\" {look}/>\n");
                self.rows.push((format!("<path d=\"M0 0H32\" {look}/>"), meaning.into()));
            }
        }
    }

    fn labels(&mut self) {
        let mut texts = String::new();
        for circle in &self.flat.circles {
            let [x, y] = self.page.at(circle.at);
            let size = (0.8 * self.page.length(circle.r)).clamp(8.0, 17.0);
            let pale = if self.is_image(circle.id) { " fill=\"#8a8167\"" } else { "" };
            texts += &format!(
                "<text x=\"{}\" y=\"{}\" font-size=\"{}\"{pale}>{}</text>\n",
                px(x),
                px(y + 0.36 * size),
                px(size),
                self.boxed.map_or(circle.id, |boxed| boxed.body(circle.id).0)
            );
        }
        self.body += &format!(
            "<g text-anchor=\"middle\" font-weight=\"bold\" stroke=\"#fff\" stroke-width=\"3\" \
             stroke-linejoin=\"round\" paint-order=\"stroke\">\n{texts}</g>\n"
        );
    }

    fn grid(&mut self) {
        let Some((origin, edge)) = cells(self.scene) else { return };
        let Some([low, high]) = self.flat.bounds() else { return };
        let look = "stroke=\"#b9b9b0\" stroke-width=\"1\" fill=\"none\"";
        let edge_here = edge * self.flat.factor;
        if (0..2).any(|k| (high[k] - low[k]) / edge_here > MOST_LINES) {
            self.rows.push((
                String::new(),
                format!("the cells of edge {edge:e} are too many to be seen"),
            ));
            return;
        }
        let mut lines = String::new();
        for k in 0..2 {
            let first = origin[self.flat.axes[k]] * self.flat.factor;
            let numbers = ((low[k] - first) / edge_here).ceil() as i64
                ..=((high[k] - first) / edge_here).floor() as i64;
            for number in numbers {
                let at = first + number as f64 * edge_here;
                let (mut a, mut b) = (low, high);
                (a[k], b[k]) = (at, at);
                segment(&mut lines, self.page.at(a), self.page.at(b));
            }
        }
        self.body += &format!("<path d=\"{lines}\" {look}/>\n");
        self.rows.push((
            format!("<path d=\"M0 0H32\" {look}/>"),
            format!("cells of edge {edge}, as detectors use them"),
        ));
    }
}

/// The rectangle around all circles and faces.
fn around(flat: &Flat, faces: &[Face]) -> Option<[[f64; 2]; 2]> {
    faces.iter().flat_map(|face| face.ends).fold(flat.bounds(), |bounds, point| {
        let [low, high] = bounds.unwrap_or([point; 2]);
        Some([[0, 1].map(|k| low[k].min(point[k])), [0, 1].map(|k| high[k].max(point[k]))])
    })
}

/// Is a pair too small to be seen in a picture of all circles?
pub fn too_small(flat: &Flat, [i, j]: [u32; 2]) -> bool {
    let Some(bounds) = flat.bounds() else { return false };
    let page = PageCoordinates::around(bounds, MOST, HEADER);
    let radii = [i, j].map(|k| flat.circle(k).map_or(f64::INFINITY, |circle| circle.r));
    page.length(radii[0].min(radii[1])) < SEEN
}

/// The lowest corner of the cells that detectors use, and their edge; none where there are no
/// cells.
fn cells(scene: &AnyScene<'_>) -> Option<(Vec<f64>, f64)> {
    fn corner<T: Real, const D: usize>(scene: &Scene<'_, T, D>) -> Option<(Vec<f64>, f64)> {
        let cells = Cells::new(&any_bodies(scene, Test::Exact).ok()?).ok()?;
        Some((cells.origin().to_vec(), cells.edge()))
    }
    with_scene!(scene, scene => corner(scene))
}
