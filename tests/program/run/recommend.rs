use crate::common::Place;

#[test]
fn recommend_names_one_and_why_not_the_others() {
    let at = Place::new();
    let answer = at.json("recommend --seconds 3 pack-c:n=2500,s=100 --memory-limit 300000");
    let detectors = answer["detectors"].as_array().unwrap();
    let find = |name: &str| detectors.iter().find(|detector| detector["detector"] == name);
    let of = |name: &str| find(name).unwrap_or_else(|| panic!("no {name}"));
    for name in ["direct", "nbs", "sorting", "streamed-nbs", "kd-tree"] {
        of(name);
    }
    assert!(find("nothing").is_none() && find("nbs-twin").is_none());
    // screening refuses, because its array over cells exceeds the memory limit.
    let refused = of("screening");
    assert_eq!(refused["outcome"], "refused");
    assert!(refused["reason"].as_str().unwrap().contains("300000"), "{refused}");
    assert!(refused["ns_per_particle"].is_null());
    let choice = of(answer["use"].as_str().unwrap());
    assert_eq!((&choice["outcome"], &choice["errors"]["missed"]), (&"ok".into(), &0.into()));
    let time = &choice["ns_per_particle"];
    let times = ["low", "median", "high"].map(|it| time[it].as_f64().unwrap());
    assert!(times.is_sorted(), "{time}");
    // The choice needs the least memory of the undecided detectors that are not much slower.
    assert_eq!(time["blocks"], answer["blocks"]);
    for name in answer["cannot_tell_apart"].as_array().unwrap() {
        let tied = of(name.as_str().unwrap());
        assert!(
            tied["ratio_to_fastest"]["median"].as_f64() > Some(1.2)
                || tied["peak_bytes"].as_u64() >= choice["peak_bytes"].as_u64(),
            "{name}"
        );
    }
    if let Some(next) = answer["next"].as_object() {
        assert!(next["ratio"]["median"].as_f64() > Some(1.0), "{next:?}");
    }
    assert_eq!([&answer["n"], &answer["contacts"], &answer["dim"]], [2500, 0, 2]);
}
