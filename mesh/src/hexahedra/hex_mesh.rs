//! Hexahedral meshes: tensor grids, runners between underside and mount, meshes from files.

use std::fmt::Display;

use crate::error::MeshError;
use crate::parameter::{expect, positive_finite};
use crate::shapes::underside::Underside;

/// Points and eight-node hexahedra.
#[derive(Clone, Debug, PartialEq)]
pub struct HexMesh {
    /// Node positions [m].
    pub points: Vec<[f64; 3]>,
    /// Corners of each cell in VTK's order: the lower face counter-clockwise seen from above
    /// (z up), then the upper face above it.
    pub cells: Vec<[usize; 8]>,
}

/// Steps along x, y and z to the corners of a cell, in VTK's order.
const CORNERS: [[usize; 3]; 8] = [
    [0, 0, 0],
    [1, 0, 0],
    [1, 1, 0],
    [0, 1, 0],
    [0, 0, 1],
    [1, 0, 1],
    [1, 1, 1],
    [0, 1, 1],
];

/// Graded coordinates along the three axes, each strictly increasing [m].
#[derive(Clone, Debug, PartialEq)]
pub struct TensorGrid {
    /// Coordinates along x [m].
    pub x: Vec<f64>,
    /// Coordinates across, y [m].
    pub y: Vec<f64>,
    /// Coordinates upwards, z [m].
    pub z: Vec<f64>,
}

impl TensorGrid {
    /// Number of nodes along each axis.
    pub fn shape(&self) -> [usize; 3] {
        [self.x.len(), self.y.len(), self.z.len()]
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.x.len() * self.y.len() * self.z.len()
    }

    /// Index of node (`i`, `j`, `k`): x runs fastest, then y, then z.
    pub fn node(&self, i: usize, j: usize, k: usize) -> usize {
        (k * self.y.len() + j) * self.x.len() + i
    }

    /// The grid as a mesh, nodes and cells with x fastest, cells in VTK's corner order.
    pub fn hex_mesh(&self) -> HexMesh {
        let [nx, ny, nz] = self.shape();
        let mut points = Vec::with_capacity(self.node_count());
        for &z in &self.z {
            for &y in &self.y {
                points.extend(self.x.iter().map(|&x| [x, y, z]));
            }
        }
        let mut cells = Vec::with_capacity((nx - 1) * (ny - 1) * (nz - 1));
        for k in 0..nz - 1 {
            for j in 0..ny - 1 {
                for i in 0..nx - 1 {
                    let at = |[di, dj, dk]: [usize; 3]| self.node(i + di, j + dj, k + dk);
                    cells.push(CORNERS.map(at));
                }
            }
        }
        HexMesh { points, cells }
    }
}

/// The error of cell `cell`, from 0, which is of this `kind` of a file format instead of a
/// hexahedron.
pub(crate) fn cell_type(cell: usize, format: &str, kind: impl Display) -> MeshError {
    MeshError::Invalid(format!(
        "cell {} has {format} type {kind}; expected eight-node hexahedra only",
        cell + 1
    ))
}

/// Levels 0 to 1 in `layers` steps, each `growth` times as high as the one below.
///
/// # Errors
/// [`MeshError::Value`] without layers, or if the growth is not positive.
pub fn graded_levels(layers: usize, growth: f64) -> Result<Vec<f64>, MeshError> {
    expect(layers > 0, "layers", 0.0, "at least 1")?;
    positive_finite("growth", growth)?;
    let mut levels = vec![0.0];
    let mut step = 1.0;
    for _ in 0..layers {
        levels.push(levels[levels.len() - 1] + step);
        step *= growth;
    }
    let total = levels[layers];
    levels.iter_mut().for_each(|level| *level /= total);
    Ok(levels)
}

