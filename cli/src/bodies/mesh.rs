//! `kufe mesh`: the hexahedra of ice and runner for a case.

use std::path::PathBuf;

use kufe::case::{Shape, StatedProblem};
use kufe::jobs::{Failure, case_file::LoadedCase};
use kufe_contact::{Runner, solve};
use kufe_mesh::{HexMesh, MeshError, VtuField, graded_levels, mapped_runner_mesh, write_vtu};
use serde_json::{Value, json};

use crate::output::folder::OutputDir;
use crate::output::global::Global;
use crate::output::paths::case_inputs;
use crate::output::say::{say, warn};

/// Layers of cells between the underside and the top of the runner, and how much each is higher than the one below.
const LAYERS: usize = 8;
const GROWTH: f64 = 1.6;
/// Columns of a scanned hull keep this part of its width and length, away from its ragged sides.
const INSET: f64 = 0.97;

/// Arguments of `kufe mesh`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The case
    pub case: PathBuf,
    /// Folder for ice.vtu, runner.vtu and quality.json
    #[arg(long, short, value_name = "FOLDER", default_value = "out")]
    pub out: PathBuf,
}

/// Solves the case, since the grid is graded to its contact, and writes the meshes with their quality.
///
/// # Errors
/// Those of `kufe press`, and [`Failure::BadInput`] where no hexahedra fit into the hull.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let loaded = LoadedCase::read(&args.case)?;
    let stated = loaded.stated()?;
    for warning in loaded.hull_warnings(stated.hull.as_ref()) {
        warn(&warning);
    }
    let inputs = case_inputs(Some(&args.case), &loaded)?;
    let output = OutputDir::begin("mesh", &inputs, &args.out, global.force)?;
    let bar = global.progress();
    bar.set_message("finding the contact that the grid is graded to");
    let solved = solve(&stated.problem, &loaded.case.options());
    bar.finish_and_clear();
    let grid = solved.map_err(|error| loaded.failure(&error))?.volume.grid;
    let mut meshes = vec![("ice", grid.hex_mesh())];
    if let Some(top) = top(&loaded, &stated) {
        let Runner { underside, .. } = &stated.problem.runner;
        let part = if stated.hull.is_some() { INSET } else { 1.0 };
        let [x0, x1, y0, y1] = underside.extent().map(|end| part * end);
        let (x, y) = (columns(&grid.x, x0, x1), columns(&grid.y, y0, y1));
        let runner = graded_levels(LAYERS, GROWTH)
            .and_then(|levels| mapped_runner_mesh(&x, &y, underside.as_ref(), top, &levels))
            .map_err(|error: MeshError| {
                Failure::BadInput(format!("{}: runner: {error}", loaded.name))
            })?;
        meshes.push(("runner", runner));
    }
    let mut document = json!({ "version": env!("CARGO_PKG_VERSION") });
    for (name, mesh) in &meshes {
        output.write(&format!("{name}.vtu"), |file| write(mesh, file))?;
        document[*name] = figures(mesh);
    }
    output.json("quality.json", &document)?;
    output.commit()?;
    if global.json {
        say(&format!("{document:#}\n"));
    } else if !global.quiet {
        say(&table(&meshes));
    }
    Ok(())
}

/// Height of the runner's flat top over its lowest point [m]; none for a paraboloid, which has no end.
fn top(loaded: &LoadedCase, stated: &StatedProblem) -> Option<f64> {
    if loaded.case.runner.mesh.is_some() {
        return None;
    }
    let filled = stated.problem.runner.elastic.as_ref().map(|e| e.top);
    if let Some(top) = filled.filter(|top| top.is_finite()) {
        return Some(top);
    }
    match (&stated.hull, &loaded.case.runner.shape) {
        (Some(hull), _) => Some(hull.report.extent[2]),
        (None, Some(Shape::Bob { height_m, .. } | Shape::Luge { height_m, .. })) => Some(*height_m),
        (None, _) => None,
    }
}

/// The grid's columns under the hull, and its two ends (a mirror plane is an end already).
fn columns(nodes: &[f64], from: f64, to: f64) -> Vec<f64> {
    let first = nodes.first().map_or(from, |&first| first.max(from));
    let mut columns = vec![first];
    let room = 1e-3 * (to - first);
    columns.extend(nodes.iter().filter(|&&x| x > first + room && x < to - room));
    columns.push(to);
    columns
}

/// The mesh with each cell's smallest scaled Jacobian and aspect ratio.
fn write(mesh: &HexMesh, file: &std::fs::File) -> Result<(), MeshError> {
    let jacobians: Vec<f64> = mesh
        .cells
        .iter()
        .map(|cell| {
            let corners = mesh.corner_jacobians(cell);
            corners
                .iter()
                .map(|corner| corner[1])
                .fold(f64::INFINITY, f64::min)
        })
        .collect();
    let volumes: Vec<f64> = mesh
        .cells
        .iter()
        .map(|cell| mesh.cell_volume(cell))
        .collect();
    let field = |name, values| VtuField {
        name,
        components: 1,
        values,
    };
    let fields = [
        field("scaled_jacobian", &jacobians),
        field("volume_m3", &volumes),
    ];
    write_vtu(mesh, &[], &fields, &[], file)
}

fn figures(mesh: &HexMesh) -> Value {
    let quality = mesh.quality();
    json!({
        "nodes": mesh.points.len(),
        "cells": quality.cells,
        "inverted": quality.inverted,
        "min_scaled_jacobian": quality.min_scaled_jacobian,
        "mean_scaled_jacobian": quality.mean_scaled_jacobian,
        "max_aspect": quality.max_aspect,
        "min_volume_m3": quality.min_volume,
        "volume_m3": quality.volume,
    })
}

fn table(meshes: &[(&str, HexMesh)]) -> String {
    let mut text = String::from(
        "mesh       nodes     cells  inverted  scaled Jacobian (min, mean)  aspect (max)\n",
    );
    for (name, mesh) in meshes {
        let quality = mesh.quality();
        text += &format!(
            "{name:<7} {:>8}  {:>8}  {:>8}  {:>13.3} {:>13.3}  {:>12.0}\n",
            mesh.points.len(),
            quality.cells,
            quality.inverted,
            quality.min_scaled_jacobian,
            quality.mean_scaled_jacobian,
            quality.max_aspect
        );
    }
    text
}
