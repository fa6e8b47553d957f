use contactbench_record::findings::trust::coverage::{Coverage, Gaps};
use contactbench_terms::number::plural;

/// Largest number of missing cells that are listed.
const SHOWN: usize = 6;

/// Returns one sentence if the record has all of its plan, or a sentence for each incomplete
/// experiment.
pub fn whole_or_partial(found: &[(&str, &Coverage<'_>)]) -> (Option<String>, Vec<String>) {
    let parts: Vec<String> = found.iter().filter_map(|(name, it)| partial(name, it)).collect();
    let all: Vec<&Coverage> =
        found.iter().map(|(_, it)| *it).filter(|it| it.gaps().of > 0).collect();
    ((parts.is_empty() && !all.is_empty()).then(|| whole(&all)), parts)
}

/// Formats a sentence such as `The record has all of the plan: 9 scenes, 54 cells.`
fn whole(found: &[&Coverage<'_>]) -> String {
    let sum = |count: fn(&Coverage) -> usize| -> usize { found.iter().map(|it| count(it)).sum() };
    let cells = plural(sum(|it| it.gaps().of), "cell");
    let mut said = format!("{}, {cells}", plural(sum(|it| it.scenes), "scene"));
    for (count, words) in [
        (sum(|it| it.twins), "of twins (equal code) show the noise"),
        (sum(|it| it.gaps().short), "got fewer blocks than planned (time budget)"),
    ] {
        if count > 0 {
            said += &format!("; {} {words}", plural(count, "cell"));
        }
    }
    format!("The record has all of the plan: {said}.")
}

/// Describes an experiment that is incomplete, or has scenes outside the plan; `None` for others.
pub fn partial(experiment: &str, found: &Coverage<'_>) -> Option<String> {
    let (gaps, outside) = (found.gaps(), found.outside);
    if gaps.of == 0 || gaps.is_none() && outside == 0 {
        return None;
    }
    let mut said = self::gaps(&gaps);
    if outside > 0 {
        said += &format!("; {} outside of the plan", plural(outside, "scene"));
    }
    Some(format!("{experiment}: {said}. A claim holds only if it is true of the whole plan."))
}

/// Formats text such as `5 of 9 planned cells; missing: s = 2; s = 5`.
pub fn gaps(gaps: &Gaps) -> String {
    let missing = &gaps.missing;
    let mut said = format!("{} of {} planned cells", gaps.of - missing.len(), gaps.of);
    if !missing.is_empty() {
        said += &format!("; missing: {}", missing[..missing.len().min(SHOWN)].join("; "));
    }
    if missing.len() > SHOWN {
        said += &format!("; and {} more", missing.len() - SHOWN);
    }
    if gaps.cut > 0 {
        said += &format!("; {} short of blocks", plural(gaps.cut, "cell"));
    }
    said
}
