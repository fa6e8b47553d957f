use std::collections::BTreeMap;

use contactbench_record::findings::trust::coverage::{Gap, Short, Summary, Uncovered, Why};
use contactbench_record::record::value::AxisValue;
use contactbench_terms::number::plural;

/// Returns one sentence if the record has all of its plan, or a sentence for each incomplete
/// experiment.
pub fn whole_or_partial<'a>(
    found: impl Iterator<Item = &'a Summary>,
) -> (Option<String>, Vec<String>) {
    let found: Vec<&Summary> = found.filter(|found| found.cells[1] > 0).collect();
    let parts: Vec<String> = found.iter().filter_map(|found| partial(found)).collect();
    ((parts.is_empty() && !found.is_empty()).then(|| whole(&found)), parts)
}

/// Formats a sentence such as `The record has all of the plan: 9 scenes, 54 cells.`
fn whole(found: &[&Summary]) -> String {
    let sum = |count: fn(&Summary) -> usize| -> usize { found.iter().map(|it| count(it)).sum() };
    let (scenes, cells) = (sum(|found| found.scenes[1]), sum(|found| found.cells[1]));
    let mut said = vec![format!("{}, {}", plural(scenes, "scene"), plural(cells, "cell"))];
    let twins = sum(|found| found.twins);
    if twins > 0 {
        said.push(format!("{} of twins (equal code) show the noise", plural(twins, "cell")));
    }
    said.extend(found.iter().filter_map(|found| match short(found)? {
        short if cells > found.cells[1] => Some(format!("{}: {short}", found.experiment)),
        short => Some(short),
    }));
    format!("The record has all of the plan: {}.", said.join("; "))
}

/// Describes an experiment that is incomplete, or has scenes outside the plan; `None` for others.
pub fn partial(found: &Summary) -> Option<String> {
    let Summary { experiment, scenes, cells, missing, outside, .. } = found;
    let cut = found.short.keys().any(|why| *why != Why::Budget);
    if missing.is_empty() && *outside == 0 && !cut {
        return None;
    }
    let quick = missing.contains_key(&Why::Quick)
        && missing.keys().all(|why| matches!(why, Why::Quick | Why::Unavailable));
    let (planned, own) = (plural(scenes[1], "scene"), plural(*outside, "scene"));
    let mut said = Vec::new();
    if quick && *outside > 0 {
        let there = scenes[0];
        said.push(format!("a quick run of {own}; it has {there} of the {planned} of the plan"));
    } else {
        let all = plural(cells[1], "cell");
        let (there, measured) = (scenes[0], cells[0]);
        said.push(format!(
            "the record has {there} of {planned} and {measured} of {all} of the plan"
        ));
        said.extend((!missing.is_empty()).then(|| format!("missing: {}", reasons(missing))));
        said.extend(short(found));
        said.extend((*outside > 0).then(|| format!("{own} outside of the plan")));
    }
    let mut unavailable: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for (name, reason) in &found.unavailable {
        unavailable.entry(reason).or_default().push(name);
    }
    let part = |(reason, names): (&&str, &Vec<&str>)| format!("{}: {reason}", names.join(", "));
    let parts: Vec<String> = unavailable.iter().map(part).collect();
    said.extend((!parts.is_empty()).then(|| format!("not started: {}", parts.join("; "))));
    let whole = "A claim holds only if it is true of the whole plan.";
    Some(format!("{experiment}: {}. {whole}", said.join("; ")))
}

/// Formats text such as `12 cells got 3 of their 15 blocks (quick run)`.
fn short(found: &Summary) -> Option<String> {
    let part = |(why, short): (&Why, &Short)| {
        let [low, high] = short.blocks;
        let range = if low < high { format!("{low} to {high}") } else { low.to_string() };
        let (blocks, cells) = (found.blocks, plural(short.cells, "cell"));
        let why = match why {
            Why::Budget => " (time budget)".into(),
            why => format!(" ({})", why.name()),
        };
        let their = if short.cells == 1 { "its" } else { "their" };
        format!("{cells} got {range} of {their} {blocks} blocks{why}")
    };
    let parts: Vec<String> = found.short.iter().map(part).collect();
    (!parts.is_empty()).then(|| parts.join(", "))
}

/// Formats reasons such as `20 cells (run in part), 4 (unavailable)`.
fn reasons(why: &BTreeMap<Why, usize>) -> String {
    let part = |(k, (why, count)): (usize, (&Why, &usize))| {
        let count = if k == 0 { plural(*count, "cell") } else { count.to_string() };
        format!("{count} ({})", why.name())
    };
    why.iter().enumerate().map(part).collect::<Vec<_>>().join(", ")
}

/// Formats text such as `not in this record: s = 2 to 20 of 2 to 200; 4 of 9 cells (run in part)`.
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

/// Formats a gap such as `s = 2 to 20 of 2 to 200`.
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
