//! What a step does, in plain words.

use std::fmt;

use crate::event::{Event, Part};
use crate::present::trace::Algorithm;
use crate::present::trace::recorder::{Marks, Names, Recorder};
use crate::present::trace::state::State;

/// A list, as shown.
pub struct Chain(pub Vec<u32>);

impl fmt::Display for Chain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<String> = self.0.iter().map(u32::to_string).collect();
        f.write_str(&names.join(" \u{2192} "))
    }
}

/// The first step.
pub fn beginning(recorder: &Recorder) -> String {
    let n = recorder.discs.len();
    let what = match recorder.algorithm {
        Algorithm::Nbs => {
            "All lists are empty: every head is -1. B has a head for each row, A and A' one for \
             each column."
        }
        Algorithm::Screening => {
            "All lists are empty: every head is -1. C has a head for each cell of the domain."
        }
        Algorithm::Sorting => {
            "Three arrays of one number per particle: X and Y for columns and rows, D for the \
             particles' numbers."
        }
        Algorithm::BinaryTree => {
            "A cell as large as the largest disc is found by halving a square, again and again: a \
             tree of nodes."
        }
    };
    format!(
        "{n} particle{}, in cells as large as the largest disc. {what}",
        if n == 1 { "" } else { "s" }
    )
}

/// The last step.
pub fn end(recorder: &Recorder) -> String {
    let contacts = recorder.state.contacts.len();
    let arrays = match recorder.algorithm {
        Algorithm::Nbs => {
            " All heads are empty and new again, without a loop over cells: ready for the next \
             detection."
        }
        Algorithm::Screening => {
            " All heads and links are empty again, without a loop over cells: ready for the next \
             detection."
        }
        Algorithm::Sorting | Algorithm::BinaryTree => "",
    };
    format!(
        "Done: {contacts} contact{}, each found once.{arrays}",
        if contacts == 1 { "" } else { "s" }
    )
}

/// The title of a part.
pub fn title(part: Part, row: Option<u32>, names: &Names) -> String {
    let row = row.map_or(0, |row| row + names.shift[1]);
    match part {
        Part::Rows => "All particles go on the lists of their rows".into(),
        Part::CentralRow { .. } => {
            format!("Row {row}: it and the row below go on lists of columns")
        }
        Part::Columns => format!("Row {row}: its cells are checked"),
        Part::RemoveColumns => format!("Row {row}: the lists of columns are emptied"),
        Part::RemoveRows => "The lists of rows are emptied".into(),
        Part::Cells => "All particles go on the lists of their cells".into(),
        Part::Search => "The cells that are not empty are checked".into(),
        Part::RemoveCells => "The lists are emptied".into(),
        Part::Fill => "The arrays are filled".into(),
        Part::Sort => "The arrays are sorted".into(),
        Part::Tree { .. } => "All particles go down the tree".into(),
        Part::Walk => "The tree is walked over, from leaf to leaf".into(),
    }
}

/// The root alone.
pub fn tree(halvings: u32) -> String {
    format!(
        "Halved {halvings} times along x and along y, in turn, the square has {} levels of nodes. \
         There is the root; others are made where they are needed.",
        2 * halvings
    )
}

/// A step for an event, if it is one; `before` is the state before it.
pub fn sentence(recorder: &Recorder, before: &State, event: &Event) -> Option<(String, Marks)> {
    let names = &recorder.names;
    match *event {
        Event::Push { heads, list, particle, next } => {
            Some(push(recorder, heads, list, particle, next))
        }
        Event::Take { heads, list, first, old } => Some(take(recorder, heads, list, first, old)),
        Event::Look { heads, list, first } => Some(look(recorder, heads, list, first)),
        Event::Reset { heads, list } => Some(reset(recorder, before, heads, list)),
        Event::Unlink { particle } => {
            let k = names.particle(particle);
            let marks = Marks {
                particle: Some(particle),
                written: vec![('E', particle as usize)],
                ..Marks::default()
            };
            Some((format!("E[{k}] = -1: its link is emptied, too."), marks))
        }
        Event::Test { i, j, touching } => Some(test(recorder, i, j, touching)),
        Event::Leaf { cell, particle, next, .. } => {
            let (k, cell_name) = (names.particle(particle), names.cell(cell));
            let nodes = match recorder.made {
                0 => "all nodes are there already".into(),
                1 => "1 node is made".into(),
                made => format!("{made} nodes are made"),
            };
            let words = format!(
                "Particle {k}, cell {cell_name}, goes down from the root: {nodes}. On the leaf's \
                 list: E[{k}] = {}, HEAD = {k}.",
                names.maybe(next)
            );
            let written = vec![('E', particle as usize)];
            Some((
                words,
                Marks { particle: Some(particle), cell: Some(cell), written, ..Marks::default() },
            ))
        }
        Event::Descended { cell, first } => {
            let visits = recorder.path.len();
            let end = match first {
                None => "there is nothing".into(),
                Some(_) => format!("the list there is {}", recorder.chain('E', first)),
            };
            let words = format!(
                "Mask cell {}: down from the root, {visits} node{}, and {end}.",
                names.cell(cell),
                if visits == 1 { "" } else { "s" }
            );
            Some((words, Marks { cell: Some(cell), ..Marks::default() }))
        }
        _ => crate::present::trace::words_sort::sentence(recorder, event),
    }
}

fn array(heads: char) -> &'static str {
    match heads {
        'B' => "B",
        'A' => "A",
        'a' => "A'",
        _ => "C",
    }
}

