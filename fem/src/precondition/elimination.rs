//! Simultaneous elimination of many tridiagonal matrices of one pattern.

use pulp::{Simd, WithSimd};
use rayon::prelude::*;

use crate::tensor::axis::Axis;

/// The end of z at which the elimination ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The plane of the lowest z.
    Low,
    /// The plane of the highest z.
    High,
}

/// The matrices T = c K + s M of one axis for many shifts s, factorised.
#[derive(Clone, Debug)]
pub(crate) struct Elimination {
    /// Nodes of the axis that are not fixed, in the order of elimination.
    pub planes: Vec<usize>,
    /// Shift s of each matrix.
    pub shift: Vec<f64>,
    /// Entries of c K and M between a node and the previous one in the order of elimination.
    pub coupling: Vec<[f64; 2]>,
    /// Reciprocal pivots by node in the order of elimination, matrices fastest.
    pub inverse_pivots: Vec<f64>,
}

/// Number of matrices per task: their values at all nodes stay in a core's cache.
const PAIRS: usize = 256;

impl Elimination {
    /// Factorises towards `end` of the axis `z`.
    pub fn new(z: &Axis, fixed: [bool; 2], coefficient: f64, shift: Vec<f64>, end: End) -> Self {
        let mut planes: Vec<usize> =
            (usize::from(fixed[0])..z.len() - usize::from(fixed[1])).collect();
        if end == End::Low {
            planes.reverse();
        }
        let entry = |k: usize, other: usize| {
            let place = 1 + other - k;
            [coefficient * z.stiffness[k][place], z.mass[k][place]]
        };
        let coupling: Vec<[f64; 2]> = std::iter::once([0.0; 2])
            .chain(planes.windows(2).map(|w| entry(w[1], w[0])))
            .collect();
        let pairs = shift.len();
        let mut inverse_pivots = vec![0.0; pairs * planes.len()];
        for (step, &plane) in planes.iter().enumerate() {
            let (before, rest) = inverse_pivots.split_at_mut(step * pairs);
            let before = &before[step.saturating_sub(1) * pairs..];
            let [k, m] = entry(plane, plane);
            let [k_off, m_off] = coupling[step];
            for (i, pivot) in rest[..pairs].iter_mut().enumerate() {
                let off = k_off + shift[i] * m_off;
                let taken = before.get(i).map_or(0.0, |inverse| off * off * inverse);
                *pivot = (k + shift[i] * m - taken).recip();
            }
        }
        Elimination {
            planes,
            shift,
            coupling,
            inverse_pivots,
        }
    }

    /// Forward and backward passes over `values`, which have the layout of the pivots.
    pub fn run(&self, values: &mut [f64], [forward, backward]: [bool; 2]) {
        let pairs = self.shift.len();
        let mut blocks: Vec<Vec<&mut [f64]>> = (0..pairs.div_ceil(PAIRS))
            .map(|_| Vec::with_capacity(self.planes.len()))
            .collect();
        for plane in values.chunks_exact_mut(pairs) {
            for (block, part) in blocks.iter_mut().zip(plane.chunks_mut(PAIRS)) {
                block.push(part);
            }
        }
        blocks
            .par_iter_mut()
            .enumerate()
            .for_each(|(block, column)| {
                let first = block * PAIRS;
                for (backward, wanted) in [(false, forward), (true, backward)] {
                    if wanted {
                        pulp::Arch::new().dispatch(Pass {
                            elimination: self,
                            first,
                            values: column,
                            backward,
                        });
                    }
                }
            });
    }
}

/// A pass over a block of pairs through all planes, in the order of elimination or back.
///
/// Forward y_i = r_i - T_(i,i-1) y_(i-1) / pivot_(i-1), backward z_i = (y_i - T_(i,i+1) z_(i+1)) /
/// pivot_i.
struct Pass<'a, 'b> {
    elimination: &'a Elimination,
    first: usize,
    values: &'a mut [&'b mut [f64]],
    backward: bool,
}

impl<'a> Pass<'a, '_> {
    /// The block's inverse pivots at one step, and its shifts.
    #[inline(always)]
    fn coefficients(&self, step: usize) -> [&'a [f64]; 2] {
        let length = self.values[step].len();
        let shift = &self.elimination.shift;
        let at = step * shift.len() + self.first;
        [
            &self.elimination.inverse_pivots[at..at + length],
            &shift[self.first..self.first + length],
        ]
    }
}

