//! Both ends of a plane's rows, laid out for the tensor operator.

use crate::tensor::factors::{WIDEST, padded};

/// The ends of rows of u between zeros, for the vectors of neighbours along x that would reach over them.
///
/// Vectors in between read u itself.
pub(crate) struct RowEnds {
    /// By component; node i of a row is number `WIDEST + i` of `stride`.
    pub values: [Aligned; 3],
    /// Numbers from a row to the next.
    pub stride: usize,
}

/// A vector and the neighbour beyond it.
const END: usize = WIDEST + 1;

impl RowEnds {
    pub fn new([nx, ny]: [usize; 2]) -> Self {
        // An odd number of cache lines, so that a column of rows spreads over all of a cache's sets.
        let lines = (padded(nx) + 2 * WIDEST) / 8;
        let stride = 8 * (lines | 1);
        RowEnds {
            values: std::array::from_fn(|_| Aligned::zeros(ny * stride)),
            stride,
        }
    }

    /// Takes rows of nx numbers, by component.
    pub fn fill(&mut self, rows: [&[f64]; 3], nx: usize) {
        for (values, rows) in self.values.iter_mut().zip(rows) {
            let rows = rows.chunks_exact(nx);
            for (to, from) in values.all_mut().chunks_exact_mut(self.stride).zip(rows) {
                let to = &mut to[WIDEST..WIDEST + nx];
                match (from.first_chunk::<END>(), from.last_chunk::<END>()) {
                    (Some(first), Some(last)) => {
                        to[..END].copy_from_slice(first);
                        to[nx - END..].copy_from_slice(last);
                    }
                    _ => to.copy_from_slice(from),
                }
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
