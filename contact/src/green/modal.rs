//! Green's matrices that are not stored: products through the modes of the contact plane.

use std::cell::RefCell;

use faer::{Mat, MatRef};
use kufe_fem::Tridiagonal;

use crate::bodies::elastic_body::{BodyWork, ElasticBody, Stiffness};
use crate::green::matrix::{LineSweep, QuadraticForm, Window};
use crate::precondition::inverse::Inverse;

/// G = B M^-1 B^T of all bodies, as a product.
///
/// A body that faces of its grid alone hold answers through the modes of x and y of the contact
/// plane, G f = Qx (T o (Qx^T F Qy)) Qy^T: four products of matrices as wide as the plane. The
/// others answer through their own preconditioner. Near G^-1 is the same form with the inverse of T
/// and the dual modes M Q, since Q^-1 = Q^T M on the nodes that nothing holds; of the ice alone it
/// is what conjugate gradients on a part of the nodes are preconditioned with.
pub(crate) struct ModalGreen<'a> {
    pub window: Window,
    /// G of the bodies that faces alone hold.
    pub forms: Vec<QuadraticForm>,
    /// G^-1 of the ice over the whole plane, on the window.
    pub stiffness: QuadraticForm,
    /// Diagonal of the forms together, by candidate.
    pub own: Vec<f64>,
    candidates: &'a [usize],
    /// Length of a plane vector.
    plane: usize,
    others: Vec<(&'a ElasticBody, RefCell<BodyWork>)>,
}

impl<'a> ModalGreen<'a> {
    /// Between `candidates` of a plane of `plane` nodes, on and under these bodies; with `scaled`
    /// the responses of those that faces alone hold are elasticity's, not their preconditioner's.
    /// None where the first body is fixed by more than faces.
    pub fn new(
        bodies: &'a [ElasticBody],
        candidates: &'a [usize],
        plane: usize,
        scaled: bool,
    ) -> Option<Self> {
        let Inverse::Planewise(first) = &bodies.first()?.inverse else {
            return None;
        };
        let window = Window::new(candidates, first.columns.plane_width);
        let mut forms = Vec::new();
        let mut others = Vec::new();
        for body in bodies {
            let Inverse::Planewise(inverse) = &body.inverse else {
                others.push((body, RefCell::new(body.work())));
                continue;
            };
            let factor = if scaled { inverse.response } else { 1.0 };
            let rows = [0, 1].map(|axis| {
                let range = &window.along[axis];
                let start = range.start - inverse.columns.first[axis];
                let modes = inverse.basis.along(axis);
                modes.subrows(start, range.len()).to_owned()
            });
            let table = faer::Scale(factor) * inverse.preconditioner.end_response();
            forms.push(form(&window, rows, table));
        }
        let Stiffness::Tensor(operator) = &bodies[0].stiffness else {
            return None;
        };
        let rows = [0, 1].map(|axis| {
            let modes = first.basis.along(axis);
            dual(modes, &operator.axes[axis].mass, &window.along[axis])
        });
        let response = first.preconditioner.end_response();
        let inverse = Mat::from_fn(response.nrows(), response.ncols(), |a, b| {
            response[(a, b)].recip()
        });
        let stiffness = form(&window, rows, inverse);
        let mut own = vec![0.0; candidates.len()];
        for form in &forms {
            let diagonal = form.diagonal();
            for (number, own) in own.iter_mut().enumerate() {
                *own += window.at(&diagonal, number);
            }
        }
        Some(ModalGreen {
            window,
            forms,
            stiffness,
            own,
            candidates,
            plane,
            others,
        })
    }

    /// G f.
    pub fn times(&self, force: &[f64]) -> Vec<f64> {
        let mut moved = self.of_others(force);
        let field = self.window.spread(force.iter().copied().enumerate());
        for form in &self.forms {
            let field = form.times(&field);
            for (number, moved) in moved.iter_mut().enumerate() {
                *moved += self.window.at(&field, number);
            }
        }
        moved
    }

    /// The part of G f that no modes of the plane give.
    pub fn of_others(&self, force: &[f64]) -> Vec<f64> {
        if self.others.is_empty() {
            return vec![0.0; force.len()];
        }
        let nodes = self.candidates.iter().copied();
        let forces: Vec<(usize, f64)> = nodes
            .zip(force.iter().copied())
            .filter(|(_, f)| *f != 0.0)
            .collect();
        let mut closing = vec![0.0; self.plane];
        for (body, work) in &self.others {
            body.respond(&forces, &mut closing, &mut work.borrow_mut());
        }
        self.candidates.iter().map(|&node| closing[node]).collect()
    }

    /// One pass of [`crate::green::matrix::Green::sweep`], line by line across the window's longer
    /// side.
    ///
    /// What other bodies answer stays as it was before the pass.
    pub fn sweep(
        &self,
        force: &mut [f64],
        deflection: &mut [f64],
        wanted: impl Fn(usize, f64, f64) -> f64,
    ) {
        let others = self.of_others(force);
        LineSweep::new(&self.window, &self.forms, force).run(&others, force, wanted);
        deflection.copy_from_slice(&self.times(force));
    }
}

/// Modes along x and y on the window, and their table, in the window's order of axes.
fn form(window: &Window, [x, y]: [Mat<f64>; 2], table: Mat<f64>) -> QuadraticForm {
    let (long, short, table) = match window.axes {
        [0, _] => (x, y, table),
        _ => (y, x, table.transpose().to_owned()),
    };
    QuadraticForm {
        long: long.transpose().to_owned(),
        short,
        table,
    }
}

/// Rows of M Q.
fn dual(modes: MatRef<'_, f64>, mass: &Tridiagonal, rows: &std::ops::Range<usize>) -> Mat<f64> {
    Mat::from_fn(rows.len(), modes.ncols(), |i, a| {
        let node = rows.start + i;
        let near = [node.wrapping_sub(1), node, node + 1];
        let values = mass[node].iter().zip(near);
        let inside = values.filter(|(_, k)| *k < modes.nrows());
        inside.map(|(m, k)| m * modes[(k, a)]).sum()
    })
}

#[cfg(test)]
#[path = "modal_tests.rs"]
mod tests;
