use crate::trace::Algorithm;
use crate::trace::recorder::{Marks, Names, Recorder};
use crate::trace::state::links;
use contactbench_ground::probe::event::{Event, Part};
use contactbench_terms::number::plural;

/// Returns the texts shown before and after the steps of an algorithm.
fn about(algorithm: Algorithm) -> [&'static str; 2] {
    match algorithm {
        Algorithm::Nbs => [
            "All lists are empty: every head is -1. B has a head for each row, A and A' one for \
             each column.",
            " All heads are empty and new again, without a loop over cells: ready for the next \
             detection.",
        ],
        Algorithm::Screening => [
            "All lists are empty: every head is -1. C has a head for each cell of the domain.",
            " All heads and links are empty again, without a loop over cells: ready for the next \
             detection.",
        ],
        Algorithm::Sorting => [
            "Three arrays of one number per particle: X and Y for columns and rows, D for the \
             particles' numbers.",
            "",
        ],
        Algorithm::BinaryTree => [
            "A cell as large as the largest disc is found by halving a square, again and again: a \
             tree of nodes.",
            "",
        ],
    }
}

pub fn beginning(recorder: &Recorder) -> String {
    let (n, [begins, _]) = (recorder.discs.len(), about(recorder.algorithm));
    format!("{}, in cells as large as the largest disc. {begins}", plural(n, "particle"))
}

pub fn end(recorder: &Recorder) -> String {
    let (contacts, [_, ends]) = (recorder.state.contacts.len(), about(recorder.algorithm));
    format!("Done: {}, each found once.{ends}", plural(contacts, "contact"))
}

