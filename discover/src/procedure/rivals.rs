//! The class of a selected effect: rivals given which it is not significant.

use crate::finding::Rival;
use crate::procedure::rules::thresholds;

/// Largest number of rivals that are reported.
const MAX_REPORTED: usize = 12;

thresholds! {
    /// When a rival belongs to the class.
    pub struct RivalRule {
        /// t that the named effect must keep given the rival, to be distinguished from it. Chosen.
        pub needed_t: f64 = 2.0,
        /// Addition to it, over the root of the number of independent runs, for few runs. Chosen.
        pub needed_t_few: f64 = 0.0,
        /// Share of the named effect's gain that a rival must explain; 0: none. Chosen.
        pub least_gain: f64 = 0.0,
        /// Correlation above which two effects are equivalent. Chosen.
        pub alike: f64 = 1.0,
        /// |t| of its own below which an effect is no rival. Chosen.
        pub least_t: f64 = 0.0,
    }
}

/// The named effect.
#[derive(Clone, Copy, Debug)]
pub struct NamedEffect<'a> {
    pub effect: &'a str,
    /// Its t, with sign.
    pub t: f64,
    /// Its gain.
    pub gain: f64,
    /// Number of independent runs or rows.
    pub units: usize,
}

impl RivalRule {
    /// The class, the named effect first, and the rivals with their class membership, best first.
    ///
    /// `others` contains every other candidate, with `in_class` set if its size is admissible. An
    /// admissible candidate belongs to the class if it is equivalent to the named effect, or if it
    /// explains enough and the named effect has less than the needed t given it.
    pub fn class(&self, named: &NamedEffect, others: Vec<Rival>) -> (Vec<String>, Vec<Rival>) {
        let needed = self.needed_t + self.needed_t_few / (named.units.max(1) as f64).sqrt();
        let mut rivals = others;
        rivals.retain(|r| r.t.abs() >= self.least_t);
        for rival in &mut rivals {
            let enough = self.least_gain == 0.0 || rival.gain > self.least_gain * named.gain;
            let hidden = rival.t_of_named_beyond * named.t.signum() < needed;
            let same = rival.correlation.abs() > self.alike;
            rival.in_class &= same || hidden && enough;
        }
        rivals.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        let mut class = vec![named.effect.to_owned()];
        for rival in rivals.iter().filter(|r| r.in_class) {
            if !class.contains(&rival.effect) {
                class.push(rival.effect.clone());
            }
        }
        rivals.truncate(MAX_REPORTED);
        (class, rivals)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rival(effect: &str, gain: f64, t_given: f64, correlation: f64) -> Rival {
        Rival {
            effect: effect.to_owned(),
            parameter: String::new(),
            size: 1.0,
            unit: String::new(),
            t: 5.0,
            gain,
            correlation,
            t_of_named_beyond: t_given,
            in_class: true,
            decides: String::new(),
        }
    }

    #[test]
    fn a_rival_is_in_the_class_if_it_makes_the_effect_insignificant_or_is_equal() {
        let rule = RivalRule {
            least_gain: 0.3,
            alike: 0.99,
            ..RivalRule::default()
        };
        let named = NamedEffect {
            effect: "named",
            t: -8.0,
            gain: 100.0,
            units: 9,
        };
        let others = vec![
            rival("hides", 80.0, -1.0, 0.9),
            rival("stands-beside", 90.0, -6.0, 0.9),
            rival("too-weak", 20.0, 0.0, 0.9),
            rival("the-same", 20.0, -6.0, -0.995),
            Rival {
                in_class: false,
                ..rival("inadmissible", 99.0, 0.0, 0.9)
            },
        ];
        let (class, rivals) = rule.class(&named, others);
        assert_eq!(class, ["named", "hides", "the-same"]);
        assert_eq!(rivals[0].effect, "inadmissible");
        assert_eq!(rivals.iter().filter(|r| r.in_class).count(), 2);
    }
}
