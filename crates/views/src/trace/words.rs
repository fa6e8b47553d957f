use crate::trace::Algorithm;
use crate::trace::recorder::{Marks, Names, Recorder};
use crate::trace::state::links;
use contactbench_ground::probe::event::{Event, Part};
use contactbench_terms::number::{number, plural};

pub fn beginning(recorder: &Recorder) -> String {
    let n = plural(recorder.discs.len(), "particle");
    let state = match recorder.algorithm {
        Algorithm::Nbs | Algorithm::Screening => "All heads of lists are empty: -1",
        Algorithm::Sorting => "X and Y will hold columns and rows, D the particles",
        Algorithm::BinaryTree => "A square is halved down to such cells: a tree of nodes",
    };
    format!("{n}, in cells as large as the largest disc. {state}.")
}

pub fn end(recorder: &Recorder) -> String {
    format!("Done: {}, each found once.", plural(recorder.state.contacts.len(), "contact"))
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
    let levels = 2 * halvings;
    format!("The tree has {levels} levels: x and y are halved {halvings} times, in turn.")
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

/// Formats the first particle of a list, and the list.
fn chain(recorder: &Recorder, heads: char, first: Option<u32>) -> String {
    let Some(k) = first else { return "-1: it is empty".into() };
    let (k, list) = (recorder.names.particle(k), recorder.chain(links(heads), first));
    format!("{k}, with the list {list}")
}

/// Describes an event of a list, and marks its head.
fn of_list(
    recorder: &Recorder,
    was_empty: bool,
    event: &Event,
    marks: &mut Marks,
) -> Option<String> {
    let names = &recorder.names;
    let (heads, list) = match *event {
        Event::Push { heads, list, .. }
        | Event::Take { heads, list, .. }
        | Event::Look { heads, list, .. }
        | Event::Reset { heads, list } => (heads, list),
        Event::Unlink { particle } => {
            (marks.particle, marks.written) = (Some(particle), vec![('E', particle as usize)]);
            return Some(format!("E[{}] = -1: its link is emptied.", names.particle(particle)));
        }
        _ => return None,
    };
    let ((head, place), at) = (head(recorder, heads, list), vec![(heads, list)]);
    let chain = |first| chain(recorder, heads, first);
    marks.cell = recorder.cell_of(heads, list);
    Some(match *event {
        Event::Push { particle, next, .. } => {
            let link = links(heads);
            marks.particle = Some(particle);
            marks.written = vec![(heads, list), (link, particle as usize)];
            let (k, was) = (names.particle(particle), names.maybe(next));
            format!(
                "Particle {k} goes to the front of the list of {place}: {link}[{k}] = {head} = \
                 {was}, then {head} = {k}."
            )
        }
        Event::Take { first, old, .. } => {
            marks.particle = recorder.visiting;
            marks.row = (heads == 'B').then_some(list as u32);
            let new = first.is_some() && !old;
            if new { &mut marks.written } else { &mut marks.read }.extend(at);
            let visitor = recorder.visiting.map(|k| format!("Particle {}, ", names.particle(k)));
            let holds = match old {
                true => "is marked old: it has been dealt with".into(),
                false => format!("= {}{}", chain(first), if new { ". Mark it old" } else { "" }),
            };
            format!("{}{place}: {head} {holds}.", visitor.unwrap_or_default())
        }
        Event::Look { first, .. } => {
            marks.read = at;
            let which = if heads == 'B' { "The row below" } else { "Contact mask" };
            format!("{which}, {place}: {head} = {}.", chain(first))
        }
        _ => {
            marks.written = at;
            let already = if was_empty { "was already" } else { "is" };
            format!("{head} = -1: the list of {place} {already} empty and new again.")
        }
    })
}

fn of_places(recorder: &Recorder, event: &Event, marks: &mut Marks) -> Option<String> {
    let (names, state) = (&recorder.names, &recorder.state);
    let (letter, cells) = (['X', 'Y'], ["column", "row"]);
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
            let places = names.places(places);
            let cell = cells[axis];
            format!("In {places} {cell}s are {min} to {max}: those below {mid} go left.")
        }
        Event::Swap { axis, places } => {
            let arrays = letter[axis..].iter().chain(&['D']);
            marks.written = arrays.flat_map(|&array| places.map(|at| (array, at))).collect();
            let key = |at| state.value(letter[axis], at).map_or(0, |key| names.key(axis, key));
            let ([a, b], [left, right]) = (places.map(|at| names.place(at)), places.map(key));
            let cell = cells[axis];
            format!("Places {a} ({cell} {right}) and {b} ({cell} {left}) are exchanged.")
        }
        Event::Halved { axis, places: [from, to], middle } => {
            marks.range = Some([from, to]);
            let lower = middle - from;
            let all = names.places([from, to]);
            format!("The pointers meet: {lower} of {all} hold the lower {}s.", cells[axis])
        }
        Event::Kept { cell, compared, places } => {
            (marks.cell, marks.range) = (Some(cell), Some(places));
            marks.read = letter.map(|array| (array, compared)).into();
            let held = letter.map(|array| state.value(array, compared).unwrap_or(0));
            let lower = if held < cell { "lower" } else { "not lower" };
            let [cell, held] = [cell, held].map(|cell| names.cell(cell));
            let (place, kept) = (names.place(compared), names.places(places));
            format!("Mask cell {cell}: place {place} holds {held}, which is {lower}: keep {kept}.")
        }
        Event::Found { cell, places: [from, to] } => {
            marks.range = (from < to).then_some([from, to]);
            let values = (from..to).filter_map(|at| state.value('D', at));
            let here: Vec<_> = values.map(|k| names.particle(k).to_string()).collect();
            let found = match to - from {
                0 => "no particle is there".into(),
                1 => format!("particle {} at {}", here.concat(), names.places([from, to])),
                _ => format!("particles {} at {}", here.join(", "), names.places([from, to])),
            };
            let name = names.cell(cell);
            if recorder.central == Some(cell) {
                return Some(format!("The next central cell is {name}: {found}."));
            }
            marks.cell = Some(cell);
            format!("Mask cell {name}: {found}.")
        }
        _ => return None,
    })
}

fn of_particles(recorder: &Recorder, event: &Event, marks: &mut Marks) -> Option<String> {
    let names = &recorder.names;
    Some(match *event {
        Event::Leaf { cell, particle, next, .. } => {
            (marks.particle, marks.cell) = (Some(particle), Some(cell));
            marks.written = vec![('E', particle as usize)];
            let (k, cell, next) = (names.particle(particle), names.cell(cell), names.maybe(next));
            let made = plural(recorder.made, "new node");
            format!("Particle {k} goes down to cell {cell}, {made}: E[{k}] = {next}, head = {k}.")
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
            let [cell, other] = [a, b].map(|disc| names.cell(disc.cell));
            let (sign, answer) = match touching {
                true => ("at most", format!("contact {}", recorder.state.contacts.len())),
                false => ("more than", "no contact".into()),
            };
            format!(
                "Particles {} and {}, cells {cell} and {other}: the distance {} is {sign} {}, the \
                 sum of the radii: {answer}.",
                names.particle(i),
                names.particle(j),
                number((a.at[0] - b.at[0]).hypot(a.at[1] - b.at[1])),
                number(a.r + b.r)
            )
        }
        _ => return None,
    })
}
