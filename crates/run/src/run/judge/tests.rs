use super::*;
use contactbench_ground::periodic::ImagePair;
use contactbench_ground::scene::{Lattice, Scene};

fn row() -> Scene<'static, f64, 2> {
    Scene::at([0.0, 2.0, 4.0, 6.0].map(|x| [x, 0.0]), 1.0).unwrap()
}

fn boxed(scene: Scene<'static, f64, 2>) -> Given {
    let edges = Lattice::along_axes([8.0, 8.0, 1.0], [true, false, false]).unwrap();
    Given::in_box(scene.into(), edges).unwrap()
}

/// Returns these pairs and a contact of disc 0 with the image `through` of disc 3.
fn contacts(plain: &[[u32; 2]], through: Option<i32>) -> ContactList {
    let shifted = through.map(|image| ImagePair::new(0, 3, [image, 0, 0])).into_iter().collect();
    ContactList { plain: plain.to_vec(), shifted }
}

const RIGHT: [[u32; 2]; 3] = [[0, 1], [1, 2], [2, 3]];

fn judged(
    judge: &mut Judge<'_>,
    arithmetic: Arithmetic,
    said: &ContactList,
    shown: Result<&ContactList, &str>,
) -> Judged {
    let found = &Found::from(said.digest());
    let said = Said { arithmetic, may_miss: false, found };
    judge.judge("one", said, |_| shown.cloned().map_err(String::from)).unwrap().0
}

#[test]
fn answers_are_right_lossy_or_wrong() {
    use Outcome::{Lossy, Ok, Wrong};
    let turned = [[2, 1], [3, 2], [1, 0]];
    let (fewer, more) = (&RIGHT[..2], [[0, 1], [1, 2], [2, 3], [0, 3]]);
    let twice = [[0, 1], [1, 2], [1, 2]];
    let given = row().into();
    for (arithmetic, said, outcome) in [
        (Arithmetic::Exact, &turned[..], Ok),
        (Arithmetic::Exact, fewer, Wrong),
        (Arithmetic::Textbook, fewer, Lossy),
        (Arithmetic::Textbook, &more, Wrong),
        (Arithmetic::Textbook, &twice, Wrong),
    ] {
        let (mut judge, said) = (Judge::new(&given, 1 << 20).unwrap(), contacts(said, None));
        let judged = judged(&mut judge, arithmetic, &said, Result::Ok(&said));
        assert_eq!(judged.outcome, outcome, "{arithmetic:?} {said:?}: {}", judged.reason);
        assert_eq!(judged.reason.is_empty(), outcome == Ok, "{}", judged.reason);
        let wrong = |errors: Option<Errors>| errors.unwrap().wrong() > 0;
        assert_eq!(wrong(judged.errors), outcome != Ok);
        assert_eq!(wrong(judged.causes.map(|causes| causes.search)), outcome != Ok);
    }
}

#[test]
fn pairs_that_cannot_be_seen_are_wrong_with_the_reason() {
    let (given, fewer) = (row().into(), contacts(&RIGHT[..2], None));
    let mut judge = Judge::new(&given, 1 << 20).unwrap();
    let others = contacts(&RIGHT[..1], None);
    for (shown, words) in
        [(Err("it has gone"), "it has gone"), (Ok(&others), "do not have the reported digest")]
    {
        let judged = judged(&mut judge, Arithmetic::Textbook, &fewer, shown);
        assert_eq!((judged.outcome, judged.errors), (Outcome::Wrong, None));
        assert!(judged.reason.contains(words), "{}", judged.reason);
    }
    // The pairs of a right answer are not requested.
    let right = judged(&mut judge, Arithmetic::F32, &contacts(&RIGHT, None), Err("asked"));
    assert_eq!(right.outcome, Outcome::Ok);
}

#[test]
fn what_nobody_knows_cannot_be_checked() {
    for given in [row().into(), boxed(row())] {
        let (mut judge, right) = (Judge::new(&given, 0).unwrap(), contacts(&RIGHT, None));
        let judged = judged(&mut judge, Arithmetic::Exact, &right, Ok(&right));
        assert_eq!((judged.outcome, judged.errors), (Outcome::Refused, None));
        assert!(judged.reason.starts_with("the answer cannot be checked: "), "{}", judged.reason);
        assert!(judge.count(Arithmetic::Exact).unwrap().1.is_some());
    }
}

#[test]
fn errors_in_a_box_have_their_causes() {
    // Two discs have a gap of 2^-30 through a face. Along x, the gap is lost by storing coordinates
    // in f32; along y, by rounding squares in f64.
    let causes = |x: f64, y: f64, arithmetic| {
        let given = boxed(Scene::at([[x, y], [7.5, 4.0]], 0.5).unwrap());
        let mut judge = Judge::new(&given, 1 << 20).unwrap();
        let said: ContactList = [ImagePair::new(0, 1, [-1, 0, 0])].into_iter().collect();
        let judged = judged(&mut judge, arithmetic, &said, Ok(&said));
        assert_eq!(judged.outcome, Outcome::Ok, "{}", judged.reason);
        let Causes { representation, predicate, search, .. } = judged.causes.unwrap();
        [judged.errors.unwrap(), representation, predicate, search].map(|e| e.spurious)
    };
    assert_eq!(causes(0.5, 4.0, Arithmetic::Exact), [0, 0, 0, 0]);
    assert_eq!(causes(0.5 + 2f64.powi(-30), 4.0, Arithmetic::F32), [1, 1, 0, 0]);
    assert_eq!(causes(0.5, 4.0 + 2f64.powi(-30), Arithmetic::F64), [1, 0, 1, 0]);
}

#[test]
fn contacts_in_a_box_have_their_images() {
    use Outcome::{Ok, Wrong};
    let given = boxed(row());
    let mut judge = Judge::new(&given, 1 << 20).unwrap();
    assert_eq!(judge.count(Arithmetic::Exact).unwrap().0.most, 4);
    for (arithmetic, image, outcome, missed, spurious) in [
        (Arithmetic::Exact, Some(-1), Ok, 0, 0),
        (Arithmetic::F64, Some(-1), Ok, 0, 0),
        (Arithmetic::Exact, Some(1), Wrong, 1, 1),
        (Arithmetic::F32, None, Wrong, 1, 0),
    ] {
        let said = contacts(&RIGHT, image);
        let judged = judged(&mut judge, arithmetic, &said, Result::Ok(&said));
        assert_eq!(judged.outcome, outcome, "{}", judged.reason);
        let errors = judged.errors.unwrap();
        assert_eq!((errors.missed, errors.spurious), (missed, spurious));
    }
}
