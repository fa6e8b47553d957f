//! What `inspect` says of boxes.

use serde_json::{Value, json};

use super::{TILTED, json_of};
use crate::common::{file, good};

#[test]
fn inspect_shows_the_box() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "tilted.dump", TILTED);
    let found = json_of(folder, &["inspect", "tilted.dump", "--json"]);
    for (key, value) in [
        ("box_vectors", json!([[4.0, 0.0, 0.0], [1.0, 4.0, 0.0], [0.0, 0.0, 4.0]])),
        ("box_origin", json!([0.0, 0.0, 0.0])),
        ("box_tilted", json!(true)),
        ("periodic", json!([true, true, false])),
        ("outside", json!(0)),
        ("reach", json!(1.0)),
        // The open numbers, marked.
        ("contacts", json!(1)),
        ("boundaries", json!("open")),
        // And those of the box.
        ("contacts_in_box", json!(2)),
        ("contacts_across", json!(1)),
        ("coordination_in_box", json!(1.0)),
        (
            "warnings",
            json!([
                "1 couples are within 1e-9 of just touching: codes that round in different ways \
                 will disagree about them"
            ]),
        ),
    ] {
        assert_eq!(found[key], value, "{key} in {found:#}");
    }
    let close = |value: &Value, to: f64| (value.as_f64().unwrap() - to).abs() < 1e-12;
    // A shear of 1 in 4 leaves 16 / sqrt 17 between the faces along x.
    assert!(close(&found["box_heights"][0], 16.0 / 17f64.sqrt()), "{found:#}");
    assert!(close(&found["box_lengths"][1], 17f64.sqrt()), "{found:#}");
    assert_eq!((&found["box_heights"][1], &found["box_heights"][2]), (&json!(4.0), &Value::Null));
    let text = good(folder, &["inspect", "tilted.dump"]).stdout;
    for line in [
        "boundaries        the box repeats along x and y, as the file says\n",
        "box               vectors (4 0 0) (1 4 0) (0 0 4), lengths 4 4.123 4, tilted; corner 0 0",
        "outside the box   0 particles\n",
        "between faces     x 3.881, y 4; bodies touch over 1 at most\n",
        "open boundaries: none across the box",
        "in the box        2 contacts (exact), 1 of them across it, 1 per particle\n",
    ] {
        assert!(text.contains(line), "'{line}' in {text}");
    }
    // Outside, small, and of two kinds.
    let xyz = |name: &str, edge: &str, radius: &str| {
        let text = format!(
            "2\nLattice=\"{edge} 0 0 0 9 0 0 0 9\" Properties=pos:R:3:r:R:1\n-1 0 0 {radius}\n2 1 \
             1 {radius}\n"
        );
        file(folder, name, text);
        json_of(folder, &["inspect", name, "--json"])
    };
    let found = xyz("outside.xyz", "4", "0.5");
    assert_eq!((&found["outside"], &found["warnings"]), (&json!(1), &json!([])), "{found:#}");
    let several = "the box is so small along x that two bodies may touch through several images, \
                   of which codes that look at the nearest one see one";
    assert_eq!(xyz("several.xyz", "4", "1")["warnings"], json!([several]));
    let own = "the box is so small along x that a body may touch its own image";
    assert_eq!(xyz("own.xyz", "4", "2")["warnings"], json!([own]));
    assert_eq!(xyz("free.xyz", "4.0001", "1")["warnings"], json!([]));
    // Discs.
    file(folder, "discs.csv", "x,y,r\n1,1,0.5\n");
    let found = json_of(folder, &["inspect", "discs.csv", "--box", "4,0,1,5", "--json"]);
    assert_eq!(found["box_vectors"], json!([[4.0, 0.0], [1.0, 5.0]]));
    assert_eq!(found["periodic"], json!([true, true]));
    // Where there is none, that is said, too.
    for (arguments, line) in [
        (&["discs.csv"][..], "boundaries        open: there is no box in the file\n"),
        (&["discs.csv", "--open"], "boundaries        open (--open)\n"),
        (&["tilted.dump", "--periodic", "none"], "boundaries        open (--periodic none)\n"),
        (
            &["discs.csv", "--box", "4,4", "--periodic", "x"],
            "boundaries        the box repeats along x (--box, --periodic)\n",
        ),
        (
            &["discs.csv", "--box", "4,4"],
            "boundaries        the box repeats along x and y (--box)\n",
        ),
    ] {
        let text = good(folder, &[&["inspect"], arguments].concat()).stdout;
        assert!(text.contains(line), "'{line}' in {text}");
    }
    file(folder, "open.dump", TILTED.replace("pp pp ff", "ff ss mf"));
    let text = good(folder, &["inspect", "open.dump"]).stdout;
    assert!(text.contains("boundaries        open, as the file says\n"), "{text}");
    assert!(text.contains("box in the file   (4 0 0) (1 4 0) (0 0 4)\n"), "{text}");
}
