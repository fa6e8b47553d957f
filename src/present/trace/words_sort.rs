//! What a step of sorting does, in plain words.

use crate::event::Event;
use crate::present::trace::recorder::{Marks, Recorder};

/// A step for an event of sorting, if it is one.
pub fn sentence(recorder: &Recorder, event: &Event) -> Option<(String, Marks)> {
    let (names, state) = (&recorder.names, &recorder.state);
    // Places count as particles do.
    let place = |at: usize| at as u32 + names.first;
    let places = |[from, to]: [usize; 2]| match to - from {
        1 => format!("place {}", place(from)),
        _ => format!("places {} to {}", place(from), place(to) - 1),
    };
    let key = |axis: usize, key: u32| key + names.shift[axis];
    let (letter, cells) = (['X', 'Y'], ["column", "row"]);
    match *event {
        Event::Key { axis, particle, key: value } => {
            let k = names.particle(particle);
            let words = format!(
                "Particle {k} lies in {} {}: {}[{k}] = {}.",
                cells[axis],
                key(axis, value),
                letter[axis],
                key(axis, value)
            );
            let written = vec![(letter[axis], particle as usize)];
            Some((words, Marks { particle: Some(particle), written, ..Marks::default() }))
        }
        Event::Halve { axis, places: range, values: [min, max], mid } => {
            let words = format!(
                "In {} every {} is from {} to {}. Halve the range of values: those below {} go \
                 left, the others right.",
                places(range),
                cells[axis],
                key(axis, min),
                key(axis, max),
                key(axis, mid)
            );
            Some((words, Marks { range: Some(range), ..Marks::default() }))
        }
        Event::Swap { axis, places: [a, b] } => {
            let at = |at: usize| {
                state.keys[axis].get(at).copied().flatten().map_or(0, |value| key(axis, value))
            };
            let words = format!(
                "From the left the pointer stops at place {}, {} {}; from the right at place {}, \
                 {} {}: they change places.",
                place(a),
                cells[axis],
                at(b),
                place(b),
                cells[axis],
                at(a)
            );
            let arrays = letter[axis..].iter().chain(&['D']);
            let written = arrays.flat_map(|&array| [(array, a), (array, b)]).collect();
            Some((words, Marks { written, ..Marks::default() }))
        }
        Event::Halved { axis, places: [from, to], middle } => {
            let words = match (middle == from, middle == to) {
                (true, _) => format!(
                    "The pointers meet: all of {} are in the upper half of the values.",
                    places([from, to])
                ),
                (_, true) => format!(
                    "The pointers meet: all of {} are in the lower half of the values.",
                    places([from, to])
                ),
                _ => format!(
                    "The pointers meet: the lower {}s are in {}, the upper ones in {}.",
                    cells[axis],
                    places([from, middle]),
                    places([middle, to])
                ),
            };
            Some((words, Marks { range: Some([from, to]), ..Marks::default() }))
        }
        Event::Found { cell, places: range } => {
            let name = names.cell(cell);
            let particles: Vec<String> = state.particles[range[0]..range[1]]
                .iter()
                .map(|&k| names.particle(k).to_string())
                .collect();
            let found = match range[1] - range[0] {
                0 => "no particle is there".into(),
                1 => format!("particle {} at {}", particles[0], places(range)),
                _ => format!("particles {} at {}", particles.join(", "), places(range)),
            };
            let central = recorder.central == Some(cell);
            let words = if central {
                format!(
                    "The next cell that is not empty is {name}: {found}. It is the central cell."
                )
            } else {
                let looked: Vec<String> =
                    recorder.places.iter().map(|&at| place(at).to_string()).collect();
                let s = if looked.len() == 1 { "" } else { "s" };
                format!(
                    "Mask cell {name}: a binary search looks at place{s} {}: {found}.",
                    looked.join(", ")
                )
            };
            let read = recorder.places.iter().flat_map(|&at| [('X', at), ('Y', at)]).collect();
            Some((
                words,
                Marks {
                    cell: (!central).then_some(cell),
                    read,
                    range: (range[0] < range[1]).then_some(range),
                    ..Marks::default()
                },
            ))
        }
        _ => None,
    }
}
