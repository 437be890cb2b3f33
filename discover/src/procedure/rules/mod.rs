//! The thresholds of a search, with what each does and whether it is derived or chosen.
//!
//! *Derived* thresholds follow from statistics or from the kind of data. *Chosen* ones could have
//! other values: `blind constants` scores searches at half and at twice each of them. Numerical
//! constants of one method, such as lengths of cells and numbers of trials, are in its file.

mod contacts;
mod laws;
mod maps;

use serde::{Deserialize, Serialize};

pub use contacts::ContactRules;
pub use laws::LawRules;
pub use maps::MapRules;

use crate::procedure::lock::LockRules;
use crate::procedure::rivals::RivalRule;

/// The thresholds of a search. [`Rules::default`] is what the command uses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Rules {
    /// What holds for every kind of data.
    pub search: SearchRules,
    /// Which data are held out.
    pub lock: LockRules,
    /// Runs on a track.
    pub runs: RunRules,
    /// Friction experiments.
    pub experiments: ExperimentRules,
    /// Pressure maps.
    pub maps: MapRules,
}

/// What holds for every kind of data.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SearchRules {
    /// Most effects that are named; twice as many screens are made, since several amplitudes or places of one effect belong to one effect. Chosen:
    /// what comes fifth is explained by its betters' errors as well.
    pub most_effects: usize,
    /// |t| given all others below which a selected effect has become superfluous. Chosen.
    pub superfluous_t: f64,
    /// Standard errors by which the gap on held-out data must fall for a step, and for the whole answer, to be named. Chosen:
    /// it is tested once more of what was significant already.
    pub beyond_scatter: f64,
    /// Standard errors by which it must fall in the channels that tell of a step for the others to count only where they rise above their
    /// scatter, and by which a law must explain more than a named effect of the catalogue to replace it. Chosen: of 34 steps that were refused without it four pass, three of which are there; at half the same four, at twice one that is not.
    pub clear: f64,
    /// Share of a channel's mean square that may repeat from run to run in an adequate model. Chosen: a twentieth of the root mean square.
    pub adequate: f64,
    /// Factor between a base parameter and its given value above which it is implausible. Chosen: coefficients of steel on ice that
    /// are published for bobsleds differ by less.
    pub plausible: f64,
    /// Share of the gap that repeats from run to run, on held-out data and with nothing named, that a step must close to be worth saying, and by
    /// which a root mean square on them may grow against the model as given. Chosen: less is seen by no one who drives.
    pub material: f64,
    /// Share of the sum of squares that the installation's tolerances amount to which a step must close, too. Chosen: a hundredth in size.
    pub trace: f64,
    /// Standard errors of their difference within which sizes of several kinds of data, or of track channel and forces, are one, and by which a size
    /// must differ from 0 in pressure maps. Derived: three of their joint error.
    pub agree: f64,
    /// Standard deviations by which a size must exceed its critical value to be selected nine times in ten. Derived: the
    /// normal law's 90 % quantile.
    pub nine_in_ten: f64,
    /// Standard deviations of a 95 % interval. Derived: the normal law's 97.5 % quantile.
    pub interval: f64,
}

impl Default for SearchRules {
    fn default() -> Self {
        Self {
            most_effects: 4,
            superfluous_t: 1.5,
            beyond_scatter: 1.0,
            clear: 3.0,
            adequate: 0.1,
            plausible: 3.0,
            material: 0.05,
            trace: 1e-4,
            agree: 3.0,
            nine_in_ten: 1.28,
            interval: 1.96,
        }
    }
}

