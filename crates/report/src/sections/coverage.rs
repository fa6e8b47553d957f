//! How much of the plan is there.

use std::collections::BTreeMap;

use crate::document::Block;
use contactbench_record::findings::coverage::{Gap, Short, Summary, Uncovered, Why};
use contactbench_record::record::value::AxisValue;
use contactbench_terms::number::plural;

/// For the head of a report: a warning for each experiment that is not whole, or one sentence that
/// all are.
pub fn blocks<'a>(found: impl Iterator<Item = &'a Summary>) -> Vec<Block> {
    // An experiment without a plan asks for nothing.
    let found: Vec<&Summary> = found.filter(|found| found.cells[1] > 0).collect();
    let parts: Vec<String> = found.iter().filter_map(|found| partial(found)).collect();
    match parts.is_empty() && !found.is_empty() {
        true => vec![Block::paragraph(whole(&found))],
        false => parts.into_iter().map(|words| Block::Warning(words.into())).collect(),
    }
}

/// `All of the plan is there: 9 scenes, 54 cells.`
fn whole(found: &[&Summary]) -> String {
    let sum = |count: fn(&Summary) -> usize| -> usize { found.iter().map(|it| count(it)).sum() };
    let (scenes, cells) = (sum(|found| found.scenes[1]), sum(|found| found.cells[1]));
    let twins = match sum(|found| found.twins) {
        0 => String::new(),
        twins => format!("; beside them {} of twins, for the noise", plural(twins, "cell")),
    };
    let named = |found: &&Summary| {
        let name = &found.experiment;
        short(found).map(|it| if cells > found.cells[1] { format!("{name}: {it}") } else { it })
    };
    let short: Vec<String> = found.iter().filter_map(named).collect();
    let short = if short.is_empty() { String::new() } else { format!("; {}", short.join("; ")) };
    format!(
        "All of the plan is there: {}, {}{twins}{short}.",
        plural(scenes, "scene"),
        plural(cells, "cell")
    )
}

/// What is said of an experiment of which something is missing, or that has scenes of its own.
pub fn partial(found: &Summary) -> Option<String> {
    let cut = found.short.keys().any(|why| *why != Why::Budget);
    if found.missing.is_empty() && found.outside == 0 && !cut {
        return None;
    }
    let Summary { experiment, scenes, cells, .. } = found;
    let quick = found.missing.contains_key(&Why::Quick)
        && found.missing.keys().all(|why| matches!(why, Why::Quick | Why::Unavailable));
    if quick && found.outside > 0 {
        return Some(format!(
            "{experiment}: a quick run, with {} of its own and {} of the {} that are planned{}. \
             {WHOLE}",
            plural(found.outside, "scene"),
            scenes[0],
            plural(scenes[1], "scene"),
            unavailable(found)
        ));
    }
    let mut words = format!(
        "{experiment}: {} of {} and {} of {} of the plan are there",
        scenes[0],
        plural(scenes[1], "scene"),
        cells[0],
        plural(cells[1], "cell")
    );
    if !found.missing.is_empty() {
        words += &format!("; missing: {}", reasons(&found.missing));
    }
    words.extend(short(found).map(|short| format!("; {short}")));
    if found.outside > 0 {
        words += &format!("; {} outside of the plan", plural(found.outside, "scene"));
    }
    Some(format!("{words}{}. {WHOLE}", unavailable(found)))
}

/// Stands behind every sentence about a part of a plan.
const WHOLE: &str = "A claim holds only if it is true of the whole plan.";

/// The contenders that could not be started, and why.
fn unavailable(found: &Summary) -> String {
    let mut reasons: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for (name, reason) in &found.unavailable {
        reasons.entry(reason).or_default().push(name);
    }
    let part = |(reason, names): (&str, Vec<&str>)| format!("{}: {reason}", names.join(", "));
    let parts: Vec<String> = reasons.into_iter().map(part).collect();
    match parts.len() {
        0 => String::new(),
        _ => format!("; not started: {}", parts.join("; ")),
    }
}

/// `12 cells got 3 of their 15 blocks (quick run)`.
fn short(found: &Summary) -> Option<String> {
    let part = |(why, short): (&Why, &Short)| {
        let [low, high] = short.blocks;
        let range = if low < high { format!("{low} to {high}") } else { low.to_string() };
        let (blocks, cells) = (found.blocks, plural(short.cells, "cell"));
        let why = match why {
            Why::Budget => ", because the time budget was used up".into(),
            why => format!(" ({})", why.name()),
        };
        let their = if short.cells == 1 { "its" } else { "their" };
        format!("{cells} got {range} of {their} {blocks} blocks{why}")
    };
    let parts: Vec<String> = found.short.iter().map(part).collect();
    (!parts.is_empty()).then(|| parts.join(", "))
}

/// `20 cells (stopped), 4 (unavailable)`.
fn reasons(why: &BTreeMap<Why, usize>) -> String {
    let part = |(k, (why, count)): (usize, (&Why, &usize))| {
        let count = if k == 0 { plural(*count, "cell") } else { count.to_string() };
        format!("{count} ({})", why.name())
    };
    why.iter().enumerate().map(part).collect::<Vec<_>>().join(", ")
}

/// `not in this record: s = 2 to 20 of 2 to 200; 4 of 9 cells (stopped)`.
pub fn uncovered(found: &Uncovered) -> String {
    let gaps: Vec<String> = found.gaps.iter().map(gap).collect();
    let names = found.unavailable.iter().cloned().collect::<Vec<_>>().join(", ");
    let why = found.why.keys().map(|why| match why {
        Why::Unavailable => format!("{names} could not be started"),
        why => why.name().into(),
    });
    let why: Vec<String> = why.collect();
    let count = match found.cells == found.of {
        true => format!("all {}", plural(found.of, "cell")),
        false => format!("{} of {}", found.cells, plural(found.of, "cell")),
    };
    let gaps = if gaps.is_empty() { String::new() } else { gaps.join(", ") + "; " };
    format!("not in this record: {gaps}{count} ({})", why.join(", "))
}

/// `s = 2 to 20 of 2 to 200`.
fn gap(gap: &Gap) -> String {
    let Gap { name, missing, planned } = gap;
    let number = planned.iter().all(|value| value.number().is_some());
    let first = planned.iter().position(|value| missing.first() == Some(value)).unwrap_or(0);
    let row = planned[first..].starts_with(missing);
    let range = |values: &[AxisValue]| match values {
        [low, .., high] if values.len() > 2 => format!("{low} to {high}"),
        _ => values.iter().map(AxisValue::to_string).collect::<Vec<_>>().join(", "),
    };
    match number {
        true if row || missing.len() <= 3 => {
            let values: Vec<String> = missing.iter().map(AxisValue::to_string).collect();
            let missing = if row { range(missing) } else { values.join(", ") };
            format!("{name} = {missing} of {}", range(planned))
        }
        false if missing.len() <= 3 => range(missing),
        _ => format!("{} of {} values of {name}", missing.len(), planned.len()),
    }
}
