//! Contact lists of other codes in boxes.

use serde_json::{Value, json};

use super::{DATA, TILTED, json_of};
use crate::common::{file, good, refused, run};

#[test]
fn verify_compares_lists_with_images_and_without() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "tilted.dump", TILTED);
    file(folder, "one.csv", "x,y,z,r\n0.25,0.5,7,0.5\n");
    good(folder, &["detect", "tilted.dump", "-o", "own.npy"]);
    good(folder, &["detect", "tilted.dump", "-o", "own.csv"]);
    file(folder, "ids.csv", "i,j,sx,sy,sz\n2,1,0,0,0\n4,3,0,1,0\n");
    file(folder, "pairs.csv", "0,1\n3,2\n");
    let local = "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ENTRIES\n2\nITEM: BOX BOUNDS xy xz yz pp pp \
                 ff\n0 5 1\n0 4 0\n0 4 0\nITEM: ENTRIES c_1[1] c_1[2]\n1 2\n3 4\n";
    file(folder, "local.dump", local);
    let images = "pairs with their images";
    let through_one = "pairs; each touches through one image";
    for (arguments, compared) in [
        (&["own.npy", "--base", "0"][..], images),
        (&["own.csv", "--base", "0"], images),
        (&["ids.csv", "--ids"], images),
        (&["pairs.csv"], through_one),
        (&["local.dump"], through_one),
    ] {
        let verify = [&["verify", "tilted.dump", "--pairs"], arguments].concat();
        let found = json_of(folder, &[&verify[..], &["--json"]].concat());
        assert_eq!(
            (&found["same"], &found["contacts"], &found["compared"], &found["periodic"]),
            (&json!(true), &json!(2), &json!(compared), &json!([true, true, false])),
            "{arguments:?}: {found:#}"
        );
        let text = good(folder, &verify).stdout;
        let head = "tilted.dump: 4 particles, 2 touching pairs in a box that repeats along x and y \
                    (exact arithmetic)\n";
        assert!(text.starts_with(head), "{text}");
        assert!(text.contains(&format!("compared: {compared}\nthe same: no pair")), "{text}");
    }
    // One body that touches three pairs of images of itself.
    for (rows, compared) in [
        (1, "pairs without images, each once, through how many it touches"),
        (3, "pairs without images, each as often as images of it touch"),
    ] {
        file(folder, "self.csv", format!("i,j\n{}", "0,0\n".repeat(rows)));
        let verify = ["verify", "one.csv", "--pairs", "self.csv", "--box", "1,1,1", "--json"];
        let found = json_of(folder, &verify);
        assert_eq!((&found["same"], &found["compared"]), (&json!(true), &json!(compared)));
    }
    file(folder, "self.csv", "i,j,sx,sy,sz\n0,0,0,0,-1\n0,0,0,1,0\n0,0,-1,0,0\n");
    good(folder, &["verify", "one.csv", "--pairs", "self.csv", "--box", "1,1,1"]);
    // Without a box a body does not touch itself.
    file(folder, "self.csv", "i,j\n0,0\n");
    assert_eq!(run(folder, &["verify", "one.csv", "--pairs", "self.csv"]).code, Some(1));

    // What differs is shown with its image.
    file(
        folder,
        "wrong.csv",
        "i,j,sx,sy,sz\n0,1,0,0,0\n0,1,0,0,0\n2,3,0,0,0\n0,0,0,0,0\n0,9,0,0,0\n",
    );
    let ended = run(folder, &["verify", "tilted.dump", "--pairs", "wrong.csv"]);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    for part in [
        "missed       1  deepest overlap 0 mean radii",
        "spurious     1  widest gap 4.325 mean radii",
        "duplicate    1",
        "with itself  1",
        "unknown      1  such as 0,9: the file has no such particle",
        "  2,3  image 0,-1,0  overlap 0\n    2: 1.5 0.25 3.0 r 0.5\n",
        "  2,3  gap 4.325\n",
    ] {
        assert!(ended.stdout.contains(part), "'{part}' in:\n{}", ended.stdout);
    }
    let wrong = run(folder, &["verify", "tilted.dump", "--pairs", "wrong.csv", "--json"]);
    let found: Value = serde_json::from_str(&wrong.stdout).unwrap();
    assert_eq!(found["missed"][0]["image"], json!([0, -1, 0]), "{found:#}");
}

