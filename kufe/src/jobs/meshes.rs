//! Hexahedral meshes of the ice and the runner of a case.

use std::fs::File;

use kufe_contact::{Options, Problem, VolumeField, solve};
use kufe_mesh::{HexMesh, MeshError, VtuField, graded_levels, mapped_runner_mesh, write_vtu};

use crate::case::{FittedHull, Shape};
use crate::jobs::case_file::LoadedCase;
use crate::jobs::failure::Failure;
use crate::jobs::watch::Watch;

/// Layers of cells between the underside and the top of the runner, and the ratio of their heights.
const LAYERS: usize = 8;
const GROWTH: f64 = 1.6;
/// Fraction of a scanned hull's width and length that the mesh covers, away from its ragged sides.
const COVERED_FRACTION: f64 = 0.97;

/// The hexahedral meshes of a case.
pub struct CaseMeshes {
    /// Mesh of the ice, graded towards the contact.
    pub ice: HexMesh,
    /// Mesh of the runner; `None` for a runner without a known top.
    pub runner: Option<HexMesh>,
}

impl CaseMeshes {
    /// Solves a case, grades the grid towards its contact, and fills ice and runner with hexahedra.
    ///
    /// # Errors
    /// Those of the solver, and [`Failure::BadInput`] if no hexahedra fit into the hull.
    pub fn of(loaded: &LoadedCase, watch: &Watch) -> Result<CaseMeshes, Failure> {
        let (problem, hull) = loaded.stated()?;
        loaded.hull_warnings(hull.as_ref(), watch);
        watch.progress("finding the contact that the grid is graded to");
        // `subsurface` requests a volume solution, whichever solver the contact would get.
        let options = Options {
            subsurface: true,
            ..loaded.case.options()
        };
        let solution = loaded.solved(solve(&problem, &options))?;
        let Some(VolumeField { grid, .. }) = solution.volume else {
            unreachable!("`subsurface` yields a volume solution");
        };
        let runner = top(loaded, &problem, hull.as_ref()).map(|top| {
            let underside = &problem.runner.underside;
            let fraction = if hull.is_some() {
                COVERED_FRACTION
            } else {
                1.0
            };
            let [x0, x1, y0, y1] = underside.extent();
            let x = columns(&grid.x, shrunk([x0, x1], fraction));
            let y = columns(&grid.y, shrunk([y0, y1], fraction));
            graded_levels(LAYERS, GROWTH)
                .and_then(|levels| mapped_runner_mesh(&x, &y, underside.as_ref(), top, &levels))
        });
        let named = |error| loaded.bad_input(format_args!("runner: {error}"));
        Ok(CaseMeshes {
            ice: grid.hex_mesh(),
            runner: runner.transpose().map_err(named)?,
        })
    }
}

/// Height of the runner's flat top above its lowest point [m]; `None` for a paraboloid, which is
/// unbounded, and for `runner.mesh`, which is a mesh already.
fn top(loaded: &LoadedCase, problem: &Problem, hull: Option<&FittedHull>) -> Option<f64> {
    if loaded.case.runner.mesh.is_some() {
        return None;
    }
    let elastic_top = problem.runner.elastic.as_ref().map(|e| e.top);
    if let Some(top) = elastic_top.filter(|top| top.is_finite()) {
        return Some(top);
    }
    match (hull, &loaded.case.runner.shape) {
        (Some(hull), _) => Some(hull.report.extent[2]),
        (None, Some(Shape::Bob { height_m, .. } | Shape::Luge { height_m, .. })) => Some(*height_m),
        (None, _) => None,
    }
}

/// The range shrunk about its middle to a fraction of its length.
fn shrunk([from, to]: [f64; 2], fraction: f64) -> [f64; 2] {
    let (middle, half) = (0.5 * (from + to), 0.5 * fraction * (to - from));
    [middle - half, middle + half]
}

/// Coordinates of the runner's nodes: the two ends of the range, and the grid's nodes in between. A
/// mirror plane of the grid replaces the first end.
fn columns(nodes: &[f64], [from, to]: [f64; 2]) -> Vec<f64> {
    let first = nodes.first().map_or(from, |&first| first.max(from));
    let mut columns = vec![first];
    let room = 1e-3 * (to - first);
    columns.extend(nodes.iter().filter(|&&x| x > first + room && x < to - room));
    columns.push(to);
    columns
}

/// Writes a mesh with the smallest scaled Jacobian and the volume of each cell.
///
/// # Errors
/// Those of the file.
pub fn write_mesh_quality(mesh: &HexMesh, file: &File) -> Result<(), MeshError> {
    let smallest = |cell| {
        let corners = mesh.corner_jacobians(cell);
        let scaled = corners.iter().map(|corner| corner[1]);
        scaled.fold(f64::INFINITY, f64::min)
    };
    let jacobians: Vec<f64> = mesh.cells.iter().map(smallest).collect();
    let volume = |cell| mesh.cell_volume(cell);
    let volumes: Vec<f64> = mesh.cells.iter().map(volume).collect();
    let fields = [("scaled_jacobian", &jacobians), ("volume_m3", &volumes)];
    let fields = fields.map(|(name, values)| VtuField {
        name,
        components: 1,
        values,
    });
    write_vtu(mesh, &[], &fields, &[], file)
}
