//! A probe that records the events of a detector as the steps of a trace.

use crate::trace::state::{HALVES, State};
use crate::trace::{Algorithm, Disc, MOST_STEPS, words};
use contactbench_ground::probe::event::{Event, Part};
use contactbench_ground::probe::{Op, Probe, Tally};

/// How particles and cells are numbered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Names {
    /// Number of the first particle: 1 for examples of the book, else 0.
    pub first: u32,
    pub shift: [u32; 2],
    /// True for an example of the book, which has 10 x 10 cells.
    pub book: bool,
}

impl Names {
    pub fn particle(&self, k: u32) -> u32 {
        k + self.first
    }

    /// Returns a particle's number, or -1 for none.
    pub fn maybe(&self, k: Option<u32>) -> String {
        k.map_or("-1".into(), |k| self.particle(k).to_string())
    }

    /// Returns the number of a place in the sorted order; places are numbered like particles.
    pub fn place(&self, at: usize) -> u32 {
        self.particle(at as u32)
    }

    pub fn places(&self, [from, to]: [usize; 2]) -> String {
        match to - from {
            1 => format!("place {}", self.place(from)),
            _ => format!("places {} to {}", self.place(from), self.place(to) - 1),
        }
    }

    pub fn key(&self, axis: usize, key: u32) -> u32 {
        key + self.shift[axis]
    }

    pub fn cell(&self, [column, row]: [u32; 2]) -> String {
        format!("({}, {})", self.key(0, column), self.key(1, row))
    }
}

#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct Marks {
    pub row: Option<u32>,
    pub central: Option<[u32; 2]>,
    pub cell: Option<[u32; 2]>,
    pub particle: Option<u32>,
    /// The tested pair of particles, and whether they touch.
    pub pair: Option<(u32, u32, bool)>,
    pub written: Vec<(char, usize)>,
    pub read: Vec<(char, usize)>,
    /// Half-open range of places in the sorted order that the sentence of the step names.
    pub range: Option<[usize; 2]>,
}

#[derive(Clone, Debug)]
pub struct Step {
    pub words: String,
    pub part: usize,
    pub marks: Marks,
    pub state: State,
    /// Operations counted from the beginning through this step.
    pub tally: Tally,
}

#[derive(Default)]
pub struct Recorder {
    pub(super) algorithm: Algorithm,
    pub(super) names: Names,
    pub(super) count: [u32; 2],
    pub(super) discs: Vec<Disc>,
    pub(super) state: State,
    pub(super) row: Option<u32>,
    pub(super) central: Option<[u32; 2]>,
    pub(super) visiting: Option<u32>,
    /// Tree nodes visited since the last step.
    pub(super) path: Vec<u32>,
    pub(super) made: usize,
    pub(super) tally: Tally,
    pub(super) parts: Vec<String>,
    pub(super) steps: Vec<Step>,
    /// Number of steps, including those beyond the limit, which are not stored.
    pub(super) all: usize,
}

impl Probe for Recorder {
    const SILENT: bool = false;

    fn add(&mut self, op: Op, n: u64) {
        self.tally.add(op, n);
    }

    fn note(&mut self, event: impl FnOnce() -> Event) {
        self.event(event());
    }
}

impl Recorder {
    pub(super) fn new(
        algorithm: Algorithm,
        names: Names,
        count: [u32; 2],
        discs: &[Disc],
    ) -> Recorder {
        let state = State::new(algorithm, discs.len(), count.map(|count| count as usize));
        let (discs, parts) = (discs.to_vec(), vec!["The beginning".into()]);
        let mut recorder =
            Recorder { algorithm, names, count, discs, state, parts, ..Recorder::default() };
        recorder.step(words::beginning(&recorder), Marks::default());
        recorder
    }

    pub(super) fn end(&mut self) {
        self.part("The end".into());
        (self.row, self.central) = (None, None);
        self.step(words::end(self), Marks::default());
    }

    fn part(&mut self, title: String) {
        if self.parts.last() != Some(&title) {
            self.parts.push(title);
        }
    }

    fn step(&mut self, words: String, mut marks: Marks) {
        self.all += 1;
        if self.all > MOST_STEPS {
            return;
        }
        marks.row = marks.row.or(self.row);
        marks.central = marks.central.or(self.central);
        let nodes = self.path.drain(..).map(|node| node as usize);
        marks.read.extend(nodes.flat_map(|node| HALVES.map(|half| (half, node))));
        self.made = 0;
        // No-break spaces keep an equation on one line.
        let words = words.replace(" = ", "\u{a0}=\u{a0}");
        let (part, state) = (self.parts.len() - 1, self.state.clone());
        self.steps.push(Step { words, part, marks, state, tally: self.tally });
    }

    fn event(&mut self, event: Event) {
        let was_empty = match event {
            Event::Reset { heads, list } => self.state.value(heads, list).is_none(),
            _ => false,
        };
        self.state.apply(&event);
        match event {
            Event::Begin(part) => self.begin(part),
            Event::Visit { particle } => self.visiting = Some(particle),
            Event::Central { cell } => self.central(cell),
            Event::Node { node, .. } => self.path.push(node),
            Event::Made { node, .. } => {
                self.made += 1;
                self.path.push(node);
            }
            _ => {
                if matches!(event, Event::Take { heads: 'B', .. }) {
                    (self.row, self.central) = (None, None);
                    self.part("Which rows are new?".into());
                }
                if let Some((words, marks)) = words::sentence(self, was_empty, &event) {
                    self.step(words, marks);
                }
                if matches!(event, Event::Take { .. }) {
                    self.visiting = None;
                }
            }
        }
    }

    fn begin(&mut self, part: Part) {
        match part {
            Part::CentralRow { row } => self.row = Some(row),
            Part::RemoveColumns | Part::RemoveCells => self.central = None,
            Part::RemoveRows => self.row = None,
            _ => {}
        }
        self.part(words::title(part, self.row, &self.names));
        if let Part::Tree { halvings } = part {
            self.step(words::tree(halvings), Marks::default());
        }
    }

    fn central(&mut self, cell: [u32; 2]) {
        self.central = Some(cell);
        match (self.algorithm, self.steps.last_mut()) {
            // The central cell is marked in the step that found it.
            (Algorithm::Nbs | Algorithm::Screening, Some(step)) => step.marks.central = Some(cell),
            (Algorithm::BinaryTree, _) => {
                let cell = self.names.cell(cell);
                let words = format!(
                    "The walk over the tree has come to the leaf of cell {cell}: it is central."
                );
                self.step(words, Marks::default());
            }
            _ => {}
        }
    }

    /// Returns the cell of a list, given the letter of the array of heads.
    pub(super) fn cell_of(&self, heads: char, list: usize) -> Option<[u32; 2]> {
        let list = list as u32;
        match heads {
            'A' => self.row.map(|row| [list, row]),
            'a' => self.row.map(|row| [list, row.saturating_sub(1)]),
            'C' => Some([list % self.count[0], list / self.count[0]]),
            _ => None,
        }
    }

    pub(super) fn chain(&self, links: char, first: Option<u32>) -> String {
        let names = self.state.chain(links, first).into_iter().map(|k| self.names.particle(k));
        names.map(|name| name.to_string()).collect::<Vec<_>>().join(" \u{2192} ")
    }
}
