//! The scene of a step as SVG.

use crate::px;
use crate::trace::arrays::{Arrays, WIDTH};
use crate::trace::recorder::Step;
use crate::trace::{Algorithm, Trace};

const SIDE: f64 = 700.0;
const MARGIN: f64 = 36.0;

/// Draws a rectangle from its upper left corner; `more` holds further attributes.
pub fn rect(class: &str, [x, y]: [f64; 2], [width, height]: [f64; 2], more: &str) -> String {
    let [x, y, width, height] = [x, y, width, height].map(px);
    format!(
        "<rect class=\"{class}\" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"{more}/>"
    )
}

pub fn label(class: &str, at: [f64; 2], size: Option<f64>, text: impl ToString) -> String {
    let [x, y] = at.map(px);
    let style = size.map_or(String::new(), |size| format!(" style=\"font-size:{}px\"", px(size)));
    format!("<text class=\"{class}\" x=\"{x}\" y=\"{y}\"{style}>{}</text>", text.to_string())
}

/// The picture of a scene: the parts that all steps share, and the scale.
pub struct Scene<'a> {
    trace: &'a Trace,
    edge: f64,
    first: [i64; 2],
    cells: [usize; 2],
    size: [f64; 2],
}

impl Trace {
    /// Returns the shown cells along an axis, in the numbering of the detector.
    pub fn shown(&self, axis: usize) -> std::ops::Range<i64> {
        let shift = i64::from(self.names.shift[axis]);
        if self.names.book { 1 - shift..11 - shift } else { 0..i64::from(self.cells.count[axis]) }
    }
}

impl<'a> Scene<'a> {
    pub fn new(trace: &'a Trace) -> Scene<'a> {
        let cells = [0, 1].map(|axis| trace.shown(axis).count());
        let edge = (SIDE / cells[0].max(cells[1]).max(1) as f64).min(110.0);
        let size = cells.map(|count| count as f64 * edge + MARGIN);
        Scene { trace, edge, first: [0, 1].map(|axis| trace.shown(axis).start), cells, size }
    }

    /// Returns the template values that are the same in all steps.
    pub fn values(&self, arrays: &Arrays<'_>) -> [(&'static str, String); 7] {
        let panel = |[width, height]: [f64; 2]| format!("0 0 {} {}", px(width), px(height));
        [
            ("scene", panel(self.size)),
            ("arrays", panel([WIDTH, arrays.height])),
            ("ground", self.ground()),
            ("grid", self.grid()),
            ("discs", (0..self.trace.discs.len() as u32).map(|k| self.disc(k, "disc")).collect()),
            ("numbers", self.numbers()),
            ("last", (self.trace.steps.len() - 1).to_string()),
        ]
    }

    fn corner(&self, [column, row]: [i64; 2]) -> [f64; 2] {
        [
            MARGIN + (column - self.first[0]) as f64 * self.edge,
            (self.cells[1] as i64 - 1 - (row - self.first[1])) as f64 * self.edge,
        ]
    }

    fn at(&self, point: [f64; 2]) -> [f64; 2] {
        let cells = &self.trace.cells;
        let along = |axis: usize| {
            (point[axis] - cells.origin()[axis]) / cells.edge() + (1 - self.first[axis]) as f64
        };
        [MARGIN + along(0) * self.edge, (self.cells[1] as f64 - along(1)) * self.edge]
    }

    fn all_cells(&self) -> impl Iterator<Item = [i64; 2]> {
        let columns = self.trace.shown(0);
        self.trace.shown(1).flat_map(move |row| columns.clone().map(move |column| [column, row]))
    }

    /// Draws the border cells, which hold no particles, below all other shapes.
    fn ground(&self) -> String {
        let count = self.trace.cells.count.map(i64::from);
        let border = |cell: &[i64; 2]| (0..2).any(|k| cell[k] <= 0 || cell[k] >= count[k] - 1);
        let cells = self.all_cells().filter(|cell| !self.trace.names.book && border(cell));
        cells.map(|cell| self.cell(cell, "border")).collect()
    }

    fn grid(&self) -> String {
        let mut svg: String = self.all_cells().map(|cell| self.cell(cell, "cell")).collect();
        let size = (0.34 * self.edge).clamp(9.0, 17.0);
        let number = |at: [f64; 2], k: i64, axis: usize| {
            label("i", at, Some(size), k + i64::from(self.trace.names.shift[axis]))
        };
        for row in self.trace.shown(1) {
            let y = self.corner([0, row])[1] + 0.5 * self.edge + 0.35 * size;
            svg += &number([0.5 * MARGIN, y], row, 1);
        }
        for column in self.trace.shown(0) {
            let x = self.corner([column, 0])[0] + 0.5 * self.edge;
            svg += &number([x, self.size[1] - 0.35 * MARGIN], column, 0);
        }
        svg
    }

    fn cell(&self, at: [i64; 2], class: &str) -> String {
        rect(class, self.corner(at), [self.edge; 2], "")
    }

    fn row(&self, row: i64, class: &str) -> String {
        let (y, width) = (self.corner([0, row])[1], self.cells[0] as f64 * self.edge);
        rect(class, [MARGIN, y], [width, self.edge], "")
    }

    /// Draws a disc; returns empty text if particle `k` does not exist.
    fn disc(&self, k: u32, class: &str) -> String {
        let Some(disc) = self.trace.discs.get(k as usize) else { return String::new() };
        let [x, y] = self.at(disc.at).map(px);
        let r = px((disc.r / self.trace.cells.edge() * self.edge).max(3.0));
        format!("<circle class=\"{class}\" cx=\"{x}\" cy=\"{y}\" r=\"{r}\"/>")
    }

    fn numbers(&self) -> String {
        let size = (0.3 * self.edge).clamp(9.0, 24.0);
        let number = |(k, at): (u32, [f64; 2])| {
            let [x, y] = self.at(at);
            label("n", [x, y + 0.36 * size], Some(size), self.trace.names.particle(k))
        };
        (0..).zip(self.trace.discs.iter().map(|disc| disc.at)).map(number).collect()
    }

    /// Draws what differs from step to step, in two layers: below the discs, and above contacts.
    pub fn layers(&self, step: &Step) -> [String; 2] {
        let (marks, discs) = (&step.marks, &self.trace.discs);
        let (mut under, mut over) = (String::new(), String::new());
        if let Some(row) = marks.row.map(i64::from) {
            under += &self.row(row, "row");
            let below = marks.cell.is_some_and(|cell| i64::from(cell[1]) == row - 1);
            if self.trace.algorithm == Algorithm::Nbs && below {
                under += &self.row(row - 1, "below");
            }
        }
        let tested = marks.pair.map(|(i, j, _)| [i, j].map(|k| discs[k as usize].cell));
        for cell in tested.into_iter().flatten().chain(marks.cell) {
            under += &self.cell(cell.map(i64::from), "look");
        }
        if let Some(cell) = marks.central {
            under += &self.cell(cell.map(i64::from), "central");
        }
        if let Some((i, j, touching)) = marks.pair {
            over += &[i, j].map(|k| self.disc(k, "ring")).concat();
            let class = if touching { "yes" } else { "no" };
            over += &format!("<path class=\"{class}\" d=\"{}\"/>", self.line([i, j]));
        }
        over += &marks.particle.map_or(String::new(), |k| self.disc(k, "ring"));
        [under, over]
    }

    pub fn line(&self, pair: [u32; 2]) -> String {
        let [a, b] = pair.map(|k| self.at(self.trace.discs[k as usize].at).map(px));
        format!("M{} {}L{} {}", a[0], a[1], b[0], b[1])
    }
}
