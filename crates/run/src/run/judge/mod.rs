//! The judge: whether an answer is right, lossy or wrong, and why, is decided here and nowhere
//! else.

mod at_rest;
mod moving;

use std::collections::HashMap;

use at_rest::AtRest;
use moving::Moving;
pub(crate) use moving::{Course, Said};

use crate::moving::Moved;
use crate::run::protocol;
use crate::run::trajectory::Trajectory;
use contactbench_core::contact::Arithmetic;
use contactbench_core::oracle::{Causes, Errors, NoTruth};
use contactbench_core::periodic::Contacts;
use contactbench_core::sink::{Digest, splitmix64};
use contactbench_io::Given;
use contactbench_record::record::row::Outcome;

/// Judges the answers about one scene. What is true is found when it is first needed.
pub struct Judge<'a> {
    of: Of<'a>,
    /// Answers judged before, by who gave them: timed samples repeat the same answer.
    seen: HashMap<(Arithmetic, String, u64, u64), (Judged, Course)>,
}

/// What is known of a scene.
enum Of<'a> {
    AtRest(AtRest<'a>),
    Moving(Moving),
}

/// Why nothing is known of a scene in an arithmetic.
#[derive(Clone)]
struct Nothing {
    reason: String,
    /// Nobody can answer: the contacts of the scene are too many, or its box makes no sense.
    hopeless: bool,
}

/// Why an answer is not judged.
enum Unjudged {
    /// Nothing is known that it could be held to.
    Nothing(Nothing),
    /// A defect of this program, or a file that cannot be read.
    Defect(anyhow::Error),
}

impl From<NoTruth> for Unjudged {
    fn from(reason: NoTruth) -> Unjudged {
        let hopeless = match &reason {
            NoTruth::Refused(refusal) => refusal.is_of_scene(),
            NoTruth::Stored(_) | NoTruth::TooLarge { .. } => false,
            _ => return Unjudged::Defect(reason.into()),
        };
        Unjudged::Nothing(Nothing { reason: reason.to_string(), hopeless })
    }
}

impl From<anyhow::Error> for Unjudged {
    fn from(error: anyhow::Error) -> Unjudged {
        Unjudged::Defect(error)
    }
}

impl Unjudged {
    /// Why nothing is known. A defect is an error.
    fn nothing(self) -> anyhow::Result<Nothing> {
        match self {
            Unjudged::Nothing(nothing) => Ok(nothing),
            Unjudged::Defect(error) => Err(error),
        }
    }
}

/// The judgement on an answer.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Judged {
    /// `ok`, `lossy` or `wrong`; `refused` where no truth is known.
    pub outcome: Outcome,
    /// Why it is not `ok`.
    pub reason: String,
    /// Against exact decisions on the scene as given. `None` where the pairs are not known.
    pub errors: Option<Errors>,
    /// The same by cause; in a box, particles and images are what is stored.
    pub causes: Option<Causes>,
}

impl Judged {
    fn without_pairs(outcome: Outcome, reason: String) -> Judged {
        Judged { outcome, reason, errors: None, causes: None }
    }

    /// Nobody knows the right one.
    fn unknown(nothing: Nothing) -> Judged {
        let reason = format!("the answer cannot be checked: {}", nothing.reason);
        Judged::without_pairs(Outcome::Refused, reason)
    }

    /// The answer is not the right one, and nobody can see in what.
    fn unseen(why: &str) -> Judged {
        let reason = format!("the pairs differ from the truth, and could not be read: {why}");
        Judged::without_pairs(Outcome::Wrong, reason)
    }

    /// By the errors against the truth in an arithmetic.
    fn by(own: &Errors, arithmetic: Arithmetic) -> Judged {
        let outcome = outcome(own, arithmetic);
        let reason = match outcome {
            Outcome::Ok => String::new(),
            _ => format!("against the true pairs in {}: {own}", arithmetic.name()),
        };
        Judged::without_pairs(outcome, reason)
    }
}

/// What errors against the truth in an arithmetic are worth: `ok`; `lossy`, if contacts are missing
/// and nothing else is wrong, where the arithmetic allows it; or `wrong`.
pub fn outcome(errors: &Errors, arithmetic: Arithmetic) -> Outcome {
    if errors.wrong() == 0 {
        Outcome::Ok
    } else if errors.wrong() == errors.missed && !arithmetic.is_safe() {
        Outcome::Lossy
    } else {
        Outcome::Wrong
    }
}

