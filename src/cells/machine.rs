//! What the provenance of a record says about the machine: the sizes of its caches, and its memory
//! bandwidth where it was measured.

use serde_json::Value;

use crate::record::hardware::size_of;
use crate::record::provenance::Bandwidth;

/// The machine that a record was made on, as far as its provenance says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Machine {
    /// Name and bytes of the second- and third-level caches.
    pub caches: Vec<(String, u64)>,
    /// By number of threads.
    pub bandwidths: Vec<Bandwidth>,
}

impl Machine {
    /// Reads what there is; records of other versions may say less.
    pub fn from_provenance(provenance: Option<&Value>) -> Machine {
        let field = |name: &str| provenance.and_then(|fields| fields.get(name));
        let size =
            |name: &str| Some((name.to_string(), size_of(field("caches")?.get(name)?.as_str()?)?));
        let bandwidths = field("bandwidth_bytes_per_s")
            .and_then(|found| serde_json::from_value(found.clone()).ok());
        Machine {
            caches: ["L2", "L3"].into_iter().filter_map(size).collect(),
            bandwidths: bandwidths.unwrap_or_default(),
        }
    }

    /// The bandwidth that so many threads have.
    pub fn bandwidth(&self, threads: u32) -> Option<&Bandwidth> {
        self.bandwidths.iter().find(|known| known.threads == threads as usize)
    }
}

/// Bytes of one number in a stored scene: its coordinates, and radii where they differ.
pub fn number_bytes(arithmetic: &str) -> u64 {
    if arithmetic == "f32" { 4 } else { 8 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn old_and_new_provenance_are_read() {
        let old =
            serde_json::json!({"caches": {"L1d": "48K", "L2": "2048K", "L3": "480M"}, "cores": 2});
        let machine = Machine::from_provenance(Some(&old));
        assert_eq!(machine.caches, [("L2".into(), 2 << 20), ("L3".into(), 480 << 20)]);
        assert_eq!(machine.bandwidth(1), None);
        let one =
            Bandwidth { threads: 1, array_bytes: 1 << 28, read: 1e10, write: 5e9, triad: 8e9 };
        let new = serde_json::json!({"bandwidth_bytes_per_s": [one]});
        assert_eq!(Machine::from_provenance(Some(&new)).bandwidth(1), Some(&one));
        assert_eq!(Machine::from_provenance(None), Machine::default());
    }
}
