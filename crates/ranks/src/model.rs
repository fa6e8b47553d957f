//! Predicts the time of a step on more ranks than were measured.
//!
//! ```text
//! search(R) = s (own + h) + latency (log2 R, rounded up, + messages) + h b / bandwidth
//! step(R)   = search(R) + measured step - search(measured R)
//! ```
//!
//! s is the measured search time per particle, own or received, while no other rank works: the
//! longest time over the most particles, because ranks are assumed to be alike. h is the measured
//! number of particles that cross a border; b is the bytes of one particle.
//!
//! A scene that grows along its slabs keeps h. In a scene that keeps its shape, h grows like the
//! area of a slab, N^((D - 1) / D). A rank sends one message, or one for each slab that a layer of
//! h particles covers. The sizes of messages are exchanged first, in log2 R steps.
//!
//! The search model omits the pass before the search, shared memory and cores, and unequal slabs.
//! Their part of the measured step is added unchanged to every predicted step. Steps are predicted
//! for at most [`FARTHEST`] times the measured ranks.

use serde::Serialize;

use super::Row;

/// Maximum ratio of predicted to measured ranks.
pub const FARTHEST: u64 = 64;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Network {
    /// Seconds from sending an empty message to its arrival.
    pub latency_s: f64,
    /// Bytes per second that one rank sends.
    pub bytes_per_s: f64,
}

/// Parses `2e-6,12.5e9`: latency in seconds, then bytes per second.
impl std::str::FromStr for Network {
    type Err = String;

