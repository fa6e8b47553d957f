use super::*;
use crate::check::reading::Deviation;
use crate::io;
use crate::scene::spec::Spec;

fn scene() -> AnyScene<'static> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.csv");
    std::fs::write(&path, "x,y,r\n0,0,1\n1,0,1\n3,0,1\n10,0,1\n20,0,1\n").unwrap();
    let (particles, _) = io::load(&path, io::Options::default()).unwrap();
    particles.scene("p", None).unwrap()
}

fn verify(
    scene: &AnyScene<'_>,
    list: &[[i64; 2]],
    naming: &Naming,
    others: &[Naming],
) -> Verification {
    allowing(scene, list, naming, others, Allowed::default())
}

fn allowing(
    scene: &AnyScene<'_>,
    list: &[[i64; 2]],
    naming: &Naming,
    others: &[Naming],
    allowed: Allowed,
) -> Verification {
    let (arithmetic, memory_limit) = (Arithmetic::Exact, 1 << 30);
    let terms =
        Terms { arithmetic, allowed, memory_limit, kept: WORST, explain: true, without: None };
    Verification::new(scene, list, naming, others, terms, None).unwrap()
}

fn verified(list: &[[i64; 2]], naming: Naming, others: &[Naming]) -> Verification {
    verify(&scene(), list, &naming, others)
}

#[test]
fn every_kind_of_difference_is_found() {
    // True are 0,1 (overlap of one radius) and 1,2 (tangent).
    let list = [[2, 1], [1, 2], [3, 3], [2, 3], [0, 4], [1, 9]];
    let found = verified(&list, Naming::Base(0), &[]);
    let Errors { missed, spurious, duplicate, self_pairs, .. } = found.errors;
    assert_eq!((missed, spurious, duplicate, self_pairs, found.contacts), (1, 2, 1, 1, 2));
    assert_eq!((found.unknown.as_slice(), found.is_same()), (&[[1, 9]][..], false));
    let pair = |i, j| ImagePair::new(i, j, [0; 3]);
    assert_eq!(found.missed, [(pair(0, 1), 1.0)]);
    assert_eq!(found.spurious, [(pair(0, 4), -18.0), (pair(2, 3), -5.0)]);
    assert!(verified(&[[0, 1], [2, 1]], Naming::Base(0), &[]).is_same());
}

#[test]
fn a_better_meaning_is_found() {
    let ids = Naming::by_id(&[7, 8, 9, 10, 11]).unwrap();
    let others = [ids.clone(), Naming::Base(1)];
    let found = verified(&[[1, 2], [2, 3]], Naming::Base(0), &others);
    let meaning = |found: &Verification| {
        found.reading.as_ref().map(|reading| (reading.meaning, reading.wrong))
    };
    assert_eq!(meaning(&found), Some((Meaning::Base(1), 0)));
    let found = verified(&[[7, 8], [8, 9]], Naming::Base(0), &others);
    assert_eq!(meaning(&found), Some((Meaning::Ids, 0)));
    assert!(verified(&[[7, 8], [8, 9]], ids, &[]).is_same());
    let twice = Naming::by_id(&[7, 8, 7]).unwrap_err().to_string();
    assert!(twice.contains("the id 7 stands twice in the file, at particles 0 and 2"), "{twice}");
}

/// The pairs of a pack whose centres are less than `reach` apart, across a box of that length if
/// there is one.
fn apart(scene: &AnyScene<'_>, reach: f64, period: f64) -> Vec<[i64; 2]> {
    let n = scene.len() as u32;
    let centre = |k: u32| particle(scene, k).0;
    let near = |i: u32, j: u32| {
        let (a, b) = (centre(i), centre(j));
        let along = |x: f64| if x.abs() > period / 2.0 { period - x.abs() } else { x };
        let square: f64 = a.iter().zip(&b).map(|(a, b)| along(a - b).powi(2)).sum();
        square <= reach * reach
    };
    let pairs = (0..n).flat_map(|i| (i + 1..n).map(move |j| [i, j]));
    pairs.filter(|&[i, j]| near(i, j)).map(|pair| pair.map(i64::from)).collect()
}

