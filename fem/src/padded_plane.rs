//! One plane of a vector, laid out for the tensor operator.

use std::ops::Range;

use crate::tensor_factors::{WIDEST, padded};

/// A plane of u: rows between zeros, as vectors want them.
pub(crate) struct PaddedPlane {
    /// By component.
    pub values: [Aligned; 3],
    /// Numbers from a row to the next.
    pub stride: usize,
}

impl PaddedPlane {
    pub fn new([nx, ny]: [usize; 2]) -> Self {
        // An odd number of cache lines, so that a column of rows spreads over all of a cache's sets.
        let lines = (padded(nx) + 2 * WIDEST) / 8;
        let stride = 8 * (lines | 1);
        PaddedPlane {
            // One row more, so that rows from any column on are whole.
            values: std::array::from_fn(|_| Aligned::zeros((ny + 1) * stride)),
            stride,
        }
    }

    /// Takes rows of plane `k` of a vector on a grid of `shape`.
    pub fn fill(&mut self, u: &[f64], [nx, ny, nz]: [usize; 3], k: usize, rows: Range<usize>) {
        for (c, values) in self.values.iter_mut().enumerate() {
            let plane = (c * nz + k) * ny;
            let rows = u[(plane + rows.start) * nx..(plane + rows.end) * nx].chunks_exact(nx);
            for (to, from) in values.all_mut().chunks_exact_mut(self.stride).zip(rows) {
                to[WIDEST..WIDEST + nx].copy_from_slice(from);
            }
        }
    }
}

/// Numbers that begin at a cache line.
pub(crate) struct Aligned {
    data: Vec<f64>,
    start: usize,
    length: usize,
}

impl Aligned {
    pub fn zeros(length: usize) -> Self {
        let data = vec![0.0; length + 8];
        let start = data.as_ptr().align_offset(64).min(8);
        Aligned {
            data,
            start,
            length,
        }
    }

    pub fn all(&self) -> &[f64] {
        &self.data[self.start..self.start + self.length]
    }

    pub fn all_mut(&mut self) -> &mut [f64] {
        &mut self.data[self.start..self.start + self.length]
    }
}
