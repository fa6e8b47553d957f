//! Tests pictures of boxes.

use crate::common::Place;

/// Returns the corners of the box in a drawing.
fn corners(svg: &str) -> Vec<[f64; 2]> {
    let points = svg.split("<polygon points=\"").nth(1).unwrap().split('"').next().unwrap();
    let numbers = |point: &str| point.split(',').map(|x| x.parse().unwrap()).collect::<Vec<_>>();
    points.split(' ').map(|point| numbers(point).try_into().unwrap()).collect()
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
    for part in ["4 discs", "1 outside", "contacts: 1<"] {
        assert!(svg.contains(part), "'{part}' in {svg}");
    }
    // The picture shows two pale images with their numbers.
    assert_eq!(svg.matches("fill=\"#8a8167\"").count(), 2, "{svg}");
    let pale = svg.split("fill=\"#f6f3ea\"").nth(1).unwrap().split("</g>").next().unwrap();
    assert_eq!([pale, &svg].map(|it| it.matches("<circle").count()), [2, 6], "{svg}");
    let spheres = picture("one.csv --box 1,1,1", &["3 contacts, 3 of"]);
    assert!(spheres.contains(": 2 of 3"), "{spheres}");
    for line in ["discs.csv --box 4,4", "tilted.xyz --slice z=3", "tilted.xyz --slice y=1"] {
        assert_eq!(corners(&picture(line, &[])).len(), 4, "{line}");
    }
    // Two edges of a sheared box are slanted by 45 degrees.
    let corners = corners(&picture("discs.csv --box 4,0,4,4", &[]));
    let edges = (0..4).map(|k| [0, 1].map(|axis| corners[(k + 1) % 4][axis] - corners[k][axis]));
    assert_eq!(edges.filter(|[x, y]| (x.abs() - y.abs()).abs() < 0.1).count(), 2, "{corners:?}");
}
