//! Which nodes touch, and which of them carry all they can.

use crate::active_set::motion::Motion;

/// Nodes whose gap is closed, and nodes that carry all they can.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Sets {
    /// Gap zero, force between its bounds.
    pub inside: Vec<usize>,
    /// Force at its upper bound.
    pub full: Vec<usize>,
}

impl Sets {
    /// The sets that forces belong to.
    pub fn of(force: &[f64], bound: &[f64]) -> Self {
        let mut sets = Sets::default();
        for (i, (&f, &b)) in force.iter().zip(bound).enumerate() {
            if f >= b {
                sets.full.push(i);
            } else if f > 0.0 {
                sets.inside.push(i);
            }
        }
        sets
    }

    /// Lets one node between its bounds where none is and what is full does not bear the load.
    ///
    /// Full nodes alone tell no motion, and their forces sum to what they sum to. Where load is left the open node that is
    /// nearest to touching takes it, where they bear too much the full one that is pressed in least gives way.
    pub fn free_one(&mut self, motion: &Motion, bound: &[f64], gap: impl Fn(usize) -> f64) {
        if !self.inside.is_empty() || self.full.is_empty() || !motion.free[0] {
            return;
        }
        let left = motion.balance[0] - self.full.iter().map(|&i| bound[i]).sum::<f64>();
        if left.abs() <= 1e-12 * motion.balance[0] {
            return;
        }
        if left > 0.0 {
            let open = (0..bound.len()).filter(|i| self.full.binary_search(i).is_err());
            self.inside
                .extend(open.min_by(|&i, &j| gap(i).total_cmp(&gap(j))));
        } else {
            let least = self
                .full
                .iter()
                .copied()
                .max_by(|&i, &j| gap(i).total_cmp(&gap(j)));
            self.full.retain(|&i| Some(i) != least);
            self.inside.extend(least);
        }
    }
}
