//! The native part of the Python package `contactbench`. `contactbench/__init__.py` documents the
//! public part.
#![allow(clippy::type_complexity)]

/// Makes a Python dictionary of fields of a value, or of names and values.
macro_rules! dict {
    ($py:expr, $of:expr => $($field:ident),* $(,)?) => {
        dict!($py; $($field: $of.$field),*)
    };
    ($py:expr; $($name:ident: $value:expr),* $(,)?) => {{
        let out = pyo3::types::PyDict::new($py);
        $(out.set_item(stringify!($name), $value)?;)*
        out
    }};
}

mod check;
mod failure;
mod given;
mod neighbours;
mod recommend;
mod record;
mod search;
mod verify;

use contactbench_run::run::runner::alloc::Counting;

/// Counts memory, as runners must.
#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Native functions of the package `contactbench`.
#[pyo3::pymodule]
mod _contactbench {
    #[pymodule_export]
    use super::check::check;
    #[pymodule_export]
    use super::neighbours::neighbours;
    #[pymodule_export]
    use super::recommend::{recommend, serve};
    #[pymodule_export]
    use super::record::{load, scene};
    #[pymodule_export]
    use super::search::{Search, limit_for};
    #[pymodule_export]
    use super::verify::verify;
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        use contactbench_detectors::table::{DEFAULT, Role, TABLE};
        let detectors = TABLE.iter().filter(|entry| entry.role == Role::Detector);
        super::failure::quiet();
        module.add("Refused", module.py().get_type::<super::failure::Refused>())?;
        module.add("DEFAULT", DEFAULT)?;
        module.add("DETECTORS", detectors.map(|entry| entry.name).collect::<Vec<_>>())?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
