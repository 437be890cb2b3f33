//! From a patch and a resolution to a mesh.

use kufe_fem::{HeldFaces, Material, TensorOperator};
use kufe_mesh::TensorGrid;

use crate::gap::Gap;
use crate::grading::{Zone, graded_axis};
use crate::level::{Body, Level};
use crate::motion::Motion;
use crate::window::Patch;
use crate::{Foundation, Load, Problem};

/// How fine a mesh is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Resolution {
    /// Cells over half the patch, along and across.
    pub cells: f64,
    /// Growth of the spacing with the distance from the patch.
    pub growth: f64,
}

/// The mesh and what belongs to it.
pub(crate) struct Discretisation {
    /// Nodes of the ice, z = 0 on top.
    pub grid: TensorGrid,
    /// The iteration's view of it.
    pub level: Level,
    /// Mirror planes x = 0 and y = 0 that were used.
    pub symmetry: [bool; 2],
}

/// Distance from the patch to the outer faces over the patch's largest half-length, on a half-space.
///
/// The faces carry the half-space's own displacements under the contact forces, so this only has to be
/// far enough for the forces to be gathered into a few lumps.
const HALF_SPACE_REACH: f64 = 3.0;
/// Distance from the patch to the sides over the thickness of a layer: exp(-pi 6 / 2) < 1e-4.
const LAYER_REACH: f64 = 6.0;

/// Depth of even layers over the patch's smaller half-width: the stresses vary most there.
const EVEN_DEPTH: f64 = 1.5;

/// Meshes the ice under `patch`.
pub(crate) fn discretise(
    problem: &Problem,
    gap: &Gap,
    material: Material,
    patch: &Patch,
    resolution: Resolution,
) -> Discretisation {
    let symmetry = gap.symmetry();
    let [x_low, x_high] = patch.span_x();
    let [y_low, y_high] = patch.y;
    let largest = 0.5 * (x_high - x_low).max(y_high - y_low);
    let (reach, depth) = match problem.ice.foundation {
        Foundation::HalfSpace => (HALF_SPACE_REACH * largest, HALF_SPACE_REACH * largest),
        Foundation::RigidBed { thickness } => (LAYER_REACH * thickness, thickness),
    };
    let widened = |interval: [f64; 2], axis: usize| {
        // The rim falls in the middle of a cell, so that all meshes cut it alike.
        let half = 0.5 * (interval[1] - interval[0]);
        let spacing = half / resolution.cells;
        let margin = 0.5 * spacing;
        let low = if symmetry[axis] && interval[0] <= 0.0 {
            0.0
        } else {
            interval[0] - margin
        };
        Zone {
            low,
            high: interval[1] + margin,
            spacing,
        }
    };
    let x_zones: Vec<Zone> = patch
        .x
        .iter()
        .map(|&interval| widened(interval, 0))
        .collect();
    let y_half = 0.5 * (y_high - y_low);
    let y_zone = widened(patch.y, 1);
    let axis = |zones: &[Zone], low: f64, high: f64, symmetric: bool| {
        if symmetric {
            graded_axis(0.0, high.max(-low) + reach, zones, resolution.growth)
        } else {
            graded_axis(low - reach, high + reach, zones, resolution.growth)
        }
    };
    let narrowest = patch
        .x
        .iter()
        .map(|i| 0.5 * (i[1] - i[0]))
        .fold(y_half, f64::min);
    let z_zone = Zone {
        low: -EVEN_DEPTH * narrowest,
        high: 0.0,
        spacing: (narrowest / resolution.cells).min(depth / 4.0),
    };
    let mut z_axis = graded_axis(-depth, 0.0, &[z_zone], resolution.growth);
    if matches!(problem.ice.foundation, Foundation::RigidBed { .. }) {
        let scale = -depth / z_axis[0];
        z_axis.iter_mut().for_each(|z| *z *= scale);
    }
    let grid = TensorGrid {
        x: axis(&x_zones, x_low, x_high, symmetry[0]),
        y: axis(&[y_zone], y_low, y_high, symmetry[1]),
        z: z_axis,
    };
    let level = level(problem, gap, material, patch, &grid, symmetry);
    Discretisation {
        grid,
        level,
        symmetry,
    }
}

/// Outer faces held in all components, mirror planes in their normal one.
fn held_faces(symmetry: [bool; 2]) -> HeldFaces {
    std::array::from_fn(|c| {
        [
            [!symmetry[0] || c == 0, true],
            [!symmetry[1] || c == 1, true],
            [true, false],
        ]
    })
}

fn level(
    problem: &Problem,
    gap: &Gap,
    material: Material,
    patch: &Patch,
    grid: &TensorGrid,
    symmetry: [bool; 2],
) -> Level {
    let operator = TensorOperator::new(
        grid,
        material.lame_lambda(),
        material.shear_modulus(),
        held_faces(symmetry),
    );
    let [nx, ny, nz] = grid.shape();
    let mut gaps = Vec::with_capacity(nx * ny);
    let mut rows = Vec::with_capacity(nx * ny);
    let mut bound = Vec::with_capacity(nx * ny);
    let mut candidates = Vec::new();
    let hardness = problem.ice.hardness.unwrap_or(f64::INFINITY);
    let [y_low, y_high] = patch.y;
    let y_margin = 0.35 * (y_high - y_low);
    for j in 0..ny {
        for i in 0..nx {
            let (x, y) = (grid.x[i], grid.y[j]);
            let outer =
                i + 1 == nx || j + 1 == ny || (i == 0 && !symmetry[0]) || (j == 0 && !symmetry[1]);
            let value = if outer { f64::INFINITY } else { gap.at(x, y) };
            let near_x = patch.x.iter().any(|p| {
                let margin = 0.35 * (p[1] - p[0]);
                (p[0] - margin..=p[1] + margin).contains(&x)
            });
            if value.is_finite() && near_x && (y_low - y_margin..=y_high + y_margin).contains(&y) {
                candidates.push(gaps.len());
            }
            gaps.push(value);
            rows.push(gap.motion_row(x, y));
            bound
                .push(hardness * operator.axes[0].lumped_mass[i] * operator.axes[1].lumped_mass[j]);
        }
    }
    let share = if symmetry[0] { 0.5 } else { 1.0 } * if symmetry[1] { 0.5 } else { 1.0 };
    let fz = match problem.load {
        Load::Force { fz, .. } => fz,
        Load::Approach { .. } => 0.0,
    };
    let free = [
        gap.free_motion[0],
        gap.free_motion[1] && !symmetry[0],
        gap.free_motion[2] && !symmetry[1],
    ];
    let ice = Body::new(operator, nz - 1, 1.0, material.poissons_ratio());
    Level {
        bodies: vec![ice],
        nx,
        gap: gaps,
        rows,
        bound,
        candidates,
        motion: Motion {
            free,
            balance: [fz * share, 0.0, 0.0],
        },
    }
}
