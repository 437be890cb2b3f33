//! Stress in the ice on the vertical line under the peak pressure.

use kufe_fem::{Material, maximum_shear};

use crate::{Error, Solution, VolumeField};

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

impl CentreLine {
    /// Maximum shear stress (sigma_1 - sigma_3) / 2 at each depth [Pa].
    pub fn shear(&self) -> Vec<f64> {
        self.stress.iter().map(|&s| maximum_shear(s)).collect()
    }

    /// The largest maximum shear stress and its depth: the vertex of the parabola through the largest value and its
    /// neighbours. `None` where it is largest at an end of the line.
    ///
    /// Under a circular Hertz contact of radius a it is 0.310 p_max at 0.481 a, under a line contact of half-width b
    /// 0.300 p_max at 0.786 b, for a Poisson's ratio of 0.3 (K. L. Johnson, Contact Mechanics, sections 4.1 and 3.4).
    pub fn largest_shear(&self) -> Option<LargestShear> {
        let shear = self.shear();
        let top = (0..shear.len()).max_by(|&a, &b| shear[a].total_cmp(&shear[b]))?;
        if top == 0 || top + 1 == shear.len() {
            return None;
        }
        let [a, b, c] = [top - 1, top, top + 1].map(|k| (self.depth[k], shear[k]));
        let (left, right) = ((b.1 - a.1) / (b.0 - a.0), (c.1 - b.1) / (c.0 - b.0));
        let bend = (right - left) / (c.0 - a.0);
        // Newton's form b.1 + slope (z - b.0) + bend (z - b.0)^2
        let slope = left + bend * (b.0 - a.0);
        let step = if bend < 0.0 { -0.5 * slope / bend } else { 0.0 };
        Some(LargestShear {
            value: b.1 + step * (slope + bend * step),
            depth: b.0 + step,
        })
    }
}

/// Stresses in the ice under the node of highest pressure, down to the end of the mesh or the bed.
///
/// sigma = lambda tr(epsilon) I + 2 mu epsilon with the strains of the nodal displacements by central differences: along x
/// and y through the neighbouring columns (mirrored at a plane of symmetry), along z over each layer of cells. Second
/// order in the spacing: about 1 % of p_max at the default accuracy of the peak pressure.
///
/// # Errors
/// [`Error::OutOfRange`] where the ice's elastic constants are none.
pub fn centre_line(solution: &Solution) -> Result<CentreLine, Error> {
    let (surface, volume) = (&solution.surface, &solution.volume);
    let material = Material::new(volume.youngs_modulus, volume.poissons_ratio).map_err(|_| {
        Error::OutOfRange {
            name: "ice material",
            value: volume.youngs_modulus,
            expected: "an elastic solid",
        }
    })?;
    let columns = surface.x.len();
    let peak = (0..surface.pressure.len())
        .max_by(|&a, &b| surface.pressure[a].total_cmp(&surface.pressure[b]))
        .unwrap_or(0);
    // The grid holds one part of a symmetric contact.
    let place = |axis: usize, at: f64| {
        if solution.symmetry[axis] {
            at.abs()
        } else {
            at
        }
    };
    let at = [
        place(0, surface.x[peak % columns]),
        place(1, surface.y[peak / columns]),
    ];
    let i = nearest(&volume.grid.x, at[0]);
    let j = nearest(&volume.grid.y, at[1]);
    let lowest = volume.bed.map_or(0, |(_, layers)| layers);
    let layers = (lowest..volume.grid.z.len() - 1).rev();
    let (depth, stress) = layers
        .map(|k| {
            let z = 0.5 * (volume.grid.z[k] + volume.grid.z[k + 1]);
            let strain = strain(volume, solution.symmetry, [i, j, k]);
            (-z, material.stress(strain))
        })
        .unzip();
    Ok(CentreLine { at, depth, stress })
}

fn nearest(nodes: &[f64], at: f64) -> usize {
    (0..nodes.len())
        .min_by(|&a, &b| (nodes[a] - at).abs().total_cmp(&(nodes[b] - at).abs()))
        .unwrap_or(0)
}

/// Strain on column (i, j) in the middle of layer k.
fn strain(volume: &VolumeField, symmetry: [bool; 2], [i, j, k]: [usize; 3]) -> [f64; 6] {
    let grid = &volume.grid;
    let u = |i: usize, j: usize, k: usize| volume.displacement[grid.node(i, j, k)];
    let middle = |i: usize, j: usize| {
        let (low, high) = (u(i, j, k), u(i, j, k + 1));
        [0, 1, 2].map(|c| 0.5 * (low[c] + high[c]))
    };
    // Rows: derivatives along x, y and z of the three components.
    let along_x = slope(&grid.x, i, 0, symmetry[0], |i| middle(i, j));
    let along_y = slope(&grid.y, j, 1, symmetry[1], |j| middle(i, j));
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

/// Central difference of a vector field at node `at` of an axis; one-sided at an end that is no mirror plane.
///
/// A mirror plane turns the component along the axis round and keeps the others.
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
