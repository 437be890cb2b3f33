//! The elastic runner in the slow way to the answer: its exact surface response by sparse Cholesky.

use faer::Mat;
use kufe_fem::{
    BlockMatrix, Body as Solid, Constraints, DofMap, ElementKind, Factor, assemble, to_components,
    to_nodes,
};

use crate::bodies::elastic_body::ElasticBody;
use crate::grid::contact_mesh::State;
use crate::grid::discretise::Discretisation;

/// The factorised runner of a mesh, its held displacements and what loads it.
pub(crate) struct PlainRunner<'a> {
    body: &'a ElasticBody,
    stiffness: BlockMatrix,
    constraints: Constraints,
    map: DofMap,
    factor: Factor,
    /// Forces from outside, node by node [N].
    load: Vec<f64>,
}

impl<'a> PlainRunner<'a> {
    /// The runner of `mesh`, held where `state` has its held displacements. None where it cannot be factorised.
    pub fn new(mesh: &'a Discretisation, element: ElementKind, state: &State) -> Option<Self> {
        let body = mesh.contact.bodies.get(1)?;
        let solid = Solid::uniform(mesh.runner_mesh.clone()?, body.material, element).ok()?;
        let nodes = solid.node_count();
        let start = mesh.contact.bodies[0].len();
        let held = &state.displacement[start..start + body.len()];
        let free = body.free()?;
        let mut constraints = Constraints::new(nodes);
        for c in 0..3 {
            for node in 0..nodes {
                let at = c * nodes + node;
                if !free[at] {
                    constraints.prescribe(node, c, held[at]).ok()?;
                }
            }
        }
        let map = constraints.dof_map();
        let stiffness = assemble(&solid);
        let factor = Factor::of_body(&stiffness, &map, &solid.mesh().points).ok()?;
        let mut load = vec![0.0; 3 * nodes];
        if !body.load.is_empty() {
            to_nodes(&body.load, &mut load);
        }
        Some(PlainRunner {
            body,
            stiffness,
            constraints,
            map,
            factor,
            load,
        })
    }

    /// Displacements by components under forces (node of the plane, value), loads and held displacements.
    pub fn displacement(&self, forces: &[(usize, f64)]) -> Vec<f64> {
        let mut contact = vec![0.0; self.body.len()];
        self.body.trace.add_forces(forces, &mut contact);
        let mut loads = vec![0.0; contact.len()];
        to_nodes(&contact, &mut loads);
        for (load, own) in loads.iter_mut().zip(&self.load) {
            *load = own - *load;
        }
        let u = self
            .factor
            .displacement(&self.stiffness, &self.constraints, &self.map, &loads);
        let mut out = vec![0.0; u.len()];
        to_components(&u, &mut out);
        out
    }

    /// Closing of the plane's nodes by displacements.
    pub fn closing(&self, displacement: &[f64], plane_nodes: usize) -> Vec<f64> {
        let mut closing = vec![0.0; plane_nodes];
        self.body.trace.add_closing(displacement, &mut closing);
        closing
    }

    /// B K^-1 B^T between the plane's nodes `nodes`.
    pub fn response(&self, nodes: &[usize], plane_nodes: usize) -> Mat<f64> {
        let still = self.closing(&self.displacement(&[]), plane_nodes);
        let columns: Vec<Vec<f64>> = nodes
            .iter()
            .map(|&node| self.closing(&self.displacement(&[(node, 1.0)]), plane_nodes))
            .collect();
        Mat::from_fn(nodes.len(), nodes.len(), |i, j| {
            still[nodes[i]] - columns[j][nodes[i]]
        })
    }
}
