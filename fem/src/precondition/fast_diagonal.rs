//! Fast-diagonalisation preconditioner: three scalar operators, each inverted in the modes of its
//! axes.

use std::collections::{BTreeMap, BTreeSet};

use faer::linalg::matmul::matmul;
use faer::traits::ComplexField;
use faer::traits::math_utils::one;
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

use crate::tensor::axis::{Axis, AxisModes};
use crate::tensor::operator::TensorOperator;

/// Inverse of the block diagonal of elasticity on a tensor grid.
///
/// Component c of P is the scalar operator with coefficient lambda + 2 mu along axis c and mu along
/// the others. With K_d q = theta_d M_d q on each axis, P_c^-1 = (Qx x Qy x Qz) diag(1 / Lambda)
/// (Qx x Qy x Qz)^T, Lambda = sum over d of coefficient_d theta_d. By Korn's inequality P is
/// spectrally equivalent to the stiffness with constants that depend on Poisson's ratio and the
/// fixed faces only, not on the grading (R. E. Lynch, J. R. Rice and D. H. Thomas, Numer. Math. 6
/// (1964) 185-199, for the diagonalisation).
///
/// [`FastDiagonal::to_modes`], [`FastDiagonal::divide`] and [`FastDiagonal::from_modes`] are
/// separate methods, so that a constraint on one horizontal plane can act between them.
#[derive(Clone, Debug)]
pub struct FastDiagonal {
    shape: [usize; 3],
    components: [Component; 3],
}

#[derive(Clone, Debug)]
struct Component {
    /// Modes by axis.
    modes: [AxisModes; 3],
    /// 1 / Lambda, first axis fastest.
    inverse: Vec<f64>,
    /// Index of this component's first modal value.
    start: usize,
}

impl FastDiagonal {
    /// Diagonalises every axis once for each pair of fixed ends that occurs. If `first` is given,
    /// component x has this axis along x instead of the operator's.
    ///
    /// For [`crate::element::hex8_axial`] `first` is the operator's first axis, [`Axis::averaged`].
    pub fn new(operator: &TensorOperator, first: Option<&Axis>) -> Self {
        // With two layers the vertical component has another z axis, and with `first` component x
        // another x axis.
        let variant = |c: usize, axis: usize| match (c, axis) {
            (2, 2) => usize::from(operator.lower_layer().is_some()),
            (0, 0) => usize::from(first.is_some()),
            _ => 0,
        };
        let key = |c: usize, axis: usize| (axis, operator.fixed[c][axis], variant(c, axis));
        let keys: BTreeSet<_> = (0..9).map(|k| key(k / 3, k % 3)).collect();
        let solved: BTreeMap<_, AxisModes> = keys
            .into_par_iter()
            .map(|(axis, fixed, variant)| {
                let modes = match (axis, first) {
                    (2, _) => operator.preconditioned_z(2 * variant).modes(fixed),
                    (0, Some(first)) if variant == 1 => first.modes(fixed),
                    _ => operator.axes[axis].modes(fixed),
                };
                ((axis, fixed, variant), modes)
            })
            .collect();
        let mut start = 0;
        let components = std::array::from_fn(|c| {
            let modes: [AxisModes; 3] = std::array::from_fn(|axis| solved[&key(c, axis)].clone());
            let coefficients = operator.scalar_coefficients(c);
            let [sx, sy, sz]: [Vec<f64>; 3] = std::array::from_fn(|axis| {
                let values = modes[axis].values.iter();
                values.map(|theta| coefficients[axis] * theta).collect()
            });
            let mut inverse = Vec::with_capacity(sx.len() * sy.len() * sz.len());
            for z in &sz {
                for y in &sy {
                    inverse.extend(sx.iter().map(|x| (x + y + z).recip()));
                }
            }
            let component = Component {
                modes,
                inverse,
                start,
            };
            start += component.inverse.len();
            component
        });
        FastDiagonal {
            shape: operator.shape(),
            components,
        }
    }

    /// Length of a modal vector.
    pub fn mode_count(&self) -> usize {
        self.components.iter().map(|c| c.inverse.len()).sum()
    }

    /// Length of the scratch that the transforms use.
    pub fn scratch_len(&self) -> usize {
        3 * self.shape.iter().product::<usize>()
    }

    /// Modes of component `c` along `axis`.
    pub fn axis_modes(&self, c: usize, axis: usize) -> &AxisModes {
        &self.components[c].modes[axis]
    }

    /// The part of a modal vector that belongs to component `c`, first axis fastest.
    pub fn component_range(&self, c: usize) -> std::ops::Range<usize> {
        let component = &self.components[c];
        component.start..component.start + component.inverse.len()
    }

    /// 1 / Lambda of component `c`, first axis fastest.
    pub fn inverse(&self, c: usize) -> &[f64] {
        &self.components[c].inverse
    }

