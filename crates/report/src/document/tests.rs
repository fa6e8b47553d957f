use super::*;

fn blocks() -> Vec<Block> {
    let text = Text::from("All of ").strong("it_").plain(" is in ").code("a.csv");
    vec![
        Block::heading(2, "A <title>"),
        Block::paragraph(text.plain(", ").code("r_`").plain(" ").emphasis("now")),
        Block::Warning("<b>".into()),
        Block::List(vec!["one".into(), "two".into()]),
        Block::Code("a < b ````".into()),
        Block::table(Table::of("t", [1u64]).left("a", |_| "x").right("b", |k| k)),
        Block::Figure { title: "F".into(), path: "f.svg".into() },
    ]
}

#[test]
fn blocks_are_written_in_every_language() {
    assert_eq!(
        markdown(&blocks()),
        "## A \\<title\\>\n\nAll of **it\\_** is in `a.csv`, `r_'` *now*\n\n\
         > Warning: \\<b\\>\n\n* one\n* two\n\n````text\na < b '\n````\n\n\
         **t**\n\n| a | b |\n| --- | ---: |\n| x | 1 |\n\n\
         ![F](figures/f.svg)\n\n"
    );
    let made = html(&blocks());
    for part in [
        "<h2>A &lt;title&gt;</h2>",
        "<strong>it_</strong> is in <code>a.csv</code>, <code>r_`</code> <em>now</em></p>",
        "<p class=\"warning\">&lt;b&gt;</p>",
        "<li>two</li>",
        "<pre tabindex=\"0\">a &lt; b ````</pre>",
    ] {
        assert!(made.contains(part), "{part} is not in {made}");
    }
    assert!(roxmltree::Document::parse(&format!("<x>{made}</x>")).is_ok(), "{made}");
    let made = plain(&blocks(), 12);
    assert!(made.lines().all(|line| line.chars().count() <= 12), "{made}");
    assert!(made.contains("\n* one\n* two\n") && made.contains("All of it_\nis in a.csv,\n"));
    assert_eq!(plain(&[Block::Warning("a b c".into())], 13), "warning: a b\n         c\n");
}
