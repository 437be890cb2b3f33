//! Sparse Cholesky factors of a body's stiffness.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::perm::Perm;
use faer::sparse::SparseColMat;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::{Conj, MatMut, Par, Side};

use crate::constraints::{Constraints, DofMap};
use crate::error::Error;
use crate::sparse::assembly::BlockMatrix;
use crate::sparse::graph::nested_dissection;

/// A supernodal Cholesky factor L L^T of the stiffness over the free displacements.
///
/// Used for unstructured bodies and for verification. Needs about 12 kB per displacement at 200,000
/// displacements; memory grows like n^(4/3), time like n^2.
pub struct Factor {
    symbolic: SymbolicCholesky<u32>,
    values: Vec<f64>,
}

impl std::fmt::Debug for Factor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Factor")
            .field("dofs", &self.dofs())
            .field("values", &self.values.len())
            .finish()
    }
}

/// Amplification (see [`Factor::amplifies`]) from which a matrix is singular to rounding: that of
/// mechanisms is 2e15 and more, that of the slender and stretched bodies of this workspace's tests
/// at most 1e7.
const SINGULAR: f64 = 1e13;

impl Factor {
    /// Factorises the stiffness of a body over its free displacements, ordered by nested dissection
    /// of `points` [m].
    ///
    /// Fails if the free displacements allow a mechanism, or if the factor is too large.
    pub fn of_body(
        stiffness: &BlockMatrix,
        map: &DofMap,
        points: &[[f64; 3]],
    ) -> Result<Self, Error> {
        let graph = &stiffness.graph;
        assert_eq!(points.len(), graph.node_count());
        let nodes: Vec<usize> = (0..points.len())
            .filter(|node| (0..3).any(|c| map.index(3 * node + c).is_some()))
            .collect();
        let order: Vec<u32> = nested_dissection(graph, points, &nodes)
            .into_iter()
            .flat_map(|node| (0..3).filter_map(move |c| map.index(3 * node + c)))
            .map(|index| index as u32)
            .collect();
        Self::new(&stiffness.lower_free(map), &order)
    }

    /// Factorises a symmetric positive definite matrix given by its lower triangle, eliminating in
    /// `order`.
    ///
    /// `order[k]` is the unknown eliminated k-th; it contains each of the n unknowns once
    /// (checked).
    pub fn new(lower: &SparseColMat<u32, f64>, order: &[u32]) -> Result<Self, Error> {
        let free_dofs = lower.ncols();
        let too_large = |reason: String| Error::FactorTooLarge { free_dofs, reason };
        if order.len() != free_dofs {
            return Err(Error::Length {
                what: "elimination order",
                found: order.len(),
                expected: free_dofs,
            });
        }
        let mut inverse = vec![u32::MAX; free_dofs];
        for (k, &unknown) in order.iter().enumerate() {
            inverse[unknown as usize] = k as u32;
        }
        let order = Perm::new_checked(order.into(), inverse.into(), free_dofs);
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let ordering = SymmetricOrdering::Custom(order.as_ref());
        let symbolic = factorize_symbolic_cholesky(lower.symbolic(), Side::Lower, ordering, params)
            .map_err(|e| too_large(format!("{e:?}")))?;
        let mut values = Vec::new();
        values
            .try_reserve_exact(symbolic.len_val())
            .map_err(|e| too_large(e.to_string()))?;
        values.resize(symbolic.len_val(), 0.0);
        // One thread: two do not speed up the factorisation of these matrices, and the bits stay
        // the same.
        let request = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(request).map_err(|e| too_large(format!("{e:?}")))?;
        symbolic
            .factorize_numeric_llt(
                &mut values,
                lower.as_ref(),
                Side::Lower,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                Default::default(),
            )
            .map_err(|_| Error::NotPositiveDefinite { free_dofs })?;
        let factor = Self { symbolic, values };
        match factor.amplifies(lower) {
            ratio if ratio < SINGULAR => Ok(factor),
            _ => Err(Error::NotPositiveDefinite { free_dofs }),
        }
    }

    /// Largest diagonal entry times the largest displacement under forces of 1 with irregular
    /// signs: at most the condition number of the matrix times the root of its size. The
    /// displacement of a mechanism whose pivot is positive by rounding is very large.
    fn amplifies(&self, lower: &SparseColMat<u32, f64>) -> f64 {
        let n = self.dofs();
        let diagonal = (0..n).flat_map(|j| {
            let entries = lower.row_idx_of_col(j).zip(lower.val_of_col(j));
            entries.filter(move |(i, _)| *i == j).map(|(_, v)| v.abs())
        });
        let largest = diagonal.fold(0.0, f64::max);
        let sign = |i: usize| match (i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) & 1 {
            0 => 1.0,
            _ => -1.0,
        };
        let mut moved: Vec<f64> = (0..n).map(sign).collect();
        self.solve(&mut moved);
        let size = |u: &f64| if u.is_nan() { f64::INFINITY } else { u.abs() };
        let most = moved.iter().map(size).fold(0.0, f64::max);
        largest * most
    }

    /// Number of unknowns.
    pub fn dofs(&self) -> usize {
        self.symbolic.nrows()
    }

    /// Memory of the factor's values [bytes].
    pub fn bytes(&self) -> usize {
        self.values.len() * size_of::<f64>()
    }

    /// Solves for many right-hand sides in place: `rhs` holds columns of [`Factor::dofs`] numbers,
    /// one after another.
    ///
    /// # Panics
    /// If the length of `rhs` is not a multiple of the number of unknowns.
    pub fn solve(&self, rhs: &mut [f64]) {
        let n = self.dofs();
        if n == 0 {
            return;
        }
        assert_eq!(rhs.len() % n, 0, "right-hand sides of {n} numbers each");
        let columns = rhs.len() / n;
        let request = self
            .symbolic
            .solve_in_place_scratch::<f64>(columns, Par::Seq);
        let mut memory = MemBuffer::new(request);
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(rhs, n, columns),
            Par::Seq,
            MemStack::new(&mut memory),
        );
    }

    /// Solves K u = f for a full vector of loads [N] with the prescribed displacements of
    /// `constraints`.
    ///
    /// Returns the full displacements [m]. `stiffness` and `map` must be those of the factor.
    pub fn displacement(
        &self,
        stiffness: &BlockMatrix,
        constraints: &Constraints,
        map: &DofMap,
        loads: &[f64],
    ) -> Vec<f64> {
        let mut u = vec![0.0; stiffness.dofs()];
        constraints.write_values(&mut u);
        let mut lifted = vec![0.0; u.len()];
        stiffness.apply(&u, &mut lifted);
        for (l, f) in lifted.iter_mut().zip(loads) {
            *l = f - *l;
        }
        let mut rhs = map.restrict(&lifted);
        self.solve(&mut rhs);
        map.extend(&rhs, &mut u);
        u
    }
}
