//! Who won where, by how much, and how sure that is: from the ratios of times within blocks.
//!
//! Every scene speaks at its largest N. Every detector runs there with its fewest threads, and decides exactly if it can, else as it does best: so the
//! detectors are compared, not their settings. Settings are in the charts and in the tables.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::marks;
use super::markup::escape;
use crate::analyse::interval::{Interval, median, ratio};
use crate::analyse::summary::{self, is_control, with_interval};
use crate::analyse::value::Cell;
use crate::analyse::{place, text};
use crate::contact::Arithmetic;
use crate::figure::style::Styles;

/// The ratio at the right edge of the picture; larger ones stand there, too.
const EDGE: f64 = 16.0;
/// Width and height of the picture of a scene, in its units.
const SIZE: (f64, f64) = (240.0, 22.0);

/// A scene at its largest N.
pub struct Scene<'a> {
    /// `packed, 3D, N = 1000`.
    pub title: String,
    /// The fastest.
    pub first: &'a Cell,
    /// The others, the next first, with their time over that of the fastest.
    pub others: Vec<(&'a Cell, Option<Interval>)>,
    /// Is the fastest faster than the next, by more than the noise?
    pub decided: bool,
}

/// The least coverage of an interval by which somebody is called the fastest: that of five blocks, the fewest that a full run takes, is 0.94.
const SURE: f64 = 0.9;

/// The scenes in which someone was timed.
pub fn scenes<'a>(cells: &[&'a Cell]) -> Vec<Scene<'a>> {
    let mut groups: BTreeMap<_, Vec<&'a Cell>> = BTreeMap::new();
    for &cell in cells.iter().filter(|cell| !is_control(&cell.key.detector) && cell.time().is_some()) {
        groups.entry(place::family(&cell.key)).or_default().push(cell);
    }
    let floor = summary::floor(cells);
    groups.values().filter_map(|group| scene(group, floor)).collect()
}

fn scene<'a>(group: &[&'a Cell], floor: f64) -> Option<Scene<'a>> {
    let swept = place::swept(group);
    let (key, cells) = summary::last_scene(group)?;
    let time = |cell: &Cell| cell.time().map_or(f64::INFINITY, |time| time.median);
    let setting = |cell: &Cell| (cell.key.threads, cell.key.arithmetic != Arithmetic::Exact.name());
    let mut best: BTreeMap<&str, &Cell> = BTreeMap::new();
    for cell in cells {
        let known = best.entry(&cell.key.detector).or_insert(cell);
        if setting(cell).cmp(&setting(known)).then(time(cell).total_cmp(&time(known))).is_lt() {
            *known = cell;
        }
    }
    let mut order: Vec<&Cell> = best.into_values().collect();
    order.sort_by(|a, b| time(a).total_cmp(&time(b)));
    let (first, others) = order.split_first()?;
    let others: Vec<_> = others.iter().map(|cell| (*cell, ratio(&cell.times, &first.times))).collect();
    let next = others.first().and_then(|(_, ratio)| *ratio);
    let decided = next.is_some_and(|next| next.coverage >= SURE && next.excludes(1.0) && next.median > floor);
    Some(Scene { title: summary::title(&key, &swept), first, others, decided })
}

