//! By how much the gap on locked-away data is lower with one model than with another.

use crate::procedure::rules::SearchRules;

/// What locked-away data say of one model beside another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lowered {
    /// By how much the sum of squares falls, over all channels, each in units of its variance.
    pub by: f64,
    /// Standard error of this fall, from how much it scatters over the data.
    pub error: f64,
    /// What repeats from run to run of the first model's sum of squares; 0 where it is not known.
    pub repeats: f64,
    /// Sum of squares that one standard deviation of everything the installation may be off by amounts to; 0 for none.
    pub tolerated: f64,
}

impl Lowered {
    /// The sum over independent pieces of data, with the error that their scatter gives; `None` without any.
    pub fn over(falls: &[f64], repeats: f64) -> Option<Self> {
        let n = falls.len() as f64;
        let by: f64 = falls.iter().sum();
        let squares: f64 = falls.iter().map(|fall| (fall - by / n).powi(2)).sum();
        (n > 0.0).then(|| Self {
            by,
            error: (squares * n / (n - 1.0).max(1.0)).sqrt(),
            repeats,
            tolerated: 0.0,
        })
    }

    /// The same as a part of the gap of the first model of all: of what repeats of it, and of what falls from that model on to the second
    /// one here, `before` being what of it has fallen already. What falls on data that were not seen repeats, whether runs are alike or not.
    pub fn of_all(self, all: &Lowered, before: f64) -> Self {
        Self {
            repeats: self.repeats.max(all.repeats).max(before + self.by),
            ..self
        }
    }

    /// Whether the gap falls beyond its scatter, by a share of what repeats, and by more than a trace of what is tolerated.
    pub fn holds(&self, rules: &SearchRules) -> bool {
        self.by > rules.beyond_scatter * self.error
            && self.by >= rules.material * self.repeats
            && self.by >= rules.trace * self.tolerated
    }

    /// How clearly it falls: in standard errors.
    pub fn strength(&self) -> f64 {
        self.by / self.error.max(1e-300)
    }

    /// The same in words.
    pub fn told(&self) -> String {
        let told = format!(
            "by {:.1} +- {:.1} units of the noise's variance, of {:.1} that repeat",
            self.by, self.error, self.repeats
        );
        match self.by < 1e-3 * self.tolerated {
            true => format!("{told}; tolerances amount to {:.1}", self.tolerated),
            false => told,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fall_within_its_scatter_or_too_small_to_matter_does_not_hold() {
        let rules = SearchRules::default();
        let lowered = |by, error, repeats| Lowered {
            by,
            error,
            repeats,
            tolerated: 0.0,
        };
        let of = |by, error, repeats| lowered(by, error, repeats).holds(&rules);
        assert!(of(30.0, 5.0, 100.0));
        assert!(!of(-1.0, 5.0, 0.0) && !of(4.0, 5.0, 0.0));
        assert!(!of(4.0, 0.1, 100.0) && of(6.0, 0.1, 100.0));
        for (repeats, before, holds) in [
            (20.0, 0.0, true),
            (1000.0, 0.0, false),
            (20.0, 900.0, false),
        ] {
            let all = lowered(20.0, 1.0, repeats);
            assert_eq!(
                lowered(6.0, 0.1, 100.0).of_all(&all, before).holds(&rules),
                holds
            );
        }
        let tolerated = |tolerated| Lowered {
            tolerated,
            ..lowered(6.0, 0.1, 100.0)
        };
        assert!(tolerated(1e4).holds(&rules) && !tolerated(1e6).holds(&rules));
    }
}
