//! A runner on its own hexahedra as a body of the contact problem.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use faer::Mat;
use kufe_fem::{Body, SparseStiffness, to_components, to_nodes};
use kufe_mesh::TensorGrid;

use crate::RunnerSolid;
use crate::bodies::elastic_body::ElasticBody;
use crate::bodies::mortar::{Rows, mortar_rows};

/// A solid with its factor as preconditioner, exact, over the ice's plane by a mortar.
pub(crate) struct SolidBody {
    solid: Arc<RunnerSolid>,
    /// For each plane node the weights of the underside's nodes, by their place in the solid's `surface`.
    rows: Rows,
    /// The solid's stiffness in the order of its vector: what is multiplied with where it is there.
    pub assembled: Option<Arc<SparseStiffness>>,
    work: Mutex<Work>,
}

/// The residual that a step begins with and vectors node by node.
struct Work {
    residual: Vec<f64>,
    by_node: Vec<f64>,
    image: Vec<f64>,
}

impl SolidBody {
    /// Over the plane of the ice's `grid`.
    pub fn new(solid: Arc<RunnerSolid>, grid: &TensorGrid) -> Self {
        let place = |node: usize| solid.surface.partition_point(|&s| s < node);
        let faces: Vec<_> = solid
            .faces
            .iter()
            .map(|face| {
                let corners = face.map(|node| solid.mesh().points[node]);
                (face.map(place), corners.map(|p| [p[0], p[1]]))
            })
            .collect();
        let length = 3 * solid.mesh().points.len();
        SolidBody {
            rows: mortar_rows(grid, &faces),
            assembled: None,
            work: Mutex::new(Work {
                residual: vec![0.0; length],
                by_node: vec![0.0; length],
                image: vec![0.0; length],
            }),
            solid,
        }
    }

    /// The hexahedra.
    pub fn body(&self) -> &Body {
        self.solid.body()
    }

    /// Which entries nothing holds.
    pub fn free(&self) -> Vec<bool> {
        (0..self.len()).map(|entry| self.is_free(entry)).collect()
    }

    fn is_free(&self, entry: usize) -> bool {
        let nodes = self.solid.mesh().points.len();
        let dof = 3 * (entry % nodes) + entry / nodes;
        self.solid.map.index(dof).is_some()
    }

    fn work(&self) -> MutexGuard<'_, Work> {
        // Never contended: one iteration runs at a time.
        self.work.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Place in the solid's vector, by components, of the vertical displacement of a node of `surface`.
    fn entry(&self, surface: usize) -> usize {
        2 * self.solid.mesh().points.len() + self.solid.surface[surface]
    }

    /// K^-1 `r`, by components, through vectors node by node.
    fn solve(&self, r: &[f64], by_node: &mut [f64], out: &mut [f64]) {
        to_nodes(r, by_node);
        let mut free = self.solid.map.restrict(by_node);
        self.solid.factor.solve(&mut free);
        by_node.fill(0.0);
        self.solid.map.extend(&free, by_node);
        to_components(by_node, out);
    }
}

impl ElasticBody for SolidBody {
    fn len(&self) -> usize {
        3 * self.solid.mesh().points.len()
    }

    fn free_dofs(&self) -> usize {
        self.solid.map.free_count()
    }

    fn apply(&self, u: &[f64], out: &mut [f64]) {
        if let Some(assembled) = &self.assembled {
            assembled.apply(u, out);
            let entries = out.iter_mut().enumerate();
            let held = entries.filter(|(entry, _)| !self.is_free(*entry));
            held.for_each(|(_, out)| *out = 0.0);
            return;
        }
        let mut work = self.work();
        let Work { by_node, image, .. } = &mut *work;
        to_nodes(u, by_node);
        self.solid.stiffness.apply(by_node, image);
        let free = self.solid.map.restrict(image);
        image.fill(0.0);
        self.solid.map.extend(&free, image);
        to_components(image, out);
    }

    fn add_closing(&self, u: &[f64], closing: &mut [f64]) {
        for (closing, row) in closing.iter_mut().zip(&self.rows) {
            *closing -= row.iter().map(|&(k, w)| w * u[self.entry(k)]).sum::<f64>();
        }
    }

    fn add_forces(&self, forces: &[(usize, f64)], out: &mut [f64]) {
        for &(node, force) in forces {
            for &(k, w) in &self.rows[node] {
                out[self.entry(k)] -= w * force;
            }
        }
    }

    fn begin(&self, residual: &[f64], closing: &mut [f64]) {
        let mut answer = vec![0.0; residual.len()];
        let mut work = self.work();
        let Work {
            residual: kept,
            by_node,
            ..
        } = &mut *work;
        kept.copy_from_slice(residual);
        self.solve(residual, by_node, &mut answer);
        drop(work);
        self.add_closing(&answer, closing);
    }

    fn finish(&self, multipliers: &[(usize, f64)], step: &mut [f64]) {
        let opposite: Vec<(usize, f64)> = multipliers.iter().map(|&(n, m)| (n, -m)).collect();
        let mut work = self.work();
        let Work {
            residual, by_node, ..
        } = &mut *work;
        self.add_forces(&opposite, residual);
        self.solve(residual, by_node, step);
    }

    fn green(&self, nodes: &[usize]) -> [Mat<f64>; 2] {
        let mut used: Vec<usize> = nodes
            .iter()
            .flat_map(|&node| self.rows[node].iter().map(|&(k, _)| k))
            .collect();
        used.sort_unstable();
        used.dedup();
        let numbers: Vec<usize> = used.iter().map(|&k| self.solid.surface[k]).collect();
        let responses = self.solid.responses(&numbers);
        // W S, then W S W^T.
        let half: Vec<Vec<f64>> = nodes
            .iter()
            .map(|&node| {
                let of = |response: &Vec<f64>| -> f64 {
                    self.rows[node].iter().map(|&(k, w)| w * response[k]).sum()
                };
                responses.iter().map(of).collect()
            })
            .collect();
        let place = |k: usize| used.partition_point(|&u| u < k);
        let n = nodes.len();
        let lower = Mat::from_fn(n, n, |i, j| {
            let row = self.rows[nodes[j]].iter();
            row.map(|&(k, w)| w * half[i][place(k)]).sum::<f64>()
        });
        let green = Mat::from_fn(n, n, |i, j| 0.5 * (lower[(i, j)] + lower[(j, i)]));
        [green.clone(), green]
    }

    fn load(&self) -> &[f64] {
        &[]
    }
}