/// What is wrong with a list in a box, and the options with which it agrees.
#[test]
fn verify_says_which_option_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "tilted.dump", TILTED);
    file(folder, "p.lmp", DATA.replace("1 atoms", "2 atoms") + "2 1 1 1 4.25 1 1\n");
    file(folder, "near.csv", "x,y,r\n0.25,1,0.5\n3.25,1,0.5\n3.25,2.1,0.5\n");
    let list = |text: &str| file(folder, "list.csv", text);
    let hint = |arguments: &[&str], words: &str, flags: Value| {
        let verify = [&["verify"], arguments, &["--pairs", "list.csv"]].concat();
        let ended = run(folder, &verify);
        let said: String = ended.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(ended.code, Some(1), "{}{}", ended.stdout, ended.stderr);
        assert!(said.contains(&format!("hint: with {words}")), "'{words}' in:\n{}", ended.stdout);
        let found = run(folder, &[&verify[..], &["--json"]].concat());
        let found: Value = serde_json::from_str(&found.stdout).unwrap();
        assert_eq!(found["hint"], flags, "{found:#}");
        // With what is said it agrees.
        if let Some(flags) = flags.as_str() {
            let more: Vec<&str> = flags.split(' ').collect();
            good(folder, &[&verify[..], &more].concat());
        }
    };
    let tilted = ["tilted.dump"];
    list("i,j\n0,1\n");
    let open = "open boundaries (no contact across the box), the one pair agrees: add --open";
    hint(&tilted, open, json!("--open"));
    list("i,j,sx,sy,sz\n1,2,0,0,0\n3,4,0,-1,0\n");
    hint(&tilted, "numbers from 1, all 2 pairs agree: add --base 1", json!("--base 1"));
    list("i,j,sx,sy,sz\n0,1,0,0,0\n3,2,0,1,0\n1,0,0,0,0\n2,3,0,-1,0\n");
    let twice = "each pair taken once, which is listed as i,j and as j,i, all 2 pairs agree: add \
                 --both-sides";
    hint(&tilted, twice, json!("--both-sides"));
    list("i,j,sx,sy,sz\n0,1,0,0,0\n2,3,0,1,0\n");
    let turned =
        "images of i in the place of those of j (S with the other sign), all 2 pairs agree";
    hint(&tilted, turned, Value::Null);
    list("i,j\n0,1\n0,2\n1,2\n");
    let skin = "pairs up to 0.487 apart (a skin), all 3 pairs agree: add --skin 0.487";
    hint(&["near.csv", "--box", "4,4"], skin, json!("--skin 0.487"));
    list("i,j\n0,2\n1,2\n");
    file(folder, "row.csv", "x,y,r\n0.25,1,0.5\n3.25,1,0.5\n3.5,1.5,0.5\n");
    let tangent = "contacts decided by <, where here it is <= (each pair missed is an exact tie: the \
                   distance is the sum of the radii), all 2 pairs agree";
    hint(&["row.csv", "--box", "4,4"], tangent, Value::Null);
    // A box of which the file does not say whether it repeats, or that was left out.
    list("1,2\n2,1\n");
    let declared = "numbers from 1, and each pair taken once, which is listed as i,j and as j,i, \
                    and the file's box, repeating along x, y and z, the one pair agrees: add --base 1 \
                    --both-sides --periodic xyz";
    hint(&["p.lmp"], declared, json!("--base 1 --both-sides --periodic xyz"));
    list("0,1\n2,3\n");
    let ended = run(folder, &["verify", "tilted.dump", "--pairs", "list.csv", "--open"]);
    let left_out = "hint: with the file's box, repeating along x and y, all 2 pairs agree: leave \
                    out --open\n";
    assert!(ended.stdout.contains(left_out), "{}", ended.stdout);
    // A box that nobody has declared is guessed.
    let rows: String = (0..6).map(|k| format!("{},{},0.5\n", k % 2 * 5, 2 * (k / 2))).collect();
    file(folder, "guess.csv", format!("x,y,r\n{rows}"));
    list("0,1\n2,3\n4,5\n");
    let guess = "periodic images (a box of 6 along x), all 3 pairs agree: add --box 6.0,0.0 \
                 --periodic x";
    hint(&["guess.csv"], guess, json!("--box 6.0,0.0 --periodic x"));
}

