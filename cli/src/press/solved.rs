//! `result.json`: what a solved case is in figures.

use kufe_contact::{CentreLine, centre_line};
use kufe_jobs::field::subsurface;
use kufe_jobs::{Failure, Pressed};
use serde_json::Value;

/// result.json's content, and the centre line where it is asked for.
pub fn document(
    pressed: &Pressed,
    with_subsurface: bool,
) -> Result<(Value, Option<CentreLine>), Failure> {
    let mut document = pressed.document();
    if !with_subsurface {
        return Ok((document, None));
    }
    let line = centre_line(&pressed.solution).map_err(Failure::bad_input)?;
    document["subsurface"] = subsurface::document(&line, &pressed.solution);
    Ok((document, Some(line)))
}