#[test]
fn usual_mistakes_are_recognised_alone_and_together() {
    let pack = Spec::parse("packed:dim=3,n=216,lattice=cubic").unwrap().make().unwrap();
    let none = f64::INFINITY;
    let right = apart(&pack, 1.0, none);
    let plus = |list: &[[i64; 2]], k: i64| -> Vec<[i64; 2]> {
        list.iter().map(|pair| pair.map(|i| i + k)).collect()
    };
    let twice = |list: &[[i64; 2]]| -> Vec<[i64; 2]> {
        list.iter().flat_map(|&[i, j]| [[i, j], [j, i]]).collect()
    };
    let read = |list: &[[i64; 2]]| {
        verify(&pack, list, &Naming::Base(0), &[Naming::Base(1)]).reading.expect("it is explained")
    };
    let reading = read(&twice(&plus(&right, 1)));
    assert_eq!((reading.meaning, reading.both_sides, reading.wrong), (Meaning::Base(1), true, 0));
    let reading = read(&plus(&apart(&pack, 1.2, none), 1));
    assert_eq!((reading.meaning, reading.wrong), (Meaning::Base(1), 0));
    let Some(Deviation::Skin(skin)) = reading.deviation else { panic!("{reading:?}") };
    assert!(skin <= 0.2 && skin > 0.05, "{skin}");
    let dense = Spec::parse("packed:n=100,spacing=0.45").unwrap().make().unwrap();
    for (scene, reach, radii) in [(&dense, 0.5, 0.5), (&pack, 2.0, 2.0)] {
        // Diameters of 2 for radii of 0.5 reach 2; a radius that was halved reaches 0.5.
        let reading = verify(scene, &apart(scene, reach, none), &Naming::Base(0), &[]).reading;
        let found = reading.map(|reading| (reading.deviation, reading.wrong));
        assert_eq!(found, Some((Some(Deviation::Radii(radii)), 0)));
    }
    let reading = read(&apart(&pack, 1.0, 6.0));
    let Some(lengths) = reading.periodic else { panic!("{reading:?}") };
    assert!(lengths.iter().flatten().count() == 3 && reading.wrong == 0, "{lengths:?}");
    assert!(lengths.iter().flatten().all(|length| (5.8..6.2).contains(length)), "{lengths:?}");
    // Any wrong pairs are explained by nothing.
    let mut wrong = right.clone();
    wrong.extend((0..200).map(|k| [k, (7 * k + 5) % 216]).filter(|[i, j]| i != j));
    assert_eq!(verify(&pack, &wrong, &Naming::Base(0), &[Naming::Base(1)]).reading, None);
}

#[test]
fn both_sides_and_skins_are_allowed_where_asked_for() {
    // True are 0,1 and 1,2; 0,2 is 1 apart.
    let both = Allowed { both_sides: true, ..Allowed::default() };
    let asked =
        |list: &[[i64; 2]], allowed| allowing(&scene(), list, &Naming::Base(0), &[], allowed);
    assert!(asked(&[[0, 1], [2, 1], [1, 0], [1, 2]], both).is_same());
    let found = asked(&[[0, 1], [2, 1], [1, 0]], both);
    assert_eq!((found.one_sided, found.errors), (vec![[2, 1]], Errors::default()));
    let skin = |skin| Allowed { skin, ..Allowed::default() };
    let list = [[0, 1], [1, 2], [0, 2]];
    assert!(asked(&list, skin(1.0)).is_same());
    assert_eq!(asked(&list, skin(1.0)).within_skin, 1);
    assert_eq!(asked(&list, skin(0.9)).errors.spurious, 1);
}