/// Runs on a track.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RunRules {
    /// Largest p-value of a selected effect within runs, all along or in a window of distance. Chosen with the three below, so that together they leave a null a chance of
    /// about 0.02 of being selected: what a model does not contain usually exceeds these by far, and chance does not.
    pub alpha: f64,
    /// The same between the sessions, and between the runs of a session, tested twice: friction and grip; and of a bin below which a place is
    /// reported although no effect is named. Chosen.
    pub alpha_levels: f64,
    /// The same for a column outside the catalogue, and where sessions differ although nothing can be named. Chosen.
    pub alpha_column: f64,
    /// The same in the track channel. Chosen.
    pub alpha_track: f64,
    /// Share of these p-values that remains after the first selected effect. Chosen.
    pub alpha_again: f64,
    /// Factors of what the sensors' noise adds between which a selected effect must hold, the noise being stated. Chosen.
    pub noise_trust: [f64; 2],
    /// The same where the noise is taken from the recordings' spectra. Measured: of 48 columns of speed, slip, steering and yaw rate beneath
    /// coloured and filtered noise, what is there is 0.7 to 1.4 times of what is found in 46.
    pub spectral_noise_trust: [f64; 2],
    /// The same where it is taken for white, from differences of the recordings. Chosen.
    pub estimated_noise_trust: [f64; 2],
    /// Share of its critical T that a selected effect must retain at both ends of the trusted noise. Chosen.
    pub holds: f64,
    /// The same for a window: runs repeat the same manoeuvre at the same place, and a small error of the model with it.
    /// Chosen.
    pub window_holds: f64,
    /// Share of a direction that a refit of the base must leave for it to be judged. Chosen.
    pub least_left: f64,
    /// The same where what the installation may be off by is refitted, too. Chosen.
    pub least_left_installed: f64,
    /// Share of a direction's products that must not be noise. Chosen.
    pub least_signal: f64,
    /// Share of the strongest selected effect's gain from which a window competes with it. Chosen.
    pub window_competes: f64,
    /// Distance between the knots of the discrepancy over place \[m\]. Chosen: half a bend.
    pub discrepancy_m: f64,
    /// Contacts with walls, each run's own.
    pub contacts: ContactRules,
    /// Standard deviations of its tolerance above which a tilt of the accelerometer comes before the forces. Derived: of 25 parts within their
    /// tolerances one exceeds it in 1.6 of 1000 campaigns.
    pub belief: f64,
    /// t that a catalogue effect must lose, and a column outside the catalogue keep, for the column to be named instead.
    /// Chosen.
    pub column_wins: [f64; 2],
    /// Laws outside the catalogue.
    pub laws: LawRules,
    /// Rivals of a selected effect within runs.
    pub rivals: RivalRule,
    /// Rivals of a selected effect between sessions or runs.
    pub level_rivals: RivalRule,
    /// Rivals of a selected effect in the track channel.
    pub track_rivals: RivalRule,
    /// The track channel is used where its runs agree within this many times what the sensors' noise scatters. Chosen.
    pub track_agrees: f64,
    /// Standard deviation of the surveyed slope where none is stated \[rad\]. Chosen: 0.002 of a levelling over 5 m to
    /// 1 cm, and 0.0035 of drivers whose mean line is a decimetre off the surveyed one where the bank grows by 0.035 rad/m. With 0.002 one campaign
    /// without an effect was called not identifiable.
    pub slope_sd_rad: f64,
    /// Share by which a driven line may be longer or shorter than the surveyed one, a standard deviation that intervals of the speed's scale and
    /// offset take in. Derived: weaving by 2 to 4 degrees makes a way half the square of that longer, 0.06 to 0.24 %, and a decimetre farther out in
    /// bends that add up to 20 rad, on 1500 m, makes it 0.13 % longer or shorter. Of 42 such intervals 30 covered the truth without it, 36 with
    /// half, 41 with it, 42 with twice (blind cases with seeds 131001 to 137001).
    pub line_share: f64,
    /// Relative standard error of what stated noise is known by, which a parameter's interval takes in. Chosen.
    pub stated_noise_error: f64,
    /// The same for noise estimated from the recordings. Chosen.
    pub estimated_noise_error: f64,
    /// How far the two edges of a stretch may be off together, a standard deviation \[m\]. Chosen.
    pub edges_m: f64,
    /// p-value of a bin below which a residual is not clean. Chosen.
    pub bin_unclean: f64,
    /// Width of the narrowest window that is searched for effects at a place \[m\]; others are twice as wide, up to 16 times; over
    /// such a length runs are compared with one another. Chosen: a wall hit.
    pub window_m: f64,
    /// Width of the track channel's bins \[m\]. Chosen.
    pub track_bin_m: f64,
    /// Time on either side of a moment at which the speed's reading may jump \[s\]. Chosen: as long as accelerometer and survey are off alike;
    /// at half of it seven of seven cases are found as with it, at twice six, with a jump that is not there.
    pub jump_reach_s: f64,
    /// Shortest piece of a run with which the sensors' noise is simulated \[s\]. Chosen: longer ones take longer.
    pub noise_piece_s: f64,
    /// Share of a direction's own size that others must leave for it to count as explainable. Chosen.
    pub explains_alone: f64,
    /// Standard errors over runs by which a direction must be significant to count as explainable. Chosen.
    pub explains_beyond: f64,
    /// How recorded signals become rows.
    pub recordings: RecordingRules,
}

