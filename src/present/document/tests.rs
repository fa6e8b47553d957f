use super::*;
use crate::present::table::{Cell, Column};

fn blocks() -> Vec<Block> {
    let table = Table::new("t", vec![Column::left("a"), Column::right("b", "")])
        .with([vec!["x".into(), Cell::count(1)]]);
    let text = Text::from("All of ").strong("it_").plain(" is in ").link("a.csv", "a.csv");
    vec![
        Block::heading(2, "A <title>"),
        Block::paragraph(text.plain(", ").code("run").plain(" ").emphasis("now")),
        Block::Warning("<b>".into()),
        Block::List(vec!["one".into(), "two".into()]),
        Block::Code("a < b ````".into()),
        Block::Table(table),
        Block::Figure { title: "F".into(), paths: ["f.svg", "f.png"].map(PathBuf::from).into() },
    ]
}

#[test]
fn markdown_has_an_empty_line_after_each_block() {
    assert_eq!(
        markdown(&blocks()),
        "## A \\<title\\>\n\nAll of **it\\_** is in [a.csv](a.csv), `run` *now*\n\n\
         > Warning: \\<b\\>\n\n* one\n* two\n\n````text\na < b '\n````\n\n\
         **t**\n\n| a | b |\n| --- | ---: |\n| x | 1 |\n\n\
         ![F](figures/f.png)\n\n[as SVG](figures/f.svg)\n\n"
    );
}

#[test]
fn html_is_well_formed_and_links_stay_in_the_folder() {
    let made = html(&blocks());
    for part in [
        "<h2>A &lt;title&gt;</h2>",
        "<strong>it_</strong> is in <a href=\"a.csv\">a.csv</a>, <code>run</code> <em>now</em></p>",
        "<p class=\"warning\">&lt;b&gt;</p>",
        "<li>two</li>",
        "<pre tabindex=\"0\">a &lt; b ````</pre>",
        "<caption>t</caption>",
    ] {
        assert!(made.contains(part), "{part} is not in {made}");
    }
    assert!(roxmltree::Document::parse(&format!("<x>{made}</x>")).is_ok(), "{made}");
    for target in ["javascript:alert(1)", "https://example.org", "../x", "/etc"] {
        let link = html(&[Block::paragraph(Text::new().link("a", target))]);
        assert_eq!(link, "<p>a</p>\n", "{target}");
    }
    let link = html(&[Block::paragraph(Text::new().link("a", "#claims"))]);
    assert_eq!(link, "<p><a href=\"#claims\">a</a></p>\n");
}

#[test]
fn plain_text_is_wrapped_and_indented() {
    let made = plain(&blocks(), 12);
    assert!(made.lines().all(|line| line.chars().count() <= 12), "{made}");
    assert!(made.contains("\n* one\n* two\n") && made.contains("All of it_\nis in a.csv,\n"));
    assert_eq!(plain(&[Block::Warning("a b c".into())], 13), "warning: a b\n         c\n");
}
