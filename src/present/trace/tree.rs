//! The binary tree of a step as SVG: every node and leaf at the place that it has in the whole
//! tree.

use crate::present::svg::{px, segment};
use crate::present::trace::Trace;
use crate::present::trace::arrays::WIDTH;
use crate::present::trace::recorder::Step;
use crate::present::trace::state::{Child, Node};

/// Where the nodes stand.
#[derive(Default)]
pub struct Tree {
    places: Vec<[f64; 2]>,
    /// Between two levels.
    level: f64,
    /// The width of a leaf.
    leaf: f64,
    /// Height of the drawing.
    pub height: f64,
}

impl Tree {
    /// Finds a place for every node that there will be.
    pub fn new(trace: &Trace) -> Tree {
        let Some(last) = trace.steps.last().filter(|last| !last.state.nodes.is_empty()) else {
            return Tree::default();
        };
        let nodes = &last.state.nodes;
        let levels = (nodes.iter().map(|node| node.level).max().unwrap_or(0) + 2) as f64;
        let is_leaf = |child: &Child| matches!(child, Child::Leaf(_));
        let leaves = nodes.iter().flat_map(|node| node.children).filter(is_leaf).count();
        let level = (460.0 / levels).min(64.0);
        let leaf = WIDTH / leaves.max(1) as f64;
        let places = vec![[0.0, 0.0]; nodes.len()];
        let mut tree = Tree { places, level, leaf, height: level * levels };
        tree.place(nodes, 0, &mut 0.0);
        tree
    }

    /// Places a node above the middle of what is below it; where that is. As deep as the tree,
    /// twice 6 levels at most.
    fn place(&mut self, nodes: &[Node], node: usize, next: &mut f64) -> f64 {
        let mut below = Vec::new();
        for child in nodes[node].children {
            match child {
                Child::Node(child) => below.push(self.place(nodes, child as usize, next)),
                Child::Leaf(_) => {
                    below.push(self.leaf * (*next + 0.5));
                    *next += 1.0;
                }
                Child::None => {}
            }
        }
        let x = if below.is_empty() {
            0.5 * WIDTH
        } else {
            below.iter().sum::<f64>() / below.len() as f64
        };
        self.places[node] = [x, self.level * (nodes[node].level as f64 + 0.4)];
        x
    }

    /// The nodes and leaves that there are at this step.
    pub fn draw(&self, trace: &Trace, step: &Step) -> String {
        let Some(last) = trace.steps.last() else { return String::new() };
        let (nodes, all) = (&step.state.nodes, &last.state.nodes);
        let visited = |node: usize| step.marks.path.contains(&(node as u32));
        let cell = step.marks.cell.or(step.marks.central);
        let (mut edges, mut marks) = (String::new(), String::new());
        // Leaves stand in the order of the whole tree, also those that are not there yet.
        let mut leaf = 0.0;
        let mut waiting: Vec<usize> = (0..all.len().min(1)).collect();
        while let Some(at) = waiting.pop() {
            let place = self.places[at];
            if at < nodes.len() {
                marks += &format!(
                    "<circle class=\"node{}\" cx=\"{}\" cy=\"{}\" r=\"6\"/>",
                    if visited(at) { " on" } else { "" },
                    px(place[0]),
                    px(place[1])
                );
            }
            for child in all[at].children {
                let Child::Node(child) = child else { continue };
                let child = child as usize;
                if child < nodes.len() {
                    let on = visited(at) && visited(child);
                    edges += &edge(on, place, self.places[child]);
                }
            }
            // The lower half first, so that leaves are met from left to right.
            for child in all[at].children.iter().rev() {
                if let Child::Node(child) = child {
                    waiting.push(*child as usize);
                }
            }
            for half in [0, 1] {
                let Child::Leaf(_) = all[at].children[half] else { continue };
                let level = all[at].level as f64 + 1.4;
                let [x, y] = [self.leaf * (leaf + 0.5), self.level * level];
                leaf += 1.0;
                let Some(Child::Leaf(head)) = nodes.get(at).map(|node| node.children[half]) else {
                    continue;
                };
                let its_cell = trace.discs.get(head as usize).map(|disc| disc.cell);
                let on = visited(at) && cell == its_cell;
                edges += &edge(on, place, [x, y]);
                let width = (self.leaf - 2.0).min(38.0);
                marks += &format!(
                    "<rect class=\"v{}\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"24\" \
                     rx=\"3\"/><text class=\"t\" x=\"{}\" y=\"{}\">{}</text>",
                    if on { " on" } else { "" },
                    px(x - 0.5 * width),
                    px(y - 12.0),
                    px(width),
                    px(x),
                    px(y + 6.0),
                    trace.names.particle(head)
                );
            }
        }
        edges + &marks
    }
}

fn edge(on: bool, from: [f64; 2], to: [f64; 2]) -> String {
    let mut line = String::new();
    segment(&mut line, from, to);
    format!("<path class=\"edge{}\" d=\"{line}\"/>", if on { " on" } else { "" })
}
