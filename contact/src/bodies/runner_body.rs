//! The elastic runner: hexahedra on the ice's columns between its underside and its mount.

use kufe_fem::{BeamModes, Body as Solid, ElementKind, Material, MatrixFree, TensorOperator};
use kufe_mesh::{HexMesh, TensorGrid, limit_slope, mesh_over_heights};

use crate::bodies::elastic_body::{ElasticBody, Inverse, fixed_faces};
use crate::grid::grading::{Start, Zone, even_steps, graded_axis};
use crate::grid::stretch::Stretch;
use crate::precondition::mounted::{BeamSpace, MountedInverse};
use crate::precondition::planewise::{Columns, Side};
use crate::problem::check::solid_material;
use crate::problem::mount::{LoadedPlace, spread_along};
use crate::{ElasticRunner, Error, Load, Mount, Problem};

/// Ratio of the size of cells in the runner to those in the ice: steel contributes little to the
/// approach.
const COARSER: f64 = 2.0;
/// In a bending runner, layers grow up to its height divided by this number. With unlimited growth,
/// the approach of a runner on two bridges is 3 % too small with 3 cells over half the patch, 1.6 %
/// with 6.
const GROWING: f64 = 3.0;
/// Smallest and largest number of knots of a whole runner's beam motions.
const KNOTS: [f64; 2] = [25.0, 61.0];
/// Fraction of the consistent mass that keeps the averaged one definite.
const MASS_FRACTION: f64 = 1e-6;

/// Input for the mesh of an elastic runner.
pub(crate) struct RunnerPlan<'a> {
    pub problem: &'a Problem,
    pub elastic: &'a ElasticRunner,
    /// The ice's grid.
    pub ice: &'a TensorGrid,
    pub symmetry: [bool; 2],
    /// Spacing of the ice at the contact [m], and growth of its axes.
    pub spacing: f64,
    pub growth: f64,
    /// Whether the body is solved; otherwise only its surface response is set up.
    pub for_solving: bool,
}

impl RunnerPlan<'_> {
    /// The runner as a body of the contact problem, with its mesh.
    ///
    /// An unbounded hull is a half-space above the plane, on the mirrored grid of the ice. A
    /// bounded hull is meshed on the columns under it; its ends and sides are free, and its mount
    /// fixes its top.
    pub fn body(&self) -> Result<(ElasticBody, HexMesh), Error> {
        let elastic = self.elastic;
        let (modulus, ratio) = (elastic.youngs_modulus, elastic.poissons_ratio);
        let material = solid_material("runner Young's modulus", modulus, ratio)?;
        if !self.problem.runner.is_bounded() {
            return Ok(self.half_space(material));
        }
        let (columns, grid) = self.columns();
        let (mesh, grid) = mapped(self.problem, elastic, grid, (self.spacing, self.growth))?;
        let kind = elastic.element_kind();
        let solid = || Solid::uniform(mesh.clone(), material, kind).map_err(Error::runner_mesh);
        let body = match elastic.mount {
            Mount::Top => {
                let fixed = fixed_faces(self.symmetry, false, [false, true]);
                let operator = TensorOperator::new(&grid, material, fixed);
                ElasticBody::on_grid(operator, Side::Above, columns)
            }
            Mount::Places(_) | Mount::Loads(_) => self.mounted(columns, &solid()?, &grid)?,
        };
        let body = if self.for_solving {
            body.on_mapped(&solid()?)
        } else {
            body
        };
        Ok((body, mesh))
    }

    fn half_space(&self, material: Material) -> (ElasticBody, HexMesh) {
        let ice = self.ice;
        let grid = TensorGrid {
            x: ice.x.clone(),
            y: ice.y.clone(),
            z: ice.z.iter().rev().map(|z| -z).collect(),
        };
        let columns = Columns::of_plane([ice.x.len(), ice.y.len()]);
        let fixed = fixed_faces(self.symmetry, true, [false, true]);
        let mut operator = TensorOperator::new(&grid, material, fixed);
        if self.elastic.element_kind() == ElementKind::Hex8Dilatation {
            operator = operator.with_mean_dilatation();
        }
        let body = ElasticBody::on_grid(operator, Side::Above, columns);
        (body, grid.hex_mesh())
    }

    /// The columns under the hull, and their grid without heights.
    fn columns(&self) -> (Columns, TensorGrid) {
        let range = |nodes: &[f64], low: f64, high: f64| {
            let slack = 1e-9 * (high - low);
            let first = nodes.partition_point(|&v| v < low - slack);
            (first, nodes.partition_point(|&v| v <= high + slack) - first)
        };
        let (ice, extent) = (self.ice, self.problem.runner.underside.extent());
        let (first_x, count_x) = range(&ice.x, extent[0], extent[1]);
        let (first_y, count_y) = range(&ice.y, extent[2], extent[3]);
        let columns = Columns {
            first: [first_x, first_y],
            count: [count_x, count_y],
            plane_width: ice.x.len(),
        };
        let grid = TensorGrid {
            x: ice.x[first_x..first_x + count_x].to_vec(),
            y: ice.y[first_y..first_y + count_y].to_vec(),
            z: Vec::new(),
        };
        (columns, grid)
    }

    fn mounted(
        &self,
        columns: Columns,
        solid: &Solid,
        grid: &TensorGrid,
    ) -> Result<ElasticBody, Error> {
        let (elastic, symmetry) = (self.elastic, self.symmetry);
        let section = solid.sections()[0];
        let extent = self.problem.runner.underside.extent();
        let length = extent[1] - extent[0];
        let faces = fixed_faces(symmetry, false, [false; 2]);
        let mut operator = TensorOperator::new(grid, section.material, faces);
        // The body is not constrained on faces: its rigid motions get a small stiffness in P, and
        // the mount is a constraint.
        let axis = &mut operator.axes[0];
        for (k, m) in axis.stiffness.iter_mut().zip(&axis.mass) {
            for d in 0..3 {
                k[d] += m[d] / (length * length);
            }
        }
        let axial = section.kind == ElementKind::Hex8Axial;
        let averaged = axial.then(|| operator.axes[0].averaged(MASS_FRACTION));
        let height = grid.z[grid.z.len() - 1];
        let beam = beam_space(solid, &operator, symmetry, [length, height]);
        let fixed = fixed_nodes(&elastic.mount, grid, symmetry);
        let [nx, ny, nz] = grid.shape();
        let entry = |c: usize, [i, j]: [usize; 2]| ((c * nz + nz - 1) * ny + j) * nx + i;
        let of = |c: usize| fixed[c].iter().map(move |&node| entry(c, node));
        let entries = (0..3).flat_map(of).collect();
        let inverse = MountedInverse::new(&operator, averaged.as_ref(), columns, beam, fixed)
            .ok_or_else(|| Error::runner_mesh("its mount holds no independent nodes"))?;
        let inverse = Inverse::Mounted(Box::new(inverse));
        Ok(ElasticBody {
            fixed: entries,
            load: match &elastic.mount {
                Mount::Loads(loads) => load_of(self.problem, loads, grid, symmetry),
                Mount::Top | Mount::Places(_) => Vec::new(),
            },
            ..ElasticBody::with_inverse(operator, inverse, Side::Above, columns)
        })
    }
}

