//! Maps in words: a table per panel, what is said of a place, and `maps.csv`.

use crate::experiment::{Experiment, Figure, FigureKind};
use crate::findings::map::{Answer, Map, Panel, Spot};
use crate::number::{number, times, with_interval};
use crate::present::document::Block;
use crate::present::table::{Cell, Column, Table};

/// A table for each panel: the values across in its head, those upwards from the top down.
pub fn blocks(map: &Map) -> Vec<Block> {
    map.panels.iter().map(|panel| Block::Table(table(map, panel))).collect()
}

/// The maps of a report, with what their tables say.
pub fn section(maps: &[Drawn]) -> Vec<Block> {
    let mut out = Vec::new();
    for Drawn { title, map, .. } in maps {
        out.extend([Block::heading(3, title.as_str()), Block::paragraph(READING)]);
        out.extend(blocks(map));
    }
    out
}

/// How the tables are read.
const READING: &str = "Who is the fastest in each place, and the time of the next over its own; \
                       bold where that is decided. Intervals, and all who may be as fast, are in \
                       maps.csv.";

/// A map that an experiment asks for.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// The name of the figure.
    pub name: String,
    /// Its heading.
    pub title: String,
    /// What its axes are called.
    pub labels: [String; 2],
    /// The map.
    pub map: Map,
}

impl Drawn {
    /// Those of an experiment that can be drawn, from all cells of a record.
    pub fn all(experiment: &Experiment, cells: &[crate::cells::Cell]) -> Vec<Drawn> {
        let own: Vec<_> =
            cells.iter().filter(|cell| cell.id.experiment == experiment.name).cloned().collect();
        let drawn = |figure: &Figure| match &figure.kind {
            // Why one cannot be drawn is said where its figure is drawn.
            FigureKind::Map(axes) => Some(Drawn {
                name: figure.name.clone(),
                title: figure.title.clone(),
                labels: axes.labels().map(String::from),
                map: Map::new(axes, &figure.filter, &own).ok()?,
            }),
            _ => None,
        };
        experiment.figures.iter().filter_map(drawn).collect()
    }
}

fn table(map: &Map, panel: &Panel) -> Table {
    let [x, y] = &map.axes;
    let across = panel.values(0);
    let heads = across.iter().map(|&k| Column::left(format!("{} = {}", x.name, x.values[k])));
    let columns = std::iter::once(Column::left(y.name.clone())).chain(heads).collect();
    let row = |k: usize| {
        let cells = across.iter().map(|&j| panel.at([j, k]).map_or_else(Cell::absent, brief));
        std::iter::once(Cell::from(y.values[k].as_str())).chain(cells).collect()
    };
    Table::new(panel.title.clone(), columns).with(panel.values(1).into_iter().rev().map(row))
}

/// `nbs 1.52`; several names where it is undecided.
fn brief(spot: &Spot) -> Cell {
    let factor = spot.factor().map_or(String::new(), |factor| times(factor.median));
    let front = spot.front();
    match spot.answer() {
        Answer::Decided(_) => Cell::from(format!("{} {factor}", front[0])).strong(),
        Answer::Undecided => format!("undecided: {}", either(&front)).into(),
        Answer::Alone => format!("{} alone", front[0]).into(),
        Answer::Nobody => spot.outcome.name().into(),
    }
}

/// `nbs or sorting or 2 more`.
pub fn either(front: &[&str]) -> String {
    let (named, more) = front.split_at(front.len().min(2));
    let more = (!more.is_empty()).then(|| format!("{} more", more.len()));
    named.iter().map(|name| name.to_string()).chain(more).collect::<Vec<_>>().join(" or ")
}

/// All that is said of a place, in a sentence.
pub fn sentence(map: &Map, panel: &Panel, spot: &Spot) -> String {
    let [x, y] = &map.axes;
    let (across, up) = (&x.values[spot.at[0]], &y.values[spot.at[1]]);
    let place = format!("{}, {} = {across}, {} = {up}", panel.title, x.name, y.name);
    let Some(contest) = &spot.contest else {
        return format!("{place}: nobody has a time ({})", spot.outcome.name());
    };
    let first = &contest.first;
    let per = number(first.per_particle);
    let said = match spot.answer() {
        Answer::Undecided => "undecided; the shortest median has",
        Answer::Alone => "timed alone:",
        _ => "the fastest is",
    };
    let others = contest.others.iter().map(|other| {
        let ratio = other.ratio.map_or("not compared".into(), |ratio| with_interval(&ratio));
        let open = if other.slower { "" } else { " undecided" };
        format!("{} {ratio}{open}", other.line.detector)
    });
    let others: Vec<String> = others.collect();
    let rest = if others.is_empty() { String::new() } else { format!("; {}", others.join("; ")) };
    format!("{place}: {said} {}, {per} ns per particle{rest}", first.line.detector)
}

