//! The arrays of a step as SVG: heads and links of lists, keys, nodes, and their marks.

use crate::px;
use crate::trace::picture::{label, rect};
use crate::trace::recorder::Step;
use crate::trace::state::{HALVES, Slot};
use crate::trace::{Algorithm, Trace};

pub const WIDTH: f64 = 900.0;
const PER_LINE: usize = 20;
/// Maximum width of the box around a value, and height of all boxes.
const VALUE: [f64; 2] = [80.0, 38.0];
const CAPTION: f64 = 16.0;
const LINE: f64 = VALUE[1] + CAPTION + 6.0;
const TITLE: f64 = 26.0;

#[derive(Clone, Copy)]
pub enum ArrayKind {
    /// Heads (first particles) of lists along an axis.
    Heads(usize),
    /// Heads of the lists of all cells.
    Matrix,
    Particles,
    /// Column (0) or row (1) of the particle at each place of the sorted order.
    Keys(usize),
    /// A half of each node of the tree.
    Nodes,
}

/// Letter, kind and title of an array.
pub type Array = (char, ArrayKind, &'static str);

const NEXT: Array = ('E', ArrayKind::Particles, "E: next particle in the cell");

pub fn blocks(algorithm: Algorithm) -> &'static [Array] {
    match algorithm {
        Algorithm::Nbs => &[
            ('B', ArrayKind::Heads(1), "B: first particle of each row"),
            ('Y', ArrayKind::Particles, "Y: next particle in the row"),
            ('A', ArrayKind::Heads(0), "A: first particle of each column, in the central row"),
            ('a', ArrayKind::Heads(0), "A&#8242;: first particle of each column, in the row below"),
            ('X', ArrayKind::Particles, "X: next particle in the cell"),
        ],
        Algorithm::Screening => &[('C', ArrayKind::Matrix, "C: first particle of each cell"), NEXT],
        Algorithm::Sorting => &[
            ('X', ArrayKind::Keys(0), "X: columns"),
            ('Y', ArrayKind::Keys(1), "Y: rows"),
            ('D', ArrayKind::Particles, "D: particles"),
        ],
        Algorithm::BinaryTree => &[
            ('L', ArrayKind::Nodes, "L: lower half of each node: a node (n) or the first particle"),
            ('U', ArrayKind::Nodes, "U: upper half of each node: a node (n) or the first particle"),
            NEXT,
        ],
    }
}

pub struct Arrays<'a> {
    trace: &'a Trace,
    /// Arrays with the y of their tops.
    blocks: Vec<(Array, f64)>,
    width: f64,
    pub height: f64,
}

