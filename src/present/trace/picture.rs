//! The scene of a step as SVG, and the rules by which it is coloured.

use crate::present::player::palette::Palette;
use crate::present::svg::px;
use crate::present::trace::recorder::Step;
use crate::present::trace::{Algorithm, Trace};

/// Longest side of the grid.
const SIDE: f64 = 700.0;
const MARGIN: f64 = 36.0;

/// The scene of a trace: what stays, and how lengths become pixels.
pub struct Scene {
    edge: f64,
    first: [i64; 2],
    cells: [usize; 2],
    /// Width and height of the panel.
    pub size: [f64; 2],
}

/// What changes from step to step, in two layers: below the discs, and above them. Contacts are
/// between.
pub type Layers = [String; 2];

impl Trace {
    /// The cells that are shown along an axis, as the detector numbers them.
    pub fn shown(&self, axis: usize) -> std::ops::Range<i64> {
        match self.names.book {
            true => 1 - i64::from(self.names.shift[axis])..11 - i64::from(self.names.shift[axis]),
            false => 0..i64::from(self.cells.count[axis]),
        }
    }
}

impl Scene {
    /// The panel of a trace.
    pub fn new(trace: &Trace) -> Scene {
        let cells = [0, 1].map(|axis| trace.shown(axis).count());
        let edge = (SIDE / cells[0].max(cells[1]).max(1) as f64).min(110.0);
        let size = cells.map(|count| count as f64 * edge + MARGIN);
        Scene { edge, first: [0, 1].map(|axis| trace.shown(axis).start), cells, size }
    }

    /// Left and top of a cell.
    fn corner(&self, [column, row]: [i64; 2]) -> [f64; 2] {
        [
            MARGIN + (column - self.first[0]) as f64 * self.edge,
            (self.cells[1] as i64 - 1 - (row - self.first[1])) as f64 * self.edge,
        ]
    }

    fn at(&self, trace: &Trace, point: [f64; 2]) -> [f64; 2] {
        let origin = trace.cells.origin();
        let along = |axis: usize| {
            (point[axis] - origin[axis]) / trace.cells.edge() + (1 - self.first[axis]) as f64
        };
        [MARGIN + along(0) * self.edge, (self.cells[1] as f64 - along(1)) * self.edge]
    }

    /// The border cells, which hold no particles: what lies below everything.
    pub fn ground(&self, trace: &Trace) -> String {
        let inside = |at: i64, axis: usize| at > 0 && at < i64::from(trace.cells.count[axis]) - 1;
        let cells = trace.shown(1).flat_map(|row| trace.shown(0).map(move |column| [column, row]));
        let border = cells
            .filter(|&[column, row]| !(trace.names.book || inside(column, 0) && inside(row, 1)));
        border.map(|cell| self.cell(cell, "border")).collect()
    }

    /// The lines between cells, and the numbers of columns and rows.
    pub fn grid(&self, trace: &Trace) -> String {
        let mut svg = String::new();
        for row in trace.shown(1) {
            for column in trace.shown(0) {
                svg += &self.cell([column, row], "cell");
            }
        }
        let size = (0.34 * self.edge).clamp(9.0, 17.0);
        let number = |x: f64, y: f64, k: i64, axis: usize| {
            format!(
                "<text class=\"i\" x=\"{}\" y=\"{}\" style=\"font-size:{}px\">{}</text>",
                px(x),
                px(y),
                px(size),
                k + i64::from(trace.names.shift[axis])
            )
        };
        for row in trace.shown(1) {
            let y = self.corner([0, row])[1] + 0.5 * self.edge + 0.35 * size;
            svg += &number(0.5 * MARGIN, y, row, 1);
        }
        for column in trace.shown(0) {
            let x = self.corner([column, 0])[0] + 0.5 * self.edge;
            svg += &number(x, self.size[1] - 0.35 * MARGIN, column, 0);
        }
        svg
    }

    fn cell(&self, at: [i64; 2], class: &str) -> String {
        let [x, y] = self.corner(at);
        let (edge, x, y) = (px(self.edge), px(x), px(y));
        format!("<rect class=\"{class}\" x=\"{x}\" y=\"{y}\" width=\"{edge}\" height=\"{edge}\"/>")
    }

    /// The discs.
    pub fn discs(&self, trace: &Trace) -> String {
        trace.discs.iter().map(|disc| self.disc(trace, disc.at, disc.r, "disc")).collect()
    }

    fn disc(&self, trace: &Trace, at: [f64; 2], r: f64, class: &str) -> String {
        let [x, y] = self.at(trace, at).map(px);
        let r = (r / trace.cells.edge() * self.edge).max(3.0);
        format!("<circle class=\"{class}\" cx=\"{x}\" cy=\"{y}\" r=\"{}\"/>", px(r))
    }