/// `maps.csv`: a line per place.
pub fn rows(name: &str, map: &Map) -> Table {
    let words = |names: &[&str]| names.iter().map(|name| Column::left(*name)).collect::<Vec<_>>();
    let mut columns = words(&["map", "experiment", "panel", "x", "x_value", "y", "y_value", "n"]);
    columns.extend(words(&["decided", "fastest", "arithmetic", "threads", "ns_per_particle"]));
    columns.extend(words(&["next"]));
    columns.push(Column::ratio("ratio"));
    columns.extend(words(&["blocks", "undecided_with", "outcome"]));
    let mut table = Table::new("", columns);
    for (panel, spot) in map.panels.iter().flat_map(|it| it.spots.iter().map(move |at| (it, at))) {
        let [x, y] = &map.axes;
        let contest = spot.contest.as_ref();
        let first = contest.map(|contest| &contest.first);
        let next = contest.and_then(|contest| contest.others.first());
        let open = contest.iter().flat_map(|contest| &contest.others).filter(|it| !it.slower);
        let open: Vec<&str> = open.map(|it| it.line.detector.as_str()).collect();
        let decided = match spot.answer() {
            Answer::Decided(_) => "yes".into(),
            Answer::Undecided => "no".into(),
            Answer::Alone => "alone".into(),
            Answer::Nobody => Cell::absent(),
        };
        let text = |text: Option<&str>| text.map_or_else(Cell::absent, Cell::from);
        let factor = spot.factor();
        table.rows.push(vec![
            name.into(),
            panel.experiment.as_str().into(),
            panel.title.as_str().into(),
            x.name.as_str().into(),
            x.values[spot.at[0]].as_str().into(),
            y.name.as_str().into(),
            y.values[spot.at[1]].as_str().into(),
            Cell::count(spot.n),
            decided,
            text(first.map(|first| &*first.line.detector)),
            text(first.map(|first| &*first.line.arithmetic)),
            first.map_or_else(Cell::absent, |first| Cell::count(first.line.threads.into())),
            first.map(|first| first.per_particle).into(),
            text(next.map(|next| &*next.line.detector)),
            factor.into(),
            factor.map_or_else(Cell::absent, |factor| Cell::count(factor.count as u64)),
            open.join("; ").into(),
            match spot.answer() {
                Answer::Nobody => spot.outcome.name().into(),
                _ => Cell::from("ok"),
            },
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::findings::map::tests::made_up;
    use crate::present::document::markdown;
    use crate::present::table::csv;

    #[test]
    fn a_map_is_a_table_and_a_line_per_place() {
        let map = made_up();
        let text = markdown(&blocks(&map));
        for line in [
            "**packed, 2D**",
            "| fraction | n = 100 | n = 1000 |",
            "| 0.6 | undecided: nbs or sorting | timeout |",
            "| 0.1 | **nbs 2.00** | **sorting 1.25** |",
        ] {
            assert!(text.contains(line), "{line} is not in {text}");
        }
        let text = csv(&[rows("winners", &map)]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 5, "{text}");
        assert_eq!(
            lines[0],
            "map,experiment,panel,x,x_value,y,y_value,n,decided,fastest,arithmetic,threads,\
             ns_per_particle,next,ratio,ratio_low,ratio_high,blocks,undecided_with,outcome"
        );
        assert!(
            lines[2].contains("fraction,0.1,1000,yes,sorting,exact,1,4,nbs,1.25")
                && lines[2].ends_with(",15,,ok"),
            "{}",
            lines[2]
        );
        assert!(lines[3].contains(",no,nbs,exact,1,10,sorting,1.0"), "{}", lines[3]);
        assert!(lines[3].ends_with(",15,sorting,ok"), "{}", lines[3]);
        assert!(lines[4].ends_with("fraction,0.6,1000,,,,,,,,,,,,timeout"), "{}", lines[4]);
    }

    #[test]
    fn a_place_is_told_in_a_sentence() {
        let map = made_up();
        let panel = &map.panels[0];
        let said: Vec<String> =
            panel.spots.iter().map(|spot| sentence(&map, panel, spot)).collect();
        assert_eq!(
            said[0],
            "packed, 2D, n = 100, fraction = 0.1: the fastest is nbs, 10 ns per particle; sorting \
             2.00 (2.00 to 2.00)"
        );
        assert!(said[2].ends_with("sorting 1.01 (1.01 to 1.01) undecided"), "{}", said[2]);
        assert!(said[3].ends_with("nobody has a time (timeout)"), "{}", said[3]);
        assert_eq!(either(&["a", "b", "c", "d"]), "a or b or 2 more");
    }
}
