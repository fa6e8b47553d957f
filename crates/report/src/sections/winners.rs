use super::{About, Section};
use crate::document::{Block, Text};
use crate::table::{Cell, Table};
use contactbench_record::findings::winners::{Contest, RankedSubject, Winners};
use contactbench_record::stats::interval::spread;
use contactbench_terms::number::{number, plural, short};

pub const ALL: &str = "Scene by scene";
/// The answer of a record whose times were disturbed.
pub const NOT_JUDGED: &str = "Times are not judged, because other load may have changed them.";

pub fn blocks(winners: &Winners, cold: bool) -> Vec<Block> {
    let sentence = (winners.scenes > 0).then(|| Block::Paragraph(sentence(winners)));
    let shown = shown(winners);
    let table =
        compared(winners).then(|| Block::Table(table(&shown, cold, short, winners.disturbed)));
    sentence.into_iter().chain(left_out(winners)).chain(table).collect()
}

/// Returns the table of all scenes, if the answer at the top shows no table or not all scenes.
pub fn section(about: &About<'_>) -> Option<Section> {
    let (winners, asked) = (about.winners, about.experiment.asks_fastest());
    let all: Vec<&Contest> = winners.contests.iter().collect();
    if !compared(winners) || asked && shown(winners).len() == all.len() {
        return None;
    }
    let sentence = (!asked).then(|| Block::Paragraph(sentence(winners)));
    let table = Block::Table(table(&all, true, number, winners.disturbed));
    Some(Section::new(ALL, sentence.into_iter().chain([table]).collect()))
}

pub fn compared(winners: &Winners) -> bool {
    winners.contests.iter().any(|contest| !contest.others.is_empty())
}

pub fn shown(winners: &Winners) -> Vec<&Contest> {
    winners.contests.iter().filter(|contest| contest.shown).collect()
}

pub fn left_out(winners: &Winners) -> Option<Block> {
    let (shown, all) = (shown(winners).len(), winners.contests.len());
    (compared(winners) && shown < all).then(|| {
        Block::paragraph(format!(
            "{shown} of {} are shown; all are in the table \u{201c}{ALL}\u{201d}.",
            plural(all, "scene")
        ))
    })
}

/// Counts the scenes that each detector wins; the table names the detectors of the others.
pub fn sentence(winners: &Winners) -> Text {
    let wins = winners.wins();
    let Some((first, margins)) = wins.first() else { return undecided_all(winners).into() };
    let untimed = winners.scenes - winners.contests.len();
    let others = [("undecided", winners.undecided()), ("without a time", untimed)];
    let others = others.into_iter().filter(|(_, count)| *count > 0);
    let won = wins.iter().skip(1).map(|(name, margins)| (*name, margins.len()));
    let rest: Vec<_> = won.chain(others).map(|(name, count)| format!("{name}: {count}")).collect();
    let words = format!("{first} is the fastest in {} of {} scenes", margins.len(), winners.scenes);
    let mut out = Text::default().strong(words);
    if let Some([least, typical, most]) = spread(margins) {
        out = out.plain(format!(
            "; the runner-up takes {typical:.1} times as long (median; {least:.1} to {most:.1})"
        ));
    }
    out.plain(if rest.is_empty() { ".".into() } else { format!(". {}.", rest.join("; ")) })
}

/// Explains why no scene is decided.
fn undecided_all(winners: &Winners) -> String {
    let others = winners.contests.iter().flat_map(|contest| &contest.others);
    let blocks = others.filter_map(|other| Some(other.ratio?.count)).max().unwrap_or(0);
    let scenes = winners.contests.len();
    let undecided = format!("Undecided in {scenes} of {scenes} scenes");
    match blocks {
        _ if winners.disturbed => NOT_JUDGED.into(),
        _ if scenes == 0 => "No times were taken: only answers, counts and memory.".into(),
        _ if !compared(winners) => "In no scene, two detectors have times.".into(),
        ..5 => format!("{undecided}: {blocks} of the 5 blocks needed."),
        _ => format!("{undecided}; the last column names the detectors."),
    }
}

/// Returns the table of these scenes, with ratios of first detections if `cold` and if there are
/// any.
fn table(contests: &[&Contest], cold: bool, time: fn(f64) -> String, disturbed: bool) -> Table {
    fn next(contest: &Contest) -> Option<&RankedSubject> {
        contest.others.first()
    }
    let cold = cold && contests.iter().any(|it| next(it).is_some_and(|next| next.cold.is_some()));
    Table::of("", contests)
        .left("scene", |it| &*it.title)
        .left("fastest", |it| {
            let first = Cell::from(&*it.first.name);
            if it.decided() { first.strong() } else { first }
        })
        .unit("time / N", "ns", |it| time(it.first.per_particle))
        .unit("time / pair", "ns", |it| it.first.per_pair.map(time))
        .left("runner-up", |it| next(it).map_or("alone", |next| &*next.name))
        .right("its time / fastest", |it| next(it).and_then(|next| next.ratio))
        .left("verdict", |it| decided(it, disturbed))
        .when(cold, |table| table.right("both cold", |it| next(it).and_then(|next| next.cold)))
        .into()
}

/// Returns `decided`, or names the detectors that may be as fast.
fn decided(contest: &Contest, disturbed: bool) -> Cell {
    let open = contest.others.iter().filter(|other| !other.slower);
    match contest.others.len() {
        0 => Cell::Absent,
        _ if disturbed => "not judged".into(),
        _ if contest.decided() => "decided".into(),
        _ => undecided(open.map(|other| &other.name)),
    }
}

/// Formats `undecided: nbs, sweep and 3 more`.
pub fn undecided<'a>(open: impl IntoIterator<Item = &'a String>) -> Cell {
    let open: Vec<&str> = open.into_iter().map(String::as_str).collect();
    let (named, more) = open.split_at(open.len().min(2));
    let more = if more.is_empty() { String::new() } else { format!(" and {} more", more.len()) };
    format!("undecided: {}{more}", named.join(", ")).into()
}
