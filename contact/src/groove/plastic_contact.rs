//! The contact plane with plastic memory.

use faer::Mat;

use crate::motion::dot;
use crate::precondition::dense::DenseLu;

/// Contact forces f and the ice's plastic depth u on the contact plane, as one complementarity
/// problem.
///
/// Nodes are rows of one y, x ascending; the ice reaches the last node of a row first. With the
/// rise r of the depth at a node over that at the next one ahead,
///
/// ```text
/// gap = g - N q + G f + u,   u_i = before + sum over i and all ahead of r
/// 0 <= f  _|_  gap >= 0,     0 <= r  _|_  f <= bound
/// ```
///
/// It is not a minimisation problem (r only acts on the nodes behind). At a given motion q it is
/// solved by Newton's method on the sets of nodes that are open (f = 0, r = 0), closed (gap = 0, r
/// = 0) or full (gap = 0, f = bound): M. Hintermüller, K. Ito, K. Kunisch, SIAM J. Optim. 13 (2003)
/// 865-888. If the sets cycle, sweeps from the front to the back give new ones.
pub(crate) struct PlasticContact {
    /// G, the response of the gap to forces [m/N].
    pub green: Mat<f64>,
    /// g, the gap without motion, forces and groove [m].
    pub gap: Vec<f64>,
    /// Rows of N.
    pub rows: Vec<[f64; 3]>,
    /// Forces at the ice's hardness [N].
    pub bound: Vec<f64>,
    /// Whether the next node is the next one ahead in the same row.
    pub has_ahead: Vec<bool>,
    /// Depth of the groove of earlier runners [m].
    pub before: Vec<f64>,
}

/// State of a node in the active set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Open,
    Closed,
    Full,
}

/// Forces, motion and groove.
#[derive(Clone, Debug)]
pub(crate) struct PlasticState {
    pub kinds: Vec<Kind>,
    /// Contact forces [N].
    pub force: Vec<f64>,
    /// Approach [m], pitch and roll [rad].
    pub motion: [f64; 3],
    /// Plastic depth u [m].
    pub depth: Vec<f64>,
    /// Rise r over the depth ahead [m].
    pub rise: Vec<f64>,
    /// Gap [m].
    pub gap: Vec<f64>,
}

/// Largest total number of Newton steps.
const MAX_STEPS: usize = 300;
/// Number of Newton steps without fewer contradictions after which sweeps follow.
const PATIENCE: usize = 12;
/// Number of sweeps at a time.
const SWEEPS: usize = 12;
/// Contradictions below this fraction of the largest force or depth are rounding.
const SLACK: f64 = 1e-11;

impl PlasticContact {
    /// Solves at a given motion from initial sets; `None` if no set is confirmed.
    pub fn at(&self, motion: [f64; 3], kinds: &[Kind]) -> Option<PlasticState> {
        let mut kinds = kinds.to_vec();
        let (mut fewest, mut patience) = (usize::MAX, PATIENCE);
        for _ in 0..MAX_STEPS {
            let state = self.newton(kinds, motion)?;
            let (next, changes) = self.corrected(&state);
            if changes == 0 {
                return Some(state);
            }
            kinds = next;
            if changes < fewest {
                (fewest, patience) = (changes, PATIENCE);
            } else if patience == 0 {
                let bounded = state.force.iter().zip(&self.bound);
                let mut force: Vec<f64> = bounded.map(|(f, b)| f.clamp(0.0, *b)).collect();
                self.sweep(&mut force, motion);
                kinds = self.kinds(&force);
                (fewest, patience) = (usize::MAX, 2 * PATIENCE);
            } else {
                patience -= 1;
            }
        }
        None
    }

    /// The sets that forces belong to.
    pub fn kinds(&self, force: &[f64]) -> Vec<Kind> {
        let of = |(&force, &bound): (&f64, &f64)| match force {
            f if f <= 0.0 => Kind::Open,
            f if f >= bound => Kind::Full,
            _ => Kind::Closed,
        };
        force.iter().zip(&self.bound).map(of).collect()
    }

    /// N^T f.
    pub fn resultant(&self, force: &[f64]) -> [f64; 3] {
        [0, 1, 2].map(|a| {
            force
                .iter()
                .zip(&self.rows)
                .map(|(f, row)| f * row[a])
                .sum()
        })
    }

