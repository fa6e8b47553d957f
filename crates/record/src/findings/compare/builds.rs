//! A record in which another build took part, as two records: of that build, and of this one.

use crate::record::row::Row;

/// The rows of each build, under the names of the detectors.
pub struct Builds {
    /// Of the build that this one is compared with.
    pub base: Vec<Row>,
    pub this: Vec<Row>,
}

impl Builds {
    /// None where no other build took part.
    pub fn new(rows: &[Row]) -> Option<Builds> {
        let (mut base, mut this) = (Vec::new(), Vec::new());
        for row in rows {
            let mut row = row.clone();
            match row.role.base_of().map(String::from) {
                Some(original) => {
                    row.id.detector = original;
                    base.push(row);
                }
                None if !row.role.is_control() => this.push(row),
                None => {}
            }
        }
        (!base.is_empty()).then_some(Builds { base, this })
    }
}
