//! Comparison of two models by the decrease of the misfit on held-out data.

use crate::procedure::rules::SearchRules;

/// Decrease of the misfit from one model to another.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Decrease {
    /// Decrease of the sum of squares over all channels, each in units of its variance.
    pub by: f64,
    /// Standard error of the decrease, from its scatter over the data.
    pub error: f64,
    /// The decrease and its standard error with channels weighted by their information on the
    /// training data; `None` for a single channel.
    pub weighted: Option<[f64; 2]>,
    /// Twice the log-likelihood ratio of contacts and its bound under noise, if only one model has
    /// contacts.
    pub contact_evidence: Option<[f64; 2]>,
    /// The decrease and its standard error by channel, if there are several.
    pub by_channel: Vec<(&'static str, [f64; 2])>,
    /// Repeatable part of the first model's sum of squares; 0 if unknown.
    pub repeats: f64,
}

impl Decrease {
    /// The sum over independent pieces, with a standard error from their scatter; `None` without
    /// pieces.
    pub fn over(pieces: &[f64]) -> Option<Self> {
        let n = pieces.len() as f64;
        let by: f64 = pieces.iter().sum();
        let squares: f64 = pieces.iter().map(|piece| (piece - by / n).powi(2)).sum();
        (n > 0.0).then(|| Self {
            by,
            error: (squares * n / (n - 1.0).max(1.0)).sqrt(),
            ..Self::default()
        })
    }

    /// The decrease plus the decrease `by` of the squared distance from the prior, which has no
    /// scatter.
    pub fn with_prior(self, by: f64) -> Self {
        Self {
            by: self.by + by,
            weighted: self
                .weighted
                .map(|[weighted, error]| [weighted + by, error]),
            ..self
        }
    }

