//! Stress in the ice on the vertical line under the peak pressure.

use kufe_fem::{Material, maximum_shear};
use kufe_mesh::TensorGrid;

use crate::mesh::contact_mesh::State;
use crate::mesh::discretise::Discretisation;
use crate::problem::check::solid_material;
use crate::{Error, Solution};

/// Stresses on a vertical line in the ice.
#[derive(Clone, Debug, PartialEq)]
pub struct CentreLine {
    /// Where the line meets the surface [m].
    pub at: [f64; 2],
    /// Depths under the surface, increasing: the middles of the layers of cells [m].
    pub depth: Vec<f64>,
    /// Stress (xx, yy, zz, yz, zx, xy) at each depth, tension positive [Pa].
    pub stress: Vec<[f64; 6]>,
}

/// Where the shear is largest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LargestShear {
    /// Largest of the maximum shear stress (sigma_1 - sigma_3) / 2 on the line [Pa].
    pub value: f64,
    /// Its depth [m].
    pub depth: f64,
}

/// The largest shear on the line under the peak pressure, with its errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnderPeak {
    /// Largest of the maximum shear stress in the limit of finer and finer meshes [Pa].
    pub shear: f64,
    /// Estimated discretisation error of the shear [Pa].
    pub shear_error: f64,
    /// Its depth on the last mesh [m].
    pub depth: f64,
    /// Estimated error of the depth [m].
    pub depth_error: f64,
}

impl CentreLine {
    /// Maximum shear stress (sigma_1 - sigma_3) / 2 at each depth [Pa].
    pub fn shear(&self) -> Vec<f64> {
        self.stress.iter().map(|&s| maximum_shear(s)).collect()
    }

    /// The largest maximum shear stress and its depth, with stresses cubic between depths; `None`
    /// if it is largest at an end of the line.
    ///
    /// Under a circular Hertz contact of radius a it is 0.310 p_max at 0.481 a, under a line
    /// contact of half-width b 0.300 p_max at 0.786 b, for a Poisson's ratio of 0.3 (K. L. Johnson,
    /// Contact Mechanics, sections 4.1 and 3.4).
    pub fn largest_shear(&self) -> Option<LargestShear> {
        let shear = self.shear();
        let top = (0..shear.len()).max_by(|&a, &b| shear[a].total_cmp(&shear[b]))?;
        let last = shear.len() - 1;
        // The shear has a kink where two principal stresses are equal; the stress components are
        // smooth there.
        let between = (top.saturating_sub(1)..last.min(top + 1)).flat_map(|k| {
            let (from, to) = (self.depth[k], self.depth[k + 1]);
            (0..=STEPS).map(move |step| from + (to - from) * f64::from(step) / f64::from(STEPS))
        });
        let at = between.map(|depth| LargestShear {
            value: maximum_shear(self.stress_at(depth)),
            depth,
        });
        at.max_by(|a, b| a.value.total_cmp(&b.value))
            .filter(|at| self.depth[0] < at.depth && at.depth < self.depth[last])
    }

    /// Stress at a depth by the cubics through the four depths nearest to it [Pa].
    pub fn stress_at(&self, depth: f64) -> [f64; 6] {
        let count = self.depth.len().min(4);
        let next = self.depth.partition_point(|&d| d < depth);
        let first = next.saturating_sub(2).min(self.depth.len() - count);
        let nodes = &self.depth[first..first + count];
        let mut stress = [0.0; 6];
        for (k, own) in self.stress[first..first + count].iter().enumerate() {
            let weight = lagrange(nodes, k, depth);
            for (sum, part) in stress.iter_mut().zip(own) {
                *sum += weight * part;
            }
        }
        stress
    }
}

/// Number of steps between two depths in the search for the largest shear; its error is of second
/// order in the step.
const STEPS: u32 = 200;

/// The polynomial through all nodes that is 1 at node `k` and 0 at the others, at `x`.
pub(crate) fn lagrange(nodes: &[f64], k: usize, x: f64) -> f64 {
    let others = (0..nodes.len()).filter(|&other| other != k);
    others
        .map(|other| (x - nodes[other]) / (nodes[k] - nodes[other]))
        .product()
}

// Stresses of a mesh's displacements on the line under the highest pressure.

