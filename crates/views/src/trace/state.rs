//! What stands in a detector's arrays: a copy that follows the writes of its events.

use crate::trace::Algorithm;
use contactbench_core::event::Event;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Slot {
    /// A particle, or a key of sorting; none is shown as -1.
    pub value: Option<u32>,
    /// Whether a head is marked old.
    pub old: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Child {
    #[default]
    None,
    Node(u32),
    /// A leaf: the head of its list.
    Leaf(u32),
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Node {
    /// Levels below the root.
    pub level: usize,
    pub children: [Child; 2],
}

/// The arrays of an algorithm, with the contacts found so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// The arrays by letter. NBS: heads B, A and a (the row below), links Y and X. Screening: heads
    /// C, links E. Sorting: keys X and Y, particles D. The tree: links E.
    pub arrays: Vec<(char, Vec<Slot>)>,
    pub nodes: Vec<Node>,
    pub contacts: Vec<[u32; 2]>,
}

/// The letter of the links of lists whose heads have this letter.
pub fn links(heads: char) -> char {
    match heads {
        'B' => 'Y',
        'A' | 'a' => 'X',
        _ => 'E',
    }
}

impl State {
    /// The arrays of an algorithm for `n` particles in `nx` x `ny` cells, before it begins.
    pub fn new(algorithm: Algorithm, n: usize, [nx, ny]: [usize; 2]) -> State {
        let lengths: &[(char, usize)] = match algorithm {
            Algorithm::Nbs => &[('B', ny), ('Y', n), ('A', nx), ('a', nx), ('X', n)],
            Algorithm::Screening => &[('C', nx * ny), ('E', n)],
            Algorithm::Sorting => &[('X', n), ('Y', n), ('D', n)],
            Algorithm::BinaryTree => &[('E', n)],
        };
        let empty = |&(letter, length)| (letter, vec![Slot::default(); length]);
        let mut state = State { arrays: lengths.iter().map(empty).collect(), ..State::default() };
        match algorithm {
            Algorithm::Sorting => (0..n).for_each(|k| state.set('D', k, Some(k as u32))),
            Algorithm::BinaryTree => state.nodes.push(Node::default()),
            _ => {}
        }
        state
    }

    /// Does what the event tells.
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
                let swapped = &['X', 'Y', 'D'][axis..];
                let arrays = self.arrays.iter_mut();
                let arrays = arrays.filter(|(letter, _)| swapped.contains(letter));
                arrays.for_each(|(_, slots)| slots.swap(a, b));
            }
            Event::Made { node, parent, half } => {
                let level = self.nodes.get(parent as usize).map_or(0, |parent| parent.level + 1);
                self.child(parent, half, Child::Node(node));
                self.nodes.push(Node { level, ..Node::default() });
            }
            Event::Leaf { node, half, particle, next, .. } => {
                self.child(node, half, Child::Leaf(particle));
                self.set('E', particle as usize, next);
            }
            _ => {}
        }
    }

    fn slot(&mut self, letter: char, at: usize) -> Option<&mut Slot> {
        self.arrays.iter_mut().find(|array| array.0 == letter)?.1.get_mut(at)
    }

    fn set(&mut self, letter: char, at: usize, value: Option<u32>) {
        if let Some(slot) = self.slot(letter, at) {
            *slot = Slot { value, old: false };
        }
    }

    fn child(&mut self, node: u32, half: usize, child: Child) {
        if let Some(node) = self.nodes.get_mut(node as usize) {
            node.children[half] = child;
        }
    }

    /// The array of this letter; empty if the algorithm has none.
    pub fn array(&self, letter: char) -> &[Slot] {
        self.arrays.iter().find(|array| array.0 == letter).map_or(&[], |array| &array.1)
    }

    /// What stands at a place of an array.
    pub fn value(&self, letter: char, at: usize) -> Option<u32> {
        self.array(letter).get(at)?.value
    }

    /// The particles of the list that begins with `first`.
    pub fn chain(&self, links: char, first: Option<u32>) -> Vec<u32> {
        // No list is longer than there are particles.
        let most = self.array(links).len();
        std::iter::successors(first, |&k| self.value(links, k as usize)).take(most).collect()
    }
}
