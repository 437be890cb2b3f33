//! By how much the gap on held-out data is lower with one model than with another.

use crate::procedure::rules::SearchRules;

/// What held-out data say of one model compared with another.
#[derive(Clone, Debug, PartialEq)]
pub struct Lowered {
    /// By how much the sum of squares falls, over all channels, each in units of its variance.
    pub by: f64,
    /// Standard error of this fall, from how much it scatters over the data.
    pub error: f64,
    /// The same fall and its standard error with each channel counting by how much it tells of it where it was learned; nothing where
    /// there is but one.
    pub weighed: Option<[f64; 2]>,
    /// What is retained of what was promised, and what noise alone retains of it, where both models differ in that: it must be more.
    pub promise: Option<[f64; 2]>,
    /// The fall and its standard error channel by channel, where there is more than one.
    pub by_channel: Vec<(&'static str, [f64; 2])>,
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
            weighed: None,
            promise: None,
            by_channel: Vec::new(),
            repeats,
            tolerated: 0.0,
        })
    }

    /// The same over channels of these names, with what each tells of it: `learned` are their falls on the data that both models were learned
    /// from.
    pub fn over_channels<const C: usize>(
        names: [&'static str; C],
        falls: &[[f64; C]],
        learned: &[[f64; C]],
    ) -> Option<Self> {
        let of_channel = |(c, name): (usize, &'static str)| {
            let own: Vec<f64> = falls.iter().map(|fall| fall[c]).collect();
            Self::over(&own, 0.0).map(|own| (name, [own.by, own.error]))
        };
        let weights = weights(learned);
        let [whole, weighed] = [[1.0; C], weights].map(|weights| -> Vec<f64> {
            let one = |fall: &[f64; C]| fall.iter().zip(&weights).map(|(f, w)| f * w).sum();
            falls.iter().map(one).collect()
        });
        let weighed = Self::over(&weighed, 0.0)?;
        Some(Self {
            weighed: Some([weighed.by, weighed.error]),
            by_channel: names
                .into_iter()
                .enumerate()
                .filter_map(of_channel)
                .collect(),
            ..Self::over(&whole, 0.0)?
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

    /// Whether the gap falls, above its scatter, by a share of what repeats, and by more than a trace of what is tolerated. Where it falls
    /// clearly in the channels that tell of it, it may scatter about nothing over all alike, but not rise above that scatter. Of what was
    /// promised more is retained than noise alone keeps.
    pub fn holds(&self, rules: &SearchRules) -> bool {
        let clearly = self.weighed.filter(|[by, error]| *by > rules.clear * error);
        let by = match clearly {
            Some([by, _]) if self.by > -rules.beyond_scatter * self.error => by.max(self.by),
            _ => self.by,
        };
        let exceeds = |[retained, chance]: [f64; 2]| retained > rules.beyond_scatter * chance;
        self.strength() > rules.beyond_scatter
            && self.promise.is_none_or(exceeds)
            && by > 0.0
            && by >= rules.material * self.repeats
            && by >= rules.trace * self.tolerated
    }

    /// The same for a selected effect that is made of this channel: there, where the model is said to be wrong, the gap may not rise above its scatter,
    /// whatever falls elsewhere.
    pub fn holds_in(&self, channel: &str, rules: &SearchRules) -> bool {
        let rises = |[by, error]: [f64; 2]| by < -rules.beyond_scatter * error;
        let mut own = self.by_channel.iter().filter(|(name, _)| *name == channel);
        self.holds(rules) && !own.any(|(_, fall)| rises(*fall))
    }

    /// How clearly it falls, in standard errors: over all channels alike, or as they tell of it, whichever is clearer. A step of one
    /// channel is lost in the scatter of the others; of one that all tell a little of, those that are heard are too few.
    pub fn strength(&self) -> f64 {
        let of = |[by, error]: [f64; 2]| by / error.max(1e-300);
        let alike = of([self.by, self.error]);
        self.weighed.map_or(alike, |weighed| of(weighed).max(alike))
    }

    /// The same in words, of a selected effect that is made of this channel.
    pub fn in_words(&self, channel: &str) -> String {
        let mut text = format!(
            "the sum of squares falls by {:.1} ± {:.1} noise variances, {:.1} repeat between runs",
            self.by, self.error, self.repeats
        );
        match (self.promise, self.weighed) {
            (Some([retained, chance]), _) => {
                text += &format!(
                    "; {retained:.1} of the predicted fall is observed, {chance:.1} by chance"
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
        if self.by < 1e-3 * self.tolerated {
            text += &format!("; the tolerances explain up to {:.1}", self.tolerated);
        }
        let own = self.by_channel.iter().find(|(name, _)| *name == channel);
        if let Some((name, [by, error])) = own {
            text += &format!("; in {name} by {by:.1} ± {error:.1}");
        }
        text
    }
}

/// What a channel's fall counts for: its mean over its variance from one piece of data to the next, with which a sum is most significant;
/// nothing where it does not fall. All alike for so few pieces that their scatter says little.
fn weights<const C: usize>(learned: &[[f64; C]]) -> [f64; C] {
    const FEW: usize = 4;
    let n = learned.len() as f64;
    let weight: [f64; C] = std::array::from_fn(|c| {
        let mean = learned.iter().map(|fall| fall[c]).sum::<f64>() / n;
        let squares = learned.iter().map(|fall| (fall[c] - mean).powi(2));
        mean.max(0.0) * (n - 1.0) / squares.sum::<f64>().max(1e-300)
    });
    let largest = weight.iter().copied().fold(0.0, f64::max);
    match learned.len() < FEW || largest == 0.0 {
        true => [1.0; C],
        false => weight.map(|weight| weight / largest),
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
            weighed: None,
            promise: None,
            by_channel: Vec::new(),
            repeats,
            tolerated: 0.0,
        };
        let of = |by, error, repeats| lowered(by, error, repeats).holds(&rules);
        assert!(of(30.0, 5.0, 100.0));
        assert!(!of(-1.0, 5.0, 0.0) && !of(4.0, 5.0, 0.0));
        let weighed = |by, weighed| Lowered {
            weighed: Some([weighed, 0.5]),
            ..lowered(by, 5.0, 0.0)
        };
        assert!(weighed(4.0, 2.0).holds(&rules));
        assert!(weighed(4.0, 1.0).holds(&rules) && !weighed(-4.0, 1.0).holds(&rules));
        // Clear where it is reported, with channels that scatter about nothing, or rise.
        assert!(weighed(-4.0, 2.0).holds(&rules) && !weighed(-6.0, 2.0).holds(&rules));
        assert!(weighed(6.0, 0.1).holds(&rules) && !weighed(4.0, 0.1).holds(&rules));
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

    /// A channel in which a fall is small and steady with one that scatters widely about nothing.
    #[test]
    fn a_steady_fall_is_not_lost_in_another_channels_scatter() {
        let rules = SearchRules::default();
        let loud = [30.0, -20.0, 25.0, -35.0, 15.0, -14.0];
        let falls = |quiet: f64| loud.map(|l| [quiet + 0.01 * l, l]);
        let names = ["quiet", "loud"];
        let of = |falls: &[[f64; 2]]| Lowered::over_channels(names, falls, &falls_learned());
        let found = of(&falls(1.0)).unwrap();
        assert!(found.holds(&rules) && found.strength() > 5.0, "{found:?}");
        assert!(found.by < found.error, "{found:?}");
        assert!(!of(&falls(-1.0)).unwrap().holds(&rules));
        // Too few to tell how much each scatters.
        let few = Lowered::over_channels(names, &falls(1.0), &falls_learned()[..3]).unwrap();
        assert_eq!(few.weighed, Some([few.by, few.error]));
    }

    #[test]
    fn of_a_promise_more_is_kept_than_noise_keeps() {
        let rules = SearchRules::default();
        let retained = |retained| Lowered {
            promise: Some([retained, 3.7]),
            ..Lowered::over(&[5.0, 6.0, 5.5], 0.0).unwrap()
        };
        assert!(retained(3.8).holds(&rules));
        assert!(!retained(3.6).holds(&rules) && !retained(-4.0).holds(&rules));
        let text = retained(-4.0).in_words("yaw");
        assert!(text.contains("-4.0 of the predicted fall"), "{text}");
    }

    #[test]
    fn what_rises_in_its_own_channel_does_not_hold_there_however_much_falls_in_another() {
        let rules = SearchRules::default();
        let falls = [[-2.0, 9.0], [-3.0, 10.0], [-2.5, 11.0], [-2.2, 10.0]];
        let lowered = Lowered::over_channels(["side", "yaw"], &falls, &falls).unwrap();
        assert!(lowered.holds(&rules) && lowered.holds_in("yaw", &rules));
        assert!(!lowered.holds_in("side", &rules), "{lowered:?}");
        // Within its scatter it may.
        let falls = [[-2.0, 9.0], [3.0, 10.0], [-2.5, 11.0], [1.0, 10.0]];
        let lowered = Lowered::over_channels(["side", "yaw"], &falls, &falls).unwrap();
        assert!(lowered.holds_in("side", &rules));
    }

    fn falls_learned() -> Vec<[f64; 2]> {
        let loud = [-12.0, 22.0, -31.0, 18.0, 27.0, -20.0, -5.0, 3.0];
        loud.iter().map(|l| [1.0 - 0.02 * l, *l]).collect()
    }
}