    /// Forces and groove that satisfy the equations of the sets, regardless of their signs.
    fn newton(&self, kinds: Vec<Kind>, motion: [f64; 3]) -> Option<PlasticState> {
        let full = |i: usize| match kinds[i] {
            Kind::Full => self.bound[i],
            _ => 0.0,
        };
        let mut force: Vec<f64> = (0..kinds.len()).map(full).collect();
        let closed = self.closed(&kinds);
        if !closed.is_empty() {
            let anchor = self.anchors(&kinds);
            let pressed = self.deflection(&force);
            // Gap of a node without the forces of the closed nodes.
            let missing = |i: usize| self.gap[i] - dot(self.rows[i], motion) + pressed[i];
            let mut solved = Mat::from_fn(closed.len(), 1, |row, _| {
                let i = closed[row];
                anchor[i].map_or(-self.before[i], missing) - missing(i)
            });
            self.response(&closed, &anchor).solve_in_place(&mut solved);
            for (row, &i) in closed.iter().enumerate() {
                force[i] = solved[(row, 0)];
            }
        }
        let finite = force.iter().all(|f| f.is_finite());
        finite.then(|| self.state(kinds, force, motion))
    }

    /// Derivative of N^T f by the motion on fixed sets: a row per component of the resultant, a
    /// column per motion.
    pub fn slopes(&self, kinds: &[Kind]) -> [[f64; 3]; 3] {
        let closed = self.closed(kinds);
        let mut slopes = [[0.0; 3]; 3];
        if closed.is_empty() {
            return slopes;
        }
        let anchor = self.anchors(kinds);
        let mut solved = Mat::from_fn(closed.len(), 3, |row, b| {
            let i = closed[row];
            self.rows[i][b] - anchor[i].map_or(0.0, |a| self.rows[a][b])
        });
        self.response(&closed, &anchor).solve_in_place(&mut solved);
        for (row, &i) in closed.iter().enumerate() {
            for (a, slopes) in slopes.iter_mut().enumerate() {
                for (b, slope) in slopes.iter_mut().enumerate() {
                    *slope += self.rows[i][a] * solved[(row, b)];
                }
            }
        }
        slopes
    }

    fn closed(&self, kinds: &[Kind]) -> Vec<usize> {
        (0..kinds.len())
            .filter(|&i| kinds[i] == Kind::Closed)
            .collect()
    }

    /// The factorised response of the closed nodes, each relative to the full node ahead whose
    /// depth it has.
    fn response(&self, closed: &[usize], anchor: &[Option<usize>]) -> DenseLu {
        let matrix = Mat::from_fn(closed.len(), closed.len(), |row, column| {
            let (i, j) = (closed[row], closed[column]);
            self.green[(i, j)] - anchor[i].map_or(0.0, |a| self.green[(a, j)])
        });
        DenseLu::new(matrix)
    }

    /// For each node the nearest full node ahead, whose depth it has.
    fn anchors(&self, kinds: &[Kind]) -> Vec<Option<usize>> {
        let mut anchor = vec![None; kinds.len()];
        for i in (0..kinds.len().saturating_sub(1)).rev() {
            if self.has_ahead[i] {
                anchor[i] = match kinds[i + 1] {
                    Kind::Full => Some(i + 1),
                    _ => anchor[i + 1],
                };
            }
        }
        anchor
    }

    /// The state with the groove of the full nodes, and the gaps over it.
    fn state(&self, kinds: Vec<Kind>, force: Vec<f64>, motion: [f64; 3]) -> PlasticState {
        let n = kinds.len();
        let deflection = self.deflection(&force);
        let (mut depth, mut rise, mut gap) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        for i in (0..n).rev() {
            let ahead = if self.has_ahead[i] {
                depth[i + 1]
            } else {
                self.before[i]
            };
            let above = self.gap[i] - dot(self.rows[i], motion) + deflection[i];
            depth[i] = if kinds[i] == Kind::Full {
                -above
            } else {
                ahead
            };
            rise[i] = depth[i] - ahead;
            gap[i] = above + depth[i];
        }
        PlasticState {
            kinds,
            force,
            motion,
            depth,
            rise,
            gap,
        }
    }

    /// The sets that the signs require, and the number of nodes that change.
    fn corrected(&self, state: &PlasticState) -> (Vec<Kind>, usize) {
        let largest = state.force.iter().fold(0.0f64, |m, f| m.max(f.abs()));
        let deep = (0..state.gap.len())
            .map(|i| (dot(self.rows[i], state.motion) - self.gap[i]).abs())
            .filter(|d| d.is_finite())
            .fold(0.0f64, f64::max);
        let mut changes = 0;
        let next = (0..state.kinds.len()).map(|i| {
            let wanted = match state.kinds[i] {
                Kind::Open if state.gap[i] < -SLACK * deep => Kind::Closed,
                Kind::Closed if state.force[i] < -SLACK * largest => Kind::Open,
                Kind::Closed if state.force[i] > self.bound[i] * (1.0 + SLACK) => Kind::Full,
                Kind::Full if state.rise[i] < -SLACK * deep => Kind::Closed,
                same => same,
            };
            changes += usize::from(wanted != state.kinds[i]);
            wanted
        });
        let next = next.collect();
        (next, changes)
    }

