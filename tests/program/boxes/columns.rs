//! Columns of contact lists: which hold images, and which are something else.

use crate::common::{file, good, refused, run};

/// Two bodies that touch through a face of a cube, by an image of the second that a list names in
/// many ways: each is used, or refused in words.
#[test]
fn images_are_understood_however_they_are_called_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "cube.xyz", super::CUBE);
    file(folder, "discs.csv", "x,y,r\n0.25,1,0.5\n3.25,1,0.5\n");
    let space = ["verify", "cube.xyz", "--pairs"];
    let discs = ["verify", "discs.csv", "--box", "4,4", "--pairs"];
    let compared = "compared: pairs with their images\nthe same: ";
    // With another image it differs: so it was looked at.
    let used = |verify: &[&str], header: &str, zero: &str, more: &[&str]| {
        for (x, code) in [("-1", 0), ("0", 1), ("1", 1)] {
            let row = format!("0 1 {x} 0{zero}\n");
            let row = if header.contains(',') { row.replace(' ', ",") } else { row };
            file(folder, "list.csv", format!("{header}{row}"));
            let ended = run(folder, &[verify, &["list.csv"], more].concat());
            assert_eq!(ended.code, Some(code), "{header}: {}{}", ended.stdout, ended.stderr);
            assert_eq!(ended.stdout.contains(compared), code == 0, "{header}: {}", ended.stdout);
        }
    };
    for header in [
        "",
        "# made by a script\n",
        "i j S_x S_y S_z\n",
        "i j Sx Sy Sz\n",
        "i j shift_x shift_y shift_z\n",
        "i,j,S[0],S[1],S[2]\n",
        "# i j sx sy sz\n",
        "# i,j,sx,sy,sz\n",
        "# written with savetxt\n# i j S0 S1 S2\n",
        "#i j cell_shift_a cell_shift_b cell_shift_c\n",
    ] {
        used(&space, header, " 0", &[]);
        // Without the last.
        let end = header.rfind([' ', ',']).filter(|_| !header.ends_with("script\n"));
        used(&discs, &end.map_or(header.into(), |end| format!("{}\n", &header[..end])), "", &[]);
    }
    used(&space, "", " 0 0.25", &["--pairs-columns", "1,2,3,4,5"]);
    used(&space, "a b c d e f\n", " 0 0.25", &["--pairs-columns", "a,b,c,d,e"]);
    // Of two, where the box is open along the third.
    used(&space, "", "", &["--periodic", "xy"]);
    used(&space, "i j sx sy\n", "", &["--periodic", "x"]);
    for (verify, columns) in [(&space[..], 5), (&discs, 4)] {
        file(
            folder,
            "list.npy",
            crate::common::npy(&[[0.0, 1.0, -1.0, 0.0, 0.0][..columns].to_vec()]),
        );
        let ended = good(folder, &[verify, &["list.npy"]].concat());
        assert!(ended.stdout.contains(compared), "{}", ended.stdout);
    }
    let two = "images are named along two vectors, and the box repeats along z, too; add the third, \
               sz\n";
    let which = |columns: &str| {
        format!(
            "{columns} may name the images that touch, and nothing says so; give --pairs-columns \
             I,J,SX,SY,SZ, or --pairs-columns I,J if not\n"
        )
    };
    for (text, words) in [
        ("i,j,sx,sy\n0,1,-1,0\n", two.into()),
        ("0,1,-1,0\n", two.into()),
        ("0,1,0.25,0,0\n", which("columns 3 4 5")),
        ("0,1\n0,1,-1,0,0\n", which("columns 3 4 5")),
        ("0,1,-1\n", which("column 3")),
        ("0,1,-1,0,0,0.5\n", which("columns 3 4 5 6")),
        ("i,j,u,v,w\n0,1,-1,0,0\n", which("columns u v w")),
        ("i,j,image\n0,1,-1 0 0\n", which("column image")),
    ] {
        file(folder, "list.csv", text);
        let ended = refused(folder, &[&space[..], &["list.csv"]].concat(), &[]);
        assert_eq!(ended.stderr, format!("contactbench: list.csv: {words}"), "{text}");
    }
    file(folder, "list.npy", crate::common::npy(&[vec![0.0, 1.0, -1.0, 0.0]]));
    refused(folder, &[&space[..], &["list.npy"]].concat(), &[two]);
    file(folder, "list.csv", "i,j,sx\n0,1,0\n");
    refused(
        folder,
        &[&space[..], &["list.csv"]].concat(),
        &["list.csv:1: images need the columns"],
    );
    // What is no image is left out, and that is said.
    for text in ["i,j,overlap,fn\n0,1,1e-3,2.5\n", "i,j,type1,type2,fn\n0,1,1,1,2.5\n"] {
        file(folder, "list.csv", text);
        let ended = good(folder, &[&space[..], &["list.csv"]].concat());
        assert!(ended.stdout.contains("; not looked at: columns "), "{}", ended.stdout);
    }
    file(folder, "list.csv", "i,j,u,v,w\n0,1,-1,0,0\n");
    let ended = good(folder, &[&space[..], &["list.csv", "--pairs-columns", "i,j"]].concat());
    assert!(ended.stdout.contains("each touches through one image"), "{}", ended.stdout);
    for columns in ["i", "i,j,u", "i,j,u,v,w,x"] {
        let words =
            "--pairs-columns takes the two columns of the particles, and those of the image";
        let verify = [&space[..], &["list.csv", "--pairs-columns", columns]].concat();
        refused(folder, &verify, &[words]);
    }
    // A dump local may name them, too.
    let local = "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ENTRIES\n1\nITEM: BOX BOUNDS pp pp pp\n0 4\n0 4\n0 \
                 4\nITEM: ENTRIES index patom1 patom2 sx sy sz\n1 1 2 -1 0 0\n";
    file(folder, "local.dump", local);
    let ended = good(folder, &[&space[..], &["local.dump"]].concat());
    assert!(ended.stdout.contains(compared), "{}", ended.stdout);
}