/// Stresses in the ice on the vertical line under the highest pressure, down to the end of the mesh
/// or the bed; `None` if only the contact plane was solved.
///
/// The line is at the vertex of the parabolas through the highest node and its neighbours.
/// sigma = lambda tr(epsilon) I + 2 mu epsilon with the strains of the nodal displacements by
/// central differences: along x and y through the neighbouring columns (mirrored at a plane of
/// symmetry), along z over each layer of cells; between columns stresses are parabolas. Second
/// order in the spacing: about 1 % of p_max on the last mesh of the default accuracy.
/// [`UnderPeak`](crate::UnderPeak) gives the limit of finer meshes.
///
/// # Errors
/// [`Error::OutOfRange`] if the ice's elastic constants are out of range.
pub fn centre_line(solution: &Solution) -> Result<Option<CentreLine>, Error> {
    let (surface, Some(volume)) = (&solution.surface, &solution.volume) else {
        return Ok(None);
    };
    let (modulus, ratio) = (volume.youngs_modulus, volume.poissons_ratio);
    let material = solid_material("ice material", modulus, ratio)?;
    // The grid holds one part of a symmetric contact: the surface's last columns and rows.
    let [nx, ny, _] = volume.grid.shape();
    let (all, rows) = (surface.x.len(), surface.y.len());
    let part = surface.pressure.chunks_exact(all).skip(rows - ny);
    let pressure: Vec<f64> = part.flat_map(|row| &row[all - nx..]).copied().collect();
    let under = SubsurfaceField {
        grid: &volume.grid,
        symmetry: solution.symmetry,
        material,
        lowest: volume.bed.map_or(0, |(_, layers)| layers),
        displacement: &|node| volume.displacement[node],
    };
    Ok(Some(under.line(&pressure)))
}

/// Displacements under a contact plane, of the part that was solved.
pub(crate) struct SubsurfaceField<'a> {
    pub grid: &'a TensorGrid,
    /// Mirror planes x = 0 and y = 0.
    pub symmetry: [bool; 2],
    /// Material of the ice.
    pub material: Material,
    /// Number of lowest layers of cells that belong to an elastic bed.
    pub lowest: usize,
    /// Displacement of a node [m].
    pub displacement: &'a dyn Fn(usize) -> [f64; 3],
}

impl Discretisation {
    /// The largest shear under the highest of these pressures; `None` at an end of the line.
    pub fn largest_shear(
        &self,
        material: Material,
        pressure: &[f64],
        state: &State,
    ) -> Option<LargestShear> {
        let nodes = self.grid.node_count();
        let under = SubsurfaceField {
            grid: &self.grid,
            symmetry: self.symmetry,
            material,
            lowest: self.bed_layers(),
            displacement: &|node| [0, 1, 2].map(|c| state.displacement[c * nodes + node]),
        };
        under.line(pressure).largest_shear()
    }
}

/// Pressures above this fraction of the highest one are equal to it up to rounding.
const HIGHEST: f64 = 1.0 - 1e-9;