    /// `modal` = (Qx x Qy x Qz)^T `r`, component by component.
    pub fn to_modes(&self, r: &[f64], modal: &mut [f64], scratch: &mut [f64]) {
        let [nx, ny, nz] = self.shape;
        let nodes = nx * ny * nz;
        assert_eq!((r.len(), modal.len()), (3 * nodes, self.mode_count()));
        for (c, component) in self.components.iter().enumerate() {
            let [mx, my, mz] = component.mode_shape();
            let planes = &mut scratch[..mx * my * nz];
            let [qx, qy, qz] = component.vectors();
            // x and y, plane by plane.
            planes.par_chunks_mut(mx * my).enumerate().for_each_init(
                || vec![0.0; mx * ny],
                |half, (k, plane)| {
                    let source = columns(&r[c * nodes + k * nx * ny..], [nx, ny]);
                    product(columns_mut(half, [mx, ny]), qx.transpose(), source);
                    product(columns_mut(plane, [mx, my]), columns(half, [mx, ny]), qy);
                },
            );
            // z, by blocks of columns of the result.
            let target = &mut modal[self.component_range(c)];
            let source = columns(planes, [mx * my, nz]);
            by_column_blocks(target, mx * my, mz, |first, block| {
                let width = block.ncols();
                product(block, source, qz.subcols(first, width));
            });
        }
    }

    /// Multiplies a modal vector by 1 / Lambda.
    pub fn divide(&self, modal: &mut [f64]) {
        for (c, component) in self.components.iter().enumerate() {
            modal[self.component_range(c)]
                .par_chunks_mut(8192)
                .zip(component.inverse.par_chunks(8192))
                .for_each(|(m, inverse)| m.iter_mut().zip(inverse).for_each(|(m, i)| *m *= i));
        }
    }

    /// `z` = (Qx x Qy x Qz) `modal`, component by component.
    pub fn from_modes(&self, modal: &[f64], z: &mut [f64], scratch: &mut [f64]) {
        let [nx, ny, nz] = self.shape;
        let nodes = nx * ny * nz;
        assert_eq!((z.len(), modal.len()), (3 * nodes, self.mode_count()));
        for (c, component) in self.components.iter().enumerate() {
            let [mx, my, mz] = component.mode_shape();
            let [qx, qy, qz] = component.vectors();
            let source = columns(&modal[component.start..], [mx * my, mz]);
            let planes = &mut scratch[..mx * my * nz];
            by_column_blocks(planes, mx * my, nz, |first, block| {
                let width = block.ncols();
                product(block, source, qz.subrows(first, width).transpose());
            });
            let planes = &scratch[..mx * my * nz];
            z[c * nodes..(c + 1) * nodes]
                .par_chunks_mut(nx * ny)
                .enumerate()
                .for_each_init(
                    || vec![0.0; nx * my],
                    |half, (k, plane)| {
                        let source = columns(&planes[k * mx * my..], [mx, my]);
                        product(columns_mut(half, [nx, my]), qx, source);
                        let half = columns(half, [nx, my]);
                        product(columns_mut(plane, [nx, ny]), half, qy.transpose());
                    },
                );
        }
    }

    /// `z` = P^-1 `r`.
    pub fn apply(&self, r: &[f64], z: &mut [f64], modal: &mut [f64], scratch: &mut [f64]) {
        self.to_modes(r, modal, scratch);
        self.divide(modal);
        self.from_modes(modal, z, scratch);
    }
}

impl Component {
    fn mode_shape(&self) -> [usize; 3] {
        std::array::from_fn(|axis| self.modes[axis].values.len())
    }

    fn vectors(&self) -> [MatRef<'_, f64>; 3] {
        self.modes.each_ref().map(|modes| modes.vectors.as_ref())
    }
}

/// Splits a `rows` x `cols` matrix into blocks of columns that do not depend on the number of
/// threads.
fn by_column_blocks(
    data: &mut [f64],
    rows: usize,
    cols: usize,
    work: impl Fn(usize, MatMut<'_, f64>) + Sync,
) {
    const WIDTH: usize = 16;
    data[..rows * cols]
        .par_chunks_mut(rows * WIDTH)
        .enumerate()
        .for_each(|(block, chunk)| {
            let width = chunk.len() / rows;
            work(block * WIDTH, columns_mut(chunk, [rows, width]));
        });
}

/// The beginning of `data` as a matrix of this many rows and columns, column by column.
pub(crate) fn columns<T>(data: &[T], [rows, cols]: [usize; 2]) -> MatRef<'_, T> {
    MatRef::from_column_major_slice(&data[..rows * cols], rows, cols)
}

/// [`columns`], mutable.
pub(crate) fn columns_mut<T>(data: &mut [T], [rows, cols]: [usize; 2]) -> MatMut<'_, T> {
    MatMut::from_column_major_slice_mut(&mut data[..rows * cols], rows, cols)
}

/// `to` = `left` `right`.
pub(crate) fn product<T: ComplexField>(
    to: MatMut<'_, T>,
    left: MatRef<'_, T>,
    right: MatRef<'_, T>,
) {
    matmul(to, Accum::Replace, left, right, one(), Par::Seq);
}
