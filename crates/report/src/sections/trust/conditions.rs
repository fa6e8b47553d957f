use contactbench_record::cells::state::SLOW;
use contactbench_record::findings::trust::conditions::{Conditions, Load};
use contactbench_record::findings::trust::modes::Modes;
use contactbench_record::record::folder::ledger::{Ledger, Process};
use contactbench_terms::number::{number, percent, plural};

pub fn sentence(conditions: &Conditions) -> Option<String> {
    let doubts = &conditions.doubts;
    let said = || format!("do not quote the times of this record: {}", doubts.join("; "));
    (!doubts.is_empty()).then(said)
}

pub fn modes(modes: Modes) -> Option<String> {
    modes.are_many().then(|| {
        format!(
            "do not quote single times of this record: in {} of {} the machine changed its speed, \
             as medians differ from paired ratios, or twins from each other, by 15% or more",
            modes.scenes,
            plural(modes.of, "scene")
        )
    })
}

pub fn machine(conditions: &Conditions) -> impl Iterator<Item = String> {
    [load(conditions), states(conditions)].into_iter().flatten()
}

fn load(conditions: &Conditions) -> Option<String> {
    match &conditions.load {
        Load::Unknown => None,
        Load::Before(load) => Some(format!("The load average before the run was {load}.")),
        Load::Watched { seconds, others, stolen } => Some(format!(
            "During the {} s of timing, other processes used {} of a core, and the host took away \
             {} of one.",
            number(*seconds),
            percent(*others),
            percent(*stolen)
        )),
    }
}

fn states(conditions: &Conditions) -> Option<String> {
    let (slow, all) = conditions.slow;
    (all > 0).then(|| {
        format!(
            "The machine was slow in {} of {}: a test loop next to the sample took over {SLOW} \
             times as long as in the quietest tenth. Times are medians of all samples; quiet times \
             are medians of the others.",
            percent(slow as f64 / all as f64),
            plural(all, "timed sample")
        )
    })
}

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
