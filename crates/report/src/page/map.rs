//! Maps on a page: tables of coloured tiles that show their row on hover, press and focus.

use std::fmt::Write as _;

use crate::figure::style::{Colour, Styles};
use crate::page::marks::{hex, on_dark};
use crate::sections::map::{Drawn, either, sentence};
use contactbench_record::findings::map::{Answer, Panel, STEPS, Spot};
use contactbench_terms::number::times;
use contactbench_terms::text::html as escape;

const SCRIPT: &str = include_str!("../../assets/report/map.js");
/// Percentage of a detector's colour in a tile, by its lead; text must stay readable.
const DEPTHS: [u32; STEPS.len() + 1] = [10, 20, 32, 46];

pub fn section(maps: &[&Drawn], styles: &Styles) -> String {
    let mut out = String::from("<section id=\"maps\"><h2>Maps</h2>\n");
    let _ = writeln!(
        out,
        "<p class=\"note\">Who is the fastest in each place, and the time of the next over its \
         own: the deeper the colour, the farther ahead (from {} on). Striped: undecided.</p>",
        STEPS.map(|step| step.to_string()).join(", ")
    );
    maps.iter().for_each(|drawn| figure(&mut out, drawn, styles));
    let _ = writeln!(out, "</section>\n<script nonce=\"contactbench\">\n{SCRIPT}</script>\n");
    out
}

fn figure(out: &mut String, drawn: &Drawn, styles: &Styles) {
    let map = &drawn.map;
    let colours = styles.of_map(&map.subjects);
    let colour = |name: &str| {
        let known = map.subjects.iter().position(|known| known == name);
        known.and_then(|k| colours.get(k).copied()).unwrap_or_default()
    };
    let title = escape(&drawn.title);
    let _ = writeln!(out, "<figure class=\"map\"><figcaption>{title}</figcaption>");
    for panel in &map.panels {
        table(out, drawn, panel, &colour);
    }
    *out += "<p class=\"said note\" role=\"status\">Point at a place, press it or go there with \
             the Tab key to read its row.</p></figure>\n";
}

fn table(out: &mut String, drawn: &Drawn, panel: &Panel, colour: &dyn Fn(&str) -> Colour) {
    let (map, [across, up]) = (&drawn.map, drawn.labels.each_ref().map(|label| escape(label)));
    let [x, y] = &map.axes;
    let _ = writeln!(
        out,
        "<div class=\"scroll\"><table><caption>{}</caption><tbody>",
        escape(&panel.title)
    );
    let (columns, rows) = (panel.values(0), panel.values(1));
    for (k, &j) in rows.iter().rev().enumerate() {
        *out += "<tr>";
        if k == 0 {
            let _ = write!(out, "<th class=\"name\" rowspan=\"{}\">{up}</th>", rows.len());
        }
        let _ = write!(out, "<th scope=\"row\">{}</th>", escape(&y.values[j]));
        for &i in &columns {
            *out += &panel.at([i, j]).map_or("<td class=\"none\"></td>".into(), |spot| {
                place(spot, &sentence(map, panel, spot), colour)
            });
        }
        *out += "</tr>\n";
    }
    *out += "</tbody><tfoot><tr><th colspan=\"2\"></th>";
    for &i in &columns {
        let _ = write!(out, "<th scope=\"col\">{}</th>", escape(&x.values[i]));
    }
    let _ = writeln!(
        out,
        "</tr><tr><th colspan=\"2\"></th><th class=\"name\" colspan=\"{}\">{across}</th></tr>\
         </tfoot></table></div>",
        columns.len()
    );
}

/// Allows a line break before the parenthesis of a name.
fn broken(name: &str) -> String {
    escape(name).replace('(', "<wbr/>(")
}

fn place(spot: &Spot, row: &str, colour: &dyn Fn(&str) -> Colour) -> String {
    let row = escape(row);
    let front = spot.front();
    let factor = spot.factor();
    let said = |words: String| format!("<small>{words}</small>");
    let ratio = factor.map_or(String::new(), |it| said(times(it.median)));
    let (class, depth, words) = match spot.answer() {
        Answer::Nobody => ("none", 0, escape(spot.outcome.name())),
        Answer::Undecided => {
            let others = broken(&either(&front[1..]));
            let names = format!("<b>{}</b> or <b>{others}</b>", broken(front[0]));
            ("open", 0, format!("<span>{names}{ratio}</span>"))
        }
        Answer::Alone => ("", 8, format!("{}{}", broken(front[0]), said("alone".into()))),
        Answer::Decided(step) => {
            let depth = DEPTHS[step.min(DEPTHS.len() - 1)];
            ("", depth, format!("<b>{}</b>{ratio}", broken(front[0])))
        }
    };
    let mut style = format!("--deep:{depth}%");
    for (name, which) in front.iter().zip(["", "2"]) {
        let c = colour(name);
        let _ = write!(style, ";--light{which}:{};--dark{which}:{}", hex(c), hex(on_dark(c)));
    }
    let class = if class.is_empty() { class.into() } else { format!(" class=\"{class}\"") };
    format!("<td{class} style=\"{style}\" tabindex=\"0\" data-row=\"{row}\">{words}</td>")
}

#[cfg(test)]
mod tests {
    use super::*;
    use contactbench_record::findings::map::testing::made_up;

    #[test]
    fn places_tell_their_row_and_no_name_becomes_markup() {
        let map = made_up();
        let labels = ["N".to_string(), "<fraction>".to_string()];
        let drawn = Drawn { name: "m".into(), title: "A & B".into(), labels, map };
        let html = section(&[&drawn], &Styles::default());
        let colours = Styles::default().of_map(&drawn.map.subjects);
        let [nbs, sorting] = [colours[0], colours[1]].map(hex);
        for part in [
            "<figcaption>A &amp; B</figcaption>".to_string(),
            "&lt;fraction&gt;</th><th scope=\"row\">0.6</th>".into(),
            format!("style=\"--deep:32%;--light:{nbs};--dark:"),
            "tabindex=\"0\" data-row=\"packed, 2D, n = 100, fraction = 0.1: the fastest is nbs"
                .into(),
            format!("<td class=\"open\" style=\"--deep:0%;--light:{nbs};--dark:"),
            format!(";--light2:{sorting}"),
            "<span><b>nbs</b> or <b>sorting</b><small>1.01</small></span>".into(),
            ">timeout</td>".into(),
        ] {
            assert!(html.contains(&part), "{part} is not in {html}");
        }
        assert_eq!(html.matches("data-row=").count(), 4);
        assert!(!html.contains("<fraction>"), "{html}");
        let table = html.split_once("<figure").unwrap().1.split_once("</figure>").unwrap().0;
        let whole = format!("<figure{table}</figure>");
        assert!(roxmltree::Document::parse(&whole).is_ok(), "{whole}");
    }
}
