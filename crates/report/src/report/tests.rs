use super::*;
use contactbench_record::cells::testing;
use contactbench_record::cells::testing::Lab;
use contactbench_record::record::row::{Outcome, Pass};
use contactbench_terms::errors::{Causes, Errors};

#[test]
fn a_report_has_question_verdicts_figures_and_provenance() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("provenance.json"),
        r#"{"command": ["contactbench", "run"], "cpu": {"name": "A_1"}}"#,
    )
    .unwrap();
    let mut lab = Lab::new("e", "packed");
    for n in [100, 1000] {
        lab.n(n).detector("nbs").time(&[n; 15]).count(&[("list_push", 2 * n)]);
        lab.detector("direct").fail(Pass::Time, Outcome::Crashed, "signal 11");
    }
    let experiment = testing::experiment(
        "[[claim]]\nname = 'two pushes'\nkind = 'equal'\nvalue = 'list_push'\nto = '2 * \
         n'\nwhere = { detector = 'nbs' }\n[[figure]]\nname = 'time'\ntitle = 'Time'\nx = \
         'n'\nx-label = 'N'\ny = 'time_ns'\ny-label = 'ns'\n[[figure]]\nname = 'bad'\ntitle = \
         'Bad'\nx = 'n'\nx-label = 'N'\ny = 'speed'\ny-label = 'ns'\n",
    );
    let report = write(
        folder.path(),
        std::slice::from_ref(&experiment),
        &lab.rows(),
        &["line 9 is torn".into()],
    )
    .unwrap();
    let page = std::fs::read_to_string(&report.path).unwrap();
    for part in [
        "**Which is fastest?**",
        "| two pushes | holds |",
        "(figures/e-time.svg)",
        "signal 11",
        "contactbench run",
        "A\\_1",
        "BIAS.md",
    ] {
        assert!(page.contains(part), "{part} is not in\n{page}");
    }
    assert!(
        page.contains("Warning: line 9 is torn") && page.contains("unknown variable 'speed'"),
        "{page}"
    );
    assert_eq!((report.figures.len(), report.warnings.len(), report.verdicts.len()), (1, 2, 1));
    assert!(
        report
            .figures
            .iter()
            .all(|path| std::fs::metadata(path).is_ok_and(|file| file.len() > 1000))
    );
    assert_eq!(
        std::fs::read_to_string(folder.path().join("summary.csv")).unwrap().lines().count(),
        5
    );
    assert!(!folder.path().join("verdicts.csv").exists());
    // a report can be made again, and is the same
    assert!(write(folder.path(), &[experiment], &lab.rows(), &["line 9 is torn".into()]).is_ok());
    assert_eq!(page, std::fs::read_to_string(&report.path).unwrap());
}

#[test]
fn verdicts_are_in_the_report_on_the_terminal_and_in_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let mut lab = Lab::new("e", "packed");
    lab.count(&[]).errors(Errors { spurious: 4, ..Errors::default() }, Causes::default());
    let experiment = testing::experiment("table = 'verdicts'");
    let report = write(folder.path(), &[experiment], &lab.rows(), &[]).unwrap();
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    let text = document::plain(&report.terminal, 80);
    assert!(
        text.starts_with("e: A title\n\nWhich is fastest?\n\ncase") && text.contains("+4"),
        "{text}"
    );
    assert!(read("report.md").contains("| packed, N = 100 | 2D | +4 |"), "{}", read("report.md"));
    assert!(
        read("verdicts.csv").contains("e,\"packed, N = 100\",2,100,1,nbs,exact,wrong,ok,"),
        "{}",
        read("verdicts.csv")
    );
}
