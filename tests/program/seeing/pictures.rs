//! Drawings of scenes, contacts and mistakes.

use contactbench::present::draw;
use contactbench::present::draw::{Highlighted, Look};
use contactbench::scene::AnyScene;
use contactbench::sink::normalise;

use super::{counted, discs, scene};

#[test]
fn a_drawing_shows_scene_contacts_and_mistakes() {
    let scene = discs(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0000001, 0.0], [9.0, 9.0]], 0.5);
    let of = |pairs: &Highlighted, look: &Look| draw::svg(&scene, pairs, look).unwrap();
    let plain =
        of(&Highlighted::from_scene(&scene, 1 << 30).unwrap(), &Look::titled("a < b & \"c\""));
    assert_eq!(
        plain.matches("<circle").count(),
        5 + 3 + 2,
        "discs, tangent and nearly tangent marks, two of them in the legend"
    );
    assert!(
        plain.contains("contacts: 2")
            && plain.contains("exactly tangent: 2")
            && plain.contains("nearly tangent")
    );
    assert!(
        plain.contains("a &lt; b &amp; &quot;c&quot;")
            && !plain.contains("missed")
            && plain.contains(">4</text>")
    );
    let wrong = of(
        &Highlighted::compare(&scene, vec![[1, 2], [4, 0], [3, 3]], 1 << 30).unwrap(),
        &Look { labels: Some(false), grid: true, ..Look::default() },
    );
    assert!(
        wrong.contains("missed: touching, but not reported: 1")
            && wrong.contains("spurious: reported, but apart: 2")
    );
    assert!(!wrong.contains(">4</text>") && wrong.contains("cells of edge 1.0"));
}

/// In a crowd, and off the middle of a pack of spheres.
#[test]
fn the_worst_mistake_is_seen() {
    for (spec, place) in [("packed:n=5000", ""), ("packed:dim=3,n=1000", ", slice ")] {
        let scene = scene(spec);
        let all = Highlighted::from_scene(&scene, 1 << 30).unwrap().contacts;
        for k in [0, all.len() / 2, all.len() - 1] {
            let mut reported = all.clone();
            let [i, j] = reported.remove(k);
            let pairs = Highlighted::compare(&scene, reported, 1 << 30).unwrap();
            let svg = draw::svg(&scene, &pairs, &Look::titled("t")).unwrap();
            assert!(svg.contains("missed: touching, but not reported: 1<"), "{spec} {k}");
            let around = format!(", around {i} and {j}: the worst mistake");
            // Spheres of a slice are large enough to be seen as it is.
            assert!(svg.contains(place) && svg.contains(&around) == place.is_empty(), "{spec} {k}");
            let numbers = svg.contains(&format!(">{i}</text>"));
            assert!(numbers || !place.is_empty(), "{spec} {k}: few enough for numbers");
            on_the_sheet(&svg);
            let whole = Look { whole: true, ..Look::titled("t") };
            let svg = draw::svg(&scene, &pairs, &whole).unwrap();
            assert!(svg.contains("not reported: 1<") && !svg.contains("around"), "{spec} {k}");
        }
    }
}

#[test]
fn captions_are_whole() {
    let scene = discs(&[[0.0, 0.0], [0.0, 9.0]], 0.5);
    let words: Vec<String> = (0..60).map(|k| format!("word-{k}")).collect();
    let pairs = Highlighted::from_scene(&scene, 1 << 30).unwrap();
    let svg = draw::svg(&scene, &pairs, &Look::titled(words.join(" "))).unwrap();
    let texts = svg.split_once("</title>").unwrap().1;
    assert!(words.iter().all(|word| texts.contains(word.as_str())), "{texts}");
    on_the_sheet(&svg);
}

/// All lines end on the sheet.
fn on_the_sheet(svg: &str) {
    let side = |name: &str| {
        svg.split(&format!(" {name}=\""))
            .nth(1)
            .unwrap()
            .split('"')
            .next()
            .unwrap()
            .parse::<f64>()
            .unwrap()
    };
    let (width, height) = (side("width"), side("height"));
    for path in svg
        .split(" d=\"")
        .skip(1)
        .map(|rest| rest.split('"').next().unwrap())
        .filter(|path| !path.contains(['A', 'h', 'H']))
    {
        for point in path.split(['M', 'L']).skip(1) {
            let (x, y) = point.split_once(' ').unwrap();
            let (x, y): (f64, f64) = (x.parse().unwrap(), y.parse().unwrap());
            assert!(
                (0.0..=width).contains(&x) && (0.0..=height).contains(&y),
                "{x} {y} on {width} x {height}"
            );
        }
    }
}

/// N = 0 and 1, points, points in one place, huge and tiny numbers, offsets that leave few bits: a
/// picture, and nothing in it that is no number.
#[test]
fn every_scene_can_be_drawn() {
    let hard: Vec<AnyScene<'static>> = [
        (vec![], 1.0),
        (vec![[3.0, 4.0]], 0.0),
        (vec![[3.0, 4.0], [3.0, 4.0]], 0.0),
        (vec![[1e15, 1e15], [1e15 + 1.0, 1e15]], 0.5),
        (vec![[f64::MAX, f64::MAX], [-f64::MAX, -f64::MAX]], f64::MAX),
        (vec![[0.0, 0.0], [1e-310, 0.0]], 5e-311),
        (vec![[0.0, 0.0], [1e300, 1.0]], 1.0),
        ((0..1000).map(|k| [f64::from(k), 0.0]).collect(), 0.5),
    ]
    .into_iter()
    .map(|(centres, r): (Vec<[f64; 2]>, f64)| discs(&centres, r))
    .chain(["packed:dim=3,n=300", "loose:dim=3,n=1", "packed:n=5000"].map(scene))
    .collect();
    for scene in &hard {
        for grid in [false, true] {
            let svg = draw::svg(
                scene,
                &Highlighted::from_scene(scene, 1 << 30).unwrap(),
                &Look { grid, ..Look::titled("hard") },
            )
            .unwrap();
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "N = {}", scene.len());
            on_the_sheet(&svg);
            if !grid {
                contactbench::present::svg::png(&svg).unwrap();
            }
        }
    }
    let many = scene("loose:n=200001");
    let error =
        draw::svg(&many, &Highlighted::default(), &Look::default()).unwrap_err().to_string();
    assert!(error.contains("200001 particles are too many"), "{error}");
}

/// `draw` finds contacts as every detector does.
#[test]
fn drawn_contacts_are_the_contacts() {
    for text in ["packed:n=500", "loose:dim=3,n=300", "clustered:n=200"] {
        let scene = scene(text);
        let (_, mut pairs) = counted("direct", &scene);
        normalise(&mut pairs);
        assert_eq!(draw::find(&scene, 1 << 30).unwrap(), pairs, "{text}");
    }
}
