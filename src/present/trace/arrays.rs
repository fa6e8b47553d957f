//! The arrays of a step as SVG: lists, heads, marks, keys, the tree.

use crate::present::svg::px;
use crate::present::trace::recorder::{Marks, Step};
use crate::present::trace::state::Head;
use crate::present::trace::tree::Tree;
use crate::present::trace::{Algorithm, Trace};

/// Width of the panel.
pub const WIDTH: f64 = 900.0;
/// Values side by side.
const PER_LINE: usize = 20;
/// The widest box of a value, and the height of all.
const VALUE: [f64; 2] = [80.0, 38.0];
/// Above a value: its number.
const CAPTION: f64 = 16.0;
const TITLE: f64 = 26.0;

/// The arrays of a trace, one below the other.
pub struct Arrays {
    blocks: Vec<Block>,
    /// Without nodes where the algorithm has none.
    tree: Tree,
    /// The width of a value.
    width: f64,
    /// Height of the panel.
    pub height: f64,
}

struct Block {
    kind: Kind,
    title: &'static str,
    y: f64,
}

#[derive(Clone, Copy)]
enum Kind {
    /// Heads along an axis.
    Heads(char, usize),
    /// Heads of all cells.
    Matrix,
    /// Links.
    Links(char),
    /// Keys along an axis.
    Keys(usize),
    /// Numbers of particles.
    Particles,
    Tree,
}

impl Arrays {
    /// Their places.
    pub fn new(trace: &Trace) -> Arrays {
        let kinds: &[(Kind, &'static str)] = match trace.algorithm {
            Algorithm::Nbs => &[
                (Kind::Heads('B', 1), "B: first particle of each row"),
                (Kind::Links('Y'), "Y: next particle in the row"),
                (Kind::Heads('A', 0), "A: first particle of each column, in the central row"),
                (Kind::Heads('a', 0), "A': first particle of each column, in the row below"),
                (Kind::Links('X'), "X: next particle in the cell"),
            ],
            Algorithm::Screening => &[
                (Kind::Matrix, "C: first particle of each cell"),
                (Kind::Links('E'), "E: next particle in the cell"),
            ],
            Algorithm::Sorting => &[
                (Kind::Keys(0), "X: columns"),
                (Kind::Keys(1), "Y: rows"),
                (Kind::Particles, "D: particles"),
            ],
            Algorithm::BinaryTree => &[
                (Kind::Tree, "The tree; in the boxes, the leaves: the first particle of each"),
                (Kind::Links('E'), "E: next particle in the cell"),
            ],
        };
        let mut arrays = Arrays {
            blocks: Vec::new(),
            tree: Tree::new(trace),
            width: value_width(trace),
            height: 0.0,
        };
        for &(kind, title) in kinds {
            let height = match kind {
                Kind::Matrix => matrix_cell(trace)[1] * trace.shown(1).count() as f64 + 26.0,
                Kind::Tree => arrays.tree.height,
                Kind::Heads(_, axis) => lines(trace.shown(axis).count()),
                Kind::Links(_) | Kind::Keys(_) | Kind::Particles => lines(trace.discs.len()),
            };
            arrays.blocks.push(Block { kind, title, y: arrays.height });
            arrays.height += TITLE + height + 14.0;
        }
        arrays
    }

    /// How many blocks there are.
    pub fn len(&self) -> usize {
        self.blocks.len()
    }

    /// The blocks of a step.
    pub fn draw(&self, trace: &Trace, step: &Step) -> Vec<String> {
        let draw = |block: &Block| {
            let title = format!(
                "<text class=\"name\" y=\"18\">{}</text>",
                block.title.replace('\'', "&#8242;")
            );
            format!(
                "<g transform=\"translate(0 {})\">{title}<g transform=\"translate(0 \
                 {TITLE})\">{}</g></g>",
                px(block.y),
                self.block(trace, step, block.kind)
            )
        };
        self.blocks.iter().map(draw).collect()
    }

    fn block(&self, trace: &Trace, step: &Step, kind: Kind) -> String {
        let (state, marks, names) = (&step.state, &step.marks, &trace.names);
        let particles = |k: usize| (k as u32 + names.first).to_string();
        let values: Vec<Value> = match kind {
            Kind::Heads(letter, axis) => {
                let heads = state.heads_of(letter);
                let value = |list: i64| {
                    let head = usize::try_from(list)
                        .ok()
                        .and_then(|list| heads.get(list))
                        .copied()
                        .unwrap_or_default();
                    let class = usize::try_from(list).map_or("", |list| class(marks, letter, list));
                    let caption = (list + i64::from(names.shift[axis])).to_string();
                    Value { caption, text: names.maybe(head.first), class: with_old(class, head) }
                };
                trace.shown(axis).map(value).collect()
            }
            Kind::Links(letter) => {
                let value = |(k, &next): (usize, &Option<u32>)| Value {
                    caption: particles(k),
                    text: names.maybe(next),
                    class: with_old(class(marks, letter, k), Head { first: next, old: false }),
                };
                state.links_of(letter).iter().enumerate().map(value).collect()
            }
            Kind::Keys(axis) => {
                let value = |(at, key): (usize, &Option<u32>)| Value {
                    caption: particles(at),
                    text: key.map_or("".into(), |key| (key + names.shift[axis]).to_string()),
                    class: place_class(marks, ['X', 'Y'][axis.min(1)], at),
                };
                state.keys[axis].iter().enumerate().map(value).collect()
            }
            Kind::Particles => {
                let value = |(at, &k): (usize, &u32)| Value {
                    caption: particles(at),
                    text: names.particle(k).to_string(),
                    class: place_class(marks, 'D', at),
                };
                state.particles.iter().enumerate().map(value).collect()
            }
            Kind::Matrix => return matrix(trace, step),
            Kind::Tree => return self.tree.draw(trace, step),
        };
        row(&values, self.width)
    }
}

fn lines(values: usize) -> f64 {
    values.div_ceil(PER_LINE) as f64 * (VALUE[1] + CAPTION + 6.0)
}

struct Value {
    caption: String,
    text: String,
    class: String,
}

/// Was the place written or read in this step?
fn class(marks: &Marks, letter: char, at: usize) -> &'static str {
    if marks.written.contains(&(letter, at)) {
        " written"
    } else if marks.read.contains(&(letter, at)) {
        " read"
    } else {
        ""
    }
}

