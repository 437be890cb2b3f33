//! Thresholds of a search, with their meaning and whether they are derived or chosen.
//!
//! *Derived* thresholds follow from statistics or from the kind of data. *Chosen* ones could have
//! other values: `blind constants` scores searches at half and at twice each of them. Numerical
//! constants of one method, such as lengths of cells and numbers of trials, are in its file.

use serde::{Deserialize, Serialize};

use crate::procedure::lock::LockRules;
use crate::procedure::rivals::RivalRule;

/// Declares structs of thresholds, each with its default value.
macro_rules! thresholds {
    ($($(#[$doc:meta])* pub struct $name:ident {
        $($(#[$field_doc:meta])* pub $field:ident: $type:ty = $default:expr,)*
    })*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct $name {
            $($(#[$field_doc])* pub $field: $type,)*
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $default,)* }
            }
        }
    )*};
}

pub(crate) use thresholds;

/// The thresholds of a search. [`Rules::default`] is what the command uses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Rules {
    /// Common to all kinds of data.
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

thresholds! {
    /// Thresholds that are common to all kinds of data.
    pub struct SearchRules {
        /// Largest number of effects that are named; twice as many screens are made, since several
        /// amplitudes or places of one effect belong to one effect. Chosen: a fifth effect is
        /// usually explained by errors of the others.
        pub most_effects: usize = 4,
        /// |t| given all other effects below which a selected effect has become superfluous, in
        /// experiments. Chosen.
        pub superfluous_t: f64 = 1.5,
        /// Decrease of the misfit on held-out data, in its standard errors, that a step and the
        /// whole model must exceed to be named. Chosen: it is a second test of significant effects.
        pub beyond_scatter: f64 = 1.0,
        /// Decrease with weighted channels, in its standard errors, above which the unweighted
        /// decrease may be within its scatter of 0; and gain of a law that replaces a named effect,
        /// in its standard errors. Chosen: of 34 steps that were refused without it four pass,
        /// three of them correctly; at half the same four, at twice one that is incorrect.
        pub clear: f64 = 3.0,
        /// Share of a channel's mean square that may repeat from run to run in an adequate model.
        /// Chosen: a twentieth of the root mean square.
        pub adequate: f64 = 0.1,
        /// Factor between a base parameter and its given value above which it is implausible.
        /// Chosen: published coefficients of steel on ice for bobsleds differ by less.
        pub plausible: f64 = 3.0,
        /// Smallest share of the repeatable misfit on held-out data that a step must close, and
        /// largest growth of a root mean square on them against the model as given. Chosen: no
        /// driver notices less.
        pub material: f64 = 0.05,
        /// Standard errors of their difference within which sizes of several kinds of data, or of
        /// track channel and forces, agree, and by which a size must differ from 0 in pressure
        /// maps. Derived: three.
        pub agree: f64 = 3.0,
        /// Standard errors by which a size must exceed its critical value to be selected with a
        /// probability of 90 %. Derived: the normal law's 90 % quantile.
        pub nine_in_ten: f64 = 1.28,
        /// Standard deviations of a 95 % interval. Derived: the normal law's 97.5 % quantile.
        pub interval: f64 = 1.96,
    }

    /// Runs on a track.
    pub struct RunRules {
        /// Largest p-value of a selected effect within runs, everywhere or in a window of distance.
        /// Chosen with the three below for a total false positive rate of about 0.02: missing
        /// effects are usually far more significant.
        pub alpha: f64 = 0.005,
        /// Largest p-value of a selected effect between sessions or between the runs of a session,
        /// tested for friction and for grip; and of a bin whose place is reported although no
        /// effect is named. Chosen.
        pub alpha_levels: f64 = 0.002,
        /// Largest p-value of a selected column outside the catalogue, and of unexplained
        /// differences between sessions. Chosen.
        pub alpha_column: f64 = 0.001,
        /// Largest p-value of a selected effect in the track channel. Chosen.
        pub alpha_track: f64 = 0.0005,
        /// Factor on these p-values after the first selected effect. Chosen.
        pub alpha_again: f64 = 0.5,
        /// Smallest share of a candidate's information that remains after a refit of the base, for
        /// it to be tested. Chosen.
        pub least_left: f64 = 2e-3,
        /// The smallest remaining share if installation errors are refitted, too. Chosen.
        pub least_left_installed: f64 = 1e-6,
        /// Smallest share of a column's products that is not noise. Chosen.
        pub least_signal: f64 = 0.2,
        /// Share of the strongest selected effect's gain above which a window competes with it.
        /// Chosen.
        pub window_competes: f64 = 0.3,
        /// Distance between the knots of the discrepancy over place \[m\]. Chosen: half a bend.
        pub discrepancy_m: f64 = 40.0,
        /// Contacts with walls, each run's own.
        pub contacts: ContactRules = ContactRules::default(),
        /// Standard deviations of its tolerance above which a tilt of the accelerometer is selected
        /// before effects on forces. Derived: of 25 parts within their tolerances one exceeds it in
        /// 1.6 of 1000 campaigns.
        pub belief: f64 = 4.0,
        /// t that a catalogue effect must lose, and a column outside the catalogue keep, for the
        /// column to be named instead. Chosen.
        pub column_wins: [f64; 2] = [2.0, 3.0],
        /// Laws outside the catalogue.
        pub laws: LawRules = LawRules::default(),
        /// Rivals of a selected effect within runs.
        pub rivals: RivalRule = RivalRule {
            needed_t: 2.0,
            needed_t_few: 2.0,
            least_gain: 0.3,
            alike: 0.995,
            least_t: 1.5,
        },
        /// Rivals of a selected effect between sessions or runs.
        pub level_rivals: RivalRule = RivalRule {
            needed_t: 2.5,
            least_gain: 0.5,
            ..RivalRule::default()
        },
        /// Rivals of a selected effect in the track channel.
        pub track_rivals: RivalRule = RivalRule {
            needed_t: 3.0,
            ..RivalRule::default()
        },
        /// Largest ratio of the scatter of the track channel's runs to the scatter by sensor noise
        /// with which the channel is used. Chosen.
        pub track_agrees: f64 = 3.0,
        /// Standard deviation of the surveyed slope if none is stated \[rad\]. Chosen: 0.002 of a
        /// levelling over 5 m to 1 cm, and 0.0035 of a mean driven line a decimetre off the
        /// surveyed one where the bank grows by 0.035 rad/m. With 0.002 one campaign without an
        /// effect was called not identifiable.
        pub slope_sd_rad: f64 = 0.004,
        /// Relative standard deviation of the length of a driven line, included in intervals of the
        /// speed's scale and offset. Derived: weaving by 2 to 4 degrees lengthens a way by half the
        /// square of that, 0.06 to 0.24 %; a decimetre farther out in bends that add up to 20 rad,
        /// on 1500 m, changes it by 0.13 %. Of 42 such intervals 30 covered the truth without it,
        /// 36 with half, 41 with it, 42 with twice (blind cases with seeds 131001 to 137001).
        pub line_share: f64 = 0.002,
        /// Standard deviation of the two edges of a window together \[m\]. Chosen.
        pub edges_m: f64 = 1.5,
        /// p-value of a bin below which a residual is not clean. Chosen.
        pub bin_unclean: f64 = 0.01,
        /// Width of the narrowest window \[m\]; others are up to 16 times as wide. Also the length
        /// over which runs are compared with one another. Chosen: a wall hit.
        pub window_m: f64 = 10.0,
        /// Width of the track channel's bins \[m\]. Chosen.
        pub track_bin_m: f64 = 20.0,
        /// Shortest piece of a run in simulations of noise \[s\]. Chosen: longer ones cost more.
        pub noise_piece_s: f64 = 7.0,
        /// Smallest eigenvalue of an explainable direction, whose candidates have unit norm: below
        /// it the candidates are collinear. Chosen.
        pub explains_alone: f64 = 1e-2,
        /// Smallest |t| over runs of the scores of an explainable direction. Chosen.
        pub explains_beyond: f64 = 2.0,
        /// Signal processing.
        pub recordings: RecordingRules = RecordingRules::default(),
    }

    /// Contacts with walls, each run's own.
    pub struct ContactRules {
        /// Deviation of a run's lateral residual from the median over runs, in robust standard
        /// deviations, above which the run differs. Chosen.
        pub differs: f64 = 8.0,
        /// Deviation of the mean square over all runs at a place from the track's median, in robust
        /// standard deviations, above which the runs differ. Chosen.
        pub together: f64 = 3.25,
        /// Deviation of a run, in robust standard deviations, below which the interval of a place
        /// ends. Chosen.
        pub ends: f64 = 4.0,
        /// Largest share of a track at which runs differ: above it the model is wrong. Chosen.
        pub most: f64 = 0.1,
        /// Largest p-value of selected contacts. Chosen: it must also be confirmed on held-out
        /// runs.
        pub alpha: f64 = 0.02,
        /// p-value of the differences between runs at a place above which they are attributed to
        /// chance pushes of single runs. Chosen.
        pub met_by_chance: f64 = 0.1,
        /// Largest ratio of a wall contact's lever to the distance of the runner on that side: a
        /// force further out is a force of the runner. Chosen.
        pub inside: f64 = 0.75,
        /// Ratio of the gain of contacts, which have three numbers each, to the gain of any single
        /// effect, above which contacts are selected. Chosen.
        pub over: f64 = 2.0,
        /// Clipping of a row of the lateral balance in comparisons of contacts, in standard
        /// deviations. Other pushes remain in the residuals of both models: seventy deviations
        /// would multiply any other difference. Chosen.
        pub most_of_a_row: f64 = 6.0,
    }

    /// Laws outside the catalogue.
    pub struct LawRules {
        /// Penalty on the log-likelihood per parameter of a formula, and smallest increase of the
        /// log-likelihood by a fully fitted law that replaces an effect. Derived: half the
        /// logarithm of some thousands of rows (Schwarz's criterion).
        pub number: f64 = 4.5,
        /// Difference of gains, in its standard errors over runs, within which a simpler formula is
        /// as good as a better one. Chosen.
        pub as_good: f64 = 1.0,
        /// Difference of gains, in its standard errors over runs, within which another column
        /// belongs to a law's class. Derived: two, as for rivals.
        pub alike: f64 = 2.0,
        /// Number of smooth laws, the best first, for which formulas are tried. Chosen.
        pub tried: usize = 4,
    }

    /// Signal processing: from recorded signals to rows.
    pub struct RecordingRules {
        /// Cutoff frequency of the low pass of every signal \[Hz\]. Chosen: a driver steers below 5
        /// Hz.
        pub signal_cutoff_hz: f64 = 16.0,
        /// Retained samples per second \[1/s\]. Derived: three times the cutoff.
        pub signal_rate_hz: f64 = 50.0,
        /// Cutoff frequency of the low pass of the balances \[Hz\]. Chosen.
        pub row_cutoff_hz: f64 = 4.0,
        /// Rows per second \[1/s\]. Derived: two and a half times the cutoff.
        pub row_rate_hz: f64 = 10.0,
        /// Range of the ratio of the noise estimated from differences to the stated noise in which
        /// the stated noise is not doubted. Chosen.
        pub noise_as_stated: [f64; 2] = [0.7, 1.4],
        /// Ratio of the power of an axis at frequencies above the motion to the power of the
        /// quietest axis of its instrument, above which the power is taken for motion. Chosen.
        pub quietest_axis: f64 = 10.0,
    }

    /// Friction experiments.
    pub struct ExperimentRules {
        /// Largest p-value of a selected effect, by permutation and by simulated tables alike.
        /// Chosen.
        pub alpha: f64 = 0.03,
        /// Smallest share of a candidate's column that remains after a refit of the base, for it to
        /// be tested. Chosen.
        pub least_left: f64 = 0.02,
        /// Share of the largest |t| above which a candidate is fitted in full. Chosen.
        pub near_largest: f64 = 0.6,
        /// Rivals of a selected effect, and t that a named effect must keep given a column.
        pub rivals: RivalRule = RivalRule {
            needed_t: 2.2,
            alike: 0.9999,
            least_t: 1.5,
            ..RivalRule::default()
        },
        /// Addition to the normal quantile of intervals, divided by the degrees of freedom.
        /// Derived: Student's t to first order.
        pub interval_few: f64 = 2.5,
        /// Mean square in units of the noise above which the residual is not clean. Chosen.
        pub unclean: f64 = 3.0,
    }

    /// Pressure maps.
    pub struct MapRules {
        /// Smallest decrease of chi2 by a selected effect. Chosen: a probability of e^-15 per
        /// effect under noise.
        pub least_drop: f64 = 30.0,
        /// Smallest relative decrease of chi2 by a selected effect. Chosen.
        pub least_share: f64 = 0.2,
        /// Rivals: t is the root of their excess of chi2, in units of the best fit's mean square.
        pub rivals: RivalRule = RivalRule {
            needed_t: 3.0,
            ..RivalRule::default()
        },
        /// Mean square in units of the noise above which a residual is not clean. Chosen.
        pub unclean: f64 = 2.0,
        /// Mean square, and remaining share of the excess over the noise, above both of which a
        /// named effect is doubtful. Chosen.
        pub doubtful: [f64; 2] = [10.0, 0.1],
        /// Cells over half the patch while searching. Chosen.
        pub searching_cells: usize = 8,
        /// Cells of the solves from which sizes are reported. Chosen.
        pub reporting_cells: usize = 12,
        /// Pixels in each direction that count as one independent value. Chosen.
        pub independent_pixels: f64 = 4.0,
        /// Standard deviation of a pixel's place given the film's place, in pixels. Chosen: without
        /// it 5 of 11 intervals of blind cases did not contain the hidden size.
        pub pixel_place: f64 = 1.0 / 3.0,
        /// Standard deviation of a film's shift against the runner in each direction, if not stated
        /// \[m\]. Chosen: a film is laid to a mark by hand.
        pub film_shift_m: f64 = 5e-4,
        /// Standard deviation of a film's rotation, if not stated \[rad\]. Derived: each end of a
        /// film 0.14 m long is off by the shift.
        pub film_rotation_rad: f64 = 5e-3,
        /// Error of the solves, relative to the peak pressure. Chosen.
        pub solves: f64 = 0.003,
    }
}

impl Rules {
    /// Rules from TOML text; missing keys have their defaults.
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
