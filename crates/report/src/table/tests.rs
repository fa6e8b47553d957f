use super::*;

fn interval(median: f64, low: f64, high: f64) -> Interval {
    Interval { median, low, high, coverage: 0.96, count: 15 }
}

fn table() -> Table {
    let number = |k: usize| match k {
        0 => Cell::Number(12.345).strong(),
        1 => Cell::Absent,
        _ => Cell::Number(3.2e8).wrong(),
    };
    let ratio = |k: usize| match k {
        0 => Cell::from("1"),
        1 => interval(1.5, 1.25, 2.0).into(),
        _ => Cell::Share(0.5),
    };
    Table::of("a_b & c", 0..3)
        .right("N", |k| (k == 0).then_some(1000u32).map_or(Cell::from(""), Cell::from))
        .left("detector", |k| match k {
            0 => Cell::from("n|b<s"),
            1 => Cell::from("-x,\"y\""),
            _ => vec!["a".to_string(), "b".to_string()].into(),
        })
        .unit("time / N", "ns", number)
        .ratio("ratio", ratio)
        .into()
}

#[test]
fn every_language_shows_the_same_and_takes_nothing_for_markup() {
    assert_eq!(
        table().markdown(),
        "**a\\_b & c**\n\n\
         | N | detector | time / N (ns) | ratio |\n\
         | ---: | --- | ---: | ---: |\n\
         | 1000 | n\\|b\\<s | **12.35** | 1 |\n\
         |  | -x,\"y\" | – | 1.50 (1.25 to 2.00) |\n\
         |  | a; b | wrong (3.200e8) | 50% |\n"
    );
    let html = table().html("results");
    assert!(html.starts_with("<div class=\"scroll\" tabindex=\"0\"><table class=\"results\">"));
    for part in [
        "<caption>a_b &amp; c</caption>",
        "<th class=\"number\">time / N (ns)</th>",
        "<td>n|b&lt;s</td><td class=\"number\"><strong>12.35</strong></td>",
        "<td>a<br>b</td>",
    ] {
        assert!(html.contains(part), "{part} is not in {html}");
    }
    assert!(roxmltree::Document::parse(&html.replace("<br>", "<br/>")).is_ok(), "{html}");
    assert_eq!(
        csv(&[table(), table()]).lines().take(5).collect::<Vec<_>>(),
        [
            "N,detector,time / N,ratio,ratio_low,ratio_high",
            "1000,n|b<s,12.345,1,,",
            ",\"'-x,\"\"y\"\"\",,1.5,1.25,2",
            ",a; b,,0.5,,",
            "1000,n|b<s,12.345,1,,",
        ]
    );
}

#[test]
fn plain_text_lines_up_and_fits_every_width() {
    assert_eq!(
        table().plain(80),
        "a_b & c\n   \
         N  detector    time / N (ns)                ratio\n\
         1000  n|b<s               12.35                    1\n      \
         -x,\"y\"                  –  1.50 (1.25 to 2.00)\n      \
         a         wrong (3.200e8)                  50%\n      \
         b\n"
    );
    let mut wide = table();
    wide.rows[0][1] = "many words that a terminal has no room for, and more of them".into();
    for width in 20..100 {
        let text = wide.plain(width);
        assert!(text.lines().all(|line| line.chars().count() <= width), "{width}: {text}");
        assert!(width < 50 || text.contains("terminal") && text.contains("detector"), "{text}");
    }
}

#[test]
fn a_single_block_has_no_interval() {
    let one = Interval { coverage: 0.0, count: 1, ..interval(4.41, 4.41, 4.41) };
    let table: Table = Table::of("", [one]).ratio("ratio", Cell::from).into();
    assert!(table.markdown().ends_with("| 4.41 (no interval) |\n"), "{}", table.markdown());
    assert_eq!(csv(&[table]), "ratio,ratio_low,ratio_high\n4.41,,\n");
}
