//! The box of an npz archive: `box`, `cell`, `lattice` or `L`, with `pbc` or `periodic`.

use anyhow::{Context, bail};

use crate::boxes;
use crate::columns::Column;
use crate::formats::npy::{self, Header};
use crate::options::Options;
use crate::raw::lines::{Source, among, short};
use crate::types::Declared;

const BOXES: &str = "box cell lattice l";
const FLAGS: &str = "pbc periodic";

#[derive(Default)]
pub(super) struct Cell {
    vectors: Option<BoxArray>,
    periodic: Option<[bool; 3]>,
}

struct BoxArray {
    values: Vec<f64>,
    shape: Vec<u64>,
    label: String,
}

impl Cell {
    pub fn is_named(label: &str) -> bool {
        let label = label.to_ascii_lowercase();
        among(BOXES, &label) || among(FLAGS, &label)
    }

    pub fn take(
        &mut self,
        source: &mut Source<'_>,
        header: &mut Header,
        label: &str,
        options: Options,
    ) -> anyhow::Result<()> {
        if options.boundaries.open || options.boundaries.edges.is_some() {
            return Ok(());
        }
        let is_flags = among(FLAGS, &label.to_ascii_lowercase());
        let place = source.name;
        let what = format!("{place}: '{}' is {}", short(label), header.words());
        let values = npy::list(source, header, label, Column::Axis(0))?;
        let shape = header.sizes.clone();
        if is_flags {
            let all: Option<Vec<bool>> = values
                .iter()
                .map(|&value| (value == 0.0 || value == 1.0).then_some(value == 1.0))
                .collect();
            self.periodic = Some(match (&shape[..], all.as_deref()) {
                ([] | [1], Some(&[all])) => [all; 3],
                ([2], Some(&[x, y])) => [x, y, false],
                ([3], Some(&[x, y, z])) => [x, y, z],
                _ => bail!("{what}; it must have true or false for each axis: give --periodic"),
            });
            return Ok(());
        }
        if let Some(BoxArray { label: other, .. }) = &self.vectors {
            bail!("{place}: '{}' and '{other}' are both the box; give --box", short(label));
        }
        let label = short(label);
        self.vectors = Some(BoxArray { values, shape, label });
        Ok(())
    }

    /// Returns the box of a frame. `frame` is the index of the frame and the number of frames.
    pub fn declared(
        &self,
        frame: Option<[u64; 2]>,
        name: &str,
        options: Options,
    ) -> anyhow::Result<Option<Declared>> {
        let periodic = self.periodic;
        let Some(BoxArray { values, shape, label }) = &self.vectors else {
            return Ok(periodic.map(|_| Declared { periodic, ..Declared::default() }));
        };
        if options.boundaries.open || options.boundaries.edges.is_some() {
            return Ok(None);
        }
        let (mut values, mut one) = (&values[..], &shape[..]);
        if let (Some([k, frames]), [first, rest @ ..]) = (frame, &shape[..])
            && *first == frames
            && !rest.is_empty()
            && !matches!(shape[..], [2, 2] | [3, 3])
        {
            let length = values.len() / (frames as usize).max(1);
            (values, one) = (&values[k as usize * length..][..length], rest);
        }
        let all = match (one, values) {
            ([] | [1], &[a]) => vec![a; 3],
            ([2] | [3] | [2, 2] | [3, 3], _) => values.to_vec(),
            _ => Vec::new(),
        };
        let vectors = boxes::vectors(&all).with_context(|| {
            format!(
                "{name}: '{label}' has the shape {}, and is not known to be a box: edges (3,) or \
                 vectors (3, 3), in two dimensions (2,) or (2, 2); give --box LX,LY,LZ, or --open",
                npy::shape(shape)
            )
        })?;
        Ok(Some(Declared { vectors: Some(vectors), periodic, ..Declared::default() }))
    }
}
