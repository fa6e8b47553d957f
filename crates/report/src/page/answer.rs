//! The table of the fastest detectors, with a picture for each scene: all detectors at their ratio
//! to the fastest.

use std::fmt::Write as _;

use crate::figure::style::{Marker, Styles};
use crate::page::marks;
use crate::sections::winners::{self, Columns};
use contactbench_record::findings::winners::{Contest, RankedSubject, Winners};
use contactbench_terms::number::{short, with_interval};
use contactbench_terms::text::html as escape;

/// Ratio at the right edge of a picture. Larger ratios are drawn at the edge.
const EDGE: f64 = 16.0;
const SIZE: (f64, f64) = (240.0, 22.0);
const PICTURE: usize = 4;
const RATIOS: [f64; 5] = [1.0, 2.0, 4.0, 8.0, EDGE];

pub struct Marks<'a> {
    pub detectors: &'a [&'a str],
    pub styles: &'a Styles,
}

impl Marks<'_> {
    fn find(&self, name: &str) -> (usize, Marker) {
        let k = self.detectors.iter().position(|known| *known == name).unwrap_or(0);
        (k, self.styles.get(name).marker)
    }
}

pub fn table(found: &Winners, marks: &Marks<'_>) -> String {
    let contests = winners::shown(found);
    let table = winners::table(&contests, &Columns { pictures: true, cold: true, time: short });
    table.html_with("answer", &|row, column| match (row.map(|row| contests[row]), column) {
        (None, PICTURE) => format!("<span>time / fastest</span>{}", ruler("strip")),
        (Some(contest), 1) => {
            let (k, marker) = marks.find(&contest.first.line.detector);
            marks::chip(k, marker)
        }
        // A narrow page hides the table's head, so each picture has its own axis.
        (Some(contest), PICTURE) => picture(contest, marks) + &ruler("strip own"),
        _ => String::new(),
    })
}

fn across(ratio: f64) -> f64 {
    let share = ratio.clamp(0.5, EDGE).log2() / EDGE.log2();
    10.0 + share.max(-0.03) * (SIZE.0 - 24.0)
}

fn ruler(class: &str) -> String {
    let mut out =
        format!("<svg class=\"{class}\" viewBox=\"0 0 {} 14\" aria-hidden=\"true\">", SIZE.0);
    for ratio in RATIOS {
        let (at, more) = (across(ratio), if ratio < EDGE { "" } else { "≥" });
        let _ = write!(out, "<text x=\"{at:.1}\" y=\"11\">{more}{ratio}×</text>");
    }
    out + "</svg>"
}

/// Draws all detectors of a scene by their ratio to the fastest, with intervals, on a logarithmic
/// axis.
fn picture(contest: &Contest, marks: &Marks<'_>) -> String {
    let middle = SIZE.1 / 2.0;
    let said =
        |it: &RankedSubject| Some(format!("{} {}", it.name, with_interval(it.ratio.as_ref()?)));
    let all: Vec<String> = contest.others.iter().filter_map(said).collect();
    let label = escape(&format!("{} 1; {}", contest.first.name, all.join("; ")));
    let mut out = format!(
        "<svg class=\"strip\" viewBox=\"0 0 {} {}\" role=\"img\" \
         aria-label=\"{label}\"><title>{label}</title>",
        SIZE.0, SIZE.1
    );
    for at in RATIOS.map(across) {
        let _ = write!(out, "<path class=\"grid\" d=\"M{at:.1} 1V{}\"/>", SIZE.1 - 1.0);
    }
    for (other, ratio) in contest.others.iter().rev().filter_map(|it| Some((it, it.ratio?))) {
        let (k, marker) = marks.find(&other.line.detector);
        let (low, high) = (across(ratio.low), across(ratio.high));
        let _ = write!(
            out,
            "<path class=\"mark line bar\" style=\"--c:var(--d{k})\" d=\"M{low:.1} \
             {middle}H{high:.1}\"/>"
        );
        marks::mark(&mut out, k, marker, (across(ratio.median), middle), 4.0);
    }
    let (k, marker) = marks.find(&contest.first.line.detector);
    marks::mark(&mut out, k, marker, (across(1.0), middle), 5.5);
    out + "</svg>"
}

#[cfg(test)]
mod tests {
    use super::*;
    use contactbench_record::cells::testing::Lab;
    use contactbench_record::findings::winners::winners;

    #[test]
    fn every_scene_has_a_picture_and_no_name_becomes_markup() {
        let mut lab = Lab::new("e", "packed");
        lab.detector("nbs").time(&[1000; 15]).detector("sorting").time(&[2500; 15]);
        lab.detector("library").time(&[4000; 15]);
        lab.scene("alone", 3).detector("<b>").time(&[5; 15]);
        let found = lab.find(winners);
        let detectors = ["<b>", "library", "nbs", "sorting"];
        let marks = Marks { detectors: &detectors, styles: &Styles::default() };
        let table = table(&found, &marks);
        for part in ["<td class=\"number\">2.50 (2.50 to 2.50)</td>", "library 4.00 (4.00 to 4.00)"]
        {
            assert!(table.contains(part), "{part} is not in {table}");
        }
        assert!(!table.contains("<b>") && table.contains("&lt;b&gt;"), "{table}");
        assert_eq!(table.matches("role=\"img\"").count(), 2);
        assert!(roxmltree::Document::parse(&table).is_ok(), "{table}");
    }
}
