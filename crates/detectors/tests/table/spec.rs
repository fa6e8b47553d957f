use contactbench_detectors::spec::{DetectorSpec, parse};
use contactbench_detectors::table;
use contactbench_ground::wide::Level;

/// Choices contain each word once and each form with each level, but no numbers.
#[test]
fn choices_cover_every_form() {
    let of = |name| DetectorSpec::choices(table::find(name).unwrap());
    let texts = |name| of(name).iter().map(DetectorSpec::to_string).collect::<Vec<_>>();
    assert_eq!(texts("direct"), ["direct"]);
    assert_eq!(texts("hgrid"), ["hgrid", "hgrid:ratio=one-level"]);
    let forms = ["", "form=dense", "form=flat", "form=sparse"];
    assert_eq!(of("streamed-nbs").len(), forms.len() * Level::all().len());
    for text in texts("streamed-nbs").into_iter().chain(texts("nbs")) {
        assert_eq!(parse(&text).unwrap().to_string(), text);
    }
}

#[test]
fn the_normal_form_is_sorted_without_defaults_and_parses_to_itself() {
    for (given, normal) in [
        ("nbs", "nbs"),
        ("nbs:", "nbs"),
        (" streamed-nbs : level = avx2 ", "streamed-nbs:level=avx2"),
        ("streamed-nbs:level=best,form=auto", "streamed-nbs"),
        ("streamed-nbs:level=portable,form=dense", "streamed-nbs:form=dense,level=portable"),
        ("hgrid:ratio=2", "hgrid"),
    ] {
        let spec = parse(given).unwrap();
        assert_eq!(spec.to_string(), normal);
        assert_eq!(parse(normal).unwrap(), spec);
    }
    for entry in table::TABLE {
        assert_eq!(parse(entry.name).unwrap(), DetectorSpec::from(entry));
    }
}

#[test]
fn errors_list_the_valid_names_and_values() {
    for (given, parts) in [
        ("nsb", &["no detector 'nsb' (did you mean nbs?)", "streamed-nbs", "direct"][..]),
        ("", &["no detector ''", "direct"]),
        ("sorting:level=avx2", &["no parameter 'level'", "sorting takes no parameters"]),
        ("streamed-nbs:avx2", &["'avx2' is not of the form", "level=best|portable|neon|avx2"]),
        ("streamed-nbs:lvl=avx2", &["no parameter 'lvl'", "form=auto|dense|flat|sparse"]),
        ("streamed-nbs:level=sse2", &["level cannot be 'sse2'", "best, portable, neon, avx2"]),
        ("streamed-nbs:level=avx2,level=best", &["level is given twice"]),
        ("streamed-nbs:levle=avx2", &["did you mean level?"]),
        ("streamed-nbs:form=dens", &["form cannot be 'dens' (did you mean dense?)"]),
        ("hgrid:ratio=", &["ratio cannot be ''"]),
        ("hgrid:ratio=1.7", &["ratio cannot be '1.7'", "one-level"]),
    ] {
        let error = parse(given).unwrap_err().to_string();
        assert!(parts.iter().all(|part| error.contains(part)), "{given}: {error}");
    }
}