/// A head, as B[7] or C(4, 7), and a place for it, as "row 7" or "cell (4, 7)".
fn head(recorder: &Recorder, heads: char, list: usize) -> (String, String) {
    let (names, list_at) = (&recorder.names, list as u32);
    match heads {
        'B' => (
            format!("B[{}]", list_at + names.shift[1]),
            format!("row {}", list_at + names.shift[1]),
        ),
        'C' => {
            let cell = recorder.cell_of('C', list).map_or(String::new(), |cell| names.cell(cell));
            (format!("C{cell}"), format!("cell {cell}"))
        }
        _ => {
            let cell = recorder.cell_of(heads, list).map_or(String::new(), |cell| names.cell(cell));
            (format!("{}[{}]", array(heads), list_at + names.shift[0]), format!("cell {cell}"))
        }
    }
}

fn link(heads: char) -> char {
    match heads {
        'B' => 'Y',
        'C' => 'E',
        _ => 'X',
    }
}

fn push(
    recorder: &Recorder,
    heads: char,
    list: usize,
    particle: u32,
    next: Option<u32>,
) -> (String, Marks) {
    let ((head, place), k, link) =
        (head(recorder, heads, list), recorder.names.particle(particle), link(heads));
    let was = recorder.names.maybe(next);
    let list_was = if next.is_none() { " (the list was empty)" } else { "" };
    let words = format!(
        "Particle {k} lies in {place} and goes to the front of its list: {link}[{k}] = {head} = \
         {was}{list_was}, then {head} = {k}."
    );
    let marks = Marks {
        particle: Some(particle),
        cell: recorder.cell_of(heads, list),
        written: vec![(heads, list), (link, particle as usize)],
        ..Marks::default()
    };
    (words, marks)
}

fn take(
    recorder: &Recorder,
    heads: char,
    list: usize,
    first: Option<u32>,
    old: bool,
) -> (String, Marks) {
    let (head, place) = head(recorder, heads, list);
    let whose = match (recorder.visiting, heads) {
        (Some(k), _) => format!("Particle {} lies in {place}. ", recorder.names.particle(k)),
        (None, 'B') => format!("Upwards to {place}. "),
        (None, _) => String::new(),
    };
    let new = first.is_some() && !old;
    let answer = match (first, old) {
        (None, _) => format!("{head} = -1: it is empty"),
        (Some(_), true) => format!("{head} is marked old: it has been dealt with"),
        (Some(_), false) => {
            let role = if heads == 'B' { "the central row" } else { "the central cell" };
            let list = recorder.chain(link(heads), first);
            format!(
                "{head} = {} is new: mark it old. It is {role}, with the list {list}",
                recorder.names.maybe(first)
            )
        }
    };
    let mut marks = Marks {
        particle: recorder.visiting,
        cell: recorder.cell_of(heads, list),
        ..Marks::default()
    };
    if heads == 'B' {
        marks.row = Some(list as u32);
    }
    if new {
        marks.written.push((heads, list))
    } else {
        marks.read.push((heads, list))
    }
    (format!("{whose}{answer}."), marks)
}

fn look(recorder: &Recorder, heads: char, list: usize, first: Option<u32>) -> (String, Marks) {
    let (head, place) = head(recorder, heads, list);
    let which = if heads == 'B' {
        format!("The row below, {place}")
    } else {
        format!("Contact mask, {place}")
    };
    let content = match first {
        None => "-1, it is empty".into(),
        Some(_) => format!(
            "{}, its list is {}",
            recorder.names.maybe(first),
            recorder.chain(link(heads), first)
        ),
    };
    (
        format!("{which}: {head} = {content}."),
        Marks {
            cell: recorder.cell_of(heads, list),
            read: vec![(heads, list)],
            ..Marks::default()
        },
    )
}

fn reset(recorder: &Recorder, before: &State, heads: char, list: usize) -> (String, Marks) {
    let (head, place) = head(recorder, heads, list);
    let already = before.heads_of(heads).get(list).is_some_and(|head| head.first.is_none());
    let words = match already {
        true => format!("{head} = -1: it was already, as another particle of {place} came first."),
        false => format!("{head} = -1: the list of {place} is empty and new again."),
    };
    let marks = Marks {
        cell: recorder.cell_of(heads, list),
        written: vec![(heads, list)],
        ..Marks::default()
    };
    (words, marks)
}

fn test(recorder: &Recorder, i: u32, j: u32, touching: bool) -> (String, Marks) {
    let (names, pair) = (&recorder.names, [i, j].map(|k| &recorder.discs[k as usize]));
    let [a, b] = pair;
    let distance = (a.at[0] - b.at[0]).hypot(a.at[1] - b.at[1]);
    let place = match a.cell == b.cell {
        true => format!("both in cell {}", names.cell(a.cell)),
        false => format!("in cells {} and {}", names.cell(a.cell), names.cell(b.cell)),
    };
    let (sign, answer) = match touching {
        true => ("at most", format!("contact number {}", recorder.state.contacts.len())),
        false => ("more than", "no contact".into()),
    };
    let words = format!(
        "Particles {} and {}, {place}: the distance {} is {sign} {}, the sum of the radii: \
         {answer}.",
        names.particle(i),
        names.particle(j),
        short(distance),
        short(a.r + b.r)
    );
    (words, Marks { pair: Some((i, j, touching)), ..Marks::default() })
}

/// A length with four digits.
pub fn short(x: f64) -> String {
    if x == 0.0 || (1e-3..1e5).contains(&x) {
        let decimals = (3 - x.max(1e-3).log10().floor() as i32).clamp(0, 6) as usize;
        let text = format!("{x:.decimals$}");
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_string()
        } else {
            text
        }
    } else {
        format!("{x:.3e}")
    }
}
