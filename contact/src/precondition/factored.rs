//! The factor of a solid as its preconditioner.

use std::sync::Arc;

use faer::Mat;
use kufe_fem::{to_components, to_nodes};

use crate::RunnerSolid;
use crate::bodies::mortar::Mortar;
use crate::precondition::work::InverseWork;

/// K^-1 by sparse Cholesky, with the contact plane reached through a mortar.
pub(crate) struct FactoredInverse {
    solid: Arc<RunnerSolid>,
    mortar: Arc<Mortar>,
}

impl FactoredInverse {
    /// Of a solid over the plane of `mortar`.
    pub fn new(solid: Arc<RunnerSolid>, mortar: Arc<Mortar>) -> Self {
        FactoredInverse { solid, mortar }
    }

    /// Vectors for the methods below.
    pub fn work(&self) -> InverseWork {
        let length = 3 * self.solid.mesh().points.len();
        InverseWork {
            kept: vec![0.0; length],
            scratch: vec![0.0; length],
            by_node: vec![0.0; length],
            ..InverseWork::default()
        }
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

    /// See [`crate::precondition::inverse::Inverse::begin`].
    pub fn begin(&self, residual: &[f64], closing: &mut [f64], work: &mut InverseWork) {
        work.kept.copy_from_slice(residual);
        self.solve(residual, &mut work.by_node, &mut work.scratch);
        self.mortar.add_closing(&work.scratch, closing);
    }

    /// See [`crate::precondition::inverse::Inverse::finish`].
    pub fn finish(&self, multipliers: &[(usize, f64)], step: &mut [f64], work: &mut InverseWork) {
        self.mortar.add_forces(multipliers, -1.0, &mut work.kept);
        self.solve(&work.kept, &mut work.by_node, step);
    }

    /// See [`crate::precondition::inverse::Inverse::respond`].
    pub fn respond(&self, forces: &[(usize, f64)], closing: &mut [f64], work: &mut InverseWork) {
        work.kept.fill(0.0);
        self.mortar.add_forces(forces, 1.0, &mut work.kept);
        self.solve(&work.kept, &mut work.by_node, &mut work.scratch);
        self.mortar.add_closing(&work.scratch, closing);
    }

    /// See [`crate::precondition::inverse::Inverse::green`]; both are exact.
    pub fn green(&self, nodes: &[usize]) -> [Mat<f64>; 2] {
        let mut used: Vec<usize> = nodes
            .iter()
            .flat_map(|&node| self.mortar.rows[node].iter().map(|&(k, _)| k))
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
                    self.mortar.rows[node]
                        .iter()
                        .map(|&(k, w)| w * response[k])
                        .sum()
                };
                responses.iter().map(of).collect()
            })
            .collect();
        let place = |k: usize| used.partition_point(|&u| u < k);
        let n = nodes.len();
        let lower = Mat::from_fn(n, n, |i, j| {
            let row = self.mortar.rows[nodes[j]].iter();
            row.map(|&(k, w)| w * half[i][place(k)]).sum::<f64>()
        });
        let green = Mat::from_fn(n, n, |i, j| 0.5 * (lower[(i, j)] + lower[(j, i)]));
        [green.clone(), green]
    }
}
