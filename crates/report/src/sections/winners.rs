use std::collections::BTreeSet;

use super::{About, Section};
use crate::document::{Block, Text};
use crate::table::{Cell, Table};
use contactbench_record::findings::winners::{Alone, Contest, RankedSubject, Tally, Winners};
use contactbench_record::record::row::Outcome;
use contactbench_terms::number::{number, plural, short};

pub const ALL: &str = "Scene by scene";

pub fn blocks(winners: &Winners, cold: bool) -> Vec<Block> {
    let sentence = (winners.scenes > 0).then(|| Block::Paragraph(sentence(winners)));
    let shown = shown(winners);
    let table = compared(winners)
        .then(|| Block::Table(table(&shown, &Columns { pictures: false, cold, time: short })));
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
    Some(Section::new(
        ALL,
        sentence
            .into_iter()
            .chain([Block::Table(table(
                &all,
                &Columns { pictures: false, cold: true, time: number },
            ))])
            .collect(),
    ))
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

pub fn sentence(winners: &Winners) -> Text {
    let tally = Tally::new(winners);
    let end = match tally.untimed {
        0 => String::new(),
        _ if tally.untimed == tally.scenes => String::new(),
        1 => " In 1 scene no detector has a time.".into(),
        some => format!(" In {some} scenes no detector has a time."),
    };
    let Some((first, rest)) = tally.wins.split_first() else {
        return match &tally.alone {
            _ if winners.contests.is_empty() => {
                "No times were taken: only answers, counts and memory.".into()
            }
            Some(found) => alone(found).plain(end),
            None => Text::from(undecided_all(&winners.contests) + &end),
        };
    };
    let wins = format!("{} of {}", first.margins.len(), plural(tally.scenes, "scene"));
    let mut out = Text::new().strong(first.detector.as_str()).plain(" is the fastest in ");
    out = out.strong(wins);
    if let Some((typical, least, most)) = first.margin() {
        out = out.plain("; the runner-up takes ").strong(format!("{typical:.1} times"));
        out = out.plain(match first.margins.len() {
            1 => " as long".into(),
            _ => format!(" as long (median; {least:.1} to {most:.1})"),
        });
    }
    let mut rest: Vec<String> =
        rest.iter().map(|wins| format!("{} wins {}", wins.detector, wins.margins.len())).collect();
    rest.extend((tally.undecided > 0).then(|| match tally.undecided {
        1 => "1 is undecided".into(),
        more => format!("{more} are undecided"),
    }));
    let rest = if rest.is_empty() { String::new() } else { format!(" {}.", rest.join("; ")) };
    out.plain(format!(".{rest}{end}"))
}

/// Formats a sentence such as `nbs is the only one with a right answer (my-det was wrong).`
fn alone(found: &Alone) -> Text {
    let Alone { name, others } = found;
    let name = Text::new().strong(name.as_str());
    if others.is_empty() {
        return name.plain(" was timed alone.");
    }
    let ended = |(other, outcome): (&String, &Outcome)| match outcome {
        Outcome::Ok => format!("{other} was not timed"),
        Outcome::Lossy => format!("{other} missed contacts"),
        Outcome::Wrong => format!("{other} was wrong"),
        outcome => format!("{other}: {}", outcome.name()),
    };
    let ended: Vec<String> = others.iter().map(ended).collect();
    let what = match others.values().any(|outcome| *outcome == Outcome::Wrong) {
        true => "right answer",
        false => "time",
    };
    name.plain(format!(" is the only one with a {what} ({}).", ended.join(", ")))
}

/// Names the detectors that are equally fast, for the case that no scene is decided.
fn undecided_all(contests: &[Contest]) -> String {
    let scenes = match contests.len() {
        1 => String::new(),
        2 => " in both scenes".into(),
        more => format!(" in all {more} scenes"),
    };
    let others = contests.iter().flat_map(|contest| &contest.others);
    let blocks = others.filter_map(|other| Some(other.ratio?.count)).max().unwrap_or(0);
    if blocks < 5 {
        let few = plural(blocks, "block");
        return format!("Undecided{scenes}: {few} of the five that a decision needs.");
    }
    let several = contests.iter().filter(|contest| !contest.others.is_empty());
    let open = several.map(|contest| -> BTreeSet<&str> {
        let others = contest.others.iter().filter(|other| !other.slower);
        others.chain([&contest.first]).map(|it| it.name.as_str()).collect()
    });
    let open = Vec::from_iter(open.collect::<BTreeSet<_>>());
    let (who, which) = match &open[..] {
        [names] if names.len() <= 4 => {
            let mut names: Vec<&str> = names.iter().copied().collect();
            let last = names.pop().unwrap_or_default();
            (format!("{} and {last}", names.join(", ")), ".")
        }
        _ => ("two or more detectors".into(), "; the last column names them."),
    };
    format!("Undecided{scenes}: {who} are equally fast within the noise{which}")
}

/// Returns the detector that is the fastest in most scenes, and the number of these scenes. Scenes
/// are not summed over experiments, which have different numbers of sizes.
pub fn brief(winners: &Winners) -> Text {
    let tally = Tally::new(winners);
    let Some(first) = tally.wins.first() else { return "undecided".into() };
    let wins = format!(" in {} of {}", first.margins.len(), plural(tally.scenes, "scene"));
    Text::new().strong(first.detector.as_str()).plain(wins)
}

pub struct Columns {
    pub pictures: bool,
    /// True if the table shows ratios of first detections.
    pub cold: bool,
    pub time: fn(f64) -> String,
}

pub fn table(contests: &[&Contest], columns: &Columns) -> Table {
    fn next(contest: &Contest) -> Option<&RankedSubject> {
        contest.others.first()
    }
    let &Columns { pictures, cold, time } = columns;
    let cold = cold && contests.iter().any(|it| next(it).is_some_and(|next| next.cold.is_some()));
    Table::of("", contests)
        .left("scene", |it| &*it.title)
        .left("fastest", |it| {
            let first = Cell::from(&*it.first.name);
            if it.decided() { first.strong() } else { first }
        })
        .unit("time / N", "ns", |it| time(it.first.per_particle))
        .unit("time / pair", "ns", |it| it.first.per_pair.map(time))
        .when(pictures, |table| table.left("", |_| ""))
        .left("runner-up", |it| next(it).map_or("alone", |next| &*next.name))
        .right("its time / fastest", |it| next(it).and_then(|next| next.ratio))
        .left("verdict", |it| decided(it))
        .when(cold, |table| table.right("both cold", |it| next(it).and_then(|next| next.cold)))
        .into()
}

/// Returns `decided`, or names the detectors that may be equally fast.
fn decided(contest: &Contest) -> Cell {
    let open = contest.others.iter().filter(|other| !other.slower);
    match contest.others.len() {
        0 => Cell::Absent,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::markdown;
    use contactbench_record::cells::testing::Lab;
    use contactbench_record::findings::winners::winners;

    fn said(lab: &Lab) -> String {
        markdown(&blocks(&lab.find(winners), true))
    }

    #[test]
    fn equally_fast_detectors_are_named() {
        let mut lab = Lab::new("e", "loose");
        lab.detector("nbs").time(&[100; 15]).detector("sorting").time(&[100; 15]);
        lab.detector("sweep").time(&[900; 15]);
        let text = said(&lab);
        let words = "Undecided: nbs and sorting are equally fast within the noise.";
        assert!(text.starts_with(words), "{text}");
        let mut lab = Lab::new("e", "loose");
        lab.detector("nbs").time(&[100; 3]).detector("sorting").time(&[100; 3]);
        assert!(said(&lab).starts_with("Undecided: 3 blocks of the five"));
    }

    #[test]
    fn nobody_wins_alone_or_without_times() {
        let mut lab = Lab::new("e", "packed");
        lab.detector("nbs").time(&[1000; 15]);
        assert_eq!(said(&lab), "**nbs** was timed alone.\n\n");
        assert!(blocks(&Winners::default(), true).is_empty());
        lab.detector("mine").time(&[10; 15]).edit(|row| row.outcome = Outcome::Wrong);
        let words = "**nbs** is the only one with a right answer (mine was wrong).";
        assert_eq!(said(&lab), format!("{words}\n\n"));
    }
}
