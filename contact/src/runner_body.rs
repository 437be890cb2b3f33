//! The elastic runner: hexahedra on the ice's columns between its underside and its mount.

use kufe_fem::{Body as Solid, ElementKind, HeldFaces, Material, TensorOperator};
use kufe_mesh::{HexMesh, TensorGrid, mapped_runner_mesh};

use crate::body::{Body, Columns, Side};
use crate::grading::{Start, Zone, graded_axis};
use crate::stretch::Stretch;
use crate::{ElasticRunner, Error, Problem};

/// Cells in the runner are this much larger than in the ice under them: steel's share of the approach is small.
const COARSER: f64 = 2.0;

/// The runner as a body of the contact problem, with its mesh.
///
/// An unbounded hull is a half-space above the plane, on the ice's grid mirrored. A bounded one stands on the columns
/// under it; its ends and sides are free and its top is held. `spacing` is the ice's at the contact, `growth` that of
/// its axes; without `for_solving` only the surface response is set up.
pub(crate) fn runner_body(
    problem: &Problem,
    elastic: ElasticRunner,
    ice: &TensorGrid,
    symmetry: [bool; 2],
    (spacing, growth): (f64, f64),
    for_solving: bool,
) -> Result<(Body, HexMesh), Error> {
    let material = Material::new(elastic.youngs_modulus, elastic.poissons_ratio).map_err(|_| {
        Error::OutOfRange {
            name: "runner Young's modulus",
            value: elastic.youngs_modulus,
            expected: "an elastic solid",
        }
    })?;
    let (lambda, mu) = (material.lame_lambda(), material.shear_modulus());
    let extent = problem.runner.underside.extent();
    if extent.iter().any(|end| end.is_infinite()) {
        let grid = TensorGrid {
            x: ice.x.clone(),
            y: ice.y.clone(),
            z: ice.z.iter().rev().map(|z| -z).collect(),
        };
        let columns = Columns {
            first: [0, 0],
            count: [grid.x.len(), grid.y.len()],
        };
        let operator = TensorOperator::new(&grid, lambda, mu, held(symmetry, true));
        return Ok((
            Body::new(operator, material, Side::Above, columns),
            grid.hex_mesh(),
        ));
    }
    let range = |nodes: &[f64], low: f64, high: f64| {
        let slack = 1e-9 * (high - low);
        let first = nodes.partition_point(|&v| v < low - slack);
        (first, nodes.partition_point(|&v| v <= high + slack) - first)
    };
    let (first_x, count_x) = range(&ice.x, extent[0], extent[1]);
    let (first_y, count_y) = range(&ice.y, extent[2], extent[3]);
    let columns = Columns {
        first: [first_x, first_y],
        count: [count_x, count_y],
    };
    let (x, y) = (
        &ice.x[first_x..first_x + count_x],
        &ice.y[first_y..first_y + count_y],
    );
    let lowest = x
        .iter()
        .flat_map(|&x| {
            y.iter()
                .map(move |&y| problem.runner.underside.height(x, y))
        })
        .fold(f64::INFINITY, f64::min);
    let height = elastic.top - lowest;
    let zone = Zone {
        stretch: Stretch::even(0.0, (COARSER * spacing).min(0.25 * height)),
        spacing: (COARSER * spacing).min(0.25 * height),
    };
    let mut z = graded_axis(Start::At(0.0), height, &[zone], growth.min(1.0));
    let top = z[z.len() - 1];
    z.iter_mut().for_each(|z| *z *= height / top);
    let levels: Vec<f64> = z.iter().map(|z| z / height).collect();
    let mesh = mapped_runner_mesh(
        x,
        y,
        problem.runner.underside.as_ref(),
        elastic.top,
        &levels,
    )
    .map_err(|error| Error::RunnerMesh {
        reason: error.to_string(),
    })?;
    let box_grid = TensorGrid {
        x: x.to_vec(),
        y: y.to_vec(),
        z,
    };
    let operator = TensorOperator::new(&box_grid, lambda, mu, held(symmetry, false));
    let body = Body::new(operator, material, Side::Above, columns);
    if !for_solving {
        return Ok((body, mesh));
    }
    // The held top lets nothing bend, so plain hexahedra serve.
    let solid = Solid::uniform(mesh.clone(), material, ElementKind::Hex8).map_err(|error| {
        Error::RunnerMesh {
            reason: error.to_string(),
        }
    })?;
    Ok((body.on_mapped(&solid), mesh))
}

/// The top held in all components, mirror planes in their normal one, ends and sides where `all_round`.
fn held(symmetry: [bool; 2], all_round: bool) -> HeldFaces {
    std::array::from_fn(|c| {
        let ends = |axis: usize| {
            if symmetry[axis] {
                [c == axis, all_round]
            } else {
                [all_round, all_round]
            }
        };
        [ends(0), ends(1), [false, true]]
    })
}