/// How often everybody is the fastest, in a sentence; HTML.
pub fn sentence(scenes: &[Scene]) -> String {
    let mut wins: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for scene in scenes.iter().filter(|scene| scene.decided) {
        let next = scene.others.first().and_then(|(_, ratio)| *ratio);
        wins.entry(&scene.first.key.detector).or_default().extend(next.map(|ratio| ratio.median));
    }
    let mut wins: Vec<(&str, Vec<f64>)> = wins.into_iter().collect();
    wins.sort_by_key(|(_, ratios)| std::cmp::Reverse(ratios.len()));
    let undecided = scenes.iter().filter(|scene| !scene.decided).count();
    let Some(((name, ratios), rest)) = wins.split_first() else {
        return match scenes {
            [] => "No times were taken here: only answers, counts and memory.".into(),
            _ if scenes.iter().all(|scene| scene.others.is_empty()) => {
                format!("<strong>{}</strong> was timed alone.", escape(&scenes[0].first.key.detector))
            }
            _ => format!(
                "Undecided in all of {}: nobody is faster than the next by more than the noise.",
                text::plural(scenes.len(), "scene")
            ),
        };
    };
    let mut out = format!(
        "<strong>{}</strong> is the fastest in <strong>{} of {}</strong>",
        escape(name),
        ratios.len(),
        text::plural(scenes.len(), "scene")
    );
    if let Some(typical) = median(ratios) {
        let _ = write!(out, "; the next takes <strong>{typical:.1} times</strong> as long");
        let (least, most) = ratios.iter().fold((f64::INFINITY, 0_f64), |(low, high), &ratio| (low.min(ratio), high.max(ratio)));
        if ratios.len() > 1 {
            let _ = write!(out, " (median of scenes; {least:.1} to {most:.1})");
        }
    }
    out.push('.');
    if !rest.is_empty() {
        let rest: Vec<String> = rest.iter().map(|(name, ratios)| format!("{} in {}", escape(name), ratios.len())).collect();
        let _ = write!(out, " Then {}.", rest.join(", "));
    }
    if undecided > 0 {
        let _ = write!(out, " Undecided: {undecided}.");
    }
    out
}

/// Scene by scene: who, at which price, a picture of all, and the next. HTML.
pub fn table(scenes: &[Scene], detectors: &[&str], styles: &Styles) -> String {
    let mut out = format!(
        "<div class=\"scroll\" tabindex=\"0\"><table class=\"answer\"><thead><tr><th>scene</th><th>fastest</th><th class=\"number\">ns / N</th>\
         <th>time over the fastest{}</th><th>next takes</th></tr></thead><tbody>\n",
        ruler()
    );
    let index = |name: &str| detectors.iter().position(|known| *known == name).unwrap_or(0);
    let several = |field: &str| {
        let all = scenes.iter().flat_map(|scene| std::iter::once(scene.first).chain(scene.others.iter().map(|other| other.0)));
        all.map(|cell| cell.key.field(field)).collect::<std::collections::BTreeSet<_>>().len() > 1
    };
    let (arithmetics, threads) = (several("arithmetic"), several("threads"));
    let named = |cell: &Cell| {
        let mut name = cell.key.detector.clone();
        if arithmetics {
            name += &format!(" ({})", cell.key.arithmetic);
        }
        if threads && cell.key.threads > 1 {
            name += &format!(" ({} threads)", cell.key.threads);
        }
        name
    };
    for scene in scenes {
        let name = &scene.first.key.detector;
        let time = scene.first.time().map_or(f64::NAN, |time| time.median) / scene.first.key.n.max(1) as f64;
        let next = match scene.others.first() {
            Some((cell, Some(ratio))) => {
                let sure = if scene.decided { "" } else { " <em class=\"undecided\">undecided</em>" };
                format!("<strong>{:.2}×</strong> {}{sure}<br><small>{}</small>", ratio.median, escape(&named(cell)), range(ratio))
            }
            Some((cell, None)) => format!("{}: no common block", escape(&named(cell))),
            None => "alone".into(),
        };
        let _ = writeln!(
            out,
            "<tr><th scope=\"row\">{}</th><td>{}<strong>{}</strong></td><td class=\"number\">{}</td><td>{}</td><td>{next}</td></tr>",
            escape(&scene.title),
            marks::chip(index(name), styles.of(name).marker),
            escape(&named(scene.first)),
            text::number(time),
            picture(scene, &index, styles)
        );
    }
    out + "</tbody></table></div>\n"
}

fn range(ratio: &Interval) -> String {
    if ratio.count < 2 {
        return "one block: no interval".into();
    }
    format!("{:.2} to {:.2}, {} of {}", ratio.low, ratio.high, text::percent(ratio.coverage), text::plural(ratio.count, "block"))
}

/// Where a ratio stands in a picture.
fn across(ratio: f64) -> f64 {
    let share = ratio.clamp(0.5, EDGE).log2() / EDGE.log2();
    10.0 + share.max(-0.03) * (SIZE.0 - 24.0)
}

