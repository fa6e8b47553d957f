//! Tests drawings of scenes, contacts and mistakes.

use contactbench::scene::touching::in_open_space;
use contactbench::views::draw::{self, Look, Pairs};
use contactbench_detectors::near::contacts;
use contactbench_ground::periodic::{Periodic, without_shift};

use super::{discs, scene};

fn titled(title: impl Into<String>) -> Look {
    Look { title: title.into(), ..Look::default() }
}

fn space(text: &str) -> Periodic<'static> {
    in_open_space(&scene(text)).unwrap()
}

fn found(scene: &Periodic<'_>) -> Pairs {
    Pairs { contacts: contacts(scene, 1 << 30).unwrap(), ..Pairs::default() }
}

#[test]
fn a_drawing_shows_scene_contacts_and_mistakes() {
    let centres = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0000001, 0.0], [9.0, 9.0]];
    let scene = in_open_space(&discs(&centres, 0.5)).unwrap();
    let plain = draw::svg(&scene, &found(&scene), &titled("a < b & \"c\"")).unwrap();
    assert_eq!(plain.matches("<circle").count(), 5);
    for words in ["contacts: 2<", "a &lt; b &amp; &quot;c&quot;", ">4</text>"] {
        assert!(plain.contains(words), "{words}: {plain}");
    }
    assert!(!plain.contains("missed"), "{plain}");
    let pairs = |pairs: &[[u32; 2]]| without_shift(pairs).collect();
    let (contacts, missed, spurious) = (&[[1, 2]], &[[0, 1]], &[[4, 0], [3, 3]]);
    let [contacts, missed, spurious] = [&contacts[..], missed, spurious].map(pairs);
    let wrong = Pairs { contacts, missed, spurious, ..Pairs::default() };
    let wrong = draw::svg(&scene, &wrong, &titled("t")).unwrap();
    for words in ["contacts: 1<", "not reported: 1<", "apart: 2<"] {
        assert!(wrong.contains(words), "{words}: {wrong}");
    }
}

/// A picture of a crowd or of a pack of spheres shows the worst mistake.
#[test]
fn the_worst_mistake_is_seen() {
    for (spec, place) in [("packed:n=5000", ""), ("packed:dim=3,n=1000", ", slice ")] {
        let scene = space(spec);
        let all = contacts(&scene, 1 << 30).unwrap();
        for k in [0, all.len() / 2, all.len() - 1] {
            let mut contacts = all.clone();
            let missed = contacts.remove(k);
            let pairs = Pairs { contacts, missed: vec![missed], ..Pairs::default() };
            let svg = draw::svg(&scene, &pairs, &titled("t")).unwrap();
            assert!(svg.contains("reported: 1<"), "{spec} {k}");
            let around = format!("around {} and {}", missed.i, missed.j);
            // A slice shows spheres large enough without zooming to the mistake.
            assert!(svg.contains(place) && svg.contains(&around) == place.is_empty(), "{spec} {k}");
            let numbers = svg.contains(&format!(">{}</text>", missed.i));
            assert!(numbers || !place.is_empty(), "{spec} {k}: few enough for numbers");
            on_the_sheet(&svg);
            let whole = Look { whole: true, ..titled("t") };
            let svg = draw::svg(&scene, &pairs, &whole).unwrap();
            assert!(svg.contains("reported: 1<") && !svg.contains("around"), "{spec} {k}");
        }
    }
}

fn on_the_sheet(svg: &str) {
    let side = |name: &str| -> f64 {
        let value = svg.split(&format!(" {name}=\"")).nth(1).unwrap().split('"').next();
        value.unwrap().parse().unwrap()
    };
    let (width, height) = (side("width"), side("height"));
    let paths = svg.split(" d=\"").skip(1).map(|rest| rest.split('"').next().unwrap());
    for path in paths.filter(|path| !path.contains(['A', 'h'])) {
        for point in path.split(['M', 'L']).skip(1) {
            let (x, y) = point.split_once(' ').unwrap();
            let (x, y): (f64, f64) = (x.parse().unwrap(), y.parse().unwrap());
            let inside = (0.0..=width).contains(&x) && (0.0..=height).contains(&y);
            assert!(inside, "{x} {y} on {width} x {height}");
        }
    }
}

/// Coordinates in pictures are finite for N = 0, N = 1, points, and huge and tiny numbers.
#[test]
fn every_scene_can_be_drawn() {
    let row: Vec<[f64; 2]> = (0..1000).map(|k| [f64::from(k), 0.0]).collect();
    let hard: [(&[[f64; 2]], f64); 8] = [
        (&[], 1.0),
        (&[[3.0, 4.0]], 0.0),
        (&[[3.0, 4.0], [3.0, 4.0]], 0.0),
        (&[[1e15, 1e15], [1e15 + 1.0, 1e15]], 0.5),
        (&[[f64::MAX, f64::MAX], [-f64::MAX, -f64::MAX]], f64::MAX),
        (&[[0.0, 0.0], [1e-310, 0.0]], 5e-311),
        (&[[0.0, 0.0], [1e300, 1.0]], 1.0),
        (&row, 0.5),
    ];
    let hard = hard.into_iter().map(|(centres, r)| discs(centres, r));
    let made = ["packed:dim=3,n=300", "loose:dim=3,n=1", "packed:n=5000"].map(scene);
    for scene in hard.chain(made) {
        let scene = in_open_space(&scene).unwrap();
        let svg = draw::svg(&scene, &found(&scene), &titled("hard")).unwrap();
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "N = {}", scene.scene().len());
        on_the_sheet(&svg);
    }
    let many = draw::svg(&space("loose:n=200001"), &Pairs::default(), &Look::default());
    assert!(many.unwrap_err().to_string().contains("200001 particles"));
    let spurious = without_shift(&[[0, 9]]).collect();
    let beyond = Pairs { spurious, ..Pairs::default() };
    let beyond = draw::svg(&space("packed:n=9"), &beyond, &Look::default());
    assert!(beyond.unwrap_err().to_string().contains("9 particles"));
}