impl<'a> Arrays<'a> {
    pub fn new(trace: &'a Trace) -> Arrays<'a> {
        let (n, last) = (trace.discs.len(), trace.steps.last());
        let nodes = last.map_or(0, |step| step.state.array(HALVES[0]).len());
        let [columns, rows] = [0, 1].map(|axis| trace.shown(axis).count());
        // The longest array fills one line, or several of `PER_LINE` values.
        let longest = n.max(columns).max(rows).max(nodes).clamp(1, PER_LINE);
        let width = (WIDTH / longest as f64).min(VALUE[0]);
        let lines = |values: usize| values.div_ceil(PER_LINE) as f64 * LINE;
        let (mut blocks, mut height) = (Vec::new(), 0.0);
        for &array in self::blocks(trace.algorithm) {
            blocks.push((array, height));
            height += TITLE + 14.0;
            height += match array.1 {
                ArrayKind::Matrix => matrix_cell(trace)[1] * rows as f64 + 26.0,
                ArrayKind::Nodes => lines(nodes),
                ArrayKind::Heads(axis) => lines([columns, rows][axis]),
                ArrayKind::Particles | ArrayKind::Keys(_) => lines(n),
            };
        }
        Arrays { trace, blocks, width, height }
    }

    pub fn len(&self) -> usize {
        self.blocks.len()
    }

    pub fn draw(&self, step: &Step) -> Vec<String> {
        let draw = |&((letter, kind, title), y): &(Array, f64)| {
            let block = match kind {
                ArrayKind::Matrix => matrix(self.trace, step),
                _ => self.row(step, letter, kind),
            };
            format!(
                "<g transform=\"translate(0 {})\"><text class=\"name\" y=\"18\">{title}</text><g \
                 transform=\"translate(0 {TITLE})\">{block}</g></g>",
                px(y)
            )
        };
        self.blocks.iter().map(draw).collect()
    }

    fn row(&self, step: &Step, letter: char, kind: ArrayKind) -> String {
        let (names, slots) = (&self.trace.names, step.state.array(letter));
        let (numbers, first) = match kind {
            ArrayKind::Heads(axis) => (self.trace.shown(axis), names.shift[axis]),
            ArrayKind::Nodes => (0..slots.len() as i64, 0),
            _ => (0..slots.len() as i64, names.first),
        };
        let size = (0.45 * self.width).clamp(17.0, 26.0);
        let mut svg = String::new();
        for (k, number) in numbers.enumerate() {
            let at = usize::try_from(number).ok().filter(|&at| at < slots.len());
            let slot = at.map_or(Slot::default(), |at| slots[at]);
            let text = match kind {
                ArrayKind::Nodes if slot.is_node => format!("n{}", slot.value.unwrap_or_default()),
                ArrayKind::Keys(axis) => {
                    slot.value.map_or(String::new(), |key| names.key(axis, key).to_string())
                }
                _ => names.maybe(slot.value),
            };
            let [x, y] = [(k % PER_LINE) as f64 * self.width, (k / PER_LINE) as f64 * LINE];
            let (middle, top) = (x + 0.5 * self.width - 1.5, y + CAPTION);
            svg += &label("i", [middle, top - 4.0], None, number + i64::from(first));
            let place = (letter, at, slot);
            let corner = [x + 1.0, top];
            svg += &value(step, place, corner, [self.width - 4.0, VALUE[1]], " rx=\"3\"");
            let base = top + 0.5 * VALUE[1] + 0.36 * size;
            svg += &text_of(step, place, [middle, base], size, text);
        }
        svg
    }
}

type Place = (char, Option<usize>, Slot);

fn value(step: &Step, place: Place, at: [f64; 2], size: [f64; 2], more: &str) -> String {
    rect(&format!("v{}", class(step, place)), at, size, more)
}

fn text_of(step: &Step, place: Place, at: [f64; 2], size: f64, text: String) -> String {
    label(&format!("t{}", class(step, place)), at, Some(size), text)
}

/// Returns the CSS classes of a value: written or read now, in the range, empty, marked old.
fn class(step: &Step, (letter, at, slot): Place) -> String {
    let marks = &step.marks;
    let holds = |places: &[(char, usize)]| at.is_some_and(|at| places.contains(&(letter, at)));
    let within = |[from, to]: [usize; 2]| at.is_some_and(|at| (from..to).contains(&at));
    let written = holds(&marks.written);
    let classes = [
        (marks.range.is_some_and(within), " in"),
        (slot.value.is_none(), " none"),
        (slot.old, " old"),
        (written, " written"),
        (!written && holds(&marks.read), " read"),
    ];
    classes.iter().filter(|(holds, _)| *holds).map(|(_, class)| *class).collect()
}

fn matrix_cell(trace: &Trace) -> [f64; 2] {
    let [nx, ny] = [0, 1].map(|axis| trace.shown(axis).count().max(1) as f64);
    [((WIDTH - 34.0) / nx).min(60.0), (640.0 / ny).clamp(15.0, 36.0)]
}

/// Draws the heads of all cells in the arrangement of the cells.
fn matrix(trace: &Trace, step: &Step) -> String {
    let ([width, height], names) = (matrix_cell(trace), &trace.names);
    let heads = step.state.array('C');
    let (nx, rows) = (i64::from(trace.cells.count[0]), trace.shown(1).count());
    let size = (0.6 * height).min(0.42 * width).clamp(8.0, 19.0);
    let number =
        |at: [f64; 2], k: i64, axis: usize| label("i", at, None, k + i64::from(names.shift[axis]));
    let mut svg = String::new();
    for (down, row) in trace.shown(1).rev().enumerate() {
        let y = down as f64 * height;
        svg += &number([12.0, y + 0.5 * height + 4.0], row, 1);
        for (right, column) in trace.shown(0).enumerate() {
            let x = 26.0 + right as f64 * width;
            let inside = (0..nx).contains(&column) && row >= 0;
            let at = usize::try_from(row * nx + column).ok();
            let at = at.filter(|&at| inside && at < heads.len());
            let place = ('C', at, at.map_or(Slot::default(), |at| heads[at]));
            svg += &value(step, place, [x, y], [width - 2.0, height - 2.0], "");
            // Empty cells show their -1 only if there is space for it.
            if place.2.value.is_some() || height > 20.0 {
                let at = [x + 0.5 * width - 1.0, y + 0.5 * height + 0.34 * size];
                svg += &text_of(step, place, at, size, names.maybe(place.2.value));
            }
        }
    }
    for (right, column) in trace.shown(0).enumerate() {
        let x = 25.0 + (right as f64 + 0.5) * width;
        svg += &number([x, rows as f64 * height + 14.0], column, 0);
    }
    svg
}
