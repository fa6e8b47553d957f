//! `report.md`, `report.html` and the terminal say the same, on every record in `results/`.
//!
//! Each text is taken apart by a reader of its own, which knows nothing of how it was made.

use std::collections::BTreeSet;
use std::path::Path;

use super::*;
use crate::sections::claims::evidence;
use contactbench_record::record::row;

/// A line of a table, empty cells left out.
type Line = Vec<String>;

fn line<'a>(cells: impl IntoIterator<Item = &'a str>) -> Line {
    cells.into_iter().map(|it| it.trim().to_string()).filter(|it| !it.is_empty()).collect()
}

/// The lines of Markdown tables, and all other words.
fn read_markdown(text: &str) -> (BTreeSet<Line>, String) {
    let (mut lines, mut words) = (BTreeSet::new(), String::new());
    for text in text.lines() {
        let (mut cells, mut escaped) = (vec![String::new()], false);
        for c in text.chars() {
            let cell = cells.last_mut().unwrap();
            match c {
                _ if escaped => cell.push(c),
                '\\' => {}
                '*' => {}
                '|' => cells.push(String::new()),
                c => cell.push(c),
            }
            escaped = c == '\\' && !escaped;
        }
        match cells.len() {
            1 => words += &(cells.remove(0) + "\n"),
            _ => drop(lines.insert(line(cells.iter().map(String::as_str)))),
        }
    }
    (lines, words)
}

/// The text between tags; pictures are left out, and a line break becomes a semicolon.
fn without_tags(html: &str) -> String {
    let (mut out, mut rest) = (String::new(), html);
    while let Some((before, tag)) = rest.split_once('<') {
        out += before;
        rest = match tag {
            _ if tag.starts_with("svg") => tag.split_once("</svg>").unwrap().1,
            _ if tag.starts_with("br>") => {
                out += "; ";
                &tag[3..]
            }
            _ => tag.split_once('>').unwrap().1,
        };
    }
    let out = out + rest;
    let entities = [("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\""), ("&#39;", "'"), ("&amp;", "&")];
    entities.iter().fold(out, |text, (from, to)| text.replace(from, to))
}

/// The lines of HTML tables, those of claims apart, and all words.
fn read_html(text: &str) -> (BTreeSet<Line>, BTreeSet<Line>, String) {
    let main = text.split_once("<main>").unwrap().1.split_once("</main>").unwrap().0;
    let (mut lines, mut claims) = (BTreeSet::new(), BTreeSet::new());
    for table in main.split("<table").skip(1) {
        let table = table.split_once("</table>").unwrap().0;
        let (attributes, body) = table.split_once('>').unwrap();
        let body = body.split_once("</caption>").map_or(body, |(_, body)| body);
        let all = if attributes.contains("claims") { &mut claims } else { &mut lines };
        for row in body.split("</tr>") {
            let cells: Vec<String> =
                row.split("</td>").flat_map(|it| it.split("</th>")).map(without_tags).collect();
            all.insert(line(cells.iter().map(String::as_str)));
        }
    }
    (lines, claims, without_tags(main))
}

/// The lines of tables on a terminal: words that two blanks part.
fn read_plain(text: &str) -> BTreeSet<Line> {
    text.lines().map(|text| line(text.split("  "))).collect()
}

