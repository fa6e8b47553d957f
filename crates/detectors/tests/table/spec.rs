use contactbench_detectors::spec::{DetectorSpec, parse};
use contactbench_detectors::table;
use contactbench_detectors::table::{Role, judges};
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
fn ranks_of_judges_are_distinct() {
    let judges = judges();
    assert!(judges.iter().all(|entry| entry.role == Role::Detector));
    let places: Vec<u8> = judges.iter().map(|entry| entry.judge).collect();
    assert_eq!(places, [1, 2, 3, 4]);
}
