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

/// From forces within their bounds towards others, up to where the first one meets its bound: the part of the way and the
/// forces there.
pub(crate) fn clip(from: &[f64], to: &[f64], bound: &[f64]) -> (f64, Vec<f64>) {
    let end = |(f, (t, b)): (&f64, (&f64, &f64))| match t - f {
        down if down < 0.0 && *t < 0.0 => f / -down,
        up if up > 0.0 && t > b => (b - f) / up,
        _ => 1.0,
    };
    let pairs = || from.iter().zip(to.iter().zip(bound));
    let part = pairs().map(end).fold(1.0, f64::min);
    let force = pairs().map(|pair| {
        let (f, (t, b)) = pair;
        match end(pair) <= part && (*t < 0.0 || t > b) {
            // Exactly at the bound, so that the node leaves the set.
            true => t.clamp(0.0, *b),
            false => (f + part * (t - f)).clamp(0.0, *b),
        }
    });
    (part, force.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clipped_way_ends_exactly_where_the_first_force_meets_its_bound() {
        let bound = [4.0, 4.0, 4.0, f64::INFINITY];
        let (part, force) = clip(&[1.0, 2.0, 3.0, 0.0], &[-1.0, -1.0, 5.0, 8.0], &bound);
        assert_eq!((part, force), (0.5, vec![0.0, 0.5, 4.0, 4.0]));
        let (part, force) = clip(&[1.0, 2.0, 3.0, 0.0], &[0.0, 4.0, 1.0, 8.0], &bound);
        assert_eq!((part, force), (1.0, vec![0.0, 4.0, 1.0, 8.0]));
    }
}