#[test]
fn lists_that_do_not_fit_the_box_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "tilted.dump", TILTED);
    for (text, arguments, words) in [
        (
            "i,j,sx,sy,sz\n0,1,0,0,0\n0,1,0,0,1\n",
            &[][..],
            "list.csv: pair 1 of the list (from 0) names the image 0,0,1, and the box repeats \
             along x and y; give --periodic with all axes along which it repeats",
        ),
        (
            "i,j,sx,sy,sz\n0,1,0,0,0\n2,3,0,-1,0\n",
            &["--open"],
            "list.csv: pair 1 (from 0) names an image in a box that repeats, 0,-1,0, and boundaries \
             are open here; leave out --open, or --pairs-columns I,J if it is something else",
        ),
        (
            "i,j,sx\n0,1,0\n",
            &[],
            "list.csv:1: images need the columns sx and sy, and sz for spheres; name them",
        ),
        (
            "i,j,sx,sy,sz\n0,1,0,one,0\n",
            &[],
            "list.csv:2: column 4: 'one' is not the number of an image",
        ),
        (
            "i,j,sx,sy,sz\n0,1,0,0,3000000000\n",
            &[],
            "list.csv:2: 3000000000 is not the number of an image: below 2^31",
        ),
    ] {
        file(folder, "list.csv", text);
        let verify = ["verify", "tilted.dump", "--pairs", "list.csv"];
        let ended = refused(folder, &[&verify[..], arguments].concat(), &[]);
        assert_eq!(ended.stderr, format!("contactbench: {words}\n"));
    }
    // Images that are none are nothing special.
    file(folder, "list.csv", "i,j,sx,sy,sz\n0,1,0,0,0\n");
    good(folder, &["verify", "tilted.dump", "--pairs", "list.csv", "--open"]);
    file(folder, "three.npy", crate::common::npy(&[vec![0.0, 1.0, 0.0]]));
    refused(
        folder,
        &["verify", "tilted.dump", "--pairs", "three.npy"],
        &["pairs have the shape (pairs, 2) or (2, pairs), with images in a box (pairs, 4)"],
    );
}

