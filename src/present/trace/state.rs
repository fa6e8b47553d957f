//! What stands in a detector's arrays: a copy that follows the writes it tells of.

use crate::event::Event;

/// A head of a list.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Head {
    /// The first particle.
    pub first: Option<u32>,
    /// Marked old.
    pub old: bool,
}

/// A child of a node.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Child {
    /// Nothing.
    #[default]
    None,
    /// Another node.
    Node(u32),
    /// A leaf: the head of its list.
    Leaf(u32),
}

/// A node of the binary tree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Node {
    /// Levels below the root.
    pub level: usize,
    /// Its two halves.
    pub children: [Child; 2],
}

/// All arrays; those that a detector does not have are empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Heads, by the letter of their array: B, A and a of NBS (a: the row below), C of screening.
    pub heads: Vec<(char, Vec<Head>)>,
    /// Next particles, by letter: Y and X of NBS, E of screening and of the tree.
    pub links: Vec<(char, Vec<Option<u32>>)>,
    /// Integerised coordinates of sorting.
    pub keys: [Vec<Option<u32>>; 2],
    /// Particles of sorting.
    pub particles: Vec<u32>,
    /// Nodes of the tree.
    pub nodes: Vec<Node>,
    /// Contacts found.
    pub contacts: Vec<[u32; 2]>,
}

impl State {
    /// Does what the event tells.
    pub fn apply(&mut self, event: &Event) {
        match *event {
            Event::Push { heads, list, particle, next } => {
                if let Some(head) = self.head(heads, list) {
                    *head = Head { first: Some(particle), old: false };
                }
                let letter = match heads {
                    'B' => 'Y',
                    'A' | 'a' => 'X',
                    _ => 'E',
                };
                self.link(letter, particle, next);
            }
            Event::Take { heads, list, first, .. } => {
                if let Some(head) = self.head(heads, list) {
                    head.old |= first.is_some();
                }
            }
            Event::Reset { heads, list } => {
                if let Some(head) = self.head(heads, list) {
                    *head = Head::default();
                }
            }
            Event::Unlink { particle } => self.link('E', particle, None),
            Event::Test { i, j, touching: true } => self.contacts.push([i, j]),
            Event::Key { axis, particle, key } => {
                if let Some(place) =
                    self.keys.get_mut(axis).and_then(|keys| keys.get_mut(particle as usize))
                {
                    *place = Some(key);
                }
            }
            Event::Swap { axis, places: [a, b] } => {
                self.keys.iter_mut().skip(axis).for_each(|keys| keys.swap(a, b));
                self.particles.swap(a, b);
            }
            Event::Made { node, parent, half } => {
                let level = self.nodes.get(parent as usize).map_or(0, |parent| parent.level + 1);
                if let Some(parent) = self.nodes.get_mut(parent as usize) {
                    parent.children[half] = Child::Node(node);
                }
                self.nodes.push(Node { level, ..Node::default() });
            }
            Event::Leaf { node, half, particle, next, .. } => {
                if let Some(node) = self.nodes.get_mut(node as usize) {
                    node.children[half] = Child::Leaf(particle);
                }
                self.link('E', particle, next);
            }
            _ => {}
        }
    }

    fn head(&mut self, letter: char, list: usize) -> Option<&mut Head> {
        self.heads.iter_mut().find(|heads| heads.0 == letter)?.1.get_mut(list)
    }

    fn link(&mut self, letter: char, particle: u32, next: Option<u32>) {
        let links = self.links.iter_mut().find(|links| links.0 == letter);
        if let Some(link) = links.and_then(|links| links.1.get_mut(particle as usize)) {
            *link = next;
        }
    }

    /// The heads of an array.
    pub fn heads_of(&self, letter: char) -> &[Head] {
        self.heads.iter().find(|heads| heads.0 == letter).map_or(&[], |heads| &heads.1)
    }

    /// The links of an array.
    pub fn links_of(&self, letter: char) -> &[Option<u32>] {
        self.links.iter().find(|links| links.0 == letter).map_or(&[], |links| &links.1)
    }

    /// The particles of the list that begins with `first`.
    pub fn chain(&self, letter: char, first: Option<u32>) -> Vec<u32> {
        let links = self.links_of(letter);
        // No list is longer than there are particles.
        std::iter::successors(first, |&k| links.get(k as usize).copied().flatten())
            .take(links.len())
            .collect()
    }
}
