//! The table of common mistakes in contact lists, each with the contacts that it would give.

use crate::check::verify::guess::periods;
use crate::check::verify::mistake::Mistake;
use crate::check::verify::search::Search;
use crate::check::verify::{truth, within};
use contactbench_ground::contact::Arithmetic;
use contactbench_ground::periodic::{ContactList, ImagePair, Periodic, depth};
use contactbench_ground::scene::Radii;
use contactbench_ground::with_scene;

/// Common mistakes of one kind. Each function passes on the contacts that each variant of one
/// mistake would give.
pub(super) struct Row {
    pub kind: Kind,
    pub tries: &'static [fn(&Search<'_>, At<'_>, Each<'_>)],
}

/// Receives a mistake with the contacts that it would give; returns whether to try more.
pub(super) type Each<'a> = &'a mut dyn FnMut(Mistake, ContactList) -> bool;

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Part,
    /// A mistake about pairs that just touch.
    Tie,
    /// Wrong sizes or a skin. Such a mistake must explain all differing pairs except distant ones.
    Size,
    Box,
}

#[derive(Clone, Copy)]
pub(super) struct At<'a> {
    pub space: &'a Periodic<'a>,
    pub truth: &'a ContactList,
}

/// The mistakes in the order in which they are tried.
pub(super) const ROWS: [Row; 5] = [
    Row { kind: Kind::Tie, tries: &[strict] },
    Row { kind: Kind::Part, tries: &[open, without_own, nearest] },
    Row { kind: Kind::Tie, tries: &[rounded] },
    Row { kind: Kind::Size, tries: &[doubled, skin, larger, halved, smaller] },
    Row { kind: Kind::Box, tries: &[straight, other_axes, guessed] },
];

fn open(_: &Search<'_>, at: At<'_>, each: Each<'_>) {
    part(at, Mistake::Open, |pair| pair.image == [0; 3], each);
}

fn without_own(_: &Search<'_>, at: At<'_>, each: Each<'_>) {
    part(at, Mistake::WithoutOwn, |pair| pair.i != pair.j, each);
}

fn nearest(search: &Search<'_>, at: At<'_>, each: Each<'_>) {
    if !at.truth.shifted.is_empty() {
        let deepest = search.against(at.space, at.truth).deepest();
        each(Mistake::Nearest, deepest.filtered(|pair| pair.i != pair.j));
    }
}

fn strict(search: &Search<'_>, at: At<'_>, each: Each<'_>) {
    let (errors, terms) = (search.found.errors, search.job.terms);
    if search.largest() > 0.0 {
        return;
    }
    if errors.spurious == 0 && terms.arithmetic == Arithmetic::Exact {
        each(Mistake::Strict, at.truth.filtered(|pair| depth(at.space, pair) != 0.0));
    } else if errors.missed == 0 && terms.arithmetic == Arithmetic::ExactOpen {
        let closed = truth(at.space, Arithmetic::Exact, terms.memory_limit);
        closed.into_iter().for_each(|closed| {
            each(Mistake::Closed, closed);
        });
    }
}

fn rounded(search: &Search<'_>, at: At<'_>, each: Each<'_>) {
    if search.job.terms.arithmetic != Arithmetic::Exact {
        return;
    }
    for of in [Arithmetic::F64, Arithmetic::F32] {
        let truth = truth(at.space, of, search.job.terms.memory_limit);
        if truth.is_ok_and(|truth| !each(Mistake::Rounded(of), truth)) {
            return;
        }
    }
}

fn doubled(search: &Search<'_>, at: At<'_>, each: Each<'_>) {
    if search.is_larger(1) && search.found.spurious.widest > 1.0 {
        search.with_radii(at, 2.0, 1.0, |_| true, each);
    }
}

fn skin(search: &Search<'_>, at: At<'_>, each: Each<'_>) {
    let gap = search.found.spurious.gap;
    // A single spurious pair does not suggest a skin.
    if search.is_larger(2)
        && let Ok(near) = within(at.space, gap, search.job.terms.memory_limit)
    {
        each(Mistake::Skin(gap), near);
    }
}

fn larger(search: &Search<'_>, at: At<'_>, each: Each<'_>) {
    let one_size =
        with_scene!(at.space.scene(), scene => matches!(scene.radii(), Radii::Uniform(_)));
    if !one_size && search.is_larger(2) {
        let widest = search.found.spurious.widest;
        let within = |pair| -depth(at.space, pair) <= widest;
        search.with_radii(at, 1.0 + 0.5 * widest, 1.0 + 1e-9, within, each);
    }
}

fn halved(search: &Search<'_>, at: At<'_>, each: Each<'_>) {
    if search.is_smaller(1) {
        search.with_radii(at, 0.5, 1.0, |_| true, each);
    }
}

fn smaller(search: &Search<'_>, at: At<'_>, each: Each<'_>) {
    let most = search.found.errors.deepest_miss;
    let deep = at.truth.filtered(|pair| depth(at.space, pair) > most);
    if !deep.is_empty() && search.is_smaller(2) {
        let least = deep.iter().map(|pair| depth(at.space, pair)).fold(2.0, f64::min);
        each(Mistake::Radii(1.0 - 0.5 * least), deep);
    }
}

fn straight(search: &Search<'_>, at: At<'_>, each: Each<'_>) {
    let lattice = at.space.lattice();
    let vectors = lattice.vectors();
    let lower = (0..3).all(|a| (a + 1..3).all(|k| vectors[a][k] == 0.0));
    if lattice.repeats() && lattice.is_tilted() && lower {
        let edges = [0, 1, 2].map(|k| vectors[k][k]);
        let [x, y, z] = edges;
        let vectors = [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]];
        search.in_box(at, Mistake::Straight(edges), (vectors, lattice.periodic()), each);
    }
}

fn other_axes(search: &Search<'_>, at: At<'_>, each: Each<'_>) {
    let lattice = at.space.lattice();
    let vectors = *lattice.vectors();
    let flat = at.space.scene().dim() == 2 || vectors[2] == [0.0; 3];
    let all = (1..8).map(|bits| [0, 1, 2].map(|k| bits >> k & 1 == 1));
    for axes in all.filter(|axes| *axes != lattice.periodic() && !(axes[2] && flat)) {
        if !lattice.repeats() || !search.in_box(at, Mistake::Along(axes), (vectors, axes), each) {
            return;
        }
    }
}

/// Guesses the periods of the box from the listed contacts, if no file declares a box.
fn guessed(search: &Search<'_>, at: At<'_>, each: Each<'_>) {
    if search.may_guess
        && !at.space.lattice().repeats()
        && let Some((periods, far)) = periods(at.space, &search.listing.contacts, at.truth)
    {
        let mut contacts = at.truth.clone();
        contacts.plain.extend(far);
        contacts.sort();
        each(Mistake::Periods(periods), contacts);
    }
}

fn part(at: At<'_>, mistake: Mistake, keep: impl Fn(ImagePair) -> bool, each: Each<'_>) {
    let part = at.truth.filtered(keep);
    if part.len() < at.truth.len() {
        each(mistake, part);
    }
}