/// Hexahedra in the columns `x` times `y` [m] between `underside` and a flat top at height `top`
/// [m]: node (i, j, k) is at height `h + levels[k] (top - h)`, h the underside's at (x_i, y_j).
///
/// Nodes and cells are numbered as those of [`TensorGrid`], so that the lowest
/// nodes lie over the nodes of an ice grid with the same columns.
///
/// # Errors
/// [`MeshError::Invalid`] if coordinates do not increase, or if a column is not under the hull or
/// reaches the top.
pub fn mapped_runner_mesh(
    x: &[f64],
    y: &[f64],
    underside: &dyn Underside,
    top: f64,
    levels: &[f64],
) -> Result<HexMesh, MeshError> {
    for (name, values) in [("x", x), ("y", y), ("levels", levels)] {
        let mut pairs = values.windows(2);
        let bad = pairs.position(|pair| pair[1].is_nan() || pair[1] <= pair[0]);
        if values.len() < 2 || bad.is_some() || !values[0].is_finite() {
            return Err(MeshError::Invalid(format!(
                "{name}: {} values, the one at index {} out of order; expected two or more \
                 increasing numbers",
                values.len(),
                bad.map_or(0, |i| i + 1)
            )));
        }
    }
    let row = |&y: &f64| x.iter().map(move |&x| underside.height(x, y));
    let heights: Vec<f64> = y.iter().flat_map(row).collect();
    mesh_over_heights(x, y, &heights, top, levels)
}

/// [`mapped_runner_mesh`] over given `heights` of the columns [m], x fastest.
///
/// # Errors
/// As [`mapped_runner_mesh`], except for the coordinates.
///
/// # Panics
/// If there is not one height per column.
pub fn mesh_over_heights(
    x: &[f64],
    y: &[f64],
    heights: &[f64],
    top: f64,
    levels: &[f64],
) -> Result<HexMesh, MeshError> {
    assert_eq!(heights.len(), x.len() * y.len());
    if let Some(at) = heights.iter().position(|h| h.is_nan() || *h >= top) {
        return Err(MeshError::Invalid(format!(
            "the column at x = {} m, y = {} m has the underside at {} m; expected a height below \
             the top at {top} m",
            x[at % x.len()],
            y[at / x.len()],
            heights[at]
        )));
    }
    let grid = TensorGrid {
        x: x.to_vec(),
        y: y.to_vec(),
        z: levels.to_vec(),
    };
    let mut mesh = grid.hex_mesh();
    for (node, point) in mesh.points.iter_mut().enumerate() {
        let height = heights[node % heights.len()];
        point[2] = height + point[2] * (top - height);
    }
    Ok(mesh)
}

