//! The Python package `kufe`: the jobs of the command as functions on NumPy arrays.
//!
//! | module | what it binds |
//! |---|---|
//! | `contact` | `Case`, `press`, `slide`, `Contact` |
//! | `hull` | `Hull`, `check_hull` |
//! | `friction` | `friction`, `friction_table` |
//! | `table` | `Table`, `fill_table` |
//! | `simulation` | `simulate`, `Simulation` |
//! | `replay` | `replay`, `Replay` |
//! | `lateral` | `fit`, `Fit`, `validate`, `Validation` |
//! | `evaluation` | `evaluate`, `Evaluation` |
//! | `recordings` | `import_runs`, `report` |
//! | `discovery` | `discover`, `Discovery` |
//! | `error` | failures as exceptions, which `kufe/_errors.py` defines |
//! | `array` | arguments that are numbers, lists or names |
//! | `work` | running a job without the interpreter's lock, Ctrl-C in time |
//! | `folder` | a new folder that receives all files or none |

mod array;
mod contact;
mod discovery;
mod error;
mod evaluation;
mod folder;
mod friction;
mod hull;
mod json;
mod lateral;
mod recordings;
mod replay;
mod simulation;
mod table;
mod work;

/// The compiled half of the package.
#[pyo3::pymodule]
mod _kufe {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::contact::{Case, Contact, press, slide};
    #[pymodule_export]
    use crate::discovery::{Discovery, discover};
    #[pymodule_export]
    use crate::evaluation::{Evaluation, evaluate};
    #[pymodule_export]
    use crate::friction::{friction, friction_table};
    #[pymodule_export]
    use crate::hull::{Hull, HullCheck, check_hull};
    #[pymodule_export]
    use crate::lateral::{Fit, Validation, fit, validate};
    #[pymodule_export]
    use crate::recordings::{import_runs, report};
    #[pymodule_export]
    use crate::replay::{Replay, replay};
    #[pymodule_export]
    use crate::simulation::{Simulation, simulate};
    #[pymodule_export]
    use crate::table::{Table, fill_table};

    #[pymodule_init]
    fn version(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
