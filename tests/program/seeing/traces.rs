//! Tests that traces follow the detectors, and show the states printed in the book.

use contactbench::views::trace::{Algorithm, Trace, example, page, trace};
use contactbench_detectors::table;
use contactbench_ground::contact::Test;
use contactbench_ground::detect::Options;
use contactbench_ground::probe::Tally;

use super::{ALL, discs, scene};

/// A trace counts the same operations as the detector, and has its contacts in the same order.
#[test]
fn a_trace_counts_and_finds_what_the_counted_build_does() {
    let scenes = [
        "packed:n=40",
        "loose:n=25,fraction=0.2",
        "clustered:n=30",
        "pack-a:n=36",
        "packed:n=1",
        "loose:n=30,size-ratio=3,offset=1e6",
    ];
    for algorithm in ALL {
        let book = example::example(algorithm).scene();
        let cases =
            scenes.iter().map(|text| (*text, Some(scene(text)))).chain([("the book's", None)]);
        for (name, given) in cases {
            let trace = trace(algorithm, given.as_ref())
                .unwrap_or_else(|error| panic!("{algorithm:?} {name}: {error:#}"));
            let (mut tally, mut pairs) = (Tally::default(), Vec::new());
            let mut detector = table::find(algorithm.name()).unwrap().make(Options::default());
            let scene = given.as_ref().unwrap_or(&book);
            detector.count(scene, Test::Exact, &mut tally, &mut pairs).unwrap();
            let last = trace.steps.last().unwrap();
            assert_eq!((last.tally, trace.tally), (tally, tally), "{algorithm:?} {name}");
            assert_eq!(trace.contacts, pairs, "{algorithm:?} {name}");
            assert_eq!(last.state.contacts, pairs, "{algorithm:?} {name}");
            // The counters never decrease, and every step has a sentence.
            for pair in trace.steps.array_windows::<2>() {
                assert!(pair[0].tally.iter().zip(pair[1].tally.iter()).all(|(a, b)| a.1 <= b.1));
            }
            assert!(
                trace.steps.iter().all(|step| step.words.ends_with('.')),
                "{algorithm:?} {name}"
            );
        }
    }
}

fn heads(trace: &Trace, step: usize, letter: char) -> Vec<i64> {
    let value = |list: i64| {
        let list = usize::try_from(list).ok();
        let first = list.and_then(|list| trace.steps[step].state.value(letter, list));
        first.map_or(-1, |k| i64::from(k) + 1)
    };
    let shift = i64::from(trace.names.shift[usize::from(letter == 'B')]);
    (1..=10).map(|shown| value(shown - shift)).collect()
}

fn links(trace: &Trace, step: usize, letter: char) -> Vec<i64> {
    let links = trace.steps[step].state.array(letter).iter();
    links.map(|next| next.value.map_or(-1, |k| i64::from(k) + 1)).collect()
}

/// The arrays equal those of example G5 in the book (pages 103 to 110).
#[test]
fn the_books_ten_particles_are_shown_as_printed() {
    let trace = trace(Algorithm::Nbs, None).unwrap();
    assert_eq!(trace.steps.len(), 144);
    assert_eq!(heads(&trace, 10, 'B'), [-1, -1, -1, -1, 5, 9, 10, 2, -1, -1]);
    assert_eq!(links(&trace, 10, 'Y'), [-1, -1, -1, 1, -1, 3, 4, 6, 8, 7]);
    // This state has the x-lists of row 7, and not yet those of the row below.
    let row_7 = trace.steps.iter().position(|step| step.marks.written.contains(&('A', 1))).unwrap();
    let pushed = (row_7..)
        .find(|&step| trace.steps[step].marks.written.iter().any(|(letter, _)| *letter == 'a'))
        .unwrap()
        - 1;
    assert_eq!(heads(&trace, pushed, 'A'), [-1, -1, 7, 1, 4, -1, -1, -1, -1, -1]);
    assert_eq!(links(&trace, pushed, 'X'), [10, -1, -1, -1, -1, -1, -1, -1, -1, -1]);
    let last = trace.steps.len() - 1;
    for letter in ['A', 'a', 'B'] {
        assert_eq!(heads(&trace, last, letter), [-1; 10]);
        assert!(trace.steps[last].state.array(letter).iter().all(|head| !head.old));
    }
}

