//! Splits a record of two builds into one record per build.

use crate::record::row::Row;

pub struct Builds {
    pub base: Vec<Row>,
    pub this: Vec<Row>,
}

impl Builds {
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