pub fn title(part: Part, row: Option<u32>, names: &Names) -> String {
    let row = row.map_or(0, |row| names.key(1, row));
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

pub fn tree(halvings: u32) -> String {
    format!(
        "Halved {halvings} times along x and along y, in turn, the square has {} levels of nodes. \
         There is the root; others are made where they are needed.",
        2 * halvings
    )
}

/// Returns sentence and marks of an event's step; `None` if the event makes no step. `was_empty` is
/// true if it resets a head that was empty.
pub fn sentence(recorder: &Recorder, was_empty: bool, event: &Event) -> Option<(String, Marks)> {
    let mut marks = Marks::default();
    let words = of_list(recorder, was_empty, event, &mut marks)
        .or_else(|| of_places(recorder, event, &mut marks))
        .or_else(|| of_particles(recorder, event, &mut marks))?;
    Some((words, marks))
}

/// Formats a head as `B[7]` or `C(4, 7)`, and its location as "row 7" or "cell (4, 7)".
fn head(recorder: &Recorder, heads: char, list: usize) -> (String, String) {
    let (names, at) = (&recorder.names, list as u32);
    let cell = recorder.cell_of(heads, list).map_or(String::new(), |cell| names.cell(cell));
    match heads {
        'B' => (format!("B[{}]", names.key(1, at)), format!("row {}", names.key(1, at))),
        'C' => (format!("C{cell}"), format!("cell {cell}")),
        'A' => (format!("A[{}]", names.key(0, at)), format!("cell {cell}")),
        _ => (format!("A'[{}]", names.key(0, at)), format!("cell {cell}")),
    }
}

fn of_list(
    recorder: &Recorder,
    was_empty: bool,
    event: &Event,
    marks: &mut Marks,
) -> Option<String> {
    let names = &recorder.names;
    Some(match *event {
        Event::Push { heads, list, particle, next } => {
            let ((head, place), link) = (head(recorder, heads, list), links(heads));
            (marks.particle, marks.cell) = (Some(particle), recorder.cell_of(heads, list));
            marks.written = vec![(heads, list), (link, particle as usize)];
            let (k, was) = (names.particle(particle), names.maybe(next));
            let empty = if next.is_none() { " (the list was empty)" } else { "" };
            format!(
                "Particle {k} lies in {place} and goes to the front of its list: {link}[{k}] = \
                 {head} = {was}{empty}, then {head} = {k}."
            )
        }
        Event::Take { heads, list, first, old } => take(recorder, (heads, list), first, old, marks),
        Event::Look { heads, list, first } => {
            let (head, place) = head(recorder, heads, list);
            (marks.cell, marks.read) = (recorder.cell_of(heads, list), vec![(heads, list)]);
            let which = if heads == 'B' { "The row below" } else { "Contact mask" };
            let content = match first {
                None => "-1, it is empty".into(),
                _ => {
                    let chain = recorder.chain(links(heads), first);
                    format!("{}, its list is {chain}", names.maybe(first))
                }
            };
            format!("{which}, {place}: {head} = {content}.")
        }
        Event::Reset { heads, list } => {
            let (head, place) = head(recorder, heads, list);
            (marks.cell, marks.written) = (recorder.cell_of(heads, list), vec![(heads, list)]);
            match was_empty {
                true => format!(
                    "{head} = -1: it was already, as another particle of {place} came first."
                ),
                false => format!("{head} = -1: the list of {place} is empty and new again."),
            }
        }
        Event::Unlink { particle } => {
            (marks.particle, marks.written) = (Some(particle), vec![('E', particle as usize)]);
            format!("E[{}] = -1: its link is emptied, too.", names.particle(particle))
        }
        _ => return None,
    })
}

/// Describes reading a head, which is marked old if it was new and not empty.
fn take(
    recorder: &Recorder,
    (heads, list): (char, usize),
    first: Option<u32>,
    old: bool,
    marks: &mut Marks,
) -> String {
    let (names, (head, place)) = (&recorder.names, head(recorder, heads, list));
    (marks.particle, marks.cell) = (recorder.visiting, recorder.cell_of(heads, list));
    marks.row = (heads == 'B').then_some(list as u32);
    let new = first.is_some() && !old;
    if new { &mut marks.written } else { &mut marks.read }.push((heads, list));
    let whose = match recorder.visiting {
        Some(k) => format!("Particle {} lies in {place}. ", names.particle(k)),
        None if heads == 'B' => format!("Upwards to {place}. "),
        None => String::new(),
    };
    let role = if heads == 'B' { "the central row" } else { "the central cell" };
    match (first, old) {
        (None, _) => format!("{whose}{head} = -1: it is empty."),
        (_, true) => format!("{whose}{head} is marked old: it has been dealt with."),
        _ => format!(
            "{whose}{head} = {} is new: mark it old. It is {role}, with the list {}.",
            names.maybe(first),
            recorder.chain(links(heads), first)
        ),
    }
}

fn of_places(recorder: &Recorder, event: &Event, marks: &mut Marks) -> Option<String> {
    let (names, state) = (&recorder.names, &recorder.state);
    let (letter, cells) = (['X', 'Y'], ["column", "row"]);
    let place = |at: usize| names.place(at);
    Some(match *event {
        Event::Key { axis, particle, key } => {
            marks.particle = Some(particle);
            marks.written = vec![(letter[axis], particle as usize)];
            let (k, array, key) = (names.particle(particle), letter[axis], names.key(axis, key));
            format!("Particle {k} lies in {} {key}: {array}[{k}] = {key}.", cells[axis])
        }
        Event::Halve { axis, places, values: [min, max], mid } => {
            marks.range = Some(places);
            let [min, max, mid] = [min, max, mid].map(|key| names.key(axis, key));
            format!(
                "In {} every {} is from {min} to {max}. Halve the range of values: those below \
                 {mid} go left, the others right.",
                names.places(places),
                cells[axis]
            )
        }
        Event::Swap { axis, places: [a, b] } => {
            let arrays = letter[axis..].iter().chain(&['D']);
            marks.written = arrays.flat_map(|&array| [(array, a), (array, b)]).collect();
            let key = |at| state.value(letter[axis], at).map_or(0, |key| names.key(axis, key));
            format!(
                "From the left the pointer stops at place {}, {cell} {}; from the right at place \
                 {}, {cell} {}: they change places.",
                place(a),
                key(b),
                place(b),
                key(a),
                cell = cells[axis]
            )
        }
        Event::Halved { axis, places: [from, to], middle } => {
            marks.range = Some([from, to]);
            let all = names.places([from, to]);
            let what = match middle {
                _ if middle == from => format!("all of {all} are in the upper half of the values"),
                _ if middle == to => format!("all of {all} are in the lower half of the values"),
                _ => format!(
                    "the lower {}s are in {}, the upper ones in {}",
                    cells[axis],
                    names.places([from, middle]),
                    names.places([middle, to])
                ),
            };
            format!("The pointers meet: {what}.")
        }
        Event::Found { cell, places } => found(recorder, cell, places, marks),
        _ => return None,
    })
}

fn found(recorder: &Recorder, cell: [u32; 2], places: [usize; 2], marks: &mut Marks) -> String {
    let (names, [from, to]) = (&recorder.names, places);
    marks.read = recorder.places.iter().flat_map(|&at| [('X', at), ('Y', at)]).collect();
    marks.range = (from < to).then_some(places);
    let listed =
        |numbers: Vec<u32>| numbers.iter().map(u32::to_string).collect::<Vec<_>>().join(", ");
    let values = (from..to).filter_map(|at| recorder.state.value('D', at));
    let here = listed(values.map(|k| names.particle(k)).collect());
    let found = match to - from {
        0 => "no particle is there".into(),
        1 => format!("particle {here} at {}", names.places(places)),
        _ => format!("particles {here} at {}", names.places(places)),
    };
    let name = names.cell(cell);
    if recorder.central == Some(cell) {
        return format!(
            "The next cell that is not empty is {name}: {found}. It is the central cell."
        );
    }
    marks.cell = Some(cell);
    let s = if recorder.places.len() == 1 { "" } else { "s" };
    let looked = listed(recorder.places.iter().map(|&at| names.place(at)).collect());
    format!("Mask cell {name}: a binary search looks at place{s} {looked}: {found}.")
}

fn of_particles(recorder: &Recorder, event: &Event, marks: &mut Marks) -> Option<String> {
    let names = &recorder.names;
    Some(match *event {
        Event::Leaf { cell, particle, next, .. } => {
            (marks.particle, marks.cell) = (Some(particle), Some(cell));
            marks.written = vec![('E', particle as usize)];
            let nodes = match recorder.made {
                0 => "all nodes are there already".into(),
                1 => "1 node is made".into(),
                made => format!("{made} nodes are made"),
            };
            format!(
                "Particle {k}, cell {}, goes down from the root: {nodes}. On the leaf's list: \
                 E[{k}] = {}, HEAD = {k}.",
                names.cell(cell),
                names.maybe(next),
                k = names.particle(particle)
            )
        }
        Event::Descended { cell, first } => {
            marks.cell = Some(cell);
            let end = match first {
                None => "there is nothing".into(),
                Some(_) => format!("the list there is {}", recorder.chain('E', first)),
            };
            let nodes = plural(recorder.path.len(), "node");
            format!("Mask cell {}: down from the root, {nodes}, and {end}.", names.cell(cell))
        }
        Event::Test { i, j, touching } => {
            marks.pair = Some((i, j, touching));
            let [a, b] = [i, j].map(|k| &recorder.discs[k as usize]);
            let place = match a.cell == b.cell {
                true => format!("both in cell {}", names.cell(a.cell)),
                false => format!("in cells {} and {}", names.cell(a.cell), names.cell(b.cell)),
            };
            let (sign, answer) = match touching {
                true => ("at most", format!("contact number {}", recorder.state.contacts.len())),
                false => ("more than", "no contact".into()),
            };
            format!(
                "Particles {} and {}, {place}: the distance {} is {sign} {}, the sum of the radii: \
                 {answer}.",
                names.particle(i),
                names.particle(j),
                short((a.at[0] - b.at[0]).hypot(a.at[1] - b.at[1])),
                short(a.r + b.r)
            )
        }
        _ => return None,
    })
}

fn short(x: f64) -> String {
    if x != 0.0 && !(1e-3..1e5).contains(&x) {
        return format!("{x:.3e}");
    }
    let decimals = (3 - x.max(1e-3).log10().floor() as i32).clamp(0, 6) as usize;
    match format!("{x:.decimals$}") {
        text if text.contains('.') => text.trim_end_matches('0').trim_end_matches('.').into(),
        text => text,
    }
}
