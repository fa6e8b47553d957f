//! Tests that operation counts are exact, and that counting changes no contact.

use std::collections::BTreeSet;

use contactbench::scene::spec::Spec;
use contactbench_detectors::table;
use contactbench_detectors::table::TABLE;
use contactbench_ground::contact::{Arithmetic, Test};
use contactbench_ground::detect::Options;
use contactbench_ground::pairs::sink::Digest;
use contactbench_ground::periodic::ContactList;
use contactbench_ground::periodic::Loaded;
use contactbench_ground::probe::{Op, Tally};
use contactbench_lists::searcher::Searcher;

use crate::make;

const SCENES: [&str; 6] = [
    "packed:dim=2,n=2000",
    "packed:dim=3,n=2000",
    "loose:dim=2,n=2000",
    "loose:dim=3,n=2000",
    "clustered:dim=2,n=2000",
    "clustered:dim=3,n=2000,size-ratio=4",
];

/// Counting does not change the contacts, and repeated counts are equal.
#[test]
fn counting_changes_nothing_and_repeats_exactly() {
    for entry in TABLE {
        for text in SCENES {
            let scene = make(text);
            let mut detector = entry.make(Options::default());
            let seen = [(); 2].map(|()| {
                let (mut tally, mut counted) = (Tally::default(), Digest::default());
                detector.count(&scene, Test::Exact, &mut tally, &mut counted).unwrap();
                let mut pairs = Vec::new();
                detector.list(&scene, Test::Exact, &mut pairs).unwrap();
                assert_eq!(counted, Digest::from_pairs(&pairs), "{} {text}", entry.name);
                tally
            });
            assert_eq!(seen[0], seen[1], "{} {text}", entry.name);
        }
    }
}

fn counted(detector: &str, text: &str) -> String {
    let given = Spec::parse(text).and_then(|spec| spec.given()).unwrap();
    let exact = Arithmetic::Exact;
    let loaded = Loaded::new(&given.scene, given.lattice, exact).unwrap();
    let mut searcher = Searcher::new(table::parse(detector).unwrap().make(Options::default()));
    let (frame, mut tally) = (loaded.frame(exact), Tally::default());
    searcher.find(frame, Some(&mut tally), &mut ContactList::default()).unwrap();
    // Key comparisons are left out where the standard library sorts: another version may differ.
    let own = |op| {
        op != Op::KeyCompare
            || !["sweep", "kd-tree", "bvh", "hgrid"].iter().any(|name| detector.starts_with(name))
    };
    tally
        .iter()
        .filter(|&(op, count)| count > 0 && own(op))
        .map(|(op, count)| format!("{}={count}", op.name()))
        .collect::<Vec<_>>()
        .join(" ")
}

/// Counts do not depend on the machine, and change only if an algorithm changes.
#[test]
fn counts_are_the_same_on_every_machine() {
    let blocks = include_str!("counts.txt").split_terminator("\n\n").skip(1);
    let (mut changed, mut pinned) = (Vec::new(), BTreeSet::new());
    for (text, detectors) in blocks.map(|block| block.split_once('\n').unwrap()) {
        for (detector, expected) in detectors.lines().map(|line| line.split_once(' ').unwrap()) {
            let found = counted(detector, text);
            if expected.contains("contact_test") {
                pinned.insert((detector, text.contains("dim=3")));
            }
            if found != expected {
                changed.push(format!("{text}\n- {detector} {expected}\n+ {detector} {found}"));
            }
        }
    }
    assert!(changed.is_empty(), "counts.txt differs:\n{}", changed.join("\n"));
    // One more test by any detector fails here, in 2D and in 3D.
    for entry in TABLE.iter().filter(|entry| !entry.is_control()) {
        let dims = [false, true].map(|dim| pinned.contains(&(entry.name, dim)));
        assert_eq!(dims, [true; 2], "counts.txt lacks contact tests of {}", entry.name);
    }
}
