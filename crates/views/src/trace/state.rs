//! Contents of a detector's arrays: a copy that is updated from the detector's events.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::trace::Algorithm;
use contactbench_ground::probe::event::Event;

#[derive(Clone, Copy, Serialize)]
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

pub fn arrays(algorithm: Algorithm) -> &'static [Array] {
    match algorithm {
        Algorithm::Nbs => &[
            ('B', ArrayKind::Heads(1), "B: first particle of each row"),
            ('Y', ArrayKind::Particles, "Y: next particle in the row"),
            ('A', ArrayKind::Heads(0), "A: first particle of each column, in the central row"),
            (
                'a',
                ArrayKind::Heads(0),
                "A\u{2032}: first particle of each column, in the row below",
            ),
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

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Slot {
    /// A particle, a key of the sorting detector, or a node; `None` is shown as -1.
    pub value: Option<u32>,
    pub old: bool,
    /// Whether the value is a node of the tree.
    pub is_node: bool,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Arrays by letter; [`arrays`] lists the letters.
    arrays: BTreeMap<char, Vec<Slot>>,
    pub contacts: Vec<[u32; 2]>,
}

/// Letters of the arrays of a node's lower and upper half.
pub const HALVES: [char; 2] = ['L', 'U'];

/// Returns the letter of the array of links that belongs to this array of heads.
pub fn links(heads: char) -> char {
    match heads {
        'B' => 'Y',
        'A' | 'a' => 'X',
        _ => 'E',
    }
}

impl State {
    /// Builds the arrays of an algorithm before its first step, for `n` particles and this many
    /// cells along each axis.
    pub fn new(algorithm: Algorithm, n: usize, cells: [usize; 2]) -> State {
        let mut state = State::default();
        for &(letter, kind, _) in arrays(algorithm) {
            let length = match kind {
                ArrayKind::Heads(axis) => cells[axis],
                ArrayKind::Matrix => cells[0] * cells[1],
                ArrayKind::Particles | ArrayKind::Keys(_) => n,
                // The root.
                ArrayKind::Nodes => 1,
            };
            state.arrays.insert(letter, vec![Slot::default(); length]);
        }
        // Array D of sorting begins with all particles in ascending order.
        (0..n).for_each(|k| state.set('D', k, Some(k as u32)));
        state
    }

    pub fn apply(&mut self, event: &Event) {
        match *event {
            Event::Push { heads, list, particle, next } => {
                self.set(heads, list, Some(particle));
                self.set(links(heads), particle as usize, next);
            }
            Event::Take { heads, list, first, .. } => {
                if let Some(head) = self.slot(heads, list) {
                    head.old |= first.is_some();
                }
            }
            Event::Reset { heads, list } => self.set(heads, list, None),
            Event::Unlink { particle } => self.set('E', particle as usize, None),
            Event::Test { i, j, touching: true } => self.contacts.push([i, j]),
            Event::Key { axis, particle, key } => {
                self.set(['X', 'Y'][axis], particle as usize, Some(key))
            }
            Event::Swap { axis, places: [a, b] } => {
                for letter in &['X', 'Y', 'D'][axis..] {
                    self.arrays.entry(*letter).and_modify(|slots| slots.swap(a, b));
                }
            }
            Event::Made { node, parent, half } => {
                let slot = Slot { value: Some(node), is_node: true, ..Slot::default() };
                self.slot(HALVES[half], parent as usize).into_iter().for_each(|it| *it = slot);
                for half in HALVES {
                    self.arrays.entry(half).or_default().push(Slot::default());
                }
            }
            Event::Leaf { node, half, particle, next, .. } => {
                self.set(HALVES[half], node as usize, Some(particle));
                self.set('E', particle as usize, next);
            }
            _ => {}
        }
    }

    fn slot(&mut self, letter: char, at: usize) -> Option<&mut Slot> {
        self.arrays.get_mut(&letter)?.get_mut(at)
    }

    fn set(&mut self, letter: char, at: usize, value: Option<u32>) {
        if let Some(slot) = self.slot(letter, at) {
            *slot = Slot { value, ..Slot::default() };
        }
    }

    /// Returns the slots that differ from those of an earlier state: letter, index and slot.
    pub fn changes(&self, before: &State) -> Vec<(char, usize, Slot)> {
        let slots = self.arrays.iter().flat_map(|(&letter, slots)| {
            slots.iter().enumerate().map(move |(at, slot)| (letter, at, *slot))
        });
        slots.filter(|(letter, at, slot)| before.array(*letter).get(*at) != Some(slot)).collect()
    }

    /// Returns the array of this letter; empty if the algorithm has none.
    pub fn array(&self, letter: char) -> &[Slot] {
        self.arrays.get(&letter).map_or(&[], Vec::as_slice)
    }

    pub fn value(&self, letter: char, at: usize) -> Option<u32> {
        self.array(letter).get(at)?.value
    }

    /// Returns the particles of the list that begins with particle `first`.
    pub fn chain(&self, links: char, first: Option<u32>) -> Vec<u32> {
        // No list is longer than the number of particles.
        let most = self.array(links).len();
        std::iter::successors(first, |&k| self.value(links, k as usize)).take(most).collect()
    }
}