/// A list of another code that made one of the usual mistakes, and what the hint says of it.
#[test]
fn the_usual_mistakes_in_boxes_are_recognised() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // In a box of 5 by 4 by 4, some outside.
    let atoms = |radius: f64| -> String {
        let mut state = 1u64;
        let mut random = |scale: f64| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            ((state >> 33) as f64 / 2f64.powi(31) * scale * 256.0).floor() / 256.0
        };
        let rows = (0..60).map(|_| {
            let [r, x, y, z] = [0.25 + random(0.25), random(6.0) - 0.5, random(4.0), random(4.0)];
            format!("{x},{y},{z},{}\n", radius * r)
        });
        format!("x,y,z,r\n{}", rows.collect::<String>())
    };
    file(folder, "p.csv", atoms(1.0));
    file(folder, "doubled.csv", atoms(2.0));
    file(folder, "halved.csv", atoms(0.5));
    let tilted = "5,4,4,1.5,0,0.5";
    let detect = |name: &str, more: &[&str]| {
        good(folder, &[&["detect", name, "--box"], more].concat()).stdout
    };
    let rows = |list: &str, of: &dyn Fn([i64; 5]) -> Option<[i64; 5]>| -> String {
        let lines = list.lines().skip(1).filter_map(|line| {
            let numbers: Vec<i64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
            of(numbers.try_into().unwrap())
        });
        let row = |row: [i64; 5]| row.map(|number| number.to_string()).join(",") + "\n";
        format!("i,j,sx,sy,sz\n{}", lines.map(row).collect::<String>())
    };
    let own = detect("p.csv", &[tilted]);
    assert!(own.lines().count() > 40, "{own}");
    let hint = |list: &str, words: &str, flags: Value| {
        file(folder, "list.csv", list);
        let verify = ["verify", "p.csv", "--box", tilted, "--pairs", "list.csv"];
        let ended = run(folder, &verify);
        let said: String = ended.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(ended.code, Some(1), "{}{}", ended.stdout, ended.stderr);
        assert!(said.contains(&format!("hint: with {words}")), "'{words}' in:\n{}", ended.stdout);
        let found = run(folder, &[&verify[..], &["--json"]].concat());
        let found: Value = serde_json::from_str(&found.stdout).unwrap();
        assert_eq!(found["hint"], flags, "{found:#}");
        let Some(flags) = flags.as_str() else { return };
        let more: Vec<&str> = flags.split(' ').collect();
        let verify = match flags.contains("--box") {
            true => [&["verify", "p.csv", "--pairs", "list.csv"], &more[..]].concat(),
            false => [&verify[..], &more].concat(),
        };
        good(folder, &verify);
    };
    let pairs = |list: &str| list.lines().count() - 1;
    let all = |list: &str| format!("all {} pairs agree", pairs(list));
    for without in [false, true] {
        let plain = |list: String| match without {
            false => list,
            true => list
                .lines()
                .map(|line| line.split(',').take(2).collect::<Vec<_>>().join(",") + "\n")
                .collect(),
        };
        let list = plain(detect("doubled.csv", &[tilted]));
        let words = format!("radii 2 times as large: diameters taken for radii?, {}", all(&list));
        hint(&list, &words, Value::Null);
        let list = plain(detect("halved.csv", &[tilted]));
        let words = format!("radii 0.5 times as large: radii taken for diameters?, {}", all(&list));
        hint(&list, &words, Value::Null);
        for (axes, words) in [("xy", "x and y"), ("z", "z")] {
            let list = plain(detect("p.csv", &[tilted, "--periodic", axes]));
            let words = format!("a box that repeats along {words}, {}", all(&list));
            hint(&list, &words, json!(format!("--periodic {axes}")));
        }
        let list = plain(detect("p.csv", &["5,4,4"]));
        let words = format!("a box without its tilt, {}", all(&list));
        hint(&list, &words, json!("--box 5.0,4.0,4.0"));
    }
    let list = rows(&own, &|[i, j, ..]| Some([i, j, 0, 0, 0]));
    let zero =
        format!("the images of the list left out (all that are named are 0), {}", all(&list));
    hint(&list, &zero, Value::Null);
    let list = rows(&own, &|[i, j, x, y, z]| Some([j, i, x, y, z]));
    let turned =
        format!("images of i in the place of those of j (S with the other sign), {}", all(&own));
    hint(&list, &turned, Value::Null);
    // As a code says it that has put them into the box first.
    let scene: Vec<[f64; 3]> = atoms(1.0)
        .lines()
        .skip(1)
        .map(|line| {
            let numbers: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
            [numbers[0], numbers[1], numbers[2]]
        })
        .collect();
    let cell = |k: i64| {
        let [x, y, z] = scene[k as usize];
        let c = z / 4.0;
        let b = (y - 0.5 * c) / 4.0;
        let a = (x - 1.5 * b) / 5.0;
        [a, b, c].map(|part| part.floor() as i64)
    };
    let list = rows(&own, &|[i, j, x, y, z]| {
        let (a, b) = (cell(i), cell(j));
        Some([i, j, x - a[0] + b[0], y - a[1] + b[1], z - a[2] + b[2]])
    });
    let words =
        "images that are counted from particles put into the box (in the file some are outside)";
    hint(&list, &format!("{words}, {}", all(&list)), Value::Null);

    // What no reading explains has no hint: one pair too many, nothing at all, many mistakes.
    let none = |list: &str| {
        file(folder, "list.csv", list);
        let ended = run(folder, &["verify", "p.csv", "--box", tilted, "--pairs", "list.csv"]);
        assert_eq!(ended.code, Some(1), "{}{}", ended.stdout, ended.stderr);
        assert!(!ended.stdout.contains("hint:"), "{}", ended.stdout);
    };
    none("i,j\n");
    none(&(own.clone() + "0,1,0,0,0\n"));
    none(&rows(&own, &|row| (row[0] % 3 != 0).then_some(row)));

    // A box so small that there are several images of a pair, and own ones.
    let of = |name: &str, edges: &str, list: &str, words: &str| {
        file(folder, "list.csv", list);
        let ended = run(folder, &["verify", name, "--box", edges, "--pairs", "list.csv"]);
        let said: String = ended.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(said.contains(&format!("hint: with {words}")), "'{words}' in:\n{}", ended.stdout);
    };
    // Two mistakes at once.
    for (how, words) in [
        (&[tilted, "--periodic", "xy"][..], "a box that repeats along x and y"),
        (&["5,4,4"], "a box without its tilt"),
    ] {
        let list = detect("doubled.csv", how);
        let words = format!(
            "radii 2 times as large: diameters taken for radii?, and {words}, {}",
            all(&list)
        );
        of("p.csv", tilted, &list, &words);
    }
    let list = good(folder, &["detect", "doubled.csv"]).stdout;
    let words = "radii 2 times as large: diameters taken for radii?, and open boundaries";
    of("p.csv", tilted, &list, words);
    let list = detect("doubled.csv", &["1.5,4,4"]);
    let others = rows(&list, &|row| (row[0] != row[1]).then_some(row));
    assert!(pairs(&others) < pairs(&list));
    let words = format!("no contact of a particle with its own image, {}", all(&others));
    of("doubled.csv", "1.5,4,4", &others, &words);
    file(folder, "two.csv", "x,y,r\n0,0,0.8\n1.5,0,0.8\n");
    let words = "no image but the nearest of each pair (minimum image), the one pair agrees";
    of("two.csv", "2.5,9", "i,j,sx,sy\n0,1,-1,0\n", words);
}
