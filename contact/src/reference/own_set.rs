//! Contact on a plane whose response is known exactly, by a primal-dual active set of its own.

use faer::Mat;
use nalgebra::{Matrix3, Vector3};

use crate::active_set::motion::{Motion, dot};
use crate::precondition::dense_cholesky::DenseCholesky;

/// The contact problem: gap = `gap` - N q + S f, 0 <= f_i <= bound_i, N^T f = balance for the motions that are free.
pub(crate) struct OwnSet<'a> {
    /// S, symmetric positive definite [m/N].
    pub response: &'a Mat<f64>,
    /// Gap without motion and forces [m].
    pub gap: &'a [f64],
    /// Rows N.
    pub rows: &'a [[f64; 3]],
    /// Largest force of each node [N].
    pub bound: &'a [f64],
    /// Which motions are free, and the balance that they answer to.
    pub motion: &'a Motion,
}

/// What a node does.
#[derive(Clone, Copy, PartialEq)]
enum Node {
    Open,
    Closed,
    Full,
}

/// Most sets; a primal-dual active set takes some ten.
const SETS: usize = 100;
/// Tension over the largest force, and penetration over the deepest one, that are rounding.
const SLACK: f64 = 1e-11;

impl OwnSet<'_> {
    /// Forces and motion, from all nodes closed; the motions that are held are those of `held`. `None` where the sets go in circles.
    ///
    /// M. Hintermüller, K. Ito and K. Kunisch, SIAM J. Optim. 13 (2003) 865-888.
    pub fn solve(&self, held: [f64; 3]) -> Option<(Vec<f64>, [f64; 3])> {
        let n = self.gap.len();
        let mut nodes = vec![Node::Closed; n];
        for _ in 0..SETS {
            let (force, motion) = self.on(&nodes, held)?;
            let largest = force.iter().fold(0.0f64, |m, f| m.max(f.abs()));
            let gaps: Vec<f64> = (0..n)
                .map(|i| {
                    let moved: f64 = (0..n).map(|j| self.response[(i, j)] * force[j]).sum();
                    self.gap[i] - dot(self.rows[i], motion) + moved
                })
                .collect();
            let deepest = (0..n).fold(0.0f64, |m, i| {
                m.max((self.gap[i] - dot(self.rows[i], motion)).abs())
            });
            let next: Vec<Node> = (0..n)
                .map(|i| match nodes[i] {
                    Node::Closed if force[i] < -SLACK * largest => Node::Open,
                    Node::Closed if force[i] > self.bound[i] + SLACK * largest => Node::Full,
                    Node::Open if gaps[i] < -SLACK * deepest => Node::Closed,
                    Node::Full if gaps[i] > SLACK * deepest => Node::Closed,
                    stays => stays,
                })
                .collect();
            if next == nodes {
                return Some((force, motion));
            }
            nodes = next;
        }
        None
    }

    /// Forces and motion with the nodes as they are: S_cc f_c = N_c q - gap_c - S_cf bound_f, and the balance by its Schur complement.
    fn on(&self, nodes: &[Node], held: [f64; 3]) -> Option<(Vec<f64>, [f64; 3])> {
        let (s, n) = (self.response, nodes.len());
        let mut force: Vec<f64> = (0..n)
            .map(|i| match nodes[i] {
                Node::Full => self.bound[i],
                Node::Open | Node::Closed => 0.0,
            })
            .collect();
        let closed: Vec<usize> = (0..n).filter(|&i| nodes[i] == Node::Closed).collect();
        let m = closed.len();
        if m == 0 {
            return None;
        }
        let factor = DenseCholesky::new(&Mat::from_fn(m, m, |i, j| s[(closed[i], closed[j])]))?;
        let solved = factor.solve(&Mat::from_fn(m, 4, |k, column| match column {
            3 => {
                let i = closed[k];
                self.gap[i] + (0..n).map(|j| s[(i, j)] * force[j]).sum::<f64>()
            }
            a => self.rows[closed[k]][a],
        }));
        let along = |a: usize, column: usize| -> f64 {
            let of = closed.iter().enumerate();
            of.map(|(k, &i)| self.rows[i][a] * solved[(k, column)])
                .sum()
        };
        let (mut matrix, mut side) = (Matrix3::identity(), Vector3::from(held));
        for a in (0..3).filter(|&a| self.motion.free[a]) {
            let full: f64 = (0..n).map(|i| self.rows[i][a] * force[i]).sum();
            side[a] = self.motion.balance[a] - full + along(a, 3);
            for b in 0..3 {
                matrix[(a, b)] = along(a, b);
            }
        }
        // A motion that no node feels (the roll on one row of nodes) has no line in the balance: the least motion is taken. Rows of
        // units apart are brought to one size first.
        let size = Vector3::from_fn(|a, _| match matrix[(a, a)] {
            d if d > 0.0 => f64::sqrt(d),
            _ => 1.0,
        });
        let scaled = Matrix3::from_fn(|a, b| matrix[(a, b)] / (size[a] * size[b]));
        let found = scaled.svd(true, true);
        let motion = found.solve(&side.component_div(&size), 1e-12).ok()?;
        let motion: [f64; 3] = motion.component_div(&size).into();
        for (k, &i) in closed.iter().enumerate() {
            force[i] = (0..3).map(|a| solved[(k, a)] * motion[a]).sum::<f64>() - solved[(k, 3)];
        }
        Some((force, motion))
    }
}
