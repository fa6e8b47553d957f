use super::{About, Section};
use crate::document::Block;
use crate::table::{Cell, Rows, Table};
use contactbench_record::experiment::{Experiment, Figure, FigureKind};
use contactbench_record::findings::map::{Answer, Map, Panel, Spot};
use contactbench_record::findings::winners::RankedSubject;
use contactbench_terms::number::{number, times, with_interval};

/// Makes a table for each panel, with x in the head and y in the first column.
pub fn blocks(map: &Map) -> Vec<Block> {
    map.panels.iter().map(|panel| Block::Table(table(map, panel))).collect()
}

pub fn sections(about: &About<'_>) -> Vec<Section> {
    let section = |drawn: &Drawn| {
        let Drawn { name, title, map, .. } = drawn;
        let blocks = [vec![Block::paragraph(READING)], blocks(map)].concat();
        Section { heading: title.clone(), blocks, csv: Some(("maps.csv", rows(name, map))) }
    };
    about.maps.iter().map(section).collect()
}

const READING: &str = "Each place names the fastest detector and the time of the runner-up over \
                       its own; bold means decided. Intervals, and all detectors that may be as \
                       fast, are in maps.csv.";

#[derive(Clone, Debug)]
pub struct Drawn {
    pub name: String,
    pub title: String,
    pub labels: [String; 2],
    pub map: Map,
}

impl Drawn {
    pub fn all(experiment: &Experiment, own: &[contactbench_record::cells::Cell]) -> Vec<Drawn> {
        let drawn = |figure: &Figure| match &figure.kind {
            // A map that fails is left out here; the figure reports the reason.
            FigureKind::Map(axes) => Some(Drawn {
                name: figure.name.clone(),
                title: figure.title.clone(),
                labels: axes.labels().map(String::from),
                map: Map::new(axes, &figure.filter, own).ok()?,
            }),
            _ => None,
        };
        experiment.figures.iter().filter_map(drawn).collect()
    }
}

fn table(map: &Map, panel: &Panel) -> Table {
    let [x, y] = &map.axes;
    let rows: Vec<usize> = panel.values(1).into_iter().rev().collect();
    let table = Table::of(panel.title.clone(), rows).left(&*y.name, |k| &*y.values[k]);
    let column = |table: Rows<usize>, j: usize| {
        table.left(format!("{} = {}", x.name, x.values[j]), |k| panel.at([j, k]).map(brief))
    };
    table.each(panel.values(0), column).into()
}

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

/// Formats names such as `nbs or sorting or 2 more`.
pub fn either(front: &[&str]) -> String {
    let (named, more) = front.split_at(front.len().min(2));
    let more = (!more.is_empty()).then(|| format!("{} more", more.len()));
    named.iter().map(|name| name.to_string()).chain(more).collect::<Vec<_>>().join(" or ")
}

pub fn sentence(map: &Map, panel: &Panel, spot: &Spot) -> String {
    let [x, y] = &map.axes;
    let (across, up) = (&x.values[spot.at[0]], &y.values[spot.at[1]]);
    let place = format!("{}, {} = {across}, {} = {up}", panel.title, x.name, y.name);
    let Some(contest) = &spot.contest else {
        return format!("{place}: no detector has a time ({})", spot.outcome.name());
    };
    let first = &contest.first;
    let per = number(first.per_particle);
    let said = match spot.answer() {
        Answer::Undecided => "undecided; the shortest median is that of",
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

pub fn rows(name: &str, map: &Map) -> Table {
    fn first(spot: &Spot) -> Option<&RankedSubject> {
        spot.contest.as_ref().map(|contest| &contest.first)
    }
    fn next(spot: &Spot) -> Option<&RankedSubject> {
        spot.contest.as_ref()?.others.first()
    }
    let [x, y] = &map.axes;
    let spots = map.panels.iter().flat_map(|it| it.spots.iter().map(move |spot| (it, spot)));
    let decided = |spot: &Spot| match spot.answer() {
        Answer::Decided(_) => Some("yes"),
        Answer::Undecided => Some("no"),
        Answer::Alone => Some("alone"),
        Answer::Nobody => None,
    };
    let open = |spot: &Spot| {
        let others = spot.contest.iter().flat_map(|contest| &contest.others);
        let open = others.filter(|it| !it.slower).map(|it| it.line.detector.as_str());
        open.collect::<Vec<_>>().join("; ")
    };
    let outcome = |spot: &Spot| match spot.answer() {
        Answer::Nobody => spot.outcome.name(),
        _ => "ok",
    };
    Table::of("", spots)
        .left("map", |_| name)
        .left("experiment", |(panel, _)| &*panel.experiment)
        .left("panel", |(panel, _)| &*panel.title)
        .left("x", |_| &*x.name)
        .left("x_value", |(_, spot)| &*x.values[spot.at[0]])
        .left("y", |_| &*y.name)
        .left("y_value", |(_, spot)| &*y.values[spot.at[1]])
        .left("n", |(_, spot)| spot.n)
        .left("decided", |(_, spot)| decided(spot))
        .left("fastest", |(_, spot)| first(spot).map(|first| &*first.line.detector))
        .left("arithmetic", |(_, spot)| first(spot).map(|first| &*first.line.arithmetic))
        .left("threads", |(_, spot)| first(spot).map(|first| u64::from(first.line.threads)))
        .left("ns_per_particle", |(_, spot)| first(spot).map(|first| first.per_particle))
        .left("next", |(_, spot)| next(spot).map(|next| &*next.line.detector))
        .ratio("ratio", |(_, spot)| spot.factor())
        .left("blocks", |(_, spot)| spot.factor().map(|factor| factor.count as u64))
        .left("undecided_with", |(_, spot)| open(spot))
        .left("outcome", |(_, spot)| outcome(spot))
        .into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::markdown;
    use crate::table::csv;
    use contactbench_record::findings::map::testing::made_up;

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
}
