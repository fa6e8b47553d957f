//! The picture: title, grid, circles, pairs, numbers, legend.

use crate::contact::{Test, any_bodies};
use crate::filter::Cells;
use crate::number::wrap;
use crate::present::draw::flat::Flat;
use crate::present::draw::page_coordinates::PageCoordinates;
use crate::present::draw::pairs::{Highlighted, NEAR, depth_of};
use crate::present::draw::{LABELLED, Look};
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
const CONTACT: &str = "#0b5394";
const TANGENT: &str = "#7b2d8e";
const MISSED: &str = "#d11507";
const SPURIOUS: &str = "#e07b00";

/// A picture to be drawn.
pub struct Sheet<'a> {
    scene: &'a AnyScene<'a>,
    flat: &'a Flat,
    pairs: &'a Highlighted,
    look: &'a Look,
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
    ) -> Sheet<'a> {
        let bounds = flat.bounds().unwrap_or([[0.0; 2], [1.0; 2]]);
        let width = PageCoordinates::around(bounds, MOST, HEADER).size[0];
        let bodies = if scene.dim() == 2 { "discs" } else { "spheres" };
        let met = flat.circles.len();
        let slice = flat.slice.map(|slice| {
            let meet = if detail.is_none() { format!(": {met} meet it") } else { String::new() };
            format!(", slice {} = {}{meet}", ["x", "y", "z"][slice.axis], slice.at)
        });
        let detail = detail.map(|[i, j]| format!(", around {i} and {j}: the worst mistake"));
        let subtitle = [slice, detail].map(Option::unwrap_or_default).concat();
        let subtitle = format!("{} {bodies}{subtitle}", scene.len());
        let title = wrap(&look.title, (width / TITLE_LETTER) as usize);
        let subtitle = wrap(&subtitle, (width / LETTER) as usize);
        let header = HEADER + TITLE * (title.len() - 1) as f64 + LINE * (subtitle.len() - 1) as f64;
        let page = PageCoordinates::around(bounds, MOST, header);
        let (rows, body) = (Vec::new(), String::new());
        Sheet { scene, flat, pairs, look, page, title, subtitle, header, rows, body }
    }

    /// Draws it.
    pub fn draw(mut self) -> String {
        if self.look.grid {
            self.grid();
        }
        self.circles();
        self.contacts();
        let pairs = self.pairs;
        self.wrong(&pairs.duplicates, SPURIOUS, "2 4", "reported more than once");
        self.wrong(&pairs.spurious, SPURIOUS, "", "spurious: reported, but apart");
        self.wrong(&pairs.missed, MISSED, "9 5", "missed: touching, but not reported");
        if self.look.labels.unwrap_or(self.flat.circles.len() <= LABELLED) {
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
        let rim = if crowd { String::new() } else { format!(" stroke=\"{RIM}\"") };
        // Points, and discs too small to be seen, are dots.
        let least = if crowd { 0.5 } else { 1.6 };
        let (mut discs, mut dots) = (String::new(), String::new());
        for circle in &self.flat.circles {
            let ([x, y], r) = (self.page.at(circle.at).map(px), self.page.length(circle.r));
            if r < least {
                dots += &format!("M{x} {y}h0");
            } else {
                discs += &format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{}\"/>\n", px(r));
            }
        }
        self.body += &format!("<g fill=\"{DISC}\"{rim}>\n{discs}</g>\n");
        if !dots.is_empty() {
            let width = px(2.0 * least);
            self.body += &format!(
                "<path d=\"{dots}\" stroke=\"{RIM}\" stroke-width=\"{width}\" \
                 stroke-linecap=\"round\" fill=\"none\"/>\n"
            );
        }
    }

    /// Centres of a pair on the sheet, if both are there.
    fn ends(&self, [i, j]: [u32; 2]) -> Option<[[f64; 2]; 2]> {
        Some([self.page.at(self.flat.circle(i)?.at), self.page.at(self.flat.circle(j)?.at)])
    }

    fn contacts(&mut self) {
        let (mut lines, mut tangents, mut nearly, mut apart) =
            (String::new(), Vec::new(), Vec::new(), String::new());
        let mut drawn = 0;
        for &pair in &self.pairs.contacts {
            let Some([a, b]) = self.ends(pair) else { continue };
            drawn += 1;
            segment(&mut lines, a, b);
            let depth = depth_of(self.scene, pair);
            if depth == 0.0 {
                tangents.push(self.between(pair, a, b));
            } else if depth < NEAR {
                nearly.push(self.between(pair, a, b));
            }
        }
        for &pair in &self.pairs.near {
            let Some([a, b]) = self.ends(pair) else { continue };
            segment(&mut apart, a, b);
            nearly.push(self.between(pair, a, b));
        }
        let width = if drawn > CROWD { "0.5" } else { "1.8" };
        let (line, dotted) = (
            format!("stroke=\"{CONTACT}\" stroke-width=\"{width}\" fill=\"none\""),
            format!(
                "stroke=\"{TANGENT}\" stroke-dasharray=\"1 4\" stroke-width=\"1.8\" \
                 stroke-linecap=\"round\" fill=\"none\""
            ),
        );
        if !lines.is_empty() {
            self.body += &format!("<path d=\"{lines}\" {line}/>\n");
        }
        if !apart.is_empty() {
            self.body += &format!("<path d=\"{apart}\" {dotted}/>\n");
        }
        let all = self.pairs.contacts.len();
        let of = if self.flat.slice.is_some() {
            format!(" of {all}, those with both spheres in the slice")
        } else {
            String::new()
        };
        self.rows.push((format!("<path d=\"M0 0H32\" {line}/>"), format!("contacts: {drawn}{of}")));
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
                    format!("{text}: {}", marks.len()),
                ));
                self.body.extend(marks.iter().map(|[x, y]| {
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
    fn wrong(&mut self, pairs: &[[u32; 2]], colour: &str, dash: &str, meaning: &str) {
        if pairs.is_empty() {
            return;
        }
        let look = format!(
            "stroke=\"{colour}\" stroke-width=\"3\" stroke-dasharray=\"{dash}\" fill=\"none\""
        );
        let look = if dash.is_empty() { look.replace(" stroke-dasharray=\"\"", "") } else { look };
        let (mut lines, mut drawn) = (String::new(), 0);
        for &pair in pairs {
            let Some([a, b]) = self.ends(pair) else { continue };
            drawn += 1;
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
        let of = if drawn < pairs.len() { format!(" of {}", pairs.len()) } else { String::new() };
        self.rows
            .push((format!("<path d=\"M0 0H32\" {look}/>"), format!("{meaning}: {drawn}{of}")));
    }

    fn labels(&mut self) {
        let mut texts = String::new();
        for circle in &self.flat.circles {
            let [x, y] = self.page.at(circle.at);
            let size = (0.8 * self.page.length(circle.r)).clamp(8.0, 17.0);
            texts += &format!(
                "<text x=\"{}\" y=\"{}\" font-size=\"{}\">{}</text>\n",
                px(x),
                px(y + 0.36 * size),
                px(size),
                circle.id
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