/// The solid's hexahedra over the columns of `grid`, and the box with as many layers that
/// represents it in the preconditioner.
fn mapped(
    problem: &Problem,
    elastic: &ElasticRunner,
    mut grid: TensorGrid,
    (spacing, growth): (f64, f64),
) -> Result<(HexMesh, TensorGrid), Error> {
    let (x, y) = (&grid.x, &grid.y);
    let underside = problem.runner.underside.as_ref();
    let row = |y: f64| x.iter().map(move |&x| underside.height(x, y));
    let mut heights: Vec<f64> = y.iter().flat_map(|&y| row(y)).collect();
    let flank = elastic.flank.unwrap_or_else(|| elastic.mount.flank());
    limit_slope(x, y, &mut heights, flank);
    let lowest = heights.iter().copied().fold(f64::INFINITY, f64::min);
    let height = elastic.top - lowest;
    let size = (COARSER * spacing).min(0.25 * height);
    let zone = Zone {
        stretch: Stretch::even(0.0, size),
        spacing: size,
    };
    let growth = growth.min(1.0);
    let z = match elastic.mount {
        Mount::Top => {
            let mut z = graded_axis(Start::At(0.0), height, &[zone], growth)?;
            let top = z[z.len() - 1];
            z.iter_mut().for_each(|z| *z *= height / top);
            z
        }
        // Bending and torsion vary up to the top.
        Mount::Places(_) | Mount::Loads(_) => {
            let grown = |z: f64| size + growth * (z - size).clamp(0.0, height / GROWING);
            let mut z = vec![0.0];
            z.extend(even_steps(0.0, height, grown, f64::ceil)?);
            z.push(height);
            z
        }
    };
    let levels: Vec<f64> = z.iter().map(|z| z / height).collect();
    let mesh =
        mesh_over_heights(x, y, &heights, elastic.top, &levels).map_err(Error::runner_mesh)?;
    grid.z = z;
    Ok((mesh, grid))
}