impl SubsurfaceField<'_> {
    /// Stresses under the highest of these pressures at the nodes of the plane.
    pub fn line(&self, pressure: &[f64]) -> CentreLine {
        let (x, y) = (&self.grid.x, &self.grid.y);
        let nx = x.len();
        let [i, j] = self.highest(pressure);
        let along = self.vertex(x, i, 0, |k| pressure[j * nx + k]);
        let across = self.vertex(y, j, 1, |k| pressure[k * nx + i]);
        let (is, js) = (weights(x, i, along), weights(y, j, across));
        let layers = (self.lowest..self.grid.z.len() - 1).rev();
        let (depth, stress) = layers
            .map(|k| {
                let z = 0.5 * (self.grid.z[k] + self.grid.z[k + 1]);
                let mut stress = [0.0; 6];
                for &(j, across) in &js {
                    for &(i, along) in &is {
                        let own = self.material.stress(self.strain([i, j, k]));
                        for (sum, part) in stress.iter_mut().zip(own) {
                            *sum += along * across * part;
                        }
                    }
                }
                (-z, stress)
            })
            .unzip();
        CentreLine {
            at: [along, across],
            depth,
            stress,
        }
    }

    /// The node of the highest pressure; of several equal ones, as in yielding ice, the node
    /// nearest to their middle.
    fn highest(&self, pressure: &[f64]) -> [usize; 2] {
        let nx = self.grid.x.len();
        let highest = HIGHEST * pressure.iter().copied().fold(0.0, f64::max);
        let all: Vec<usize> = (0..pressure.len())
            .filter(|&n| pressure[n] >= highest)
            .collect();
        let place = |n: usize| [self.grid.x[n % nx], self.grid.y[n / nx]];
        let middle = [0, 1].map(|axis| {
            if self.symmetry[axis] {
                0.0
            } else {
                all.iter().map(|&n| place(n)[axis]).sum::<f64>() / all.len() as f64
            }
        });
        let off = |n: usize| {
            let [x, y] = place(n);
            (x - middle[0]).hypot(y - middle[1])
        };
        let nearest = all.iter().min_by(|&&a, &&b| off(a).total_cmp(&off(b)));
        nearest.map_or([0, 0], |&n| [n % nx, n / nx])
    }

    /// Vertex of the parabola through the pressures of a node and its neighbours; the node itself
    /// if a neighbour is open or all three are equal.
    fn vertex(&self, nodes: &[f64], k: usize, axis: usize, pressure: impl Fn(usize) -> f64) -> f64 {
        let inside = k > 0 && k + 1 < nodes.len();
        if !inside || (self.symmetry[axis] && nodes[k] == 0.0) {
            return nodes[k];
        }
        let [a, b, c] = [k - 1, k, k + 1].map(|n| (nodes[n], pressure(n)));
        let (left, right) = ((b.1 - a.1) / (b.0 - a.0), (c.1 - b.1) / (c.0 - b.0));
        if a.1.min(c.1) <= 0.0 || left <= right {
            return nodes[k];
        }
        // Slopes in the middles of both sides, 0 between them.
        let [low, high] = [0.5 * (a.0 + b.0), 0.5 * (b.0 + c.0)];
        (low + left / (left - right) * (high - low)).clamp(low, high)
    }

    /// Strain on column (i, j) in the middle of layer k.
    fn strain(&self, [i, j, k]: [usize; 3]) -> [f64; 6] {
        let grid = self.grid;
        let u = |i: usize, j: usize, k: usize| (self.displacement)(grid.node(i, j, k));
        let middle = |i: usize, j: usize| {
            let (low, high) = (u(i, j, k), u(i, j, k + 1));
            [0, 1, 2].map(|c| 0.5 * (low[c] + high[c]))
        };
        // Rows: derivatives along x, y and z of the three components.
        let along_x = slope(&grid.x, i, 0, self.symmetry[0], |i| middle(i, j));
        let along_y = slope(&grid.y, j, 1, self.symmetry[1], |j| middle(i, j));
        let (low, high) = (u(i, j, k), u(i, j, k + 1));
        let along_z = [0, 1, 2].map(|c| (high[c] - low[c]) / (grid.z[k + 1] - grid.z[k]));
        [
            along_x[0],
            along_y[1],
            along_z[2],
            along_y[2] + along_z[1],
            along_z[0] + along_x[2],
            along_x[1] + along_y[0],
        ]
    }
}

/// Node `k` and its neighbours, with their weights in the interpolating parabola at `at`.
fn weights(nodes: &[f64], k: usize, at: f64) -> Vec<(usize, f64)> {
    if at == nodes[k] {
        return vec![(k, 1.0)];
    }
    let near = &nodes[k - 1..=k + 1];
    (0..3).map(|n| (k - 1 + n, lagrange(near, n, at))).collect()
}

/// Central difference of a vector field at node `at` of an axis; one-sided at an end that is no
/// mirror plane.
///
/// A mirror plane reverses the component along the axis and keeps the others.
fn slope(
    nodes: &[f64],
    at: usize,
    axis: usize,
    mirrored: bool,
    value: impl Fn(usize) -> [f64; 3],
) -> [f64; 3] {
    let here = value(at);
    let up = (at + 1 < nodes.len()).then(|| (nodes[at + 1] - nodes[at], value(at + 1)));
    let down = match at {
        0 if mirrored => up.map(|(h, mut v)| {
            v[axis] = -v[axis];
            (h, v)
        }),
        0 => None,
        _ => Some((nodes[at] - nodes[at - 1], value(at - 1))),
    };
    [0, 1, 2].map(|c| {
        let rise = |(h, v): (f64, [f64; 3])| (v[c] - here[c]) / h;
        match (down, up) {
            (Some(d), Some(u)) => (-rise(d) * u.0 + rise(u) * d.0) / (d.0 + u.0),
            (Some(d), None) => -rise(d),
            (None, Some(u)) => rise(u),
            (None, None) => 0.0,
        }
    })
}
