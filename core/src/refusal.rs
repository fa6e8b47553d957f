//! Why a detector will not work on a scene, in one sentence with the limit and a remedy.

/// Why a detector will not work on a scene. Nothing was reported; arrays whose size is known
/// beforehand were not allocated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs)] // the fields are explained by the messages
pub enum Refusal {
    /// The arrays would be larger than the limit.
    #[error(
        "{detector} needs {needed} bytes for this scene ({shape}), the limit is {limit}; raise \
         the memory limit, or use another detector: sorting is the leanest, direct needs nothing"
    )]
    Memory { detector: &'static str, needed: u64, limit: u64, shape: String },
    /// There are more pairs than a list may hold, or could; they were counted.
    #[error(
        "{particles} particles have {found} touching pairs, {} each, and a list of them may not \
         take more than {room} bytes; are the radii in another unit than the coordinates, or \
         particles there twice? If not, raise the memory limit",
        count(2.0 * *found as f64 / *particles as f64)
    )]
    Pairs { found: u64, particles: u64, room: u64 },
    /// There will be more pairs than a list may hold: a sample of the particles says so.
    #[error(
        "each of the {particles} particles touches about {} others, which makes some {:.1e} \
         pairs, and a list of them may not take more than {limit} bytes; are the radii in another \
         unit than the coordinates, or particles there twice? If not, raise the memory limit",
        count(*each), 0.5 * each * *particles as f64
    )]
    Crowd { particles: u64, each: f64, limit: u64 },
    /// Cells cannot be told apart or addressed.
    #[error(
        "the scene spans {cells:.3e} cells of edge {edge:e} along {axis} ({low:e} to {high:e}), a \
         grid can address 2^31; remove far-away particles, or use kd-tree"
    )]
    Domain { axis: &'static str, low: f64, high: f64, edge: f64, cells: f64 },
    /// The largest difference of two coordinates along an axis overflows.
    #[error(
        "along {axis} the scene reaches from {low:e} to {high:e}, and the difference overflows; \
         scale the scene down, or use kd-tree"
    )]
    Extent { axis: &'static str, low: f64, high: f64 },
    /// More particles than the lists can number.
    #[error("{detector} numbers at most {limit} particles, the scene has {n}; use direct")]
    Particles { detector: &'static str, n: u64, limit: u64 },
    /// The square of a diameter overflows in the arithmetic asked for.
    #[error(
        "the square of the largest diameter {diameter:e} overflows in {precision}; use \
         exact arithmetic, or smaller units"
    )]
    Overflow { diameter: f64, precision: &'static str },
    /// The processor lacks the vector instructions asked for.
    #[error(
        "this processor does not have the instructions level={level} asks for, only {}; leave \
         out level to use the widest", has.join(" and ")
    )]
    Instructions { level: String, has: Vec<&'static str> },
    /// The library behind a peer cannot be trusted with the scene.
    #[error("{detector}: {reason}")]
    Library { detector: &'static str, reason: String },
}

impl Refusal {
    /// The same, of a detector that does its work by another one.
    pub(crate) fn of(self, name: &'static str) -> Refusal {
        match self {
            Refusal::Memory { needed, limit, shape, .. } => {
                Refusal::Memory { detector: name, needed, limit, shape }
            }
            other => other,
        }
    }

    /// The pairs of the scene are too many, for every detector alike.
    pub fn is_of_scene(&self) -> bool {
        matches!(self, Refusal::Pairs { .. } | Refusal::Crowd { .. })
    }
}

/// A number of contacts, to be read.
fn count(each: f64) -> String {
    if each < 10.0 { format!("{each:.1}") } else { format!("{each:.0}") }
}
