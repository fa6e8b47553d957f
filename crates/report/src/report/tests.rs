use super::*;
use contactbench_record::cells::testing::{self, Lab};
use contactbench_record::findings::claim::Status;
use contactbench_record::record::row::{Outcome, Pass};
use contactbench_terms::errors::{Causes, Errors};

fn written(folder: &Path, experiment: Experiment, lab: &Lab) -> (Report, [String; 3]) {
    let report = write(folder, &[experiment], &lab.rows(), &["line 9 is torn".into()]).unwrap();
    let read = |path: &Path| std::fs::read_to_string(path).unwrap();
    let texts =
        [read(&report.path), read(&report.page), document::plain(&report.terminal, usize::MAX)];
    (report, texts)
}

#[test]
fn a_report_has_question_verdicts_figures_and_provenance() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let provenance = r#"{"command": "contactbench run", "cpu": {"name": "A_1"}}"#;
    std::fs::write(folder.join("provenance.json"), provenance).unwrap();
    let mut lab = Lab::new("e", "packed");
    for n in [100, 1000] {
        lab.n(n).detector("nbs").time(&[n; 15]).count(&[("list_push", 2 * n)]);
        lab.detector("sorting").time(&[3 * n; 15]);
        lab.detector("direct").fail(Pass::Time, Outcome::Crashed, "signal 11");
    }
    let experiment = testing::experiment(
        "[[claim]]\nname = 'two pushes'\nkind = 'equal'\nvalue = 'list_push'\nto = '2 * \
         n'\nwhere = { detector = 'nbs' }\n[[figure]]\nname = 'time'\ntitle = 'Time'\nx = \
         'n'\nx-label = 'N'\ny = 'time_ns'\ny-label = 'ns'\n[[figure]]\nname = 'bad'\ntitle = \
         'Bad'\nx = 'n'\nx-label = 'N'\ny = 'speed'\ny-label = 'ns'\n",
    );
    let (report, [markdown, page, terminal]) = written(folder, experiment.clone(), &lab);
    for part in [
        "**Which is fastest?**",
        "| two pushes | holds |",
        "(figures/e-time.svg)",
        "A\\_1",
        "BIAS.md",
        "Warning: line 9 is torn",
    ] {
        assert!(markdown.contains(part), "{part} is not in\n{markdown}");
    }
    for part in ["signal 11", "3.00 (3.00 to 3.00)", "exact in both cells", "packed, 2D, N = 1000"]
    {
        let texts = [&markdown, &page, &terminal];
        assert!(texts.iter().all(|text| text.contains(part)), "{part}: {texts:#?}");
    }
    for text in [&markdown, &page] {
        assert_eq!(text.matches("exact in both cells").count(), 2, "{text}");
    }
    assert!(markdown.contains("contactbench run") && page.contains("contactbench run"));
    // The second figure shows only the crash.
    assert_eq!((report.figures.len(), report.warnings.len(), report.verdicts.len()), (2, 1, 1));
    let summary = std::fs::read_to_string(folder.join("summary.csv")).unwrap();
    assert_eq!(summary.lines().count(), 7);
    assert!(!folder.join("verdicts.csv").exists());
    // Writing the report again gives the same text.
    assert_eq!(written(folder, experiment, &lab).1[0], markdown);
}

#[test]
fn nothing_is_decided_by_disturbed_times() {
    let mut lab = Lab::new("e", "packed");
    lab.detector("nbs").time(&[100; 15]).detector("library").time(&[300; 15]);
    let claim = "ratios-to = 'nbs'\n[[claim]]\nname = 'c'\nkind = 'faster'\nthan = \
                 'library'\nwhere = { detector = 'nbs' }\n";
    for (load, judged, status) in [("0.1", true, Status::Holds), ("9.0", false, Status::NotShown)] {
        let folder = tempfile::tempdir().unwrap();
        let provenance = format!(r#"{{"load_average": "{load} 1 1"}}"#);
        std::fs::write(folder.path().join("provenance.json"), provenance).unwrap();
        let (report, texts) = written(folder.path(), testing::experiment(claim), &lab);
        assert_eq!(report.verdicts[0].evidence.status, status);
        assert!(texts.iter().all(|text| text.contains("not judged") != judged), "{texts:?}");
    }
}

#[test]
fn verdicts_are_in_the_report_on_the_terminal_and_in_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let mut lab = Lab::new("e", "packed");
    lab.count(&[]).errors(Errors { spurious: 4, ..Errors::default() }, Causes::default());
    let experiment = testing::experiment("table = 'verdicts'");
    let (_, [markdown, _, terminal]) = written(folder.path(), experiment, &lab);
    assert!(terminal.starts_with("e: A title\n\nWhich is fastest?\n\n"), "{terminal}");
    assert!(terminal.contains("+4"), "{terminal}");
    assert!(markdown.contains("| packed, N = 100 | 2D | +4 |"), "{markdown}");
    let file = std::fs::read_to_string(folder.path().join("verdicts.csv")).unwrap();
    assert!(file.contains("e,\"packed, N = 100\",2,100,1,nbs,exact,wrong,ok,"), "{file}");
}
