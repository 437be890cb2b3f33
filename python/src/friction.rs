//! Friction of one runner.

use std::path::PathBuf;

use kufe::jobs::simulate::stated_conditions;
use kufe::jobs::slide::friction_table as solved_table;
use kufe::jobs::{DrivingConditions, FrictionLaw};
use kufe_contact::Options;
use pyo3::prelude::*;

use crate::array::list;
use crate::contact::loaded_case;
use crate::error::raised;
use crate::json::to_python;
use crate::work::work;

/// Solves a contact and evaluates a friction law at its peak pressure; returns a dictionary, as
/// `kufe friction --json` prints it.
///
/// `case` is as for `press`, `v_mps` the speed [m/s], `alpha_rad` the slip angle [rad]; `model` is
/// the `model.toml` whose friction and effects apply, or the published law where absent. `ice_c`,
/// `air_c` [C], `air_pa` [Pa] and `humidity_pct` are needed only by effects that depend on them.
#[pyfunction]
#[pyo3(signature = (
    case,
    v_mps,
    *,
    alpha_rad = 0.0,
    model = None,
    ice_c = None,
    air_c = None,
    air_pa = None,
    humidity_pct = None,
    progress = None,
))]
#[allow(clippy::too_many_arguments)] // keywords in Python
pub fn friction<'py>(
    py: Python<'py>,
    case: &Bound<'py, PyAny>,
    v_mps: f64,
    alpha_rad: f64,
    model: Option<PathBuf>,
    ice_c: Option<f64>,
    air_c: Option<f64>,
    air_pa: Option<f64>,
    humidity_pct: Option<f64>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let loaded = loaded_case(case)?;
    let stated = [ice_c, air_c, air_pa, humidity_pct, None, None];
    let conditions = DrivingConditions {
        v_mps,
        alpha_rad,
        environment: stated_conditions(stated).map_err(raised)?,
    };
    let found = work(py, progress, move |watch, _| {
        let law = match &model {
            Some(path) => FrictionLaw::of_model(path)?,
            None => FrictionLaw::published(),
        };
        law.solve(&loaded, &conditions, watch)
    })?;
    to_python(py, &found)
}

/// Solves the friction of groove and melt film at every speed [m/s] on ice of every temperature
/// [C]; returns a list of dictionaries, one per point, temperature by temperature.
///
/// `case` is as for `press`; the other keys of its `[sliding]` apply at every point. Where a
/// requested accuracy is not reached, `NotConvergedError.best` is this list.
#[pyfunction]
#[pyo3(signature = (case, v_mps, ice_c, *, progress = None))]
pub fn friction_table<'py>(
    py: Python<'py>,
    case: &Bound<'py, PyAny>,
    v_mps: &Bound<'py, PyAny>,
    ice_c: &Bound<'py, PyAny>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let loaded = loaded_case(case)?;
    let (v_mps, ice_c) = (list(v_mps, "v_mps")?, list(ice_c, "ice_c")?);
    let table = work(py, progress, move |watch, reporter| {
        let options = Options {
            stop: Some(reporter.stop.clone()),
            ..Options::default()
        };
        solved_table(&loaded, &v_mps, &ice_c, watch, &options)
    })?;
    let points = to_python(py, &table.points)?;
    let Some(short) = table.short else {
        return Ok(points);
    };
    let error = raised(short);
    error.value(py).setattr("best", points)?;
    Err(error)
}
