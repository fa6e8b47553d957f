//! Under which conditions a record was made, in words.

use contactbench_record::cells::state::SLOW;
use contactbench_record::findings::conditions::{Conditions, Doubt, Load};
use contactbench_record::record::ledger::{Ledger, Process};
use contactbench_terms::number::{number, plural};

/// Why the times of a record are doubtful, one reason each.
pub fn doubts(conditions: &Conditions) -> Vec<String> {
    conditions.doubts.iter().map(doubt).collect()
}

/// The same in one sentence; none where there is no reason.
pub fn sentence(conditions: &Conditions) -> Option<String> {
    let doubts = doubts(conditions);
    let said = || format!("do not quote the times of this record: {}", doubts.join("; "));
    (!doubts.is_empty()).then(said)
}

fn doubt(doubt: &Doubt) -> String {
    let in_a_scene = |worst: &Option<(String, f64)>| match worst {
        Some((scene, share)) => format!(" ({} during {scene})", percent(*share)),
        None => String::new(),
    };
    match doubt {
        Doubt::Others(mean, worst) => {
            format!("other processes used {} of a core{}", percent(*mean), in_a_scene(worst))
        }
        Doubt::Stolen(mean, worst) => {
            format!("the host took away {} of a core{}", percent(*mean), in_a_scene(worst))
        }
        Doubt::Before(load) => format!("the machine was busy before the run (load {load})"),
        Doubt::Unwatched(rows, all) => {
            let rows = plural(*rows, "row");
            format!("what else the machine did is not known of {rows} of {all} timed")
        }
        Doubt::Dirty => "the program was built from sources that were not committed".into(),
        Doubt::Profile(profile) => format!("the program is a {profile} build"),
        Doubt::Programs(name, count) => {
            format!("{count} different programs of the name {name} were at work")
        }
    }
}

/// What is known of the machine while it was timed: what else it did, and how often it was slow.
pub fn machine(conditions: &Conditions) -> Vec<String> {
    [load(conditions), states(conditions)].into_iter().flatten().collect()
}

/// What else the machine did, whatever it was; none where that is not known.
fn load(conditions: &Conditions) -> Option<String> {
    match &conditions.load {
        Load::Unknown => None,
        Load::Before(load) => Some(format!("The load average before the run was {load}.")),
        Load::Watched { seconds, others, stolen } => Some(format!(
            "While it was timed, {} s in all, other processes used {} of a core, and the host \
             took away {} of one.",
            number(*seconds),
            percent(*others),
            percent(*stolen)
        )),
    }
}

/// How often the machine was slow; none where nobody looked.
fn states(conditions: &Conditions) -> Option<String> {
    let (slow, all) = conditions.slow;
    (all > 0).then(|| {
        format!(
            "In {} of {} the machine was slow: a test loop beside them took over {SLOW} times as \
             long as in the quietest tenth. Times are medians of all samples, quiet times of the \
             other samples.",
            percent(slow as f64 / all as f64),
            plural(all, "timed sample")
        )
    })
}

/// The programs behind the rows, a line each.
pub fn programs(ledger: &Ledger) -> Vec<String> {
    ledger.processes.values().map(program).collect()
}

fn program(process: &Process) -> String {
    let files = process.files.iter().map(|file| match &file.sha256 {
        Some(sum) => format!("{} (SHA-256 {})", file.name, sum.get(..16).unwrap_or(sum)),
        None => file.name.clone(),
    });
    let version = Some(&process.version).filter(|version| !version.is_empty());
    let version = version.map(|version| format!("version {version}"));
    let build = process.build.iter().map(|(name, value)| format!("{name} {value}"));
    let said: Vec<String> = files.chain(version).chain(build).collect();
    format!("{}: {}", process.id, said.join(", "))
}

/// `0.4%`, `35%`.
fn percent(share: f64) -> String {
    let percent = share * 100.0;
    if percent < 9.95 { format!("{percent:.1}%") } else { format!("{percent:.0}%") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_doubtful_is_one_sentence() {
        let said = |doubts: &[Doubt]| {
            sentence(&Conditions { doubts: doubts.to_vec(), ..Conditions::default() })
        };
        assert_eq!(said(&[]), None);
        let worst = Some(("scaling: packed 3D".to_string(), 0.9));
        assert_eq!(
            said(&[Doubt::Others(0.351, worst), Doubt::Stolen(0.03, None), Doubt::Dirty]).unwrap(),
            "do not quote the times of this record: other processes used 35% of a core (90% during \
             scaling: packed 3D); the host took away 3.0% of a core; the program was built from \
             sources that were not committed"
        );
    }
}