/// How recorded signals become rows.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RecordingRules {
    /// Corner of the low pass of every signal, before the balances are taken \[Hz\]. Chosen: a driver steers below 5 Hz.
    pub signal_cutoff_hz: f64,
    /// Samples a second that are retained \[1/s\]. Derived: three times the corner.
    pub signal_rate_hz: f64,
    /// Corner of the low pass of the balances \[Hz\]. Chosen.
    pub row_cutoff_hz: f64,
    /// Rows a second \[1/s\]. Derived: two and a half times the corner.
    pub row_rate_hz: f64,
    /// Noise from sample to sample over the stated one outside which what is stated is doubted. Chosen.
    pub noise_as_stated: [f64; 2],
    /// Power of an axis over that of the quietest axis of its instrument, above the motion, above which it is taken for motion. Chosen.
    pub quietest_axis: f64,
}

impl Default for RecordingRules {
    fn default() -> Self {
        Self {
            signal_cutoff_hz: 16.0,
            signal_rate_hz: 50.0,
            row_cutoff_hz: 4.0,
            row_rate_hz: 10.0,
            noise_as_stated: [0.7, 1.4],
            quietest_axis: 10.0,
        }
    }
}

impl Default for RunRules {
    fn default() -> Self {
        Self {
            alpha: 0.005,
            alpha_levels: 0.002,
            alpha_column: 0.001,
            alpha_track: 0.0005,
            alpha_again: 0.5,
            noise_trust: [0.75, 1.3],
            spectral_noise_trust: [0.7, 1.4],
            estimated_noise_trust: [0.5, 1.6],
            holds: 0.85,
            window_holds: 1.5,
            least_left: 2e-3,
            least_left_installed: 1e-6,
            least_signal: 0.2,
            window_competes: 0.3,
            discrepancy_m: 40.0,
            contacts: ContactRules::default(),
            belief: 4.0,
            column_wins: [2.0, 3.0],
            laws: LawRules::default(),
            rivals: RivalRule {
                needed_t: 2.0,
                needed_t_few: 2.0,
                least_gain: 0.3,
                alike: 0.995,
                least_t: 1.5,
            },
            level_rivals: RivalRule {
                needed_t: 2.5,
                least_gain: 0.5,
                ..RivalRule::default()
            },
            track_rivals: RivalRule {
                needed_t: 3.0,
                ..RivalRule::default()
            },
            track_agrees: 3.0,
            slope_sd_rad: 0.004,
            line_share: 0.002,
            stated_noise_error: 0.1,
            estimated_noise_error: 0.5,
            edges_m: 1.5,
            bin_unclean: 0.01,
            window_m: 10.0,
            track_bin_m: 20.0,
            jump_reach_s: 0.8,
            noise_piece_s: 7.0,
            explains_alone: 1e-2,
            explains_beyond: 2.0,
            recordings: RecordingRules::default(),
        }
    }
}

/// Friction experiments.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ExperimentRules {
    /// Largest p-value of a selected effect, by permutation and against simulated tables alike. Chosen.
    pub alpha: f64,
    /// Share of a direction that a refit of the base must leave for it to be judged. Chosen.
    pub least_left: f64,
    /// Share of the largest |t| from which a candidate is fitted in full. Chosen.
    pub near_largest: f64,
    /// Rivals of a selected effect, and t that a named effect must retain given a mere column.
    pub rivals: RivalRule,
    /// What is added to the normal quantile of intervals, over the degrees of freedom. Derived: Student's t to first order.
    pub interval_few: f64,
    /// Mean square in units of the noise above which the residual is not clean. Chosen.
    pub unclean: f64,
}

impl Default for ExperimentRules {
    fn default() -> Self {
        Self {
            alpha: 0.03,
            least_left: 0.02,
            near_largest: 0.6,
            rivals: RivalRule {
                needed_t: 2.2,
                alike: 0.9999,
                least_t: 1.5,
                ..RivalRule::default()
            },
            interval_few: 2.5,
            unclean: 3.0,
        }
    }
}

impl Rules {
    /// Rules from TOML text; what it leaves out stays as it is by default.
    ///
    /// # Errors
    /// Those of the TOML reader: unknown keys and wrong types.
    pub fn from_toml(text: &str) -> Result<Self, toml::de::Error> {
        toml::from_str(text)
    }

    /// The rules as TOML text.
    ///
    /// # Errors
    /// Those of the TOML writer.
    pub fn to_toml(&self) -> Result<String, toml::ser::Error> {
        toml::to_string(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_go_through_toml_unchanged_and_unknown_ones_are_refused() {
        let rules = Rules::default();
        let text = rules.to_toml().expect("plain data");
        assert_eq!(Rules::from_toml(&text), Ok(rules));
        let one = Rules::from_toml("[maps]\nleast_drop = 15.0\n").expect("a rule");
        assert_eq!((one.maps.least_drop, one.runs), (15.0, rules.runs));
        assert!(Rules::from_toml("[maps]\nleast_drops = 15.0\n").is_err());
    }
}
