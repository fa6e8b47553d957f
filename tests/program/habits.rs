//! `verify` and what people bring to it: frozen groups, six digits, lists by id without ids.

use std::fmt::Write as _;

use crate::common::{file, good, refused, run};

/// A floor of three spheres (type 2) that overlap, and two that roll on it; LAMMPS with
/// `neigh_modify exclude type 2 2` lists only the contacts of those.
const FLOOR: &str = "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n5\nITEM: BOX BOUNDS ff ff ff\n-9 9\n\
                     -9 9\n-9 9\nITEM: ATOMS id type x y z radius\n10 2 0 0 0 1\n11 2 1 0 0 1\n12 2 \
                     2 0 0 1\n1 1 0 0 2 1\n2 1 1 0 2 1\n";
const LISTED: &str = "i,j\n1,2\n1,10\n2,11\n";

/// Contacts of a floor are left out of both, by type and between types, and it is said how many.
#[test]
fn groups_are_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "p.dump", FLOOR);
    file(folder, "l.csv", LISTED);
    let verify = ["verify", "p.dump", "--pairs", "l.csv", "--ids"];
    let with = |arguments: &[&str]| run(folder, &[&verify, arguments].concat());
    // 10,11, 10,12 (tangent) and 11,12 of the floor.
    let plain = with(&[]);
    assert!(plain.code == Some(1) && plain.stdout.contains("missed"), "{}", plain.stdout);
    let between = good(folder, &[&verify[..], &["--without", "type=2:2"]].concat());
    assert!(between.stdout.contains("left out: 3 contacts, 0 pairs of the list"));
    assert!(between.stdout.contains("the same"), "{}", between.stdout);
    // All contacts with the floor: two of the list are left out, too.
    let all = good(folder, &[&verify[..], &["--without", "type=2"]].concat());
    assert!(all.stdout.contains("left out: 5 contacts, 2 pairs of the list"), "{}", all.stdout);
    // Several, by any column, as numbers or as words.
    for terms in ["type=2:2,type=1:1", "type=1:1,type=2.0:2", "id=1:2,id=10,id=11,id=12"] {
        let ended = with(&["--without", terms]);
        assert!(ended.stdout.contains("left out: "), "{terms}: {}", ended.stderr);
    }
    // In a box, and in all frames.
    for more in [&["--periodic", "xy"][..], &["--frame", "all"]] {
        let arguments = [&verify[..], &["--without", "type=2:2"], more].concat();
        assert!(good(folder, &arguments).stdout.contains("left out: 3 contacts"), "{more:?}");
    }
    for (terms, words) in
        [("kind=2", &["no such column", "id type x"][..]), ("type=7", &["no particle has type 7"])]
    {
        refused(folder, &[&verify[..], &["--without", terms]].concat(), words);
    }
    // Where only some frames have such particles.
    let second = FLOOR.replace("TIMESTEP\n0", "TIMESTEP\n5").replace(" 2 ", " 3 ");
    file(folder, "two.dump", format!("{FLOOR}{second}"));
    file(folder, "two.csv", "step,i,j\n0,1,2\n0,1,10\n0,2,11\n5,1,2\n5,1,10\n5,2,11\n");
    let two = ["verify", "two.dump", "--pairs", "two.csv", "--ids", "--frame", "all"];
    let ended = run(folder, &[&two[..], &["--without", "type=2:2,type=3:3"]].concat());
    assert!(ended.stdout.contains("left out: 6 contacts"), "{}{}", ended.stdout, ended.stderr);
    for (terms, words) in [
        ("type", "not of the form type=2"),
        ("type=1:2:3", "more than two values"),
        ("type=1,id=2", "name one"),
        ("type=", "empty"),
    ] {
        let ended = with(&["--without", terms]);
        assert!(ended.code == Some(2) && ended.stderr.contains(words), "{}", ended.stderr);
    }
}

/// Six digits, as LAMMPS writes them, are recognised; all digits, and the few of a lattice, are
/// let alone.
#[test]
fn few_digits_are_recognised() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "l.csv", "i,j\n");
    let said = |name: &str, of: &dyn Fn(usize, usize) -> String| {
        let mut text = String::from("x,y,z,r\n");
        (0..40).for_each(|k| {
            let _ = writeln!(text, "{},{},{},1e-9", of(k, 0), of(k, 1), of(k, 2));
        });
        file(folder, name, &text);
        good(folder, &["verify", name, "--pairs", "l.csv"]).stderr
    };
    let at = |k: usize, axis: usize| ((k * 3 + axis) as f64 * 0.754_877_666_246_69).fract() * 50.0;
    let six = said("six.csv", &|k, axis| format!("{:.4}", at(k, axis)));
    assert!(six.contains("6 significant digits at most") && six.contains("%.17g"), "{six}");
    for (name, of) in [
        ("all.csv", &(|k, axis| format!("{}", at(k, axis))) as &dyn Fn(usize, usize) -> String),
        ("lattice.csv", &|k, axis| format!("{}", [k / 4, k % 4, k][axis] as f64 * 0.5)),
        ("round.csv", &|k, axis| format!("{:e}", (1 + k + axis) as f64 * 1e7)),
    ] {
        assert!(!said(name, of).contains("digits"), "{name}");
    }
}

/// A list of ids beside particles without them is taken by places, and that is said.
#[test]
fn ids_that_are_not_there_are_missed() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "p.csv", "x,y,r\n0,0,1\n1,0,1\n9,0,1\n");
    let local = "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ENTRIES\n1\nITEM: ENTRIES c_p[1] c_p[2]\n1 2\n";
    file(folder, "l.dump", local);
    let verify = ["verify", "p.csv", "--pairs", "l.dump"];
    let ended = good(folder, &verify);
    assert!(ended.stderr.contains("has no column id"), "{}", ended.stderr);
    let chosen = good(folder, &[&verify[..], &["--base", "1"]].concat());
    assert!(!chosen.stderr.contains("has no column id"), "{}", chosen.stderr);
}