impl<'a> Judge<'a> {
    /// A judge who knows nothing yet. A list of contacts may take so many bytes.
    ///
    /// # Errors
    /// A box that does not suit the scene.
    pub fn new(given: &'a Given, memory_limit: u64) -> anyhow::Result<Judge<'a>> {
        let of = Of::AtRest(AtRest::new(given, memory_limit)?);
        Ok(Judge { of, seen: HashMap::new() })
    }

    /// A judge of all frames of a trajectory, and what the motion is like, if the truth is known in
    /// all of them.
    pub fn moving(
        trajectory: Trajectory,
        memory_limit: u64,
    ) -> anyhow::Result<(Judge<'static>, Option<Moved>)> {
        let (moving, moved) = Moving::new(trajectory, memory_limit)?;
        Ok((Judge { of: Of::Moving(moving), seen: HashMap::new() }, moved))
    }

    /// Judges the answer of a contender in its arithmetic: the number and the digest of its pairs.
    /// `fetch` asks for the pairs; it is not called for an answer that is right or was judged
    /// before.
    pub(crate) fn judge(
        &mut self,
        contender: &str,
        arithmetic: Arithmetic,
        (contacts, digest): (u64, &str),
        fetch: impl FnOnce() -> Result<Contacts, String>,
    ) -> anyhow::Result<Judged> {
        let said = match protocol::digest(contacts, digest) {
            Ok(said) => said,
            Err(reason) => return Ok(Judged::without_pairs(Outcome::Wrong, reason)),
        };
        let key = (arithmetic, contender.to_string(), said.contacts, said.sum);
        if let Some((judged, _)) = self.seen.get(&key) {
            return Ok(judged.clone());
        }
        let fetch = || {
            let contacts = fetch()?;
            let same = contacts.digest() == said;
            if same { Ok(contacts) } else { Err("asked for them, it gave others".into()) }
        };
        let judged = match &mut self.of {
            Of::AtRest(scene) => scene.judge(arithmetic, said, fetch),
            Of::Moving(_) => Ok(Judged::unseen("it answers one frame of several")),
        };
        let judged = judged.or_else(|why| why.nothing().map(Judged::unknown))?;
        if judged.errors.is_some() {
            self.seen.insert(key, (judged.clone(), Course::default()));
        }
        Ok(judged)
    }

    /// Judges the answers of a contender to all frames of a trajectory, and the digest of all of
    /// them. `fetch` asks for the pairs of a frame, as in [`Judge::judge`].
    pub(crate) fn judge_course(
        &mut self,
        contender: &str,
        said: Said<'_>,
        whole: Digest,
        fetch: impl FnMut(u64) -> Result<Contacts, String>,
    ) -> anyhow::Result<(Judged, Course)> {
        if let Some(why) = said.steps.answers().find_map(Result::err) {
            return Ok((Judged::without_pairs(Outcome::Wrong, why), Course::default()));
        }
        // When lists were built is part of what is said.
        let flags = said.steps.built.iter().chain(&said.steps.dangerous);
        let sum = flags.fold(whole.sum, |sum, &flag| splitmix64(sum ^ u64::from(flag)));
        let key = (said.arithmetic, contender.to_string(), whole.contacts, sum);
        if let Some(known) = self.seen.get(&key) {
            return Ok(known.clone());
        }
        let Of::Moving(moving) = &mut self.of else {
            let words = "it answers several frames, and there is one";
            return Ok((Judged::unseen(words), Course::default()));
        };
        let found = moving
            .judge(said, fetch)
            .or_else(|why| anyhow::Ok((Judged::unknown(why.nothing()?), Course::default())))?;
        if found.0.errors.is_some() {
            self.seen.insert(key, found.clone());
        }
        Ok(found)
    }

    /// How many contacts there are at most in a frame, in exact arithmetic.
    pub fn most_contacts(&mut self) -> anyhow::Result<u64> {
        let most = match &mut self.of {
            Of::Moving(moving) => moving.most_contacts(),
            Of::AtRest(_) => self.truth(Arithmetic::Exact).map(|digest| digest.contacts),
        };
        most.or_else(|why| why.nothing().map(|_| 0))
    }

    pub fn is_moving(&self) -> bool {
        matches!(self.of, Of::Moving(_))
    }

    /// How many contacts there are by the arithmetic's own contact test. `None` where no truth is
    /// known.
    pub fn contacts(&mut self, arithmetic: Arithmetic) -> anyhow::Result<Option<u64>> {
        let contacts = self.truth(arithmetic).map(|digest| Some(digest.contacts));
        contacts.or_else(|why| why.nothing().map(|_| None))
    }

    /// Why nobody can answer, if nobody can.
    pub fn hopeless(&mut self, arithmetic: Arithmetic) -> anyhow::Result<Option<String>> {
        let nothing = self.nothing(arithmetic)?.filter(|nothing| nothing.hopeless);
        Ok(nothing.map(|nothing| nothing.reason))
    }

    /// Why no truth is known in `arithmetic`; empty where one is.
    pub fn why_none(&mut self, arithmetic: Arithmetic) -> anyhow::Result<String> {
        Ok(self.nothing(arithmetic)?.map_or_else(String::new, |nothing| nothing.reason))
    }

    fn nothing(&mut self, arithmetic: Arithmetic) -> anyhow::Result<Option<Nothing>> {
        self.truth(arithmetic).err().map(Unjudged::nothing).transpose()
    }

    /// The fingerprint of the right answer.
    fn truth(&mut self, arithmetic: Arithmetic) -> Result<Digest, Unjudged> {
        match &mut self.of {
            Of::AtRest(scene) => Ok(scene.known(arithmetic)?.own.digest),
            Of::Moving(moving) => moving.truth(arithmetic),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contactbench_core::periodic::ImagePair;
    use contactbench_core::scene::{AnyScene, Lattice, Radii, Scene, Stored};

    /// Four unit discs in a row, of which neighbours touch.
    fn row() -> Given {
        let centres = [0.0, 2.0, 4.0, 6.0].map(|x| nalgebra::Point::from([x, 0.0]));
        Scene::<f64, 2>::new(centres.to_vec(), Radii::Uniform(1.0)).unwrap().into()
    }

    fn seen(pairs: &[[u32; 2]]) -> Contacts {
        Contacts { plain: pairs.to_vec(), ..Contacts::default() }
    }

    const RIGHT: [[u32; 2]; 3] = [[0, 1], [1, 2], [2, 3]];

    fn judged(arithmetic: Arithmetic, said: &[[u32; 2]], shown: Option<&[[u32; 2]]>) -> Judged {
        let scene = row();
        let digest = Digest::from_pairs(said);
        let fetch = || shown.map(seen).ok_or_else(|| "it has gone".into());
        let answer = (digest.contacts, &*digest.hex());
        Judge::new(&scene, 1 << 20).unwrap().judge("one", arithmetic, answer, fetch).unwrap()
    }

    #[test]
    fn answers_are_right_lossy_or_wrong() {
        use Outcome::{Lossy, Ok, Wrong};
        let turned = [[2, 1], [3, 2], [1, 0]];
        let (fewer, more) = (&RIGHT[..2], [[0, 1], [1, 2], [2, 3], [0, 3]]);
        let twice = [[0, 1], [1, 2], [1, 2]];
        for (arithmetic, said, outcome) in [
            (Arithmetic::Exact, &turned[..], Ok),
            (Arithmetic::Exact, fewer, Wrong),
            (Arithmetic::Textbook, fewer, Lossy),
            (Arithmetic::Textbook, &more, Wrong),
            (Arithmetic::Textbook, &twice, Wrong),
        ] {
            let judged = judged(arithmetic, said, Some(said));
            assert_eq!(judged.outcome, outcome, "{arithmetic:?} {said:?}: {}", judged.reason);
            assert_eq!(judged.reason.is_empty(), outcome == Ok, "{}", judged.reason);
            let wrong = |errors: Option<Errors>| errors.unwrap().wrong() > 0;
            assert_eq!(wrong(judged.errors), outcome != Ok);
            assert_eq!(wrong(judged.causes.map(|causes| causes.search)), outcome != Ok);
        }
    }

    #[test]
    fn pairs_that_cannot_be_seen_are_wrong_with_the_reason() {
        for (shown, words) in [(None, "it has gone"), (Some(&RIGHT[..1]), "it gave others")] {
            let judged = judged(Arithmetic::Textbook, &RIGHT[..2], shown);
            assert_eq!((judged.outcome, judged.errors), (Outcome::Wrong, None));
            assert!(judged.reason.contains(words), "{}", judged.reason);
        }
        // Nobody asks for the pairs of a right answer.
        assert_eq!(judged(Arithmetic::F32, &RIGHT, None).outcome, Outcome::Ok);
    }

    #[test]
    fn a_digest_that_is_none_is_wrong() {
        let scene = row();
        let upper = Digest::from_pairs(&RIGHT).hex().to_uppercase();
        let judged = Judge::new(&scene, 1 << 20)
            .unwrap()
            .judge("one", Arithmetic::Exact, (3, &upper), || Ok(seen(&RIGHT)))
            .unwrap();
        assert_eq!(judged.outcome, Outcome::Wrong);
        assert!(judged.reason.contains("16 lower-case hexadecimal digits"), "{}", judged.reason);
    }

    #[test]
    fn what_nobody_knows_cannot_be_checked() {
        let AnyScene::Plane(Stored::F64(scene)) = row().scene else { panic!("discs") };
        let edges = Lattice::along_axes([8.0, 8.0, 1.0], [true, false, false]).unwrap();
        let digest = Digest::from_pairs(&RIGHT);
        for given in [row(), Given::in_box(scene.into(), edges).unwrap()] {
            let mut judge = Judge::new(&given, 0).unwrap();
            let said = (digest.contacts, &*digest.hex());
            let judged = judge.judge("one", Arithmetic::Exact, said, || Ok(seen(&RIGHT))).unwrap();
            assert_eq!((judged.outcome, judged.errors), (Outcome::Refused, None));
            let words = "the answer cannot be checked: ";
            assert!(judged.reason.starts_with(words), "{}", judged.reason);
            assert_eq!(judge.contacts(Arithmetic::Exact).unwrap(), None);
        }
    }

    #[test]
    fn errors_in_a_box_have_their_causes() {
        use Outcome::Ok;
        // Through a face, by 2^-30 too far: along x that is lost where coordinates are stored in
        // f32, across it where the test rounds squares in f64.
        let judged = |x: f64, y: f64, arithmetic| {
            let centres = [[x, y], [7.5, 4.0]].map(nalgebra::Point::from).to_vec();
            let scene: Scene<'_, f64, 2> = Scene::new(centres, Radii::Uniform(0.5)).unwrap();
            let edges = Lattice::along_axes([8.0, 8.0, 1.0], [true, false, false]).unwrap();
            let given = Given::in_box(scene.into(), edges).unwrap();
            let mut judge = Judge::new(&given, 1 << 20).unwrap();
            let shifted = vec![ImagePair::new(0, 1, [-1, 0, 0])];
            let contacts = Contacts { plain: Vec::new(), shifted };
            let digest = contacts.digest();
            let said = (digest.contacts, &*digest.hex());
            let judged = judge.judge("one", arithmetic, said, || Result::Ok(contacts)).unwrap();
            assert_eq!(judged.outcome, Ok, "{}", judged.reason);
            let Causes { representation, predicate, search, .. } = judged.causes.unwrap();
            [judged.errors.unwrap(), representation, predicate, search].map(|e| e.spurious)
        };
        assert_eq!(judged(0.5, 4.0, Arithmetic::Exact), [0, 0, 0, 0]);
        assert_eq!(judged(0.5 + 2f64.powi(-30), 4.0, Arithmetic::F32), [1, 1, 0, 0]);
        assert_eq!(judged(0.5, 4.0 + 2f64.powi(-30), Arithmetic::F64), [1, 0, 1, 0]);
    }

    #[test]
    fn contacts_in_a_box_have_their_images() {
        use Outcome::{Ok, Wrong};
        let AnyScene::Plane(Stored::F64(scene)) = row().scene else { panic!("discs") };
        let edges = Lattice::along_axes([8.0, 8.0, 1.0], [true, false, false]).unwrap();
        let given = Given::in_box(scene.into(), edges).unwrap();
        let mut judge = Judge::new(&given, 1 << 20).unwrap();
        assert_eq!(judge.contacts(Arithmetic::Exact).unwrap(), Some(4));
        let through = |image: i32| {
            let shifted = vec![ImagePair::new(0, 3, [image, 0, 0])];
            Contacts { plain: RIGHT.to_vec(), shifted }
        };
        for (arithmetic, contacts, outcome, missed, spurious) in [
            (Arithmetic::Exact, through(-1), Ok, 0, 0),
            (Arithmetic::F64, through(-1), Ok, 0, 0),
            (Arithmetic::Exact, through(1), Wrong, 1, 1),
            (Arithmetic::F32, seen(&RIGHT), Wrong, 1, 0),
        ] {
            let digest = contacts.digest();
            let said = (digest.contacts, &*digest.hex());
            let judged = judge.judge("one", arithmetic, said, || Result::Ok(contacts)).unwrap();
            assert_eq!(judged.outcome, outcome, "{}", judged.reason);
            let errors = judged.errors.unwrap();
            assert_eq!((errors.missed, errors.spurious), (missed, spurious));
        }
    }
}
