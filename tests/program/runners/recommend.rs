//! `recommend`.

use std::path::Path;

use serde_json::Value;

use crate::common::run;

fn recommended(folder: &Path, seconds: &str, arguments: &[&str]) -> Value {
    let ended = run(folder, &[&["recommend", "--json", "--seconds", seconds], arguments].concat());
    assert_eq!((ended.code, &*ended.stderr), (Some(0), ""), "{arguments:?}: {}", ended.stdout);
    serde_json::from_str(&ended.stdout).unwrap()
}

#[test]
fn recommend_names_one_and_says_why_not_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let answer =
        recommended(folder.path(), "3", &["pack-c:n=2500,s=100", "--memory-limit", "300000"]);
    let detectors = answer["detectors"].as_array().unwrap();
    let of = |name: &str| {
        detectors
            .iter()
            .find(|detector| detector["detector"] == name)
            .unwrap_or_else(|| panic!("no {name}"))
    };
    for name in ["direct", "nbs", "sorting", "streamed-nbs", "kd-tree"] {
        of(name);
    }
    assert!(detectors.iter().all(|detector| detector["detector"] != "nothing" && detector["detector"] != "nbs-twin"));
    // An array over cells does not fit.
    let refused = of("screening");
    assert!(
        refused["outcome"] == "refused"
            && refused["reason"].as_str().unwrap().contains("the limit is 300000"),
        "{refused}"
    );
    assert!(refused["ns_per_particle"].is_null());
    let choice = of(answer["use"].as_str().unwrap());
    assert!(
        choice["outcome"] == "ok"
            && choice["peak_bytes"].as_u64().is_some()
            && choice["errors"]["missed"] == 0,
        "{choice}"
    );
    let time = &choice["ns_per_particle"];
    assert!(
        time["low"].as_f64() <= time["median"].as_f64()
            && time["median"].as_f64() <= time["high"].as_f64(),
        "{time}"
    );
    // It is the leanest of those that cannot be told apart and are not much slower.
    let blocks = |detector: &Value| detector["ns_per_particle"]["blocks"].as_u64();
    assert_eq!(blocks(choice), answer["blocks"].as_u64());
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
    assert_eq!(
        (&answer["n"], &answer["contacts"], &answer["dim"]),
        (&2500.into(), &0.into(), &2.into())
    );
    let because = answer["because"].as_str().unwrap();
    assert!(because.contains("; exact\n") && because.contains("decides nothing"), "{because}");
}

#[test]
fn recommend_takes_files_dimensions_and_arithmetics() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    crate::common::file(folder, "discs.csv", "x,y\n0,0\n1,0\n5,0\n");
    let answer = recommended(
        folder,
        "0.5",
        &["discs.csv", "--radius", "0.5", "--arithmetic", "f32", "--threads", "2"],
    );
    assert_eq!(
        (&answer["n"], &answer["contacts"], &answer["arithmetic"]),
        (&3.into(), &1.into(), &"f32".into())
    );
    assert_eq!(recommended(folder, "0.5", &["loose:dim=3,n=300"])["dim"], 3);
    assert!(recommended(folder, "0.5", &["hard:case=shrink-then-grow,dim=3"])["use"].is_string());
    // In words.
    let ended = run(folder, &["recommend", "packed:n=400", "--seconds", "0.3"]);
    assert_eq!((ended.code, &*ended.stderr), (Some(0), ""), "{}", ended.stdout);
    let last = ended.stdout.split("\n\nuse ").nth(1).unwrap();
    assert!(
        last.contains(" ns per particle in this run")
            && last.contains(" bytes per particle; exact"),
        "{last}"
    );
    assert!(ended.stdout.starts_with("packed:n=400: 400 discs, "), "{}", ended.stdout);
    for (arguments, words) in [
        (vec!["recommend"], "name a particle file, or a scene"),
        (vec!["recommend", "none.csv"], "none.csv"),
        (vec!["recommend", "packed:n=0x"], "n is '0x'"),
        (vec!["recommend", "loose:n=0"], "the scene has no particles"),
        (vec!["recommend", "packed", "--seconds", "0"], "--seconds 0: give a number from"),
        (vec!["recommend", "packed", "--threads", "0"], "--threads 0: give a number from"),
        (vec!["recommend", "packed", "--radius", "1"], "belong to files"),
    ] {
        let ended = run(folder, &arguments);
        assert!(
            ended.code == Some(2) && ended.stderr.contains(words),
            "{arguments:?}: {:?} {}",
            ended.code,
            ended.stderr
        );
    }
}