/// What stands in one and not in the other, or in another order.
fn differences(markdown: &str, html: &str, plain: &str, report: &Report) -> Vec<String> {
    let (lines, _) = read_markdown(markdown);
    let (page, claims, page_words) = read_html(html);
    let shown = read_plain(plain);
    let mut out = Vec::new();
    let mut differ = |what: &str, line: &Line| out.push(format!("{what}: {line:?}"));
    let claim = |line: &&Line| report.verdicts.iter().any(|it| line.first() == Some(&it.claim));
    let rule = |line: &&Line| line.iter().all(|cell| cell.chars().all(|c| "-: ".contains(c)));
    let heads = |line: &&Line| line.first().is_some_and(|it| it == "claim");
    let tables: Vec<&Line> =
        lines.iter().filter(|it| !rule(it) && !claim(it) && !heads(it)).collect();
    let picture = |line: &&Line| line.iter().any(|it| it == "next / fastest");
    for line in &tables {
        // The page has one column more, for pictures.
        if !picture(line) && !page.contains(*line) {
            differ("not in the page", line);
        }
    }
    let known: BTreeSet<&Line> = tables.iter().copied().collect();
    for line in page.iter().filter(|it| !it.is_empty() && !picture(it)) {
        if !known.contains(line) {
            differ("only in the page", line);
        }
    }
    for verdict in &report.verdicts {
        let (name, evidence) = (verdict.status.name(), evidence(&verdict.evidence));
        let markdown = |it: &&Line| it[0] == verdict.claim && it[1] == name && it[2] == evidence;
        if !lines.iter().filter(|it| it.len() > 2).any(|it| markdown(&it)) {
            differ("a claim is not in the report", &vec![verdict.claim.clone()]);
        }
        let html = |it: &&Line| {
            it.len() == 3
                && it[0].starts_with(&verdict.claim)
                && it[1].ends_with(name)
                && it[2] == evidence
        };
        if !claims.iter().any(|it| html(&it)) {
            differ("a claim is not in the page", &vec![verdict.claim.clone()]);
        }
        let plain = |it: &&Line| {
            it.len() == 3 && it[0] == name && it[1].ends_with(&verdict.claim) && it[2] == evidence
        };
        if !shown.iter().any(|it| plain(&it)) {
            differ("a claim is not on the terminal", &vec![verdict.claim.clone()]);
        }
    }
    // Tables of winners, which other tables of six columns are not, stand on the terminal, too.
    // Seven with first detections.
    let decided = |it: &String| it == "yes" || it.starts_with("undecided: ");
    let winner = |it: &&Line| [6, 7].contains(&it.len()) && it.last().is_some_and(decided);
    let ratio = |it: &&Line| it[4].contains(" to ") && it[2].parse::<f64>().is_ok();
    // Details have all scenes; above them are those that an answer shows.
    let (answers, answer_words) = read_markdown(markdown.split("\n## ").next().unwrap_or_default());
    let answers = answers.iter();
    for line in answers.filter(|it| winner(it) && ratio(it) && it[1].parse::<f64>().is_err()) {
        if !shown.contains(line) {
            differ("not on the terminal", line);
        }
    }
    let answer = |it: &&str| {
        [" is the fastest in ", "Undecided", " is the only one with "]
            .iter()
            .any(|w| it.contains(w))
    };
    for sentence in answer_words.lines().filter(answer) {
        if !page_words.contains(sentence) || !plain.contains(sentence) {
            differ("a sentence of the report alone", &vec![sentence.into()]);
        }
    }
    out
}

/// The record of a folder under `results`, and its experiments without figures.
fn read(folder: &Path) -> (Vec<Row>, Vec<Experiment>) {
    let rows = row::read(&folder.join(row::FILE)).unwrap().rows;
    let names: BTreeSet<&str> = rows.iter().map(|row| row.id.experiment.as_str()).collect();
    let experiment = |name: &&str| {
        let path = folder.join("experiments").join(format!("{name}.toml"));
        let text = contactbench_run::plan::text_of(&path).unwrap();
        let mut experiment = contactbench_run::plan::parse_copy(&text).unwrap();
        experiment.figures.clear();
        experiment
    };
    let experiments = names.iter().map(experiment).collect();
    (rows, experiments)
}

#[test]
fn report_page_and_terminal_agree_on_all_committed_records() {
    let mut seen = 0;
    for folder in crate::committed::committed() {
        let name = folder.display().to_string();
        if !row::exists(&folder.join(row::FILE)) {
            continue;
        }
        let (rows, experiments) = read(&folder);
        let made = tempfile::tempdir().unwrap();
        let report = write(made.path(), &experiments, &rows, &[]).unwrap();
        let markdown = std::fs::read_to_string(&report.path).unwrap();
        let html = std::fs::read_to_string(&report.page).unwrap();
        let plain = document::plain(&report.terminal, usize::MAX);
        let found = differences(&markdown, &html, &plain, &report);
        assert!(found.is_empty(), "{name}: {:#?}", &found[..found.len().min(10)]);
        // A number that stands in one of them alone is found.
        let ratio =
            |it: &&str| it.contains(" (") && it.chars().all(|c| "0123456789. to()".contains(c));
        let Some(number) = markdown.split(" | ").find(ratio).map(str::to_string) else {
            // Counts alone have none.
            continue;
        };
        let other = number.replacen('.', ".9", 1);
        for (markdown, html) in [
            (markdown.replace(&number, &other), html.clone()),
            (markdown.clone(), html.replace(&number, &other)),
        ] {
            assert!(!differences(&markdown, &html, &plain, &report).is_empty(), "{name}: {number}");
        }
        seen += 1;
    }
    assert!(seen >= 3, "{seen} records");
}
