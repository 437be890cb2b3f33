//! What the faces below and above a tensor grid add to K u.

use crate::tensor::axis::{Axis, Tridiagonal};

/// An end of z of one material: the terms with E = diag(-1, 0 .. 0, 1) of z,
///
/// lambda D_x E_z M_y u_z in x, lambda D_y E_z M_x u_z in y and mu E_z (D_x M_y u_x + D_y M_x u_y) in z.
pub(crate) struct FaceTerms<'a> {
    pub axes: [&'a Axis; 2],
    /// Lame constants times E's entry [Pa].
    pub lambda: f64,
    pub mu: f64,
}

impl FaceTerms<'_> {
    /// Adds to the plane's part of K u; `u` is its part by component, and `row` has room for a row.
    pub fn add(&self, u: [&[f64]; 3], row: &mut Vec<f64>, [out_x, out_y, out_z]: [&mut [f64]; 3]) {
        let [x, y] = self.axes;
        let nx = x.len();
        let mut term = |to: &mut [f64],
                        factor: f64,
                        along_x: &Tridiagonal,
                        along_y: &Tridiagonal,
                        u: &[f64]| {
            for (j, (to, [low, on, high])) in to.chunks_exact_mut(nx).zip(along_y).enumerate() {
                let at = |j: usize| &u[j * nx..(j + 1) * nx];
                // Where there is no such row its coefficient is 0.
                let (below, above) = (at(j.saturating_sub(1)), at((j + 1).min(y.len() - 1)));
                row.clear();
                row.push(0.0);
                let three = below.iter().zip(at(j)).zip(above);
                row.extend(three.map(|((b, o), a)| factor * (low * b + on * o + high * a)));
                row.push(0.0);
                for ((to, three), t) in to.iter_mut().zip(row.windows(3)).zip(along_x) {
                    *to += t[0] * three[0] + t[1] * three[1] + t[2] * three[2];
                }
            }
        };
        term(out_x, self.lambda, &x.gradient, &y.mass, u[2]);
        term(out_y, self.lambda, &x.mass, &y.gradient, u[2]);
        term(out_z, self.mu, &x.gradient, &y.mass, u[0]);
        term(out_z, self.mu, &x.mass, &y.gradient, u[1]);
    }
}
