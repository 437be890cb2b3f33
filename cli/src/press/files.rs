//! What one solved case is written to.

use std::io::Write;

use kufe_contact::{CentreLine, PressureMap, pressure_maps};
use kufe_jobs::{Failure, Pressed};
use kufe_mesh::HullFormat;
use serde_json::Value;

use crate::bodies::placed_hull::placed_hull;
use crate::bodies::volume_vtu;
use crate::map::{draw, write_exr};
use crate::output::staging::Staging;
use crate::press::{sliding, subsurface, summary};

/// Writes result.json, pressure.exr, pressure.png, field.vtu, hull.glb where the shape has ends, and runner.vtu where the runner deforms; where it
/// slides groove.exr, groove.png and film.csv; with a centre line subsurface.csv and subsurface.png, and the maximum shear stress in the VTU files.
///
/// # Errors
/// [`Failure::BadInput`] with the file that cannot be written.
pub fn write(
    staging: &Staging,
    pressed: &Pressed,
    document: &Value,
    line: Option<&CentreLine>,
) -> Result<(), Failure> {
    let solution = &pressed.solution;
    let map = PressureMap::of(solution);
    staging.write("result.json", |mut file| writeln!(file, "{document:#}"))?;
    staging.write("pressure.exr", |file| {
        let curvature = pressed.problem.track_curvature;
        write_exr::write(file, &map, solution.fz, curvature)
    })?;
    let title = summary::title(solution);
    let maps = pressure_maps(solution);
    draw::write(&staging.path("pressure.png"), &maps, &title)
        .map_err(|error| staging.failure("pressure.png", &error))?;
    let shear = line.is_some();
    staging.write("field.vtu", |file| {
        volume_vtu::write_ice(file, &solution.volume, shear)
    })?;
    if let Some(hull) = placed_hull(&pressed.problem, solution) {
        staging.write("hull.glb", |file| HullFormat::Gltf.write(&hull, file))?;
    }
    if let (Some(field), Some(elastic)) = (&solution.runner_volume, &pressed.problem.runner.elastic)
    {
        staging.write("runner.vtu", |file| {
            volume_vtu::write_runner(file, field, elastic, shear)
        })?;
    }
    if let Some(slid) = &pressed.sliding {
        sliding::write(staging, pressed, &map, slid)?;
    }
    if let Some(line) = line {
        staging.write("subsurface.csv", |file| subsurface::write_csv(file, line))?;
        subsurface::write_png(&staging.path("subsurface.png"), line)
            .map_err(|error| staging.failure("subsurface.png", &error))?;
    }
    Ok(())
}
