//! Measures other load on the machine: processor time of other processes, and time that the host of
//! a virtual machine took away.
//!
//! The load average includes the run's own processes and the minute before, so it is not used. The
//! time of other processes is the time of all cores, minus idle time, stolen time, and time of
//! harness and runners. It is measured over the blocks of a scene, which last seconds. The system's
//! clocks have 100 ticks per second, too coarse for a sample of two milliseconds.

use std::time::{Instant, SystemTime};

use contactbench_record::record::folder::ledger::Span;
use contactbench_terms::mix::splitmix64;

pub(crate) struct Watch {
    pub id: String,
    began: Instant,
    before: Times,
    load: Option<f64>,
}

/// Times in seconds over all cores, since the start of the machine (`own`: of the harness).
#[derive(Clone, Copy, Debug, PartialEq)]
struct Times {
    cores: u64,
    idle: f64,
    stolen: f64,
    own: f64,
}

impl Watch {
    /// Starts measuring; `None` if the system does not report these times (only Linux does).
    pub fn start() -> Option<Watch> {
        let before = now()?;
        let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        let random = splitmix64(since.as_nanos() as u64 ^ u64::from(std::process::id()) << 32);
        let id = format!("{:08x}", random >> 32);
        Some(Watch { id, began: Instant::now(), before, load: load() })
    }

    pub fn end(self, scene: String) -> Option<Span> {
        let seconds = self.began.elapsed().as_secs_f64();
        let span = between(self.before, now()?, seconds);
        Some(Span { id: self.id, scene, load_before: self.load, load_after: load(), ..span })
    }
}

fn between(before: Times, after: Times, seconds: f64) -> Span {
    // Counters jump when a virtual machine is moved, and processors may be taken away.
    let cores = before.cores.max(after.cores);
    let most = cores as f64 * seconds;
    let of = |which: fn(&Times) -> f64| (which(&after) - which(&before)).clamp(0.0, most);
    let (idle, stolen_s, own_s) = (of(|it| it.idle), of(|it| it.stolen), of(|it| it.own));
    let others = most - idle - stolen_s - own_s;
    let round = |seconds: f64| (seconds * 1e3).round() / 1e3;
    Span {
        seconds: round(seconds),
        cores,
        own_s: round(own_s),
        others_s: round(others.max(0.0)),
        stolen_s: round(stolen_s),
        ..Span::default()
    }
}

#[cfg(target_os = "linux")]
fn now() -> Option<Times> {
    let read = |path| std::fs::read_to_string(path).ok();
    let tick = 1.0 / rustix::param::clock_ticks_per_second() as f64;
    times(&read("/proc/stat")?, &read("/proc/self/stat")?, tick)
}

#[cfg(not(target_os = "linux"))]
fn now() -> Option<Times> {
    None
}

fn load() -> Option<f64> {
    std::fs::read_to_string("/proc/loadavg").ok()?.split(' ').next()?.parse().ok()
}

/// Parses `/proc/stat` and `/proc/self/stat`, whose ticks last `tick` seconds.
#[cfg(any(target_os = "linux", test))]
fn times(all: &str, own: &str, tick: f64) -> Option<Times> {
    let number = |text: &str| text.parse::<u64>().ok();
    let line = all.lines().find_map(|line| line.strip_prefix("cpu "))?;
    // Order of the numbers: user nice system idle iowait irq softirq steal.
    let all_cores: Vec<u64> = line.split_whitespace().map_while(number).collect();
    let core = |line: &&str| line.starts_with("cpu") && !line.starts_with("cpu ");
    let cores = all.lines().filter(core).count() as u64;
    // The program's name, in parentheses, may contain anything. After it come the state, ten
    // numbers, and the user and system time of the process and of its ended children.
    let fields: Vec<&str> = own.rsplit_once(')')?.1.split_whitespace().collect();
    let used: Vec<u64> = fields.get(11..15)?.iter().map_while(|text| number(text)).collect();
    let seconds = |ticks: &[u64]| ticks.iter().sum::<u64>() as f64 * tick;
    Some(Times {
        cores,
        idle: seconds(all_cores.get(3..5)?),
        stolen: seconds(all_cores.get(7..8)?),
        own: seconds(&used),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const STAT: &str = "cpu  100 7 30 1000 50 1 2 40 9 9\ncpu0 50 7 30 500 50 1 2 40 9 9\n\
                        cpu1 50 0 0 500 0 0 0 0 0 0\nintr 5\n";
    const SELF: &str = "7 (a ) b) S 1 7 7 0 -1 4194560 1 2 3 4 11 5 20 4 20 0 1 0 99";

    #[test]
    fn what_the_system_says_is_read() {
        let found = times(STAT, SELF, 0.01).unwrap();
        assert_eq!(found, Times { cores: 2, idle: 10.5, stolen: 0.4, own: 0.4 });
        for (all, own) in [("", SELF), (STAT, ""), (STAT, "7 (a) S 1"), ("cpu  1 2\n", SELF)] {
            assert_eq!(times(all, own, 0.01), None);
        }
    }

    #[test]
    fn what_is_left_went_to_others() {
        let before = Times { cores: 2, idle: 10.0, stolen: 1.0, own: 5.0 };
        let after = Times { cores: 2, idle: 11.0, stolen: 1.5, own: 13.0 };
        let span = between(before, after, 10.0);
        assert_eq!((span.own_s, span.stolen_s, span.others_s), (8.0, 0.5, 10.5));
        // Negative differences, from clocks that disagree or restart, count as 0.
        let span = between(after, before, 0.1);
        assert_eq!((span.own_s, span.stolen_s, span.others_s), (0.0, 0.0, 0.2));
        assert_eq!(between(before, after, 1.0).others_s, 0.0);
    }

    /// Other processes may be active, so only bounds are tested.
    #[test]
    #[cfg(target_os = "linux")]
    fn own_work_is_own() {
        let watch = Watch::start().unwrap();
        let began = Instant::now();
        while began.elapsed().as_secs_f64() < 0.2 {
            std::hint::black_box(0);
        }
        let span = watch.end("s".into()).unwrap();
        assert!(span.own_s > 0.0 && span.seconds >= 0.2 && span.cores > 0, "{span:?}");
        let had = span.cores as f64 * span.seconds + 0.1;
        assert!(span.own_s + span.others_s + span.stolen_s <= had, "{span:?}");
        assert!(span.load_before.is_some() && span.load_after.is_some());
    }
}
