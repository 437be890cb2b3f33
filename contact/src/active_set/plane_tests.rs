//! Claims on accelerated projective SOR on the contact plane.

use std::borrow::Cow;

use super::*;

/// Nodes on a square under a round bottom: point loads on a half-space, and a stiff spring under
/// each.
struct Square {
    green: Mat<f64>,
    gap: Vec<f64>,
    rows: Vec<[f64; 3]>,
}

impl Square {
    fn new(n: usize, lean: f64) -> Self {
        let place = |i: usize| {
            let at = |k: usize| 2.0 * k as f64 / (n - 1) as f64 - 1.0;
            [at(i % n), at(i / n)]
        };
        let green = Mat::from_fn(n * n, n * n, |i, j| {
            let ([x, y], [s, t]) = (place(i), place(j));
            let spacing = 2.0 / (n - 1) as f64;
            1.0 / (x - s).hypot(y - t).max(0.28 * spacing)
        });
        let gap = (0..n * n).map(|i| {
            let [x, y] = place(i);
            0.5 * (x * x + y * y) + lean * x
        });
        let rows = (0..n * n).map(|i| [1.0, place(i)[0], -place(i)[1]]);
        Square {
            green,
            gap: gap.collect(),
            rows: rows.collect(),
        }
    }

    fn solve(&self, bound: f64, motion: &Motion, start: f64) -> PlaneState {
        let bound = vec![bound; self.gap.len()];
        let green = Green::Dense(Cow::Borrowed(&self.green));
        let problem = PlaneProblem {
            green: &green,
            gap: &self.gap,
            rows: &self.rows,
            bound: &bound,
            motion,
        };
        let none = vec![0.0; self.gap.len()];
        problem.solve(PlaneState::new(none, [start, 0.0, 0.0]))
    }
}

fn free(motions: [bool; 3], balance: [f64; 3]) -> Motion {
    Motion {
        free: motions,
        balance,
    }
}

#[test]
fn energy_falls_step_by_step_to_a_state_that_meets_every_condition() {
    let square = Square::new(15, 0.1);
    for (load, bound) in [
        (0.3, f64::INFINITY),
        (0.02, f64::INFINITY),
        (0.3, 0.006),
        (0.3, 0.0021),
    ] {
        for start in [0.0, 0.4, 30.0] {
            let motion = free([true; 3], [load, 0.1 * load, 0.05 * load]);
            let s = square.solve(bound, &motion, start);
            assert!(s.settled, "{load} {bound} {start}: {:?}", s.counts);
            assert!(
                s.energies.windows(2).all(|e| e[1] <= e[0]),
                "{:?}",
                s.energies
            );
            for a in 0..3 {
                let sum: f64 = s
                    .force
                    .iter()
                    .zip(&square.rows)
                    .map(|(f, r)| f * r[a])
                    .sum();
                assert!((sum - motion.balance[a]).abs() < 1e-9 * load, "{a}: {sum}");
            }
            assert!(s.force.iter().all(|f| (0.0..=bound).contains(f)));
            for i in 0..s.force.len() {
                let deflection: f64 = (0..s.force.len())
                    .map(|j| square.green[(i, j)] * s.force[j])
                    .sum();
                let gap = square.gap[i] - dot(square.rows[i], s.motion) + deflection;
                let wrong = match s.force[i] {
                    0.0 => gap.min(0.0),
                    f if f >= bound => gap.max(0.0),
                    _ => gap,
                };
                assert!(wrong.abs() < 1e-9, "{load} {bound} {start}, {i}: {gap}");
            }
        }
    }
}

/// Thousands of plain sweeps at the motion that was found come to the same forces.
#[test]
fn plain_projected_sor_at_the_motion_found_gives_the_same_forces() {
    let square = Square::new(11, 0.05);
    let motion = free([true, true, false], [0.2, 0.0, 0.0]);
    let s = square.solve(f64::INFINITY, &motion, 0.1);
    let bound = vec![f64::INFINITY; square.gap.len()];
    let green = Green::Dense(Cow::Borrowed(&square.green));
    let plain = PlaneProblem {
        green: &green,
        gap: &square.gap,
        rows: &square.rows,
        bound: &bound,
        motion: &motion,
    };
    let mut state = PlaneState::new(vec![0.0; bound.len()], s.motion);
    let mut deflection = vec![0.0; bound.len()];
    for _ in 0..5000 {
        plain.sweep(&mut state, &mut deflection);
    }
    for (a, b) in state.force.iter().zip(&s.force) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
}

#[test]
fn a_load_that_the_nodes_cannot_bear_is_not_settled_and_presses_all_of_them() {
    let square = Square::new(7, 0.0);
    let s = square.solve(1e-3, &free([true, false, false], [1.0, 0.0, 0.0]), 0.1);
    assert!(!s.settled && s.energies.is_empty());
    assert!(s.force.iter().all(|&f| f == 1e-3));
}