fn with_old(class: &str, head: Head) -> String {
    format!(
        "{}{}{class}",
        if head.first.is_none() { " none" } else { "" },
        if head.old { " old" } else { "" }
    )
}

fn place_class(marks: &Marks, letter: char, at: usize) -> String {
    let within = marks.range.is_some_and(|[from, to]| (from..to).contains(&at));
    format!("{}{}", if within { " in" } else { "" }, class(marks, letter, at))
}

/// Values side by side, and below one another where they are many.
fn row(values: &[Value], width: f64) -> String {
    let size = (0.45 * width).clamp(17.0, 26.0);
    let mut svg = String::new();
    for (k, Value { caption, text, class }) in values.iter().enumerate() {
        let (x, y) =
            ((k % PER_LINE) as f64 * width, (k / PER_LINE) as f64 * (VALUE[1] + CAPTION + 6.0));
        let middle = px(x + 0.5 * width - 1.5);
        svg += &format!(
            "<text class=\"i\" x=\"{middle}\" y=\"{}\">{caption}</text><rect class=\"v{class}\" \
             x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"3\"/><text class=\"t{class}\" \
             x=\"{middle}\" y=\"{}\" style=\"font-size:{size}px\">{text}</text>",
            px(y + CAPTION - 4.0),
            px(x + 1.0),
            px(y + CAPTION),
            px(width - 4.0),
            px(VALUE[1]),
            px(y + CAPTION + 0.5 * VALUE[1] + 0.36 * size)
        );
    }
    svg
}

/// As wide as lets the longest array stand in one line, or in lines of equal length.
fn value_width(trace: &Trace) -> f64 {
    let longest = [trace.discs.len(), trace.shown(0).count(), trace.shown(1).count()]
        .into_iter()
        .max()
        .unwrap_or(1);
    (WIDTH / longest.clamp(1, PER_LINE) as f64).min(VALUE[0])
}

fn matrix_cell(trace: &Trace) -> [f64; 2] {
    let [nx, ny] = [0, 1].map(|axis| trace.shown(axis).count().max(1) as f64);
    [((WIDTH - 34.0) / nx).min(60.0), (640.0 / ny).clamp(15.0, 36.0)]
}

/// The heads of all cells, as they lie in the plane.
fn matrix(trace: &Trace, step: &Step) -> String {
    let ([width, height], names) = (matrix_cell(trace), &trace.names);
    let heads = step.state.heads_of('C');
    let (nx, rows) = (i64::from(trace.cells.count[0]), trace.shown(1).count());
    let size = (0.6 * height).min(0.42 * width).clamp(8.0, 19.0);
    let mut svg = String::new();
    for (down, row) in trace.shown(1).rev().enumerate() {
        let y = down as f64 * height;
        svg += &format!(
            "<text class=\"i\" x=\"12\" y=\"{}\">{}</text>",
            px(y + 0.5 * height + 4.0),
            row + i64::from(names.shift[1])
        );
        for (right, column) in trace.shown(0).enumerate() {
            let x = 26.0 + right as f64 * width;
            let inside = (0..nx).contains(&column) && row >= 0;
            let at = if inside {
                usize::try_from(row * nx + column).ok().filter(|&at| at < heads.len())
            } else {
                None
            };
            let head = at.map_or(Head::default(), |at| heads[at]);
            let class = with_old(at.map_or("", |at| class(&step.marks, 'C', at)), head);
            svg += &format!(
                "<rect class=\"v{class}\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>",
                px(x),
                px(y),
                px(width - 2.0),
                px(height - 2.0)
            );
            // Most cells are empty: their -1 only where there is room for it.
            if head.first.is_some() || height > 20.0 {
                svg += &format!(
                    "<text class=\"t{class}\" x=\"{}\" y=\"{}\" style=\"font-size:{}px\">{}</text>",
                    px(x + 0.5 * width - 1.0),
                    px(y + 0.5 * height + 0.34 * size),
                    px(size),
                    names.maybe(head.first)
                );
            }
        }
    }
    for (right, column) in trace.shown(0).enumerate() {
        let x = 25.0 + (right as f64 + 0.5) * width;
        svg += &format!(
            "<text class=\"i\" x=\"{}\" y=\"{}\">{}</text>",
            px(x),
            px(rows as f64 * height + 14.0),
            column + i64::from(names.shift[0])
        );
    }
    svg
}