/// The beam motions of a body of `length` and `height` [m] without constraints.
///
/// Rigid motions get a hundredth of the stiffness of the first bending mode of a free beam, E H^2 /
/// 12 (4.73 / L)^4 per volume: well above rounding. The mount determines them.
fn beam_space(
    solid: &Solid,
    operator: &TensorOperator,
    symmetry: [bool; 2],
    [length, height]: [f64; 2],
) -> BeamSpace {
    let [nx, ny, nz] = operator.shape();
    let [x, y, z] = &operator.axes;
    let material = solid.sections()[0].material;
    let stiffness =
        0.01 * material.youngs_modulus() * height.powi(2) / 12.0 * (4.73 / length).powi(4);
    let mass = |node: usize| {
        let [i, j, k] = [node % nx, node / nx % ny, node / nx / ny];
        stiffness * x.lumped_mass[i] * y.lumped_mass[j] * z.lumped_mass[k]
    };
    let mass: Vec<f64> = (0..nx * ny * nz).map(mass).collect();
    let flags = |node: usize| {
        let [i, j] = [node % nx, node / nx % ny];
        [symmetry[0] && i == 0, symmetry[1] && j == 0, false]
    };
    let on_mirror: Vec<bool> = (0..nx * ny * nz).flat_map(flags).collect();
    let mut operator = MatrixFree::new(solid);
    let apply = |u: &[f64], out: &mut [f64]| {
        operator.apply(u, out);
        for (d, out) in out.iter_mut().enumerate() {
            *out = if on_mirror[d] {
                0.0
            } else {
                *out + mass[d / 3] * u[d]
            };
        }
    };
    // Motions shorter than one and a half heights are not beam-like.
    let knots = (length / (1.5 * height)).clamp(KNOTS[0], KNOTS[1]) as usize;
    let knots = if symmetry[0] { knots / 2 + 1 } else { knots };
    let middle = if symmetry[1] {
        0.0
    } else {
        0.5 * (y.nodes[0] + y.nodes[ny - 1])
    };
    let points = solid.mesh().points.clone();
    let heights = points.iter().map(|p| p[2]);
    let top = heights.fold(f64::NEG_INFINITY, f64::max);
    let axis = [middle, top - 0.5 * height];
    match BeamModes::new(points, &x.nodes, knots, axis, on_mirror.clone(), apply) {
        Ok(modes) => BeamSpace::new(modes, [nx, ny, nz]),
        Err(error) => unreachable!("three flags a node: {error}"),
    }
}

// Fixed nodes and loads on the top of a meshed runner.

/// The nodes (i, j) of the top that the mount fixes, by component, except those that mirror planes
/// fix already.
///
/// A runner without fixed nodes gets three points with zero reaction, which fix its six rigid
/// motions.
pub(crate) fn fixed_nodes(
    mount: &Mount,
    grid: &TensorGrid,
    symmetry: [bool; 2],
) -> [Vec<[usize; 2]>; 3] {
    let [nx, ny, _] = grid.shape();
    let Mount::Loads(_) = mount else {
        let free = |c: usize, [i, j]: [usize; 2]| {
            !(c == 0 && symmetry[0] && i == 0 || c == 1 && symmetry[1] && j == 0)
        };
        let nodes = (0..nx * ny).map(|n| [n % nx, n / nx]);
        let places: Vec<[usize; 2]> = nodes.filter(|&[i, _]| mount.over(grid.x[i])).collect();
        return [0, 1, 2].map(|c| places.iter().copied().filter(|&n| free(c, n)).collect());
    };
    let centre = |n: usize, symmetric: bool| if symmetric { 0 } else { n / 2 };
    let (i, j) = (centre(nx, symmetry[0]), centre(ny, symmetry[1]));
    let mut fixed = [Vec::new(), Vec::new(), vec![[i, j]]];
    if !symmetry[0] {
        fixed[0].push([i, j]);
        fixed[2].push([nx - 1, j]);
    }
    if !symmetry[1] {
        fixed[1].push([i, j]);
        fixed[2].push([i, ny - 1]);
    }
    if !symmetry[0] && !symmetry[1] {
        fixed[1].push([nx - 1, j]);
    }
    fixed
}

/// The nodal forces of the loads on the top, by components [N].
pub(crate) fn load_of(
    problem: &Problem,
    loads: &[LoadedPlace],
    grid: &TensorGrid,
    symmetry: [bool; 2],
) -> Vec<f64> {
    let [nx, ny, nz] = grid.shape();
    let mut forces = vec![0.0; 3 * nx * ny * nz];
    let Load::Force { fz, offset_y, .. } = problem.load else {
        return forces;
    };
    // Distributed to the two rows of nodes next to the line of action; half of it on a mirror
    // plane.
    let row = grid.y.partition_point(|&y| y <= offset_y).clamp(1, ny - 1) - 1;
    let part = ((offset_y - grid.y[row]) / (grid.y[row + 1] - grid.y[row])).clamp(0.0, 1.0);
    let half = if symmetry[1] { 0.5 } else { 1.0 };
    let top = (2 * nz + nz - 1) * nx * ny;
    for load in loads {
        for (i, along) in spread_along(&grid.x, &load.place).iter().enumerate() {
            let force = -fz * load.share * along * half;
            forces[top + row * nx + i] += force * (1.0 - part);
            forces[top + (row + 1) * nx + i] += force * part;
        }
    }
    forces
}
