//! The usual mistakes, as a table: what would touch if the code had made each.

use crate::check::verify::guess::periods;
use crate::check::verify::mistake::Mistake;
use crate::check::verify::search::Search;
use crate::check::verify::{truth, within};
use contactbench_core::contact::Arithmetic;
use contactbench_core::periodic::{Contacts, ImagePair, Periodic, depth};
use contactbench_core::scene::{Lattice, Radii};
use contactbench_core::with_scene;

/// A mistake that is tried: what would touch if the code had made it.
pub(super) struct Row {
    pub kind: Kind,
    pub tries: for<'a> fn(&'a Search<'_>, At<'a>) -> Tries<'a>,
}

/// What touches with each variant of a mistake, found when it is asked for.
pub(super) type Tries<'a> = Box<dyn Iterator<Item = (Mistake, Contacts)> + 'a>;

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// A part of the contacts.
    Part,
    /// Pairs that just touch are decided otherwise.
    Tie,
    /// Other sizes or a skin: counts only if it explains all but what is far apart.
    Size,
    /// Another box.
    Box,
}

/// The particles for which a mistake is tried, and the contacts that are true there.
#[derive(Clone, Copy)]
pub(super) struct At<'a> {
    pub space: &'a Periodic<'a>,
    pub truth: &'a Contacts,
}

/// The mistakes, in the order in which they are tried.
pub(super) const ROWS: [Row; 13] = [
    Row { kind: Kind::Part, tries: open },
    Row { kind: Kind::Part, tries: without_own },
    Row { kind: Kind::Part, tries: nearest },
    Row { kind: Kind::Tie, tries: strict },
    Row { kind: Kind::Tie, tries: rounded },
    Row { kind: Kind::Size, tries: doubled },
    Row { kind: Kind::Size, tries: skin },
    Row { kind: Kind::Size, tries: larger },
    Row { kind: Kind::Size, tries: halved },
    Row { kind: Kind::Size, tries: smaller },
    Row { kind: Kind::Box, tries: straight },
    Row { kind: Kind::Box, tries: other_axes },
    Row { kind: Kind::Box, tries: guessed },
];

fn open<'a>(_: &'a Search<'_>, at: At<'a>) -> Tries<'a> {
    part(at, Mistake::Open, |pair| pair.image == [0; 3])
}

fn without_own<'a>(_: &'a Search<'_>, at: At<'a>) -> Tries<'a> {
    part(at, Mistake::WithoutOwn, |pair| pair.i != pair.j)
}

fn nearest<'a>(search: &'a Search<'_>, at: At<'a>) -> Tries<'a> {
    if at.truth.shifted.is_empty() {
        return none();
    }
    let deepest = search.against(at.space, at.truth).deepest();
    one(Mistake::Nearest, deepest.filtered(|pair| pair.i != pair.j))
}

fn strict<'a>(search: &'a Search<'_>, at: At<'a>) -> Tries<'a> {
    if search.found.errors.spurious > 0 || search.largest() > 0.0 {
        return none();
    }
    one(Mistake::Strict, at.truth.filtered(|pair| depth(at.space, pair) != 0.0))
}

fn rounded<'a>(search: &'a Search<'_>, at: At<'a>) -> Tries<'a> {
    if search.job.terms.arithmetic != Arithmetic::Exact {
        return none();
    }
    let limit = search.job.terms.memory_limit;
    let truth = move |of| Some((Mistake::Rounded(of), self::truth(at.space, of, limit).ok()?));
    Box::new([Arithmetic::F64, Arithmetic::F32].into_iter().filter_map(truth))
}

fn doubled<'a>(search: &'a Search<'_>, at: At<'a>) -> Tries<'a> {
    match search.is_larger(1) && search.found.spurious.widest > 1.0 {
        true => search.with_radii(at, 2.0, 1.0, |_| true),
        false => none(),
    }
}

