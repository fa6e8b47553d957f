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
fn invalid_text_is_an_error() {
    for text in [
        "verlet(nbs",
        "skin(nbs)",
        "verlet",
        "verlet(nbx)",
        "verlet()",
        "verlet(nbs,skin=-1)",
        "verlet(nbs,skin=nan)",
        "verlet(nbs,skin=inf)",
        "verlet(nbs,rule=never)",
        "verlet(nbs,skin=auto,rule=every-5)",
        "verlet(nbs,skin=auto,rule=lammps-0-1-yes)",
        "verlet(nbs,margin=0.1)",
        "verlet(nbs,skin=1,skin=2)",
        "verlet(nbs,rule=summed,rule=top-two)",
    ] {
        assert!(parse(text).is_err(), "{text}");
    }
}
