//! A runner of unstructured hexahedra.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use kufe_fem::{
    BlockMatrix, Body, Constraints, DofMap, ElementKind, Factor, Material, NodeCells, assemble,
    boundary_faces,
};
use kufe_mesh::{HexMesh, Hull, Noise, noise_of_faces};

use crate::Error;

/// The factorised stiffness of a runner of unstructured hexahedra, and the faces that may touch the
/// ice.
///
/// Cells have incompatible modes, for the bending of thin steel. The factor is computed once and
/// used on every mesh of the ice.
pub struct RunnerSolid {
    pub(crate) body: Body,
    pub(crate) stiffness: BlockMatrix,
    pub(crate) map: DofMap,
    pub(crate) factor: Factor,
    /// Faces of the underside, nodes counter-clockwise seen from below.
    pub(crate) faces: Vec<[usize; 4]>,
    /// Heights of the hexahedra on these faces [m].
    heights: Vec<f64>,
    /// Nodes of the underside.
    pub(crate) surface: Vec<usize>,
    /// Vertical displacements of the underside's nodes under 1 N on one of them, by that node:
    /// those requested so far [m/N].
    responses: Mutex<HashMap<usize, Vec<f64>>>,
}

impl std::fmt::Debug for RunnerSolid {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RunnerSolid")
            .field("nodes", &self.body.node_count())
            .field("underside", &self.faces.len())
            .field("factor", &self.factor)
            .finish()
    }
}

/// Largest vertical part of the outward unit normal of a face that faces down.
const DOWN: f64 = -0.2;
/// Right-hand sides solved at once.
const BATCH: usize = 32;

impl RunnerSolid {
    /// A solid of one material whose nodes where `fixed` are clamped; z points up.
    ///
    /// The underside consists of the faces that face down and are connected with the lowest one.
    ///
    /// # Errors
    /// [`Error::Unsuitable`] if a cell is inside out, no node is fixed, the fixed nodes leave a
    /// mechanism, or no face faces down.
    pub fn new(
        mesh: HexMesh,
        youngs_modulus: f64,
        poissons_ratio: f64,
        fixed: impl Fn([f64; 3]) -> bool,
    ) -> Result<Self, Error> {
        let bad = Error::runner_mesh::<String>;
        let unsuitable = Error::runner_mesh::<kufe_fem::Error>;
        let material = Material::new(youngs_modulus, poissons_ratio).map_err(unsuitable)?;
        if let Some(wrong) = wrong_in(&mesh) {
            return Err(bad(wrong));
        }
        let faces = underside(&mesh);
        if faces.is_empty() {
            return Err(bad("no face of its mesh faces down".into()));
        }
        let clamped: Vec<usize> = (0..mesh.points.len())
            .filter(|&node| fixed(mesh.points[node]))
            .collect();
        if clamped.is_empty() {
            return Err(bad("its mount holds no node of its mesh".into()));
        }
        let heights = heights(&mesh, &faces);
        let body =
            Body::uniform(mesh, material, ElementKind::Hex8Incompatible).map_err(unsuitable)?;
        let mut constraints = Constraints::new(body.node_count());
        constraints.clamp(clamped).map_err(unsuitable)?;
        let map = constraints.dof_map();
        let stiffness = assemble(&body);
        let factor = Factor::of_body(&stiffness, &map, &body.mesh().points).map_err(unsuitable)?;
        let mut surface: Vec<usize> = faces.iter().flatten().copied().collect();
        surface.sort_unstable();
        surface.dedup();
        Ok(RunnerSolid {
            body,
            stiffness,
            map,
            factor,
            faces,
            heights,
            surface,
            responses: Mutex::default(),
        })
    }

    /// The hexahedra.
    pub fn mesh(&self) -> &HexMesh {
        self.body.mesh()
    }

    /// Young's modulus and Poisson's ratio.
    pub(crate) fn material(&self) -> Material {
        self.body.sections()[0].material
    }

    /// The underside as triangles, for a smooth surface through its nodes.
    pub fn underside(&self) -> Hull {
        let number = |node: usize| self.surface.partition_point(|&s| s < node) as u32;
        let triangles = self.faces.iter().flat_map(|face| {
            let [a, b, c, d] = face.map(number);
            [[a, b, c], [a, c, d]]
        });
        let nodes = self.surface.iter();
        Hull {
            positions: nodes.map(|&node| self.mesh().points[node]).collect(),
            triangles: triangles.collect(),
        }
    }

    /// Noise of the underside's nodes, as [`noise_of_faces`] estimates it.
    pub fn noise(&self) -> Option<Noise> {
        noise_of_faces(&self.mesh().points, &self.faces)
    }

