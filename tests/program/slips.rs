//! Slips of users, and lists as other programs write them.

use crate::common::{file, good, run};

/// Pairs as other programs write them, through `verify`; `draw` and `detect` name what is amiss.
#[test]
fn slips_of_users_are_named_with_the_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "c.csv", "x,y,z,r\n0,0,0,0.5\n1,0,0,0.5\n2,0,0,0.5\n");
    let exact = |k: u32| format!("{k}.000000000000000000e+00");
    file(
        folder,
        "ids.txt",
        (0..3)
            .map(|k| [7 + k, k, 0, 0].map(exact).join(" ") + " 5.000000000000000000e-01\n")
            .fold("# id x y z r\n".to_string(), |text, line| text + &line),
    );
    file(folder, "byid.csv", "i,j\n7,8\n8,9\n");
    file(folder, "savetxt.txt", [[0, 1], [1, 2]].map(|p| p.map(exact).join(" ") + "\n").concat());
    file(folder, "matlab.txt", "% i j\n0 1\n1 2\n");
    file(folder, "tuple.txt", "(0, 1)\n");
    good(folder, &["verify", "ids.txt", "--pairs", "byid.csv", "--ids"]);
    good(folder, &["verify", "c.csv", "--pairs", "savetxt.txt"]);
    good(folder, &["verify", "c.csv", "--pairs", "matlab.txt"]);
    let lig = "ITEM: NUMBER OF ENTRIES\n1\nITEM: ENTRIES c_p[1] c_p[2] c_p[3]\n0.01 0.02 1\n";
    file(folder, "lig.dump", lig);
    // A library that decides by < misses the ties: exact ones, and none of them is there.
    file(folder, "ties.csv", "x,y,z,r\n0,0,0,0.5\n1,0,0,0.5\n1.75,0,0,0.5\n");
    file(folder, "strict.csv", "i,j\n1,2\n");
    for more in [&[][..], &["--box", "9,9,9", "--periodic", "xyz"]] {
        let verify = [&["verify", "ties.csv", "--pairs", "strict.csv"][..], more].concat();
        let ended = run(folder, &verify);
        let said = ended.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(ended.code, Some(1), "{said}");
        assert!(said.contains("contacts decided by <, where here it is <="), "{said}");
    }
    for (arguments, words) in [
        (&["verify", "c.csv", "--pairs", "tuple.txt"][..], "tuple.txt:1: column 1: '(0'"),
        (&["verify", "c.csv", "--pairs", "lig.dump"], "--pairs-columns I,J"),
        (&["draw", "c.csv", "--slice", "z=99"], "z goes from -0.5000 to 0.5000"),
        (&["detect", "-"], "/dev/stdin"),
        (&["track", "c.csv", "--tracker", "verlet"], "verlet(DETECTOR,rule=RULE,skin=S)"),
    ] {
        let ended = run(folder, arguments);
        assert_eq!(ended.code, Some(2), "{arguments:?}: {}", ended.stdout);
        assert!(ended.stderr.contains(words), "{arguments:?}: {}", ended.stderr);
    }
}