/// Checks examples G2 (pages 90 and 91) and G3 (95 to 98) of the book, and a binary tree.
#[test]
fn the_other_examples_are_shown_as_printed() {
    let screening = trace(Algorithm::Screening, None).unwrap();
    assert_eq!(screening.steps.len(), 70);
    assert_eq!(links(&screening, 9, 'E'), [-1, 1, -1, 2, 3, -1, 5, -1, 7]);
    let (nx, c) = (screening.cells.count[0], screening.steps[9].state.array('C'));
    let shown =
        |column: u32, row: u32| c[((row - 5) * nx + column - 1) as usize].value.map(|k| k + 1);
    assert_eq!(
        [shown(2, 7), shown(5, 6), shown(5, 7), shown(6, 6)],
        [Some(9), Some(6), Some(4), Some(8)]
    );
    assert_eq!(c.iter().filter(|head| head.value.is_some()).count(), 4);

    let sorting = trace(Algorithm::Sorting, None).unwrap();
    assert_eq!(sorting.steps.len(), 189);
    let last = &sorting.steps.last().unwrap().state;
    let keys = |axis: usize| {
        let keys = last.array(['X', 'Y'][axis]).iter();
        keys.map(|key| sorting.names.key(axis, key.value.unwrap())).collect::<Vec<_>>()
    };
    assert_eq!((keys(0), keys(1)), (vec![3, 4, 4, 4, 5, 5, 5, 6], vec![7, 5, 6, 7, 6, 7, 8, 6]));
    assert_eq!(links(&sorting, 188, 'D'), [7, 5, 3, 1, 6, 4, 2, 8]);
    // Figures 3.25 to 3.27: the halves that the search for cell (5, 7) keeps.
    let steps = sorting.steps.iter().filter(|step| step.words.starts_with("Mask cell (5, 7): "));
    let search: Vec<_> = steps.collect();
    let kept: Vec<_> = search.iter().map(|step| step.marks.range.unwrap()).collect();
    assert_eq!(kept, [[4, 8], [4, 6], [5, 6], [5, 6]]);
    assert!(search[3].words.ends_with("particle 4 at place 6."));

    let tree = trace(Algorithm::BinaryTree, None).unwrap();
    assert_eq!(tree.steps.len(), 78);
    assert_eq!(links(&tree, 77, 'E'), [-1, -1, -1, -1, -1, -1, -1, -1, -1, 1]);
    let nodes = tree.tally.get(contactbench_ground::probe::Op::NodeVisit);
    assert!(nodes > 10 * 8, "{nodes}");
}

#[test]
fn traces_refuse_what_they_cannot_show() {
    let far = discs(&[[0.0, 0.0], [500.0, 0.0]], 0.5);
    for (scene, words) in [
        (scene("packed:dim=3,n=20"), "of spheres"),
        (scene("packed:n=61"), "61 particles"),
        (scene("packed:n=0"), "no particles"),
        (far, "502 x 3 cells"),
    ] {
        let error = trace(Algorithm::Nbs, Some(&scene)).unwrap_err();
        assert!(format!("{error:#}").contains(words), "{error:#}");
    }
    // In a crowd every pair is in contact, and the page stays small.
    for (algorithm, n) in ALL.into_iter().zip([60, 20, 20, 20]) {
        let crowd = discs(&vec![[0.0, 0.0]; n], 0.5);
        let trace = trace(algorithm, Some(&crowd)).unwrap();
        assert_eq!(trace.contacts.len(), n * (n - 1) / 2);
        assert!(page::html(&trace, "crowd").len() < 5_000_000);
    }
}