fn skin<'a>(search: &'a Search<'_>, at: At<'a>) -> Tries<'a> {
    // One pair beside the others is no skin.
    if !search.is_larger(2) {
        return none();
    }
    let gap = search.found.spurious.gap;
    let near = within(at.space, gap, search.job.terms.memory_limit);
    near.map_or_else(|_| none(), |near| one(Mistake::Skin(gap), near))
}

fn larger<'a>(search: &'a Search<'_>, at: At<'a>) -> Tries<'a> {
    let one_size =
        with_scene!(at.space.scene(), scene => matches!(scene.radii(), Radii::Uniform(_)));
    if one_size || !search.is_larger(2) {
        return none();
    }
    let widest = search.found.spurious.widest;
    let within = move |pair| -depth(at.space, pair) <= widest;
    search.with_radii(at, 1.0 + 0.5 * widest, 1.0 + 1e-9, within)
}

fn halved<'a>(search: &'a Search<'_>, at: At<'a>) -> Tries<'a> {
    match search.is_smaller(1) {
        true => search.with_radii(at, 0.5, 1.0, |_| true),
        false => none(),
    }
}

fn smaller<'a>(search: &'a Search<'_>, at: At<'a>) -> Tries<'a> {
    let most = search.found.errors.deepest_miss;
    let deep = at.truth.filtered(|pair| depth(at.space, pair) > most);
    if deep.is_empty() || !search.is_smaller(2) {
        return none();
    }
    let least = deep.iter().map(|pair| depth(at.space, pair)).fold(2.0, f64::min);
    one(Mistake::Radii(1.0 - 0.5 * least), deep)
}

fn straight<'a>(search: &'a Search<'_>, at: At<'a>) -> Tries<'a> {
    let lattice = at.space.lattice();
    let vectors = lattice.vectors();
    let lower = (0..3).all(|a| (a + 1..3).all(|k| vectors[a][k] == 0.0));
    if !lattice.repeats() || !lattice.is_tilted() || !lower {
        return none();
    }
    let edges = [0, 1, 2].map(|k| vectors[k][k]);
    let [x, y, z] = edges;
    let vectors = [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]];
    let straight = Lattice::new(vectors, lattice.periodic(), lattice.origin());
    search.boxes(at, [straight.ok().map(|of| (Mistake::Straight(edges), of))])
}

fn other_axes<'a>(search: &'a Search<'_>, at: At<'a>) -> Tries<'a> {
    let lattice = at.space.lattice();
    if !lattice.repeats() {
        return none();
    }
    let (vectors, origin, axes) = (*lattice.vectors(), lattice.origin(), lattice.periodic());
    let flat = at.space.scene().dim() == 2 || vectors[2] == [0.0; 3];
    let flags = (1..8).map(|bits| [0, 1, 2].map(|k| bits >> k & 1 == 1));
    let other = flags.filter(move |flags| *flags != axes && !(flags[2] && flat));
    let lattice = move |flags| Lattice::new(vectors, flags, origin).ok();
    search.boxes(at, other.map(move |flags| Some((Mistake::Along(flags), lattice(flags)?))))
}

/// Guesses the periods of the box from the listed contacts, if no file declares a box.
fn guessed<'a>(search: &'a Search<'_>, at: At<'a>) -> Tries<'a> {
    if !search.may_guess || at.space.lattice().repeats() {
        return none();
    }
    match periods(at.space, &search.listing.contacts, at.truth) {
        None => none(),
        Some((periods, far)) => {
            let mut contacts = at.truth.clone();
            contacts.plain.extend(far);
            contacts.sort();
            one(Mistake::Periods(periods), contacts)
        }
    }
}

fn none<'a>() -> Tries<'a> {
    Box::new(std::iter::empty())
}

pub(super) fn one<'a>(mistake: Mistake, contacts: Contacts) -> Tries<'a> {
    Box::new(std::iter::once((mistake, contacts)))
}

fn part<'a>(at: At<'a>, mistake: Mistake, keep: impl Fn(ImagePair) -> bool) -> Tries<'a> {
    let part = at.truth.filtered(keep);
    if part.len() < at.truth.len() { one(mistake, part) } else { none() }
}