    /// Largest extents along x, y and z of the hexahedra on the underside's faces whose middle lies
    /// within these intervals of x and y [m]; zero if there are none.
    pub(crate) fn largest_cell(&self, x: [f64; 2], y: [f64; 2]) -> [f64; 3] {
        let mut largest = [0.0f64; 3];
        for (face, &height) in self.faces.iter().zip(&self.heights) {
            let ends = [0, 1].map(|axis| {
                let at = face.map(|node| self.mesh().points[node][axis]);
                [
                    at.into_iter().reduce(f64::min),
                    at.into_iter().reduce(f64::max),
                ]
                .map(|end| end.unwrap_or(f64::NAN))
            });
            let middle = ends.map(|[low, high]| 0.5 * (low + high));
            if (x[0]..=x[1]).contains(&middle[0]) && (y[0]..=y[1]).contains(&middle[1]) {
                let [dx, dy] = ends.map(|[low, high]| high - low);
                for (largest, size) in largest.iter_mut().zip([dx, dy, height]) {
                    *largest = largest.max(size);
                }
            }
        }
        largest
    }

    /// Vertical displacements of the underside's nodes, in the order of `surface`, under 1 N
    /// upwards on each of `nodes` [m/N].
    pub(crate) fn responses(&self, nodes: &[usize]) -> Vec<Vec<f64>> {
        let known = self.responses.lock();
        let mut known = known.unwrap_or_else(PoisonError::into_inner);
        let missing = nodes.iter().filter(|node| !known.contains_key(node));
        let missing: Vec<usize> = missing.copied().collect();
        let free = self.map.free_count();
        for batch in missing.chunks(BATCH) {
            let mut sides = vec![0.0; free * batch.len()];
            for (column, &node) in sides.chunks_exact_mut(free).zip(batch) {
                if let Some(index) = self.map.index(3 * node + 2) {
                    column[index] = 1.0;
                }
            }
            self.factor.solve(&mut sides);
            for (column, &node) in sides.chunks_exact(free).zip(batch) {
                let index = |node: usize| self.map.index(3 * node + 2);
                let vertical = |&node: &usize| index(node).map_or(0.0, |index| column[index]);
                known.insert(node, self.surface.iter().map(vertical).collect());
            }
        }
        nodes.iter().map(|node| known[node].clone()).collect()
    }
}

/// The first defect of a mesh, in words: a node that is not finite, or a cell with a node that does
/// not exist.
fn wrong_in(mesh: &HexMesh) -> Option<String> {
    let count = mesh.points.len();
    let infinite = |point: &[f64; 3]| point.iter().any(|x| !x.is_finite());
    if let Some(node) = mesh.points.iter().position(infinite) {
        return Some(format!("node {node} of its mesh is not finite"));
    }
    let strange = |cell: &[usize; 8]| cell.iter().any(|&node| node >= count);
    let cell = mesh.cells.iter().position(strange)?;
    Some(format!(
        "cell {cell} of its mesh has a node that is not one of the {count} nodes"
    ))
}

/// Faces that face down and are connected, over edges, with the one whose centre is lowest.
fn underside(mesh: &HexMesh) -> Vec<[usize; 4]> {
    let down: Vec<[usize; 4]> = boundary_faces(mesh)
        .into_iter()
        .filter(|face| {
            let [a, b, c, d] = face.map(|node| mesh.points[node]);
            let minus = |p: [f64; 3], q: [f64; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
            let (p, q) = (minus(c, a), minus(d, b));
            let normal = [
                p[1] * q[2] - p[2] * q[1],
                p[2] * q[0] - p[0] * q[2],
                p[0] * q[1] - p[1] * q[0],
            ];
            let length = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
            normal[2] < DOWN * length
        })
        .collect();
    let mut by_edge: HashMap<[usize; 2], Vec<usize>> = HashMap::new();
    let edges = |face: &[usize; 4]| {
        let face = *face;
        (0..4).map(move |k| {
            let (a, b) = (face[k], face[(k + 1) % 4]);
            [a.min(b), a.max(b)]
        })
    };
    for (index, face) in down.iter().enumerate() {
        for edge in edges(face) {
            by_edge.entry(edge).or_default().push(index);
        }
    }
    let height = |face: &[usize; 4]| face.iter().map(|&n| mesh.points[n][2]).sum::<f64>();
    let lowest = (0..down.len()).min_by(|&a, &b| height(&down[a]).total_cmp(&height(&down[b])));
    let mut reached = vec![false; down.len()];
    let mut open: Vec<usize> = lowest.into_iter().collect();
    while let Some(index) = open.pop() {
        if !std::mem::replace(&mut reached[index], true) {
            open.extend(edges(&down[index]).flat_map(|edge| by_edge[&edge].iter().copied()));
        }
    }
    down.into_iter()
        .zip(reached)
        .filter_map(|(face, reached)| reached.then_some(face))
        .collect()
}

/// Heights of the hexahedra on these faces, in the mean of their four edges that leave the face
/// [m].
fn heights(mesh: &HexMesh, faces: &[[usize; 4]]) -> Vec<f64> {
    let cells = NodeCells::new(mesh);
    let height = |face: &[usize; 4]| {
        let around = cells.of(face[0]).map(|(cell, _)| &mesh.cells[cell]);
        let edge = |node: &usize| {
            let sign = if face.contains(node) { -0.25 } else { 0.25 };
            sign * mesh.points[*node][2]
        };
        around
            .filter(|cell| face.iter().all(|node| cell.contains(node)))
            .map(|cell| cell.iter().map(edge).sum::<f64>())
            .fold(0.0, f64::max)
    };
    faces.iter().map(height).collect()
}
