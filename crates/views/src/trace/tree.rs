//! The binary tree of a step as SVG. Each node keeps the position that it has in the final tree.

use crate::trace::Trace;
use crate::trace::arrays::WIDTH;
use crate::trace::picture::{label, rect};
use crate::trace::recorder::Step;
use crate::trace::state::{Child, Node};
use crate::{px, segment};

#[derive(Default)]
pub struct Tree {
    nodes: Vec<[f64; 2]>,
    /// Positions of the leaves in both halves of each node of the final tree.
    leaves: Vec<[[f64; 2]; 2]>,
    level: f64,
    leaf: f64,
    pub height: f64,
}

impl Tree {
    pub fn new(trace: &Trace) -> Tree {
        let nodes = trace.steps.last().map_or(&[][..], |last| &last.state.nodes);
        let Some(deepest) = nodes.iter().map(|node| node.level).max() else {
            return Tree::default();
        };
        let levels = (deepest + 2) as f64;
        let is_leaf = |child: &Child| matches!(child, Child::Leaf(_));
        let leaves = nodes.iter().flat_map(|node| node.children).filter(is_leaf).count();
        let level = (460.0 / levels).min(64.0);
        let mut tree = Tree {
            nodes: vec![[0.0; 2]; nodes.len()],
            leaves: vec![[[0.0; 2]; 2]; nodes.len()],
            level,
            leaf: WIDTH / leaves.max(1) as f64,
            height: level * levels,
        };
        tree.place(nodes, 0, &mut 0.0);
        tree
    }

    /// Places a node above the middle of its children, and returns its position. Recurses to the
    /// depth of the tree, at most twice 6 levels.
    fn place(&mut self, nodes: &[Node], node: usize, next: &mut f64) -> f64 {
        let (mut below, level) = (Vec::new(), nodes[node].level as f64);
        for (half, child) in nodes[node].children.into_iter().enumerate() {
            match child {
                Child::Node(child) => below.push(self.place(nodes, child as usize, next)),
                Child::Leaf(_) => {
                    let x = self.leaf * (*next + 0.5);
                    self.leaves[node][half] = [x, self.level * (level + 1.4)];
                    below.push(x);
                    *next += 1.0;
                }
                Child::None => {}
            }
        }
        let x = match below.len() {
            0 => 0.5 * WIDTH,
            count => below.iter().sum::<f64>() / count as f64,
        };
        self.nodes[node] = [x, self.level * (level + 0.4)];
        x
    }

    pub fn draw(&self, trace: &Trace, step: &Step) -> String {
        let visited = |node: usize| step.marks.path.contains(&(node as u32));
        let cell = step.marks.cell.or(step.marks.central);
        let (mut edges, mut marks) = (String::new(), String::new());
        for (at, node) in step.state.nodes.iter().enumerate() {
            let place = self.nodes[at];
            let on = if visited(at) { " on" } else { "" };
            let [x, y] = place.map(px);
            marks += &format!("<circle class=\"node{on}\" cx=\"{x}\" cy=\"{y}\" r=\"6\"/>");
            for (half, child) in node.children.into_iter().enumerate() {
                match child {
                    Child::Node(child) => {
                        let on = visited(at) && visited(child as usize);
                        edges += &edge(on, place, self.nodes[child as usize]);
                    }
                    Child::Leaf(head) => {
                        let [x, y] = self.leaves[at][half];
                        let its_cell = trace.discs.get(head as usize).map(|disc| disc.cell);
                        let on = visited(at) && cell == its_cell;
                        edges += &edge(on, place, [x, y]);
                        let class = if on { "v on" } else { "v" };
                        let width = (self.leaf - 2.0).min(38.0);
                        let corner = [x - 0.5 * width, y - 12.0];
                        marks += &rect(class, corner, [width, 24.0], " rx=\"3\"");
                        marks += &label("t", [x, y + 6.0], None, trace.names.particle(head));
                    }
                    Child::None => {}
                }
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
