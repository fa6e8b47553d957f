use contactbench_detectors::tracker::parse;

#[test]
fn the_normal_form_parses_to_itself() {
    for (text, normal) in [
        ("nbs", "every-step(nbs)"),
        ("every-step(streamed-nbs:form=dense)", "every-step(streamed-nbs:form=dense)"),
        ("verlet(nbs)", "verlet(nbs,rule=top-two,skin=0.1)"),
        ("verlet(nbs,skin=auto)", "verlet(nbs,rule=top-two,skin=auto)"),
        ("verlet(nbs,skin=-0)", "verlet(nbs,rule=top-two,skin=0)"),
        ("every-step( hgrid:ratio=2 )", "every-step(hgrid)"),
        (
            " verlet( rule = every-5 , streamed-nbs:form=dense, level=portable,skin =1e-3)",
            "verlet(streamed-nbs:form=dense,level=portable,rule=every-5,skin=0.001)",
        ),
    ] {
        let spec = parse(text).unwrap_or_else(|error| panic!("{text}: {error}"));
        assert_eq!(spec.to_string(), normal);
        assert_eq!(parse(normal), Ok(spec));
    }
}

#[test]
fn invalid_text_is_an_error_with_a_remedy() {
    for (text, says) in [
        ("verlet(nbs", "is not a tracker"),
        ("skin(nbs)", "is not a tracker"),
        ("verlet", "'verlet' is not a tracker; write every-step(DETECTOR) or verlet("),
        ("verlet(nbx)", "there is no detector 'nbx'"),
        ("verlet()", "there is no detector ''"),
        ("verlet(nbs,skin=-1)", "skin cannot be '-1'"),
        ("verlet(nbs,skin=nan)", "skin cannot be 'nan'"),
        ("verlet(nbs,skin=inf)", "skin cannot be 'inf'"),
        ("verlet(nbs,rule=never)", "rule cannot be 'never'"),
        ("verlet(nbs,skin=auto,rule=every-5)", "skin=auto needs rule=half-skin"),
        ("verlet(nbs,skin=auto,rule=lammps-0-1-yes)", "skin=auto needs rule=half-skin"),
        ("verlet(nbs,margin=0.1)", "there is no parameter 'margin'"),
        ("verlet(nbs,skin=1,skin=2)", "skin is given twice"),
        ("incremental(nbs)", "is not a tracker"),
        ("verlet(nbs,rule=summed,rule=top-two)", "rule is given twice"),
    ] {
        let error = parse(text).unwrap_err().to_string();
        assert!(error.contains(says), "{text}: {error}");
    }
}
