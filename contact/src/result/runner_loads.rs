//! Loads of an elastic runner: its largest stress, and its forces on each part of the mount.

use std::collections::BTreeMap;

use kufe_fem::{Body, FACES, Material, MatrixFree, nodal_stresses, von_mises};
use kufe_mesh::HexMesh;

use crate::{ElasticRunner, Error, Mount, Problem, RunnerField, Solution};

/// What the steel bears, of the last mesh: nothing here is extrapolated.
#[derive(Clone, Debug, PartialEq)]
pub struct RunnerLoads {
    /// Largest von Mises stress at a node [Pa].
    pub von_mises: f64,
    /// Where that is, undeformed, as in [`RunnerField::mesh`] [m]; where mirror planes were used
    /// its images bear the same.
    pub at: [f64; 3],
    /// Von Mises stress at the nodes of [`RunnerField::mesh`] [Pa].
    pub von_mises_at_nodes: Vec<f64>,
    /// The parts of the mount along the runner; none where the runner has no end.
    pub mounts: Vec<MountForce>,
}

/// What the runner pushes one part of its mount with.
#[derive(Clone, Debug, PartialEq)]
pub struct MountForce {
    /// Centre of the fixed or loaded part [m].
    pub at: [f64; 3],
    /// Force on the mount; what carries a load has that load, upwards [N].
    pub force: [f64; 3],
    /// Moment on the mount about `at` [N m].
    pub moment: [f64; 3],
    /// Largest von Mises stress of the steel at its nodes [Pa].
    pub von_mises: f64,
}

/// The runner's largest von Mises stress and its forces on the mount; `None` where it is rigid.
///
/// The steel's nodal forces f = K u are those that act on it from outside. On the nodes of a part
/// of the mount they are the mount's,
///
/// F = -sum f,  M = -sum (r - r0) x f,
///
/// with r0 the middle of the part: a part is connected over fixed faces. They sum to the contact's
/// force and to its moments as far as equilibrium is reached. Stresses are [`nodal_stresses`]; at
/// the rim of a fixed part they are singular, so that they grow there with finer meshes.
///
/// # Errors
/// [`Error::Unsuitable`] where the solution's mesh is no body.
pub fn runner_loads(problem: &Problem, solution: &Solution) -> Result<Option<RunnerLoads>, Error> {
    let (Some(elastic), Some(field)) = (&problem.runner.elastic, &solution.runner_volume) else {
        return Ok(None);
    };
    let said = Error::runner_mesh::<kufe_fem::Error>;
    let material = Material::new(elastic.youngs_modulus, elastic.poissons_ratio).map_err(said)?;
    let body = Body::uniform(field.mesh.clone(), material, elastic.element_kind()).map_err(said)?;
    let displacement: Vec<f64> = field.displacement.iter().flatten().copied().collect();
    let mises: Vec<f64> = nodal_stresses(&body, &displacement)
        .into_iter()
        .map(von_mises)
        .collect();
    let most = (0..mises.len()).fold(0, |most, n| if mises[n] > mises[most] { n } else { most });
    let mut mounts = Vec::new();
    let ends = problem.runner.underside.extent();
    if elastic.solid.is_some() || ends.iter().all(|end| end.is_finite()) {
        let mut forces = vec![0.0; displacement.len()];
        MatrixFree::new(&body).apply(&displacement, &mut forces);
        let on_mount = on_mount(elastic, field);
        for nodes in parts(&field.mesh, &on_mount) {
            let part = Part {
                nodes: &nodes,
                mesh: &field.mesh,
                forces: &forces,
                von_mises: nodes.iter().fold(0.0, |m, &n| f64::max(m, mises[n])),
            };
            mounts.extend(part.unfolded(solution.symmetry));
        }
        mounts.sort_by(|a, b| {
            a.at[0]
                .total_cmp(&b.at[0])
                .then(a.at[1].total_cmp(&b.at[1]))
        });
    }
    Ok(Some(RunnerLoads {
        von_mises: mises[most],
        at: field.mesh.points[most],
        von_mises_at_nodes: mises,
        mounts,
    }))
}

/// The nodes that a mount holds or loads.
fn on_mount(elastic: &ElasticRunner, field: &RunnerField) -> Vec<bool> {
    let points = &field.mesh.points;
    if let Some(solid) = &elastic.solid {
        let fixed = |node| solid.map.index(3 * node).is_none();
        return (0..points.len()).map(fixed).collect();
    }
    let top = points
        .iter()
        .map(|p| p[2])
        .fold(f64::NEG_INFINITY, f64::max);
    let slack = 1e-9 * top.abs();
    let over = |x| elastic.mount == Mount::Top || elastic.mount.over(x);
    let fixed = |p: &[f64; 3]| p[2] >= top - slack && over(p[0]);
    points.iter().map(fixed).collect()
}

