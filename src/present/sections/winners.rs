//! Who is the fastest: a sentence, and a line per scene.

use crate::findings::winners::{Contest, Tally};
use crate::number::plural;
use crate::present::document::{Block, Text};
use crate::present::table::{Cell, Column, Table};

/// The sentence and, where anybody was compared, the table.
pub fn blocks(contests: &[Contest]) -> Vec<Block> {
    let compared = contests.iter().any(|contest| !contest.others.is_empty());
    let table = compared.then(|| Block::Table(table(contests)));
    let sentence = (!contests.is_empty()).then(|| Block::Paragraph(sentence(contests)));
    sentence.into_iter().chain(table).collect()
}

/// How often each detector is the fastest.
pub fn sentence(contests: &[Contest]) -> Text {
    let tally = Tally::new(contests);
    let Some((first, rest)) = tally.wins.split_first() else {
        return match &tally.alone {
            _ if tally.scenes == 0 => {
                "No times were taken: only answers, counts and memory.".into()
            }
            Some(name) => Text::new().strong(name.as_str()).plain(" was timed alone."),
            None => {
                let scenes = match tally.scenes {
                    1 => String::new(),
                    more => format!(" in all of {}", plural(more, "scene")),
                };
                let why = "nobody is faster than all others by more than the noise";
                format!("Undecided{scenes}: {why}.").into()
            }
        };
    };
    let wins = format!("{} of {}", first.margins.len(), plural(tally.scenes, "scene"));
    let mut out = Text::new().strong(first.detector.as_str()).plain(" is the fastest in ");
    out = out.strong(wins);
    if let Some((typical, least, most)) = first.margin() {
        out = out.plain("; the next takes ").strong(format!("{typical:.1} times"));
        out = out.plain(" as long");
        if first.margins.len() > 1 {
            out = out.plain(format!(" (median of scenes; {least:.1} to {most:.1})"));
        }
    }
    let mut end = ".".to_string();
    if !rest.is_empty() {
        let rest: Vec<String> = rest
            .iter()
            .map(|wins| format!("{} in {}", wins.detector, wins.margins.len()))
            .collect();
        end += &format!(" Then {}.", rest.join(", "));
    }
    if tally.undecided > 0 {
        end += &format!(" Undecided: {}.", tally.undecided);
    }
    out.plain(end)
}

/// Of several experiments together: who is the fastest in each. Their scenes are not added up: some
/// are one size of one pack, others six scenes at their largest.
pub fn by_experiment(experiments: &[(&str, &[Contest])]) -> Text {
    let mut out = Text::new();
    for (k, (name, contests)) in experiments.iter().enumerate() {
        let tally = Tally::new(contests);
        out = out.plain(if k == 0 { "" } else { "; " }).plain(format!("{name}: "));
        out = match tally.wins.first() {
            Some(first) => out.strong(first.detector.as_str()).plain(format!(
                " in {} of {}",
                first.margins.len(),
                plural(tally.scenes, "scene")
            )),
            None => out.plain("undecided"),
        };
    }
    out.plain(".")
}

/// A line per scene.
pub fn table(contests: &[Contest]) -> Table {
    let columns = vec![
        Column::left("scene"),
        Column::left("fastest"),
        Column::right("time / N", "ns"),
        Column::left("next"),
        Column::right("next / fastest", ""),
        Column::left("decided"),
    ];
    let row = |contest: &Contest| {
        let next = contest.others.first();
        let first = Cell::from(contest.first.name.as_str());
        vec![
            contest.title.as_str().into(),
            if contest.decided() { first.strong() } else { first },
            Cell::number(contest.first.per_particle),
            next.map_or("alone".into(), |next| next.name.as_str().into()),
            next.and_then(|next| next.ratio).into(),
            decided(contest),
        ]
    };
    Table::new("", columns).with(contests.iter().map(row))
}

/// `yes`, or who may be as fast.
fn decided(contest: &Contest) -> Cell {
    let open = contest.others.iter().filter(|other| !other.slower);
    match contest.others.len() {
        0 => Cell::absent(),
        _ if contest.decided() => "yes".into(),
        _ => undecided(open.map(|other| &other.name)),
    }
}

/// `undecided: nbs, sweep and 3 more`: those who leave it open, the fastest first.
pub fn undecided<'a>(open: impl IntoIterator<Item = &'a String>) -> Cell {
    let open: Vec<&str> = open.into_iter().map(String::as_str).collect();
    let (named, more) = open.split_at(open.len().min(2));
    let more = if more.is_empty() { String::new() } else { format!(" and {} more", more.len()) };
    format!("undecided: {}{more}", named.join(", ")).into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells;
    use crate::cells::testing::Lab;
    use crate::findings::winners::contests;
    use crate::present::document::markdown;

    fn said(lab: &Lab) -> String {
        let cells = cells::cells(&lab.rows());
        markdown(&blocks(&contests(&cells.iter().collect::<Vec<_>>())))
    }

    #[test]
    fn the_fastest_is_named_with_its_margin() {
        let mut lab = Lab::new("e", "packed");
        lab.detector("nbs").time(&[1000; 15]).detector("sorting").time(&[2500; 15]);
        lab.scene("loose", 2).detector("nbs").time(&[100; 15]).detector("sorting").time(&[100; 15]);
        let text = said(&lab);
        assert!(
            text.starts_with(
                "**nbs** is the fastest in **1 of 2 scenes**; the next takes **2.5 times** as \
                 long. Undecided: 1.\n"
            ),
            "{text}"
        );
        assert!(
            text.contains(
                "| packed, 2D, N = 100 | **nbs** | 10 | sorting | 2.50 (2.50 to 2.50) | yes |"
            ),
            "{text}"
        );
        let undecided =
            "| loose, 2D, N = 100 | nbs | 1 | sorting | 1.00 (1.00 to 1.00) | undecided: sorting |";
        assert!(text.contains(undecided), "{text}");
    }

    #[test]
    fn scenes_of_several_experiments_are_not_added_up() {
        let mut lab = Lab::new("e", "packed");
        lab.detector("nbs").time(&[1000; 15]).detector("sorting").time(&[2500; 15]);
        lab.scene("loose", 2).detector("nbs").time(&[100; 15]).detector("sorting").time(&[100; 15]);
        let cells = cells::cells(&lab.rows());
        let all = contests(&cells.iter().collect::<Vec<_>>());
        let both = [("one", &all[..]), ("two", &all[..1])];
        let said = markdown(&[Block::Paragraph(by_experiment(&both))]);
        assert_eq!(said, "one: **nbs** in 1 of 2 scenes; two: undecided.\n\n");
    }

    #[test]
    fn nobody_wins_alone_or_without_times() {
        let mut lab = Lab::new("e", "packed");
        lab.detector("nbs").time(&[1000; 15]);
        assert_eq!(said(&lab), "**nbs** was timed alone.\n\n");
        assert!(blocks(&[]).is_empty());
    }
}
