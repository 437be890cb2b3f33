//! Forces that keep their bounds and the load balance.

use nalgebra::{Matrix3, Vector3};

use crate::motion::{Motion, dot, solve_semidefinite};

/// Projection of a gap step onto the bounds and the load balance.
///
/// The forces are f_i(t) = clamp(f_i - s_i (gap_i - N_i t), 0, bound_i) at nodes with
/// `may_change`. The rigid motion t is such that N^T f(t) = balance for the free motions. It
/// minimises a convex function of at most three variables, whose gradient is the imbalance
/// N^T f(t) - balance. f(t) is the projection of f - s gap onto bounds and balance in the norm of
/// 1/s; from balanced forces it is a direction of descent of their energy.
pub(crate) struct Balance<'a> {
    /// Forces to start from [N].
    pub force: &'a [f64],
    /// Gaps under them [m].
    pub gap: &'a [f64],
    /// s, the stiffness of each node on its own [N/m].
    pub stiffness: &'a [f64],
    /// Rows of N.
    pub rows: &'a [[f64; 3]],
    /// Largest forces [N].
    pub bound: &'a [f64],
    /// Nodes whose forces may change.
    pub may_change: &'a [bool],
    pub motion: &'a Motion,
}

/// Balanced forces and the rigid motion t.
pub(crate) struct BalancedForces {
    pub force: Vec<f64>,
    pub motion_step: [f64; 3],
    /// Whether the load is balanced: the nodes that may change can bear it.
    pub feasible: bool,
}

/// Largest number of Newton steps; each is a sum over the nodes.
const MAX_STEPS: usize = 200;
/// Largest imbalance relative to the sum of the terms that it is computed from.
const TOLERANCE: f64 = 1e-12;

impl Balance<'_> {
    /// Newton's method with the damping of K. Levenberg (1944).
    pub fn solve(&self) -> BalancedForces {
        let mut motion_step = Vector3::zeros();
        let mut point = self.evaluate(motion_step);
        let full_hessian = point.full_hessian;
        let mut damping = 1e-9;
        for _ in 0..MAX_STEPS {
            if self.is_balanced(&point, TOLERANCE) {
                break;
            }
            let hessian = point.hessian + full_hessian * damping;
            let step = solve_semidefinite(hessian, -point.imbalance);
            let next = self.evaluate(motion_step + step);
            let halved = next.imbalance.norm() < 0.5 * point.imbalance.norm();
            if next.value < point.value || halved {
                (motion_step, point) = (motion_step + step, next);
                damping = (0.1 * damping).max(1e-15);
            } else if damping > 1e3 {
                break;
            } else {
                damping *= 10.0;
            }
        }
        let force = (0..self.force.len())
            .map(|i| self.force_of(i, motion_step))
            .collect();
        BalancedForces {
            force,
            motion_step: motion_step.into(),
            feasible: self.is_balanced(&point, 1e3 * TOLERANCE),
        }
    }

    fn force_of(&self, i: usize, motion_step: Vector3<f64>) -> f64 {
        if !self.may_change[i] {
            return self.force[i];
        }
        self.unbounded_force(i, motion_step)
            .clamp(0.0, self.bound[i])
    }

    fn unbounded_force(&self, i: usize, motion_step: Vector3<f64>) -> f64 {
        self.force[i] - self.stiffness[i] * (self.gap[i] - dot(self.rows[i], motion_step.into()))
    }

    fn is_balanced(&self, point: &Point, tolerance: f64) -> bool {
        (0..3).all(|a| point.imbalance[a].abs() <= tolerance * point.scale[a])
    }

    fn evaluate(&self, motion_step: Vector3<f64>) -> Point {
        let balance = Vector3::from(self.motion.balance);
        let mut point = Point {
            value: 0.0,
            imbalance: -balance,
            scale: balance.abs(),
            hessian: Matrix3::zeros(),
            full_hessian: Matrix3::zeros(),
        };
        for i in 0..self.force.len() {
            let row = Vector3::from(self.rows[i]);
            let force = self.force_of(i, motion_step);
            point.imbalance += row * force;
            point.scale += row.abs() * force;
            if !self.may_change[i] {
                continue;
            }
            let unbounded = self.unbounded_force(i, motion_step);
            let s = self.stiffness[i];
            // The integral of the force over the motion.
            point.value += force * (unbounded - 0.5 * force) / s;
            let square = row * row.transpose() * s;
            point.full_hessian += square;
            if unbounded > 0.0 && unbounded < self.bound[i] {
                point.hessian += square;
            }
        }
        point.value -= (0..self.force.len())
            .filter(|&i| !self.may_change[i])
            .map(|i| -self.force[i] * dot(self.rows[i], motion_step.into()))
            .sum::<f64>()
            + balance.dot(&motion_step);
        for a in (0..3).filter(|&a| !self.motion.free[a]) {
            point.imbalance[a] = 0.0;
            for b in 0..3 {
                for matrix in [&mut point.hessian, &mut point.full_hessian] {
                    matrix[(a, b)] = 0.0;
                    matrix[(b, a)] = 0.0;
                }
            }
        }
        point
    }
}

/// The convex function and its derivatives.
struct Point {
    value: f64,
    /// Gradient: N^T f - balance.
    imbalance: Vector3<f64>,
    /// Sum of the magnitudes of the imbalance's terms.
    scale: Vector3<f64>,
    hessian: Matrix3<f64>,
    /// The Hessian with every node between its bounds.
    full_hessian: Matrix3<f64>,
}