/// Without a box they are the types of the particles, or anything else.
#[test]
fn columns_without_names_are_no_images_where_there_is_no_box() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "three.csv", "x,y,z,r\n0,0,1,1\n2,0,1,1\n4,0,1,1\n");
    for (rows, others) in [
        ("0,1,1,2\n1,2,2,1\n", "3 4"),
        ("0 1 0 0 0\n1 2 0 0 0\n", "3 4 5"),
        ("0,1,3,0,7\n1,2,0,1,5000000000\n", "3 4 5"),
    ] {
        file(folder, "list.csv", rows);
        let verify = ["verify", "three.csv", "--pairs", "list.csv"];
        let said = good(folder, &verify).stdout;
        assert!(said.contains(&format!("; not looked at: columns {others})")), "{said}");
        good(folder, &["draw", "three.csv", "--pairs", "list.csv", "-o", "three.svg"]);
    }
    let boxed = ["verify", "three.csv", "--box", "9,9,9", "--pairs", "list.csv"];
    refused(folder, &boxed, &["columns 3 4 5 may name the images that touch"]);
    // What is named so is an image; and so it may be where a box was left out.
    let words = ["names an image in a box that repeats", "boundaries are open here"];
    file(folder, "list.csv", "i,j,sx,sy,sz\n0,1,1,0,0\n");
    refused(folder, &["verify", "three.csv", "--pairs", "list.csv"], &words);
    file(folder, "list.csv", "0,1,1,0,0\n");
    file(folder, "p.xyz", "2\nLattice=\"4 0 0 0 4 0 0 0 4\"\nA 0 0 0\nA 1 0 0\n");
    let open = ["verify", "p.xyz", "--radius", "0.5", "--open", "--pairs", "list.csv"];
    refused(folder, &open, &words);
    let draw = ["draw", "p.xyz", "--radius", "0.5", "--open", "--pairs", "list.csv"];
    refused(folder, &draw, &words);
}
