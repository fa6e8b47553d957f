//! `file`: particles from a file.
//!
//! ```text
//!   x,y,r
//!   0,0,0.5        ->   o o
//!   1,0,0.5
//! ```
//!
//! [`contactbench_io`] reads the formats. The file decides the number of particles and the
//! dimension. n = 0 accepts any number; another n must equal the number in the file. `file-dim` is
//! the dimension of an array with three columns; see [`contactbench_io::Options`].

use std::path::Path;

use serde_json::Value;

use crate::generate::table::{Generator, Parameter, ParameterKind, REQUIRED, optional, parameter};
use contactbench_io as io;

pub const NAME: &str = "file";

const fn option(place: usize, name: &'static str, kind: ParameterKind) -> Parameter {
    optional(name, kind, io::OPTIONS[place].meaning)
}

const PARAMS: [Parameter; 9] = [
    parameter("path", ParameterKind::Text, REQUIRED, "the file's name"),
    option(0, "radius", ParameterKind::NOT_NEGATIVE),
    option(1, "file-dim", ParameterKind::DIM),
    option(2, "frame", ParameterKind::Text),
    option(3, "columns", ParameterKind::Text),
    option(4, "format", ParameterKind::Text),
    option(5, "box", ParameterKind::Text),
    option(6, "periodic", ParameterKind::Axes),
    option(7, "open", ParameterKind::Yes),
];

pub const GENERATOR: Generator = Generator {
    name: NAME,
    summary: "a particle file: CSV, XYZ, LAMMPS, YADE, NumPy, VTK or GSD",
    own_n: true,
    params: &[&PARAMS, &[crate::neighbours::NEIGHBOURS]],
    make: |inputs| {
        let path = Path::new(inputs.text("path")?);
        let mut options = io::Options::NONE;
        for (option, Parameter { name, .. }) in io::OPTIONS.iter().zip(&PARAMS[1..]) {
            let text = match inputs.params.get(*name) {
                None => continue,
                Some(Value::String(text)) => text.clone(),
                Some(value) => value.to_string(),
            };
            let set = option.set(&mut options, &text);
            set.map_err(|must| anyhow::anyhow!("file: {name} is '{text}'; {must}"))?;
        }
        let given = io::given(path, options)?;
        inputs.own_n(given)
    },
    ..Generator::PLAIN
};
