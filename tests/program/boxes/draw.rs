//! Pictures of boxes.

use super::{CUBE, TILTED};
use crate::common::{file, good, refused};

/// One disc in the middle, two that touch through the side, one outside.
const DISCS: &str = "x,y,r\n2,2,0.5\n0.25,1,0.5\n3.25,1,0.5\n-1.5,3,0.25\n";

#[test]
fn the_box_its_images_and_contacts_across_it_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "discs.csv", DISCS);
    let picture = |arguments: &[&str]| {
        let ended = good(folder, &[&["draw", "-o", "p.svg"], arguments].concat());
        (std::fs::read_to_string(folder.join("p.svg")).unwrap(), ended.stderr)
    };
    let (svg, said) = picture(&["discs.csv", "--box", "4,4"]);
    assert!(said.contains("N = 4, 2D, 1 contact, 1 of them across the box; p.svg"), "{said}");
    for part in [
        "4 discs in a box that repeats along x and y, 1 outside it",
        "contacts: 0<",
        "contacts across the box: 1; each is drawn from both sides",
        ">faces of the box<",
    ] {
        assert!(svg.contains(part), "'{part}' in {svg}");
    }
    // Two images, pale, with the numbers of their particles.
    assert_eq!(svg.matches("fill=\"#8a8167\"").count(), 2, "{svg}");
    let pale = svg.split("fill=\"#f6f3ea\"").nth(1).unwrap().split("</g>").next().unwrap();
    assert_eq!(pale.matches("<circle").count(), 2, "{pale}");
    assert_eq!(svg.matches("<circle").count(), 6 + 3, "marks of tangency, too: {svg}");
    assert!(svg.contains(">exactly tangent: 1<"), "{svg}");
    // Four faces; two of them open; two where nobody says where the others are.
    let faces = |svg: &str, look: &str| {
        let line = svg.lines().find(|line| line.contains("stroke=\"#555") && line.contains(look));
        line.map_or(0, |line| line.matches('M').count())
    };
    assert_eq!((faces(&svg, "width=\"1.6\""), faces(&svg, "width=\"1.2\"")), (4, 0));
    let (svg, _) = picture(&["discs.csv", "--box", "4,4", "--periodic", "x"]);
    assert_eq!((faces(&svg, "width=\"1.6\""), faces(&svg, "width=\"1.2\"")), (2, 2));
    let (svg, _) = picture(&["discs.csv", "--box", "4,0", "--periodic", "x"]);
    assert_eq!((faces(&svg, "width=\"1.6\""), faces(&svg, "width=\"1.2\"")), (2, 0));
    // A body and its own image.
    file(folder, "one.csv", "x,y,z,r\n0.25,0.5,7,0.5\n");
    let (svg, said) = picture(&["one.csv", "--box", "1,1,1"]);
    assert!(said.contains("3 contacts, 3 of them across the box"), "{said}");
    assert!(svg.contains("contacts across the box: 2 of 3, those with both spheres"), "{svg}");
    // The faces of a sheared box are as steep as they are.
    let (svg, _) = picture(&["discs.csv", "--box", "4,0,4,4"]);
    let line = svg.lines().find(|line| line.contains("stroke=\"#555")).unwrap();
    let path = line.split('"').nth(1).unwrap();
    let steep = path.split('M').skip(1).filter(|edge| {
        let numbers: Vec<f64> =
            edge.split([' ', 'L', 'H', 'V']).filter_map(|word| word.parse().ok()).collect();
        let [a, b, c, d] = numbers[..] else { return false };
        ((a - c).abs() - (b - d).abs()).abs() < 0.2
    });
    assert_eq!(steep.count(), 2, "{line}");
    // Slices of tilted boxes.
    file(folder, "tilted.dump", TILTED);
    let (svg, _) = picture(&["tilted.dump", "--slice", "z=3"]);
    assert!(svg.contains("contacts across the box: 1 of 1"), "{svg}");
    assert_eq!((faces(&svg, "width=\"1.6\""), faces(&svg, "width=\"1.2\"")), (4, 0));
    let (svg, _) = picture(&["tilted.dump", "--slice", "y=1"]);
    assert_eq!((faces(&svg, "width=\"1.6\""), faces(&svg, "width=\"1.2\"")), (2, 2));
    file(folder, "cube.xyz", CUBE);
    picture(&["cube.xyz"]);
    refused(
        folder,
        &["draw", "cube.xyz", "--grid"],
        &["--grid shows the cells of open boundaries"],
    );
}

#[test]
fn lists_are_drawn_with_their_images_and_without() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "discs.csv", DISCS);
    let draw = ["draw", "discs.csv", "--box", "4,4", "-o", "p.svg", "--pairs", "l.csv"];
    for (list, words) in [
        ("i,j,sx,sy\n1,2,-1,0\n", "0 missed, 0 spurious, 0 repeated"),
        ("i,j,sx,sy\n2,1,1,0\n1,2,-1,0\n", "0 missed, 0 spurious, 1 repeated"),
        ("i,j,sx,sy\n1,2,1,0\n", "1 missed, 1 spurious, 0 repeated"),
        ("i,j,sx,sy\n", "1 missed, 0 spurious, 0 repeated"),
        ("0,1,0,0\n", "1 missed, 1 spurious, 0 repeated"),
        ("i,j\n1,2\n", "0 missed, 0 spurious, 0 repeated"),
        ("i,j\n1,2\n2,1\n", "0 missed, 0 spurious, 1 repeated"),
        ("i,j\n0,3\n1,1\n", "1 missed, 2 spurious, 0 repeated"),
    ] {
        file(folder, "l.csv", list);
        let said = good(folder, &draw).stderr;
        assert!(said.contains(&format!("1 contact, 1 of them across the box, {words}")), "{said}");
    }
    let svg = std::fs::read_to_string(folder.join("p.svg")).unwrap();
    assert!(svg.contains("missed: touching, but not reported: 1<"), "{svg}");
    for (list, words) in [
        ("i,j\n0,9\n", "l.csv: the pair 0,9: the scene has 4 particles"),
        ("i,j\n-1,2\n", "l.csv: the pair -1,2: particles are numbered from 0"),
        ("0,1,2\n", "l.csv: column 3 may name the images"),
        ("i,j,sx,sy,sz\n0,1,0,0,1\n", "names the image 0,0,1, and the box repeats along x and y"),
    ] {
        file(folder, "l.csv", list);
        refused(folder, &draw, &[words]);
    }
    file(folder, "l.csv", "i,j,sx,sy\n1,2,-1,0\n");
    let words = "the pair 1,2 names an image in a box that repeats, and boundaries are open here";
    refused(folder, &["draw", "discs.csv", "--pairs", "l.csv"], &[words]);
}