    /// The particles' numbers.
    pub fn numbers(&self, trace: &Trace) -> String {
        let size = (0.3 * self.edge).clamp(9.0, 24.0);
        let number = |(k, at): (usize, [f64; 2])| {
            let [x, y] = self.at(trace, at);
            let (y, name) = (y + 0.36 * size, trace.names.particle(k as u32));
            format!(
                "<text class=\"n\" x=\"{}\" y=\"{}\" style=\"font-size:{}px\">{name}</text>",
                px(x),
                px(y),
                px(size)
            )
        };
        trace.discs.iter().map(|disc| disc.at).enumerate().map(number).collect()
    }

    /// What changes.
    pub fn layers(&self, trace: &Trace, step: &Step) -> Layers {
        let marks = &step.marks;
        let (mut under, mut over) = (String::new(), String::new());
        if let Some(row) = marks.row.map(i64::from) {
            under += &self.row(row, "row");
            if trace.algorithm == Algorithm::Nbs
                && marks.cell.is_some_and(|cell| i64::from(cell[1]) == row - 1)
            {
                under += &self.row(row - 1, "below");
            }
        }
        let tested = marks.pair.map(|(i, j, _)| [i, j].map(|k| trace.discs[k as usize].cell));
        for cell in tested.into_iter().flatten().chain(marks.cell) {
            under += &self.cell(cell.map(i64::from), "look");
        }
        if let Some(cell) = marks.central {
            under += &self.cell(cell.map(i64::from), "central");
        }
        if let Some((i, j, touching)) = marks.pair {
            for k in [i, j] {
                let disc = &trace.discs[k as usize];
                over += &self.disc(trace, disc.at, disc.r, "ring");
            }
            let class = if touching { "yes" } else { "no" };
            over += &format!("<path class=\"{class}\" d=\"{}\"/>", self.line(trace, [i, j]));
        }
        if let Some(disc) = marks.particle.and_then(|k| trace.discs.get(k as usize)) {
            over += &self.disc(trace, disc.at, disc.r, "ring");
        }
        [under, over]
    }

    /// The line between two particles, as the data of a path.
    pub fn line(&self, trace: &Trace, pair: [u32; 2]) -> String {
        let [a, b] = pair.map(|k| self.at(trace, trace.discs[k as usize].at).map(px));
        format!("M{} {}L{} {}", a[0], a[1], b[0], b[1])
    }

    fn row(&self, row: i64, class: &str) -> String {
        let [_, y] = self.corner([0, row]);
        let (width, height) = (px(self.cells[0] as f64 * self.edge), px(self.edge));
        format!(
            "<rect class=\"{class}\" x=\"{}\" y=\"{}\" width=\"{width}\" height=\"{height}\"/>",
            px(MARGIN),
            px(y)
        )
    }
}

/// The rules of a style sheet, each selector after `scope`.
pub fn style(palette: &Palette, scope: &str) -> String {
    let Palette { ground, ink, faint, line, border, disc, row, central, look, accent, contact } =
        palette;
    let ([fill, rim], [row, below]) = (disc, row);
    [
        (".cell", format!("fill:none;stroke:{line};stroke-width:1")),
        (".border", format!("fill:{border}")),
        (".row", format!("fill:{row}")),
        (".below", format!("fill:{below}")),
        (".central", format!("fill:{central};stroke:{ink};stroke-width:2")),
        (".look", format!("fill:{look};stroke:{line}")),
        (".disc", format!("fill:{fill};fill-opacity:.5;stroke:{rim};stroke-width:1.5")),
        (".ring", format!("fill:none;stroke:{accent};stroke-width:5")),
        (".contact", format!("stroke:{contact};stroke-width:4;fill:none")),
        (".yes", format!("stroke:{accent};stroke-width:8;fill:none")),
        (".no", format!("stroke:{accent};stroke-width:4;stroke-dasharray:3 9;fill:none")),
        (
            ".n",
            format!(
                "fill:{ink};stroke:{ground};stroke-width:4;paint-order:stroke;text-anchor:middle;\
                 font-weight:bold"
            ),
        ),
        (".i", format!("fill:{faint};font-size:14px;text-anchor:middle")),
        (".name", format!("fill:{ink};font-size:20px;font-weight:bold")),
        (".v", format!("fill:{ground};stroke:{line};stroke-width:1.5")),
        (".v.in", format!("fill:{row}")),
        (".v.old", format!("fill:{line}")),
        (".v.read", format!("fill:{look};stroke:{ink}")),
        (".v.written", format!("fill:{row};stroke:{accent};stroke-width:4")),
        (".v.on", format!("fill:{look};stroke:{ink}")),
        (".t", format!("fill:{ink};font-size:18px;text-anchor:middle")),
        (".t.none", format!("fill:{faint}")),
        (".node", format!("fill:{ground};stroke:{faint};stroke-width:1.5")),
        (".node.on", format!("fill:{accent};stroke:{accent}")),
        (".edge", format!("stroke:{line};stroke-width:1.5")),
        (".edge.on", format!("stroke:{accent};stroke-width:4")),
    ]
    .iter()
    .map(|(selector, rules)| format!("{scope}{selector}{{{rules}}}\n"))
    .collect()
}
