//! Forces that keep their bounds and the load balance.

use nalgebra::{Matrix3, Vector3};

use crate::motion::{Motion, dot, solve_semidefinite};

/// The motion under which nodes, each on its own, carry the load.
///
/// With the forces f_i(t) = clamp(f_i - s_i (gap_i - N_i t)) of nodes that `may` move, t is such
/// that N^T f(t) = balance for the free motions: the minimiser of a convex function of three
/// numbers at most, whose gradient is what is out of balance. f(t) is the projection of the step
/// along the gaps, each over its stiffness 1/s_i, onto bounds and balance; from balanced forces it
/// leads where their energy falls.
pub(crate) struct Balance<'a> {
    /// Forces to start from [N].
    pub force: &'a [f64],
    /// Gaps under them [m].
    pub gap: &'a [f64],
    /// s [N/m].
    pub softness: &'a [f64],
    pub rows: &'a [[f64; 3]],
    pub bound: &'a [f64],
    /// Whose forces may change.
    pub may: &'a [bool],
    pub motion: &'a Motion,
}

/// Balanced forces and the turn that goes with them.
pub(crate) struct BalancedForces {
    pub force: Vec<f64>,
    pub turn: [f64; 3],
    /// Whether the load is balanced: what may move can bear it.
    pub met: bool,
}

/// Steps of the search; each is a sum over the nodes.
const STEPS: usize = 200;
/// What may be out of balance, over the load.
const SLACK: f64 = 1e-12;

impl Balance<'_> {
    /// Newton's method, damped as K. Levenberg (1944) does.
    pub fn solve(&self) -> BalancedForces {
        let mut turn = Vector3::zeros();
        let mut at = self.at(turn);
        let whole = at.whole;
        let mut damping = 1e-9;
        for _ in 0..STEPS {
            if self.small(&at, SLACK) {
                break;
            }
            let step = solve_semidefinite(at.slope + whole * damping, -at.out);
            let next = self.at(turn + step);
            if next.value < at.value || next.out.norm() < 0.5 * at.out.norm() {
                (turn, at) = (turn + step, next);
                damping = (0.1 * damping).max(1e-15);
            } else if damping > 1e3 {
                break;
            } else {
                damping *= 10.0;
            }
        }
        let force = (0..self.force.len())
            .map(|i| self.force_of(i, turn))
            .collect();
        BalancedForces {
            force,
            turn: turn.into(),
            met: self.small(&at, 1e3 * SLACK),
        }
    }

    fn force_of(&self, i: usize, turn: Vector3<f64>) -> f64 {
        if !self.may[i] {
            return self.force[i];
        }
        self.wanted(i, turn).clamp(0.0, self.bound[i])
    }

    fn wanted(&self, i: usize, turn: Vector3<f64>) -> f64 {
        self.force[i] - self.softness[i] * (self.gap[i] - dot(self.rows[i], turn.into()))
    }

    fn small(&self, at: &Point, slack: f64) -> bool {
        (0..3).all(|a| at.out[a].abs() <= slack * at.size[a])
    }

    fn at(&self, turn: Vector3<f64>) -> Point {
        let balance = Vector3::from(self.motion.balance);
        let mut point = Point {
            value: 0.0,
            out: -balance,
            size: balance.abs(),
            slope: Matrix3::zeros(),
            whole: Matrix3::zeros(),
        };
        for i in 0..self.force.len() {
            let row = Vector3::from(self.rows[i]);
            let force = self.force_of(i, turn);
            point.out += row * force;
            point.size += row.abs() * force;
            if !self.may[i] {
                continue;
            }
            let (s, wanted) = (self.softness[i], self.wanted(i, turn));
            // The integral of the force over the motion.
            point.value += force * (wanted - 0.5 * force) / s;
            let square = row * row.transpose() * s;
            point.whole += square;
            if wanted > 0.0 && wanted < self.bound[i] {
                point.slope += square;
            }
        }
        point.value -= (0..self.force.len())
            .filter(|&i| !self.may[i])
            .map(|i| -self.force[i] * dot(self.rows[i], turn.into()))
            .sum::<f64>()
            + balance.dot(&turn);
        for a in (0..3).filter(|&a| !self.motion.free[a]) {
            point.out[a] = 0.0;
            for b in 0..3 {
                for matrix in [&mut point.slope, &mut point.whole] {
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
    /// What is out of balance.
    out: Vector3<f64>,
    /// Of how much.
    size: Vector3<f64>,
    slope: Matrix3<f64>,
    /// The slope with every node between its bounds.
    whole: Matrix3<f64>,
}
