//! The Python package `hpf`: the library crate `hpf` as Python has it. What is here is names, conversions and threads; no
//! mathematics.
//!
//! | room | what it is |
//! |---|---|
//! | `task`, `policy`, `motion`, `run`, `session`, `controller` | the classes |
//! | `learn`, `imitate` | the functions |
//! | `callable` | a Python callable as the environment |
//! | `desk` | work on a thread of its own, Ctrl-C and progress on the one that called |
//! | `errors` | failures as exceptions, with their places |
//! | `figure` | figures as bytes |

mod callable;
mod controller;
mod desk;
mod errors;
mod figure;
mod imitate;
mod learn;
mod motion;
mod policy;
mod run;
mod session;
mod task;

use std::ffi::OsString;

use pyo3::prelude::*;

/// The program `hpf` with `arguments`, the first of which is its name; returns its exit code.
#[pyfunction]
fn _main(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| hpf_cli::run(arguments))
}

#[pymodule]
fn _hpf(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<task::PyTask>()?;
    module.add_class::<policy::PyPolicy>()?;
    module.add_class::<motion::PyMotion>()?;
    module.add_class::<run::PyRun>()?;
    module.add_class::<session::PySession>()?;
    module.add_class::<controller::PyController>()?;
    module.add_class::<controller::PyCommand>()?;
    module.add_function(wrap_pyfunction!(learn::learn, module)?)?;
    module.add_function(wrap_pyfunction!(learn::resume, module)?)?;
    module.add_function(wrap_pyfunction!(learn::load, module)?)?;
    module.add_function(wrap_pyfunction!(imitate::_imitate, module)?)?;
    module.add_function(wrap_pyfunction!(_main, module)?)?;
    Ok(())
}