/// The axis of the pictures.
fn ruler() -> String {
    let mut out = format!("<br><svg class=\"strip\" viewBox=\"0 0 {} 14\" aria-hidden=\"true\">", SIZE.0);
    for ratio in [1, 2, 4, 8, 16] {
        let text = if f64::from(ratio) < EDGE { format!("{ratio}×") } else { format!("≥{ratio}×") };
        let _ = write!(out, "<text x=\"{:.1}\" y=\"11\">{text}</text>", across(f64::from(ratio)));
    }
    out + "</svg>"
}

/// All detectors of a scene by their ratio to the fastest, with intervals, on a logarithmic axis.
fn picture(scene: &Scene, index: &dyn Fn(&str) -> usize, styles: &Styles) -> String {
    let middle = SIZE.1 / 2.0;
    let said = |(cell, ratio): &(&Cell, Option<Interval>)| Some(format!("{} {}", cell.key.detector, with_interval(&(*ratio)?)));
    let all: Vec<String> = scene.others.iter().filter_map(said).collect();
    let label = format!("{} 1; {}", scene.first.key.detector, all.join("; "));
    let mut out = format!("<svg class=\"strip\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">", SIZE.0, SIZE.1, escape(&label));
    let _ = write!(out, "<title>{}</title>", escape(&label));
    for ratio in [1.0, 2.0, 4.0, 8.0, 16.0] {
        let _ = write!(out, "<path class=\"grid\" d=\"M{0:.1} 1V{1}\"/>", across(ratio), SIZE.1 - 1.0);
    }
    for (cell, ratio) in scene.others.iter().rev() {
        let Some(ratio) = ratio else { continue };
        let (k, style) = (index(&cell.key.detector), styles.of(&cell.key.detector));
        let (low, high) = (across(ratio.low), across(ratio.high));
        let _ = write!(out, "<path class=\"mark line bar\" style=\"--c:var(--d{k})\" d=\"M{low:.1} {middle}H{high:.1}\"/>");
        marks::mark(&mut out, k, style.marker, (across(ratio.median), middle), 4.0);
    }
    let name = &scene.first.key.detector;
    marks::mark(&mut out, index(name), styles.of(name).marker, (across(1.0), middle), 5.5);
    out + "</svg>"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analyse::{fake::Lab, value};

    #[test]
    fn detectors_are_compared_in_their_plainest_setting_and_noise_decides_nothing() {
        let mut lab = Lab::new("e", "packed");
        for (n, sorting) in [(100, 50), (1000, 2500)] {
            lab.n(n).threads(1).detector("nbs").time(&[1000; 15]).detector("sorting").time(&[sorting; 15]);
            // neither two threads nor rounded arithmetic wins
            lab.threads(2).detector("nbs").time(&[600; 15]);
            lab.threads(1).arithmetic("f64").time(&[700; 15]).detector("library").time(&[4000; 15]).arithmetic("exact");
        }
        lab.scene("loose", 2).detector("nbs").time(&[100; 15]).detector("sorting").time(&[101; 15]);
        lab.detector("nbs-twin").time(&[95; 15]);
        lab.scene("alone", 3).detector("<b>").time(&[5; 15]);
        let cells = value::cells(&lab.rows());
        let all: Vec<&Cell> = cells.iter().collect();
        let scenes = scenes(&all);
        let found: Vec<_> = scenes.iter().map(|s| (s.title.as_str(), s.first.key.detector.as_str(), s.others.len(), s.decided)).collect();
        assert_eq!(
            found,
            [("alone, 3D, N = 1000", "<b>", 0, false), ("loose, 2D, N = 1000", "nbs", 1, false), ("packed, 2D, N = 1000", "nbs", 2, true)]
        );
        assert_eq!(scenes[2].others[0].1.map(|ratio| ratio.median.round()), Some(3.0));
        let sentence = sentence(&scenes);
        assert!(sentence.contains("<strong>nbs</strong> is the fastest in <strong>1 of 3 scenes</strong>"), "{sentence}");
        assert!(sentence.contains("<strong>2.5 times</strong>") && sentence.ends_with("Undecided: 2."), "{sentence}");
        let table = table(&scenes, &["<b>", "library", "nbs", "sorting"], &Styles::default());
        assert!(table.contains("<strong>2.50×</strong> sorting (exact)") && table.contains("library 4.00 (4.00 to 4.00)"), "{table}");
        assert!(!table.contains("<b>") && table.contains("&lt;b&gt;"), "{table}");
    }
}
