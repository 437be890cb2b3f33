//! Projected SOR where the Green's matrix is not stored.

use faer::Mat;

use crate::green::window::{Form, Window, product};

/// One pass over lines of the window.
///
/// The forces stand in the modes of the plane, L = Qx^T F Qy. The deflection of one line, and what the line's own forces change on it, are
/// sums over the modes of the other axis; the line's change of L is a product of a column and a row. So a pass costs as much as a product,
/// and every node meets the forces as they are then.
pub(crate) struct LineSweep<'a> {
    window: &'a Window,
    forms: &'a [Form],
    /// L for each form.
    loads: Vec<Mat<f64>>,
}

impl<'a> LineSweep<'a> {
    /// From these forces of the candidates.
    pub fn new(window: &'a Window, forms: &'a [Form], force: &[f64]) -> Self {
        let field = window.spread(force.iter().copied().enumerate());
        let loads = forms.iter().map(|form| form.to_modes(&field));
        LineSweep {
            loads: loads.collect(),
            window,
            forms,
        }
    }

    /// Sets forces as `wanted` says for a node, its force and its deflection, of which `others` is the part that is not of the modes.
    pub fn run(
        mut self,
        others: &[f64],
        force: &mut [f64],
        wanted: impl Fn(usize, f64, f64) -> f64,
    ) {
        let [_, short] = self.window.shape();
        for (line, nodes) in self.window.lines.iter().enumerate() {
            if nodes.is_empty() {
                continue;
            }
            let mut deflection = vec![0.0; short];
            let mut own = Mat::<f64>::zeros(short, short);
            for (form, load) in self.forms.iter().zip(&self.loads) {
                let along = form.long.col(line);
                let count = form.short.ncols();
                let (mut here, mut weights) = (vec![0.0; count], vec![0.0; count]);
                for b in 0..count {
                    let sums = (along.iter()).zip(form.table.col(b).iter().zip(load.col(b).iter()));
                    for (x, (t, l)) in sums {
                        here[b] += x * t * l;
                        weights[b] += x * x * t;
                    }
                }
                for (i, deflection) in deflection.iter_mut().enumerate() {
                    let row = form.short.row(i);
                    *deflection += row.iter().zip(&here).map(|(y, v)| y * v).sum::<f64>();
                }
                let weighted = Mat::from_fn(short, count, |i, b| form.short[(i, b)] * weights[b]);
                own += product(weighted.as_ref(), form.short.transpose());
            }
            let mut changes = vec![0.0; short];
            for &[place, number] in nodes {
                let moved = deflection[place] + others[number];
                let next = wanted(number, force[number], moved);
                let change = next - force[number];
                if change != 0.0 {
                    force[number] = next;
                    changes[place] = change;
                    for (d, g) in deflection.iter_mut().zip(own.col(place).iter()) {
                        *d += change * g;
                    }
                }
            }
            self.take(line, &changes);
        }
    }

    /// Takes the changes of a line's forces into the loads.
    fn take(&mut self, line: usize, changes: &[f64]) {
        if changes.iter().all(|c| *c == 0.0) {
            return;
        }
        for (form, load) in self.forms.iter().zip(&mut self.loads) {
            let along = form.long.col(line);
            for (b, column) in load.col_iter_mut().enumerate() {
                let modes = form.short.col(b);
                let share: f64 = modes.iter().zip(changes).map(|(y, c)| y * c).sum();
                for (load, x) in column.iter_mut().zip(along.iter()) {
                    *load += x * share;
                }
            }
        }
    }
}
