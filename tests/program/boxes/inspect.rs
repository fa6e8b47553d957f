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
        ("contacts", json!(2)),
        ("contacts_across", json!(1)),
        ("contacts_own", json!(0)),
        ("coordination", json!(1.0)),
        ("boundaries", json!("periodic")),
        ("near_tangent", json!(2)),
        ("packing_of", json!("bounds")),
        (
            "warnings",
            json!([
                "2 couples are within 1e-9 of just touching: codes that round in different ways \
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
        "between faces     x 3.881, y 4; bodies touch over 1 at most: at least 3.881 times as far\n",
        "in contact), 1 of them across the box, 0 of one with itself, 1 per particle",
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
    assert_eq!(found["outside"], json!(1), "{found:#}");
    let nothing = found["warnings"][0].as_str().unwrap();
    assert!(nothing.starts_with("nothing touches"), "{found:#}");
    let several = "the box is so small along x that two bodies may touch through several images, \
                   of which codes that look at the nearest one see one";
    assert_eq!(xyz("several.xyz", "4", "1")["warnings"], json!([several]));
    let own = "the box is so small along x that a body may touch its own image";
    let found = xyz("own.xyz", "4", "2");
    assert_eq!((&found["contacts_own"], &found["f32_missed"]), (&json!(2), &json!(0)));
    assert!(found["warnings"].as_array().unwrap().contains(&json!(own)), "{found:#}");
    assert!(!xyz("free.xyz", "4.0001", "1")["warnings"].to_string().contains("so small"));
    file(folder, "cube.xyz", super::CUBE);
    // Discs.
    file(folder, "discs.csv", "x,y,r\n1,1,0.5\n");
    let found = json_of(folder, &["inspect", "discs.csv", "--box", "4,0,1,5", "--json"]);
    assert!(close(&found["packing_fraction"], std::f64::consts::PI / 80.0), "{found:#}");
    assert_eq!(found["packing_of"], json!("box"));
    assert_eq!(found["box_vectors"], json!([[4.0, 0.0], [1.0, 5.0]]));
    assert_eq!(found["periodic"], json!([true, true]));
    // Where there is none, that is said, too.
    for (arguments, line) in [
        (&["discs.csv"][..], "boundaries        open: there is no box in the file\n"),
        (&["discs.csv", "--open"], "boundaries        open (--open)\n"),
        (&["tilted.dump", "--periodic", "none"], "boundaries        open (--periodic none)\n"),
        (
            &["discs.csv", "--box", "4,4", "--periodic", "x"],
            "boundaries        the box repeats along x (--periodic)\n",
        ),
        (
            &["tilted.dump", "--box", "5,5,5"],
            "boundaries        the box repeats along x and y, as the file says\n",
        ),
        (&["tilted.dump", "--box", "5,5,5"], "vectors (5 0 0) (0 5 0) (0 0 5) (--box), lengths"),
        (
            &["cube.xyz"],
            "packing fraction  0.0164 of the box that repeats, overlaps counted twice\n",
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
