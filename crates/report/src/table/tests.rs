use super::*;

fn interval(median: f64, low: f64, high: f64) -> Interval {
    Interval { median, low, high, coverage: 0.96, count: 15 }
}

fn table() -> Table {
    Table::new(
        "a_b & c",
        vec![
            Column::right("N", ""),
            Column::left("detector"),
            Column::right("time / N", "ns"),
            Column::ratio("ratio"),
        ],
    )
    .with([
        vec![Cell::count(1000), "n|b<s".into(), Cell::number(12.345).strong(), "1".into()],
        vec!["".into(), "x".into(), Cell::absent(), Cell::ratio(&interval(1.5, 1.25, 2.0))],
        vec![
            "".into(),
            Cell::lines(vec!["a".into(), "b".into()]),
            Cell::number(3.2e8).wrong(),
            Cell::share(0.5),
        ],
    ])
}

#[test]
fn markdown_has_a_line_per_row_and_no_stray_markup() {
    assert_eq!(
        table().markdown(),
        "**a\\_b & c**\n\n\
         | N | detector | time / N (ns) | ratio |\n\
         | ---: | --- | ---: | ---: |\n\
         | 1000 | n\\|b\\<s | **12.35** | 1 |\n\
         |  | x | – | 1.50 (1.25 to 2.00) |\n\
         |  | a; b | wrong (3.200e8) | 50% |\n"
    );
}

#[test]
fn html_aligns_numbers_scrolls_and_escapes() {
    let html = table()
        .html_with("answer", &|j, k| if (j, k) == (Some(0), 1) { "<i></i>" } else { "" }.into());
    assert!(html.starts_with("<div class=\"scroll\" tabindex=\"0\"><table class=\"answer\">"));
    for part in [
        "<caption>a_b &amp; c</caption>",
        "<th class=\"number\">time / N (ns)</th>",
        "<th>detector</th>",
        "<td><i></i>n|b&lt;s</td><td class=\"number\"><strong>12.35</strong></td>",
        "<td>a<br>b</td>",
    ] {
        assert!(html.contains(part), "{part} is not in {html}");
    }
    assert!(roxmltree::Document::parse(&html.replace("<br>", "<br/>")).is_ok(), "{html}");
    assert!(table().html().starts_with("<div class=\"scroll\" tabindex=\"0\"><table><caption>"));
}

#[test]
fn csv_has_every_digit_three_columns_per_interval_and_quotes() {
    let mut table = table();
    table.rows[0][1] = "a,\"b\"".into();
    table.rows[1][2] = Cell::number(0.1 + 0.2);
    assert_eq!(
        csv(&[table.clone(), table]).lines().take(5).collect::<Vec<_>>(),
        [
            "N,detector,time / N,ratio,ratio_low,ratio_high",
            "1000,\"a,\"\"b\"\"\",12.345,1,,",
            ",x,0.30000000000000004,1.5,1.25,2",
            ",a; b,,0.5,,",
            "1000,\"a,\"\"b\"\"\",12.345,1,,",
        ]
    );
    assert_eq!(csv(&[]), "");
}

#[test]
fn plain_text_lines_up_and_fits_every_width() {
    assert_eq!(
        table().plain(80),
        "a_b & c\n   \
         N  detector    time / N (ns)                ratio\n\
         1000  n|b<s               12.35                    1\n      \
         x                       –  1.50 (1.25 to 2.00)\n      \
         a         wrong (3.200e8)                  50%\n      \
         b\n"
    );
    let mut wide = table();
    wide.rows[0][1] = "many words that a terminal has no room for, and more of them".into();
    for width in 20..100 {
        let text = wide.plain(width);
        assert!(text.lines().all(|line| line.chars().count() <= width), "{width}: {text}");
    }
    let words = Table::new("", vec![Column::left(""), Column::left("")])
        .with([vec!["a".into(), "one two".into()], vec!["bb".into(), "three".into()]]);
    assert_eq!(words.plain(9), "a   one\n    two\nbb  three\n");
}