    fn from_str(text: &str) -> Result<Network, String> {
        let numbers = text.split_once(',').and_then(|(latency, rate)| {
            Some([latency.trim().parse::<f64>().ok()?, rate.trim().parse::<f64>().ok()?])
        });
        match numbers {
            Some([latency_s, bytes_per_s])
                if latency_s >= 0.0 && latency_s.is_finite() && bytes_per_s > 0.0 =>
            {
                Ok(Network { latency_s, bytes_per_s })
            }
            _ => Err("it must be seconds and bytes per second, such as 2e-6,12.5e9".into()),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Step {
    pub ranks: u64,
    pub n: f64,
    pub halo: f64,
    pub ms: f64,
    /// Time of a single rank that owns equally many particles, divided by `ms`.
    pub efficiency: f64,
    /// Time that the search model alone predicts.
    pub search_ms: f64,
}

/// Growth of the scene with the number of ranks; the particles per rank stay the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Growth {
    Long,
    /// Grows in all directions, so that the scene keeps its shape.
    Alike,
}

/// Predicts the step on `ranks` ranks from a measured row. `one_ms` is the measured step of a
/// single rank with equally many own particles; without it the model estimates this step. Returns
/// `None` if the row is of one rank, or `ranks` exceeds [`FARTHEST`] times the ranks of the row.
pub fn step(
    row: &Row,
    one_ms: Option<f64>,
    network: Network,
    growth: Growth,
    ranks: u64,
) -> Option<Step> {
    if ranks > FARTHEST * row.ranks as u64 {
        return None;
    }
    let of = |ranks| search(row, network, growth, ranks);
    let (found, measured, one) = (of(ranks)?, of(row.ranks as u64)?, of(1)?);
    let one_ms = one_ms.unwrap_or(one.ms);
    let beside = row.step_ms - measured.ms;
    let ms = if ranks == 1 { one_ms } else { found.ms + beside };
    Some(Step { ms, efficiency: one_ms / ms, ..found })
}

/// Predicts the time of the search on `ranks` ranks and of their messages only.
fn search(row: &Row, network: Network, growth: Growth, ranks: u64) -> Option<Step> {
    // In a periodic box the last slab meets the first.
    let borders = if row.around { row.ranks } else { row.ranks.checked_sub(1)? };
    if row.ranks < 2 || row.n == 0 {
        return None;
    }
    let own = row.n as f64 / row.ranks as f64;
    let n = own * ranks as f64;
    let measured = row.sent as f64 / borders as f64;
    let area = match growth {
        Growth::Long => 1.0,
        Growth::Alike => (n / row.n as f64).powf((row.dim as f64 - 1.0) / row.dim as f64),
    };
    let halo = if ranks > 1 { measured * area } else { 0.0 };
    let each_ms = row.alone_ms / (row.own[1] + row.halo_most) as f64;
    let bytes = row.sent_bytes as f64 / (row.sent as f64).max(1.0);
    let messages = if ranks > 1 { (halo / own).ceil() + (ranks as f64).log2().ceil() } else { 0.0 };
    let network_ms = 1e3 * (network.latency_s * messages + halo * bytes / network.bytes_per_s);
    let ms = each_ms * (own + halo) + network_ms;
    Some(Step { ranks, n, halo, ms, efficiency: each_ms * own / ms, search_ms: ms })
}

#[cfg(test)]
mod tests {
    use super::*;

    const NETWORK: Network = Network { latency_s: 1e-3, bytes_per_s: 1e6 };

    /// A row of two ranks with a thousand spheres each, of which a hundred cross the border.
    fn row() -> Row {
        Row {
            scene: "packed".into(),
            n: 2000,
            dim: 3,
            detector: "nbs".into(),
            kind: "threads",
            ranks: 2,
            along: 0,
            around: false,
            own: [1000, 1000],
            halo_most: 100,
            sent: 100,
            sent_bytes: 2800,
            sent_bytes_most: 2800,
            partners_most: 1,
            alone_over_step: None,
            alone_over_search: None,
            revision: None,
            dirty: None,
            machine: String::new(),
            step_ms: 1.0,
            exchange_ms: 0.1,
            search_ms: 0.9,
            alone_ms: 1.1,
            memory_most: 1,
            pairs: 1,
            digest: String::new(),
            whole: None,
        }
    }

    #[test]
    fn predicted_steps_follow_the_formula() {
        let one = search(&row(), NETWORK, Growth::Alike, 1).unwrap();
        assert_eq!((one.halo, one.efficiency), (0.0, 1.0));
        assert!((one.ms - 1.0).abs() < 1e-12);
        let long = search(&row(), NETWORK, Growth::Long, 8).unwrap();
        assert_eq!((long.n, long.halo), (8000.0, 100.0));
        // Expect 1.1 ms of search, four messages of 1 ms, and 2.8 ms of transfer.
        assert!((long.ms - (1.1 + 4.0 + 2.8)).abs() < 1e-9, "{long:?}");
        // Eight times the particles in the same shape have four times the area.
        let alike = search(&row(), NETWORK, Growth::Alike, 16).unwrap();
        assert!((alike.halo - 400.0).abs() < 1e-9, "{alike:?}");
        // These slabs are thinner than the halo, so there are more messages.
        let thin = search(&row(), NETWORK, Growth::Alike, 1 << 20).unwrap();
        assert!(thin.halo > thin.n / 1048576.0 && thin.efficiency < 0.02, "{thin:?}");
        assert_eq!(search(&Row { ranks: 1, ..row() }, NETWORK, Growth::Long, 8), None);
    }

    #[test]
    fn a_predicted_step_starts_from_the_measured_one() {
        let row = Row { step_ms: 8.0, ..row() };
        let at = |one_ms, ranks| step(&row, one_ms, NETWORK, Growth::Long, ranks);
        // The model alone gives 1.1 + 2.0 + 2.8 ms, but 8 ms are measured. The difference of 2.1 ms
        // is added for any number of ranks.
        let measured = at(Some(4.0), 2).unwrap();
        assert!((measured.search_ms - 5.9).abs() < 1e-9 && (measured.ms - 8.0).abs() < 1e-9);
        assert!((measured.efficiency - 0.5).abs() < 1e-9, "{measured:?}");
        assert!((at(Some(4.0), 8).unwrap().ms - (7.9 + 2.1)).abs() < 1e-9);
        assert_eq!(at(Some(4.0), 1).unwrap().ms, 4.0);
        assert!((at(None, 1).unwrap().ms - 1.0).abs() < 1e-9);
        assert!(at(None, 128).is_some() && at(None, 129).is_none());
    }

    #[test]
    fn networks_are_two_numbers() {
        assert_eq!("1e-3, 1e6".parse(), Ok(NETWORK));
        for text in ["", "1", "-1,1", "1,0", "nan,1", "1,2,3"] {
            assert!(text.parse::<Network>().is_err(), "{text}");
        }
    }
}