    /// The sum over independent pieces of several channels. The weights of the channels follow from
    /// `training`, the decreases on the training data.
    pub fn over_channels<const C: usize>(
        names: [&'static str; C],
        pieces: &[[f64; C]],
        training: &[[f64; C]],
    ) -> Option<Self> {
        let over = |weights: [f64; C]| {
            let sum = |piece: &[f64; C]| piece.iter().zip(&weights).map(|(f, w)| f * w).sum();
            Self::over(&pieces.iter().map(sum).collect::<Vec<f64>>())
        };
        let weighted = over(weights(training))?;
        let of_channel = |(c, name): (usize, &'static str)| {
            let decrease = over(std::array::from_fn(|k| f64::from(k == c)))?;
            Some((name, [decrease.by, decrease.error]))
        };
        Some(Self {
            weighted: Some([weighted.by, weighted.error]),
            by_channel: (names.into_iter().enumerate())
                .filter_map(of_channel)
                .collect(),
            ..over([1.0; C])?
        })
    }

    /// The sum of this decrease and the decrease in data of another kind.
    pub fn with_other_data(self, other: Self) -> Self {
        Self {
            by: self.by + other.by,
            error: self.error.hypot(other.error),
            weighted: None,
            contact_evidence: self.contact_evidence.or(other.contact_evidence),
            by_channel: [self.by_channel, other.by_channel].concat(),
            repeats: self.repeats + other.repeats,
        }
    }

    /// This decrease by one step, with the repeatable part of the whole comparison `all`: the
    /// largest of the repeatable misfits and of the decrease by all steps, of which `before` is due
    /// to the other steps. A decrease on held-out data is repeatable whether runs are alike or not.
    pub fn with_repeatable_part_of(self, all: &Decrease, before: f64) -> Self {
        Self {
            repeats: self.repeats.max(all.repeats).max(before + self.by),
            ..self
        }
    }

    /// Whether the decrease is accepted: significant, and a material share of the repeatable
    /// misfit.
    ///
    /// If it is clearly significant with weighted channels, the unweighted decrease may be within
    /// its scatter of 0. The evidence of contacts must exceed its bound under noise.
    pub fn is_accepted(&self, rules: &SearchRules) -> bool {
        let clear = self
            .weighted
            .filter(|[by, error]| *by > rules.clear * error);
        let by = match clear {
            Some([by, _]) if self.by > -rules.beyond_scatter * self.error => by.max(self.by),
            _ => self.by,
        };
        let exceeds = |[observed, chance]: [f64; 2]| observed > rules.beyond_scatter * chance;
        self.strength() > rules.beyond_scatter
            && self.contact_evidence.is_none_or(exceeds)
            && by > 0.0
            && by >= rules.material * self.repeats
    }

    /// The decrease in standard errors: unweighted or weighted, whichever is larger. The unweighted
    /// one dilutes a step of one channel by the scatter of the others.
    pub fn strength(&self) -> f64 {
        let ratio = |[by, error]: [f64; 2]| by / error.max(1e-300);
        let unweighted = ratio([self.by, self.error]);
        self.weighted
            .map_or(unweighted, |weighted| ratio(weighted).max(unweighted))
    }

    /// The decrease in words, for an effect selected in this channel.
    pub fn in_words(&self, channel: &str) -> String {
        let mut text = format!(
            "the sum of squares decreases by {:.1} ± {:.1} noise variances, its repeatable part is {:.1}",
            self.by, self.error, self.repeats
        );
        match (self.contact_evidence, self.weighted) {
            (Some([observed, chance]), _) => {
                text += &format!(
                    "; twice the log-likelihood ratio of the contacts is {observed:.1}, noise alone gives up to {chance:.1}"
                );
            }
            (None, Some([by, error])) => {
                let errors = by / error.max(1e-300);
                text += &format!(
                    "; {errors:.1} standard errors with channels weighted by their information"
                );
            }
            (None, None) => {}
        }
        let own = self.by_channel.iter().find(|(name, _)| *name == channel);
        if let Some((name, [by, error])) = own {
            text += &format!("; in {name} by {by:.1} ± {error:.1}");
        }
        text
    }
}

/// Weight of each channel: the ratio of its mean decrease to its variance between pieces of data,
/// which maximises the significance of the sum; 0 without a decrease. All 1 for too few pieces and
/// if no channel decreases.
fn weights<const C: usize>(training: &[[f64; C]]) -> [f64; C] {
    const MIN_PIECES: usize = 4;
    let n = training.len() as f64;
    let weight: [f64; C] = std::array::from_fn(|c| {
        let mean = training.iter().map(|piece| piece[c]).sum::<f64>() / n;
        let squares = training.iter().map(|piece| (piece[c] - mean).powi(2));
        mean.max(0.0) * (n - 1.0) / squares.sum::<f64>().max(1e-300)
    });
    let largest = weight.iter().copied().fold(0.0, f64::max);
    if training.len() < MIN_PIECES || largest == 0.0 {
        [1.0; C]
    } else {
        weight.map(|weight| weight / largest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decrease_within_its_scatter_or_too_small_is_rejected() {
        let rules = SearchRules::default();
        let decrease = |by, error, repeats| Decrease {
            by,
            error,
            weighted: None,
            contact_evidence: None,
            by_channel: Vec::new(),
            repeats,
        };
        let of = |by, error, repeats| decrease(by, error, repeats).is_accepted(&rules);
        assert!(of(30.0, 5.0, 100.0));
        assert!(!of(-1.0, 5.0, 0.0) && !of(4.0, 5.0, 0.0));
        let weighted = |by, weighted| Decrease {
            weighted: Some([weighted, 0.5]),
            ..decrease(by, 5.0, 0.0)
        };
        assert!(weighted(4.0, 2.0).is_accepted(&rules));
        assert!(weighted(4.0, 1.0).is_accepted(&rules) && !weighted(-4.0, 1.0).is_accepted(&rules));
        // Clear as reported, with channels that scatter about 0 or rise.
        assert!(
            weighted(-4.0, 2.0).is_accepted(&rules) && !weighted(-6.0, 2.0).is_accepted(&rules)
        );
        assert!(weighted(6.0, 0.1).is_accepted(&rules) && !weighted(4.0, 0.1).is_accepted(&rules));
        assert!(!of(4.0, 0.1, 100.0) && of(6.0, 0.1, 100.0));
        for (repeats, before, accepted) in [
            (20.0, 0.0, true),
            (1000.0, 0.0, false),
            (20.0, 900.0, false),
        ] {
            let all = decrease(20.0, 1.0, repeats);
            assert_eq!(
                decrease(6.0, 0.1, 100.0)
                    .with_repeatable_part_of(&all, before)
                    .is_accepted(&rules),
                accepted
            );
        }
    }

    /// A channel of a small, steady decrease with one that scatters widely about 0.
    #[test]
    fn a_steady_decrease_is_significant_despite_another_channels_scatter() {
        let rules = SearchRules::default();
        let loud = [30.0, -20.0, 25.0, -35.0, 15.0, -14.0];
        let falls = |quiet: f64| loud.map(|l| [quiet + 0.01 * l, l]);
        let names = ["quiet", "loud"];
        let of = |falls: &[[f64; 2]]| Decrease::over_channels(names, falls, &falls_learned());
        let found = of(&falls(1.0)).unwrap();
        assert!(
            found.is_accepted(&rules) && found.strength() > 5.0,
            "{found:?}"
        );
        assert!(found.by < found.error, "{found:?}");
        assert!(!of(&falls(-1.0)).unwrap().is_accepted(&rules));
        // Too few to estimate the scatter.
        let few = Decrease::over_channels(names, &falls(1.0), &falls_learned()[..3]).unwrap();
        assert_eq!(few.weighted, Some([few.by, few.error]));
    }

    #[test]
    fn contact_evidence_must_exceed_its_bound_under_noise() {
        let rules = SearchRules::default();
        let observed = |observed| Decrease {
            contact_evidence: Some([observed, 3.7]),
            ..Decrease::over(&[5.0, 6.0, 5.5]).unwrap()
        };
        assert!(observed(3.8).is_accepted(&rules));
        assert!(!observed(3.6).is_accepted(&rules) && !observed(-4.0).is_accepted(&rules));
        let text = observed(-4.0).in_words("yaw");
        assert!(text.contains("ratio of the contacts is -4.0"), "{text}");
    }

    fn falls_learned() -> Vec<[f64; 2]> {
        let loud = [-12.0, 22.0, -31.0, 18.0, 27.0, -20.0, -5.0, 3.0];
        loud.iter().map(|l| [1.0 - 0.02 * l, *l]).collect()
    }
}
