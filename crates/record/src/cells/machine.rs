//! Cache sizes of the machine, from the provenance of a record.

use serde_json::Value;

use crate::record::origin::hardware::size_of;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Machine {
    /// Name and bytes of the second- and third-level caches.
    pub caches: Vec<(String, u64)>,
}

impl Machine {
    pub fn from_provenance(provenance: Option<&Value>) -> Machine {
        let field = |name: &str| provenance.and_then(|fields| fields.get(name));
        let size =
            |name: &str| Some((name.to_string(), size_of(field("caches")?.get(name)?.as_str()?)?));
        Machine { caches: ["L2", "L3"].into_iter().filter_map(size).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn caches_are_read_from_provenance() {
        let fields =
            serde_json::json!({"caches": {"L1d": "48K", "L2": "2048K", "L3": "480M"}, "cores": 2});
        let machine = Machine::from_provenance(Some(&fields));
        assert_eq!(machine.caches, [("L2".into(), 2 << 20), ("L3".into(), 480 << 20)]);
        assert_eq!(Machine::from_provenance(None), Machine::default());
    }
}