/// Lowers `heights` over the columns `x` times `y`, x fastest, until no two neighbours differ by
/// more than `slope` times their distance: the largest such surface that is nowhere higher.
///
/// A convex section is unchanged up to where it is that steep, and continues straight from there.
///
/// # Panics
/// Where there is not one height a column.
pub fn limit_slope(x: &[f64], y: &[f64], heights: &mut [f64], slope: f64) {
    let nx = x.len();
    assert_eq!(heights.len(), nx * y.len());
    let mut relax = |from: usize, to: usize, distance: f64| {
        heights[to] = heights[to].min(heights[from] + slope * distance);
    };
    // Distances add up along x and along y, so one forward and one backward sweep on each axis
    // suffice.
    let mut sweep = |places: &[f64], first: usize, stride: usize| {
        let distance = |k: usize| places[k] - places[k - 1];
        let node = |k: usize| first + k * stride;
        (1..places.len()).for_each(|k| relax(node(k - 1), node(k), distance(k)));
        let back = (1..places.len()).rev();
        back.for_each(|k| relax(node(k), node(k - 1), distance(k)));
    };
    (0..y.len()).for_each(|j| sweep(x, j * nx, 1));
    (0..nx).for_each(|i| sweep(y, i, nx));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::swept::BobRunner;
    use crate::shapes::underside::Paraboloid;

    fn even(from: f64, to: f64, count: usize) -> Vec<f64> {
        (0..=count)
            .map(|i| from + (to - from) * i as f64 / count as f64)
            .collect()
    }

    #[test]
    fn mapped_runner_fills_the_space_between_underside_and_top() {
        let runner = BobRunner::default().swept().unwrap();
        let (x, y) = (even(-0.5, 0.5, 200), even(-0.0049, 0.0049, 40));
        let mesh = mapped_runner_mesh(
            &x,
            &y,
            &runner,
            runner.top(),
            &graded_levels(6, 1.5).unwrap(),
        )
        .unwrap();
        let quality = mesh.quality();
        assert_eq!((quality.inverted, quality.cells), (0, 200 * 40 * 6));
        let n = 600;
        let mut volume = 0.0;
        for i in 0..n {
            for j in 0..n {
                let part = |k: usize| (k as f64 + 0.5) / n as f64 - 0.5;
                volume += (runner.top() - runner.height(part(i), 0.0098 * part(j))) * 0.0098
                    / (n * n) as f64;
            }
        }
        assert!(
            (quality.volume / volume - 1.0).abs() < 1e-3,
            "{} {volume}",
            quality.volume
        );
        for (node, point) in mesh.points[..x.len() * y.len()].iter().enumerate() {
            assert_eq!(
                *point,
                [
                    x[node % 201],
                    y[node / 201],
                    runner.height(x[node % 201], y[node / 201])
                ]
            );
        }
        assert!(
            mesh.points
                .iter()
                .rev()
                .take(201 * 41)
                .all(|p| p[2] == runner.top())
        );
    }

    #[test]
    fn levels_grow_by_their_ratio() {
        let levels = graded_levels(3, 2.0).unwrap();
        assert_eq!(levels, [0.0, 1.0 / 7.0, 3.0 / 7.0, 1.0]);
        assert!(graded_levels(0, 2.0).is_err() && graded_levels(3, f64::NAN).is_err());
    }

    #[test]
    fn columns_beside_the_hull_are_refused_with_their_place() {
        let runner = BobRunner::default().swept().unwrap();
        let mesh = |x: &[f64], top: f64| {
            mapped_runner_mesh(x, &[-0.001, 0.001], &runner, top, &[0.0, 1.0])
        };
        assert!(
            mesh(&[0.0, 0.6], 0.03)
                .unwrap_err()
                .to_string()
                .contains("0.6")
        );
        assert!(
            mesh(&[0.0, 0.0], 0.03)
                .unwrap_err()
                .to_string()
                .contains("x")
        );
        let bowl = Paraboloid::new(1.0, 1.0).unwrap();
        assert!(mapped_runner_mesh(&[0.0, 1.0], &[0.0, 1.0], &bowl, 0.9, &[0.0, 1.0]).is_err());
    }

    #[test]
    fn a_limited_surface_is_the_section_where_it_is_gentle_and_straight_beyond() {
        let runner = BobRunner::default().swept().unwrap();
        let (x, y) = (even(-0.4, 0.4, 8), even(-0.005, 0.005, 400));
        let original: Vec<f64> = y
            .iter()
            .flat_map(|&y| x.iter().map(|&x| runner.height(x, y)).collect::<Vec<_>>())
            .collect();
        let mut heights = original.clone();
        limit_slope(&x, &y, &mut heights, 0.5);
        // A circle of 5 mm is as steep as 0.5 at 5 mm sin(atan 0.5).
        let bend = 0.005 * (0.5f64.atan()).sin();
        for (j, &y) in y.iter().enumerate() {
            let at = j * x.len() + 4;
            if y.abs() < bend - 5e-5 {
                assert_eq!(heights[at], original[at]);
            } else if y.abs() > bend + 5e-5 {
                let line = runner.height(0.0, bend) + 0.5 * (y.abs() - bend);
                assert!((heights[at] - line).abs() < 1e-7 && heights[at] < original[at]);
            }
        }
        let slope = |a: usize, b: usize, d: f64| (heights[a] - heights[b]).abs() / d;
        assert!((1..y.len()).all(|j| {
            slope(j * x.len(), (j - 1) * x.len(), y[j] - y[j - 1]) < 0.5 * (1.0 + 1e-9)
        }));
    }
}
