//! The experiments that are part of the program. On the command line, a name that is not a file
//! refers to one of them.

use std::path::Path;

use anyhow::{Context, anyhow};

use crate::plan;
use contactbench_record::experiment::Experiment;
use contactbench_scenes::spec::GENERATORS;
use contactbench_terms::nearest::hint;

pub const FILES: &[(&str, &str)] = &crate::files! { "/experiments/", ".toml":
    "scaling" "book" "arithmetic" "speed-error" "hard-cases" "vectors" "scale" "sizes" "periodic"
    "motion" "rebuilds" "peers" "neighbours" "codes"
};

pub fn names() -> impl Iterator<Item = &'static str> {
    FILES.iter().map(|(name, _)| *name)
}

pub fn all() -> anyhow::Result<Vec<Experiment>> {
    FILES.iter().map(|(name, text)| parse(name, text)).collect()
}

pub fn find(name: &str) -> anyhow::Result<(Experiment, String)> {
    if let Some((name, text)) = FILES.iter().find(|(known, _)| *known == name) {
        return Ok((parse(name, text)?, text.to_string()));
    }
    let path = Path::new(name);
    if !path.exists() {
        let known: Vec<&str> = names().collect();
        if GENERATORS.iter().any(|it| name.split(':').next() == Some(it.name)) {
            return Err(anyhow!(
                "'{name}' is a scene, not an experiment: try `contactbench recommend {name}`, or \
                 write it into an experiment as [[scene]] (docs/EXPERIMENTS.md)"
            ));
        }
        return Err(anyhow!(
            "there is no experiment '{name}'{}; it is neither a file nor one of {}",
            hint(name.trim_end_matches(".toml"), known.iter().copied()),
            known.join(", ")
        ));
    }
    let read = plan::read(path);
    if path.extension().is_some_and(|ending| ending == "toml") {
        return read;
    }
    read.map_err(|error| {
        anyhow!("{error:#} (an experiment; for a file of particles: contactbench recommend {name})")
    })
}

fn parse(name: &str, text: &str) -> anyhow::Result<Experiment> {
    plan::parse(text, Path::new("experiments"))
        .with_context(|| format!("in experiments/{name}.toml"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use contactbench_record::experiment::claims::Set;

    #[test]
    fn every_file_is_in_the_list_and_well_formed() {
        let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("experiments");
        let mut files: Vec<String> = std::fs::read_dir(folder)
            .unwrap()
            .map(|f| f.unwrap().file_name().into_string().unwrap())
            .collect();
        let mut listed: Vec<String> =
            FILES.iter().map(|(name, _)| format!("{name}.toml")).collect();
        files.sort();
        listed.sort();
        assert_eq!(files, listed);
        for (experiment, (name, _)) in all().unwrap().iter().zip(FILES) {
            assert_eq!(experiment.name, *name);
            let unsaid = experiment.claims.iter().find(|claim| claim.set == Set::Unknown);
            assert!(unsaid.is_none(), "{name}: set = ... is missing: {unsaid:?}");
            assert!(experiment.planned.quick.len() <= 18, "{name}: a quick run has few scenes");
        }
    }
}