impl WithSimd for Pass<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let coupling = &self.elimination.coupling;
        let last = self.values.len() - 1;
        if !self.backward {
            for step in 1..=last {
                let coefficients = self.coefficients(step - 1);
                let (before, rest) = self.values.split_at_mut(step);
                let (before, here) = (&*before[step - 1], &mut *rest[0]);
                eliminate::<S, false>(simd, coupling[step], coefficients, before, here);
            }
            return;
        }
        let [inverse, _] = self.coefficients(last);
        let values = self.values[last].iter_mut().zip(inverse);
        values.for_each(|(y, inverse)| *y *= inverse);
        for step in (0..last).rev() {
            let coefficients = self.coefficients(step);
            let (here, after) = self.values.split_at_mut(step + 1);
            let (after, here) = (&*after[0], &mut *here[step]);
            eliminate::<S, true>(simd, coupling[step + 1], coefficients, after, here);
        }
    }
}

/// `here` -= (k + shift m) inverse `next`, and `BACKWARD` `here` = (`here` - (k + shift m) `next`)
/// inverse.
#[inline(always)]
fn eliminate<S: Simd, const BACKWARD: bool>(
    simd: S,
    [k, m]: [f64; 2],
    [inverse, shift]: [&[f64]; 2],
    next: &[f64],
    here: &mut [f64],
) {
    let n = here.len();
    let (inverse, inverse_rest) = S::as_simd_f64s(&inverse[..n]);
    let (shift, shift_rest) = S::as_simd_f64s(&shift[..n]);
    let (next, next_rest) = S::as_simd_f64s(&next[..n]);
    let (here, here_rest) = S::as_mut_simd_f64s(here);
    let (minus_k, minus_m) = (simd.splat_f64s(-k), simd.splat_f64s(-m));
    for (((y, next), inverse), shift) in here.iter_mut().zip(next).zip(inverse).zip(shift) {
        let off = simd.mul_add_e_f64s(*shift, minus_m, minus_k);
        *y = if BACKWARD {
            simd.mul_f64s(simd.mul_add_e_f64s(off, *next, *y), *inverse)
        } else {
            simd.mul_add_e_f64s(off, simd.mul_f64s(*next, *inverse), *y)
        };
    }
    let rest = next_rest.iter().zip(inverse_rest).zip(shift_rest);
    for (y, ((next, inverse), shift)) in here_rest.iter_mut().zip(rest) {
        *y = if BACKWARD {
            (*y - (k + shift * m) * next) * inverse
        } else {
            *y - (k + shift * m) * (next * inverse)
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// More matrices than one task works on, towards both ends.
    #[test]
    fn both_passes_solve_every_tridiagonal_matrix() {
        let nodes: Vec<f64> = (0..17).map(|i| 1.3f64.powi(i)).collect();
        let z = Axis::new(&nodes);
        let coefficient = 2.5;
        let shift: Vec<f64> = (0..PAIRS + 37)
            .map(|i| 1e-6 * 1.06f64.powi(i as i32))
            .collect();
        for (end, fixed) in [(End::High, [true, false]), (End::Low, [false, true])] {
            let elimination = Elimination::new(&z, fixed, coefficient, shift.clone(), end);
            let pairs = shift.len();
            let given: Vec<f64> = (0..pairs * elimination.planes.len())
                .map(|i| (0.7 * i as f64).sin())
                .collect();
            let mut solved = given.clone();
            elimination.run(&mut solved, [true, true]);
            for (pair, shift) in shift.iter().enumerate() {
                let value = |k: usize| {
                    let step = elimination.planes.iter().position(|plane| *plane == k);
                    step.map_or(0.0, |step| solved[step * pairs + pair])
                };
                for (step, &k) in elimination.planes.iter().enumerate() {
                    let mut sum = 0.0;
                    let mut size = 0.0f64;
                    for (offset, (stiffness, mass)) in
                        z.stiffness[k].iter().zip(z.mass[k]).enumerate()
                    {
                        let neighbour = (k + offset).checked_sub(1).map_or(0.0, value);
                        let term = (coefficient * stiffness + shift * mass) * neighbour;
                        sum += term;
                        size = size.max(term.abs());
                    }
                    let error = (sum - given[step * pairs + pair]).abs();
                    assert!(
                        error < 1e-13 * size.max(1.0),
                        "{pair}, {k}: {error:e} of {size}"
                    );
                }
            }
        }
    }
}