    /// Projected sweep at fixed motion, each row from front to back, with its groove updated.
    fn sweep(&self, force: &mut [f64], motion: [f64; 3]) {
        let mut deflection = self.deflection(force);
        for _ in 0..SWEEPS {
            let mut depth = 0.0;
            for i in (0..force.len()).rev() {
                if !self.has_ahead[i] {
                    depth = self.before[i];
                }
                let stiff = self.green[(i, i)];
                let gap = self.gap[i] - dot(self.rows[i], motion) + deflection[i] + depth;
                let wanted = force[i] - gap / stiff;
                depth += stiff * (wanted - self.bound[i]).max(0.0);
                let change = wanted.clamp(0.0, self.bound[i]) - force[i];
                if change != 0.0 {
                    force[i] += change;
                    for (d, g) in deflection.iter_mut().zip(self.green.col(i).iter()) {
                        *d += change * g;
                    }
                }
            }
        }
    }

    /// G f.
    pub fn deflection(&self, force: &[f64]) -> Vec<f64> {
        let mut deflection = vec![0.0; force.len()];
        for (j, &f) in force.iter().enumerate().filter(|(_, f)| **f != 0.0) {
            for (d, g) in deflection.iter_mut().zip(self.green.col(j).iter()) {
                *d += f * g;
            }
        }
        deflection
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: usize = 13;

    /// Nodes under a round bottom, five rows of thirteen: point loads on a half-space, and a stiff
    /// spring under each.
    fn place(i: usize) -> [f64; 2] {
        let at = |k: usize| k as f64 / 6.0 - 1.0;
        [at(i % N), 0.5 * at(3 * (i / N))]
    }

    /// So many rows of such nodes, with this largest force and depth of the groove ahead.
    fn plane(lines: usize, bound: f64, before: f64) -> PlasticContact {
        let n = lines * N;
        PlasticContact {
            green: Mat::from_fn(n, n, |i, j| {
                let ([x, y], [s, t]) = (place(i), place(j));
                1.0 / (x - s).hypot(y - t).max(0.05)
            }),
            gap: (0..n)
                .map(|i| place(i).iter().map(|v| 0.5 * v * v).sum())
                .collect(),
            rows: (0..n).map(|i| [1.0, place(i)[0], -place(i)[1]]).collect(),
            bound: vec![bound; n],
            has_ahead: (0..n).map(|i| i % N + 1 < N).collect(),
            before: vec![before; n],
        }
    }

    /// Hundreds of plain sweeps from the front to the back at the same motion come to the same
    /// forces and the same groove.
    #[test]
    fn the_sets_found_are_those_of_plain_sweeps() {
        let n = 5 * N;
        // The largest force without a bound is 4.9e-3.
        for (bound, before, yields) in [
            (6e-3, 0.0, false),
            (4e-3, 0.0, true),
            (3e-3, 0.0, true),
            (3e-3, 0.02, true),
        ] {
            let memory = plane(5, bound, before);
            let motion = [0.35, 0.02, 0.0];
            let found = memory
                .at(motion, &vec![Kind::Closed; n])
                .expect("sets that hold");
            let mut force = vec![0.0; n];
            (0..300).for_each(|_| memory.sweep(&mut force, motion));
            for (i, &force) in force.iter().enumerate() {
                let off = (force - found.force[i]).abs();
                assert!(off < 1e-9, "{bound} {i}: {force} {}", found.force[i]);
                let ahead = if memory.has_ahead[i] {
                    found.depth[i + 1]
                } else {
                    before
                };
                assert!(found.depth[i] >= ahead - 1e-12 && found.gap[i] > -1e-12);
                assert!(found.depth[i] <= ahead + 1e-12 || force == bound);
            }
            assert_eq!(found.kinds.contains(&Kind::Full), yields, "{bound}");
        }
    }

    /// The slopes are differences of resultants, while no node changes sides.
    #[test]
    fn slopes_are_differences_of_the_resultant() {
        let n = 2 * N;
        let memory = PlasticContact {
            gap: (0..n).map(|i| 0.5 * place(i)[0].powi(2)).collect(),
            ..plane(2, 4e-3, 0.0)
        };
        let motion = [0.2, 0.01, 0.0];
        let here = memory
            .at(motion, &vec![Kind::Closed; n])
            .expect("sets that hold");
        let slopes = memory.slopes(&here.kinds);
        for b in 0..3 {
            let step = 1e-9;
            let mut moved = motion;
            moved[b] += step;
            let there = memory.at(moved, &here.kinds).expect("sets that hold");
            assert_eq!(there.kinds, here.kinds);
            let [from, to] = [&here, &there].map(|state| memory.resultant(&state.force));
            for a in 0..3 {
                let difference = (to[a] - from[a]) / step;
                assert!(
                    (difference - slopes[a][b]).abs() < 1e-4,
                    "{a} {b}: {difference} {}",
                    slopes[a][b]
                );
            }
        }
    }
}