/// Nodes that hang together over faces of which all corners are `on`; the remaining nodes, within
/// cells.
fn parts(mesh: &HexMesh, on: &[bool]) -> Vec<Vec<usize>> {
    let mut above: Vec<usize> = (0..on.len()).collect();
    let mut join = |nodes: &[usize]| {
        let roots: Vec<usize> = nodes.iter().map(|&n| root(&mut above, n)).collect();
        let first = roots.iter().copied().min().unwrap_or(0);
        roots.into_iter().for_each(|root| above[root] = first);
    };
    let mut unassigned = on.to_vec();
    for cell in mesh.cells.iter().filter(|cell| cell.iter().any(|&n| on[n])) {
        for face in FACES.map(|face| face.map(|corner| cell[corner])) {
            if face.iter().all(|&n| on[n]) {
                join(&face);
                face.iter().for_each(|&n| unassigned[n] = false);
            }
        }
    }
    for cell in mesh
        .cells
        .iter()
        .filter(|cell| cell.iter().any(|&n| unassigned[n]))
    {
        let nodes: Vec<usize> = cell.iter().copied().filter(|&n| unassigned[n]).collect();
        join(&nodes);
    }
    let mut parts: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for node in (0..on.len()).filter(|&n| on[n]) {
        let root = root(&mut above, node);
        parts.entry(root).or_default().push(node);
    }
    parts.into_values().collect()
}

/// The node that represents all that a node hangs together with.
fn root(above: &mut [usize], mut node: usize) -> usize {
    while above[node] != node {
        above[node] = above[above[node]];
        node = above[node];
    }
    node
}

/// A part of the mount, on the side of the mirror planes that was solved.
struct Part<'a> {
    nodes: &'a [usize],
    mesh: &'a HexMesh,
    /// K u, three a node [N].
    forces: &'a [f64],
    von_mises: f64,
}

impl Part<'_> {
    /// The part with its mirror images: one with it where it meets the plane, separate from it
    /// where it does not.
    fn unfolded(&self, symmetry: [bool; 2]) -> Vec<MountForce> {
        let meets = [0, 1].map(|axis| {
            let on_plane = |&n: &usize| self.mesh.points[n][axis] == 0.0;
            symmetry[axis] && self.nodes.iter().any(on_plane)
        });
        let separate = [0, 1].map(|axis| symmetry[axis] && !meets[axis]);
        let whole = signs(meets);
        let image = |sign: [f64; 2]| -> MountForce {
            let turned: Vec<[f64; 2]> = whole
                .iter()
                .map(|own| [own[0] * sign[0], own[1] * sign[1]])
                .collect();
            self.force(&turned)
        };
        signs(separate).into_iter().map(image).collect()
    }

    /// What acts on the images of the part by these signs of x and y, together.
    fn force(&self, images: &[[f64; 2]]) -> MountForce {
        let turned = |[sx, sy]: [f64; 2], [x, y, z]: [f64; 3]| [sx * x, sy * y, z];
        let places = images.iter().flat_map(|&sign| {
            let points = self.nodes.iter().map(|&n| self.mesh.points[n]);
            points.map(move |p| turned(sign, p))
        });
        let mut ends = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for place in places {
            for axis in 0..3 {
                ends[0][axis] = ends[0][axis].min(place[axis]);
                ends[1][axis] = ends[1][axis].max(place[axis]);
            }
        }
        let at = [0, 1, 2].map(|axis| 0.5 * (ends[0][axis] + ends[1][axis]));
        let (mut force, mut moment) = ([0.0; 3], [0.0; 3]);
        for &sign in images {
            for &node in self.nodes {
                let own = [0, 1, 2].map(|axis| -self.forces[3 * node + axis]);
                let [fx, fy, fz] = turned(sign, own);
                let place = turned(sign, self.mesh.points[node]);
                let [x, y, z] = [0, 1, 2].map(|axis| place[axis] - at[axis]);
                let turn = [y * fz - z * fy, z * fx - x * fz, x * fy - y * fx];
                for (axis, (f, m)) in [fx, fy, fz].into_iter().zip(turn).enumerate() {
                    force[axis] += f;
                    moment[axis] += m;
                }
            }
        }
        MountForce {
            at,
            force,
            moment,
            von_mises: self.von_mises,
        }
    }
}

/// The signs of x and y of all images by these mirror planes, the original first.
fn signs(planes: [bool; 2]) -> Vec<[f64; 2]> {
    let of = |used: bool| if used { vec![1.0, -1.0] } else { vec![1.0] };
    let along = of(planes[0]);
    let each = along.into_iter();
    each.flat_map(|x| of(planes[1]).into_iter().map(move |y| [x, y]))
        .collect()
}

#[cfg(test)]
#[path = "runner_loads_tests.rs"]
mod tests;
