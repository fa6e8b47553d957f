//! Tests pictures of boxes.

use crate::common::Place;

/// Returns the numbers of periodic and of open faces in a drawing.
fn faces(svg: &str) -> (usize, usize) {
    let lines = || svg.lines().filter(|line| line.contains("stroke=\"#555"));
    let count = |look: &str| {
        lines().find(|line| line.contains(look)).map_or(0, |line| line.matches('M').count())
    };
    (count("width=\"1.6\""), count("width=\"1.2\""))
}

#[test]
fn the_box_its_images_and_contacts_across_it_are_drawn() {
    let at = Place::new();
    // A disc in the middle, two that touch through a face, and one outside.
    at.file("discs.csv", "x,y,r\n2,2,0.5\n0.25,1,0.5\n3.25,1,0.5\n-1.5,3,0.25\n");
    at.file("one.csv", "x,y,z,r\n0.25,0.5,7,0.5\n");
    at.file(
        "tilted.xyz",
        "4\nLattice=\"4 0 0 1 4 0 0 0 4\" pbc=\"T T F\" Properties=pos:R:3:r:R:1\n1 1 1 0.5\n\
         2 1 1 0.5\n1.5 0.25 3 0.5\n2.5 3.25 3 0.5\n",
    );
    let picture = |line: &str, words: &[&str]| {
        at.ends(0, &format!("draw -o p.svg {line}"), words);
        at.read("p.svg")
    };
    let svg = picture("discs.csv --box 4,4", &["N = 4, 2D, 1 contact, 1 of"]);
    for part in ["4 discs", "1 outside", ": 1;", "tangent: 1<"] {
        assert!(svg.contains(part), "'{part}' in {svg}");
    }
    // The picture shows two pale images with their numbers, and marks of tangency.
    assert_eq!(svg.matches("fill=\"#8a8167\"").count(), 2, "{svg}");
    let pale = svg.split("fill=\"#f6f3ea\"").nth(1).unwrap().split("</g>").next().unwrap();
    assert_eq!(pale.matches("<circle").count(), 2, "{pale}");
    assert_eq!(svg.matches("<circle").count(), 6 + 3, "{svg}");
    let spheres = picture("one.csv --box 1,1,1", &["3 contacts, 3 of"]);
    assert!(spheres.contains(": 2 of 3"), "{spheres}");
    // Numbers of periodic and open faces; an axis without a length has none.
    for (line, expected) in [
        ("discs.csv --box 4,4", (4, 0)),
        ("discs.csv --box 4,4 --periodic x", (2, 2)),
        ("discs.csv --box 4,0 --periodic x", (2, 0)),
        ("tilted.xyz --slice z=3", (4, 0)),
        ("tilted.xyz --slice y=1", (2, 2)),
    ] {
        assert_eq!(faces(&picture(line, &[])), expected, "{line}");
    }
    // The faces of a sheared box are drawn slanted.
    let svg = picture("discs.csv --box 4,0,4,4", &[]);
    let line = svg.lines().find(|line| line.contains("stroke=\"#555")).unwrap();
    let steep = line.split('"').nth(1).unwrap().split('M').skip(1).filter(|edge| {
        let words = edge.split([' ', 'L', 'H', 'V']);
        let numbers: Vec<f64> = words.filter_map(|word| word.parse().ok()).collect();
        let [a, b, c, d] = numbers[..] else { return false };
        ((a - c).abs() - (b - d).abs()).abs() < 0.2
    });
    assert_eq!(steep.count(), 2, "{line}");
}
