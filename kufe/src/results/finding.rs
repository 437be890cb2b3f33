//! `report.json`: the result of a search for missing effects, with the pictures of its page.
//!
//! [`Report`] is the whole document; [`Picture`]s are only on the page.

use std::collections::{BTreeMap, BTreeSet};

use schemars::JsonSchema;
use serde::Serialize;

/// A value with its 95 % interval.
pub use kufe_sled::friction::Estimate as Interval;

use crate::case::effects::Map;
use crate::plot::Scale;

/// Outcome of a search in one word.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// One effect, which the data distinguish from all others.
    Named,
    /// One effect of a class whose members the data cannot distinguish.
    OneOf,
    /// A law that is not in the catalogue, written as a formula.
    Law,
    /// The conclusion depends on the stated deviation of the survey.
    DependsOn,
    /// A significant place or bin, but no named effect.
    Located,
    /// A misfit that repeats from run to run, without a named effect or a significant bin.
    Inadequate,
    /// No significant effect.
    #[default]
    None,
    /// A significant difference whose cause these data cannot identify.
    NotIdentifiable,
}

/// A fitted parameter.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Fitted {
    /// Key, as in `[effects.NAME]`.
    pub name: String,
    /// Estimate.
    pub value: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end of the 95 % interval.
    pub high: f64,
    /// Unit.
    pub unit: String,
}

/// An installation error within its tolerance.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Tolerated {
    /// Kind of error, such as the delay of a channel.
    pub what: String,
    /// Estimated size.
    pub size: f64,
    /// Unit of the size.
    pub unit: String,
}

/// A significant zero offset of a sensor in the runs of one session.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SessionOffset {
    /// Column of the sensor.
    pub sensor: String,
    /// Session.
    pub session: String,
    /// Estimate.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
    /// Unit.
    pub unit: String,
    /// Stated standard deviation of the offset, `tolerances.session_offset_rad`.
    pub tolerance: f64,
}

impl SessionOffset {
    /// The offsets of each sensor.
    pub fn by_sensor(offsets: &[Self]) -> Vec<Vec<&Self>> {
        let sensors: BTreeSet<&str> = offsets.iter().map(|one| one.sensor.as_str()).collect();
        let of = |sensor: &str| offsets.iter().filter(|one| one.sensor == sensor).collect();
        sensors.into_iter().map(of).collect()
    }

    /// Range over sessions and standard error of the offsets of one sensor; there is at least one.
    pub fn in_words(offsets: &[&Self]) -> String {
        let first = offsets[0];
        let values = || offsets.iter().map(|one| one.value);
        let [min, max] = [
            values().fold(f64::INFINITY, f64::min),
            values().fold(f64::NEG_INFINITY, f64::max),
        ];
        let error = offsets.iter().map(|one| one.error).fold(0.0, f64::max);
        let scale = Scale::of_all(&first.unit, [min, max]);
        let [low, high, error] =
            [min, max, error].map(|value| format!("{:.2}", scale.times * value));
        let range = if offsets.len() == 1 {
            format!("{low} {} in session {}", scale.unit, first.session)
        } else {
            let count = offsets.len();
            format!("{low} to {high} {} in {count} sessions", scale.unit)
        };
        format!(
            "zero offset of {}: {range}, standard error {error} {}",
            first.sensor, scale.unit
        )
    }
}

/// A rival effect: another explanation of the misfit, with the evidence for and against it.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Rival {
    /// Name of the effect.
    pub effect: String,
    /// Parameter of the effect.
    pub parameter: String,
    /// Fitted size of the parameter.
    pub size: f64,
    /// Unit of the size.
    pub unit: String,
    /// t statistic of the rival alone.
    pub t: f64,
    /// Reduction of the sum of squared residuals, in units of the noise variance.
    pub gain: f64,
    /// Partial correlation with the named effect, given the base parameters.
    pub correlation: f64,
    /// t statistic of the named effect when the rival is fitted too. If it is small, the data
    /// cannot distinguish the two.
    pub t_of_named_beyond: f64,
    /// Whether the rival belongs to the class of indistinguishable effects.
    pub in_class: bool,
    /// Measurement that would distinguish the two.
    pub decides: String,
}

/// One effect that was found.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Step {
    /// Name of the effect.
    pub effect: String,
    /// All effects that the data cannot distinguish from it, including itself.
    pub class: Vec<String>,
    /// Meaning of the effect in a few words; empty for an effect without a name.
    pub summary: String,
    /// Channel with the largest contribution of the effect.
    pub channel: String,
    /// Place or condition of the effect.
    #[serde(rename = "where")]
    pub place: String,
    /// Formula of a law that is not in the catalogue, as in the next model, in the unit of the
    /// step's parameter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub law: Option<String>,
    /// p-value, corrected for all effects that were tested.
    pub p_value: f64,
    /// p-value if runs are independent; absent if it was computed otherwise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub p_runs: Option<f64>,
    /// p-value if sessions are independent and the runs of a session may share a fault; absent with
    /// a single session.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub p_sessions: Option<f64>,
    /// Fitted parameters of the effect.
    pub parameters: Vec<Fitted>,
    /// Root mean square of the channel's residual without the effect.
    pub gap_before: f64,
    /// Root mean square of the channel's residual with the effect.
    pub gap_after: f64,
    /// Unit of both root mean squares.
    pub unit: String,
    /// Fraction of the explainable misfit that all steps of the channel explain on the held-out
    /// runs, or on the fitted runs where there are too few to hold any out.
    pub explainable_gap_closed: Interval,
    /// The rivals, best first.
    pub rivals: Vec<Rival>,
    /// Places at which runs hit a wall, with the force of each run.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub contacts: Vec<ContactPlace>,
    /// Forces over all of these contacts; absent without any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact_forces: Option<ContactForces>,
    /// Evidence of each kind of data of a campaign alone.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub evidence: Vec<OfKind>,
}

impl Step {
    /// Force, number and places of the contacts with walls, in words; `None` without contacts.
    pub fn contacts_in_words(&self) -> Option<String> {
        /// Largest number of places that are named.
        const MAX_NAMED: usize = 5;
        let forces = self.contact_forces.as_ref()?;
        let mut places: Vec<&ContactPlace> = self.contacts.iter().collect();
        places.sort_by_key(|place| std::cmp::Reverse(place.hit));
        let named = places.iter().take(MAX_NAMED);
        let mut named: Vec<String> = named.map(|place| place.in_words()).collect();
        if places.len() > MAX_NAMED {
            named.push(format!("{} more", places.len() - MAX_NAMED));
        }
        Some(format!(
            "{} in {} of {} runs, at {}",
            forces.in_words(),
            forces.hit,
            forces.runs,
            named.join(", ")
        ))
    }
}

/// Evidence of one kind of data of a campaign.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct OfKind {
    /// Kind of data.
    pub data: String,
    /// Parameters fitted to this kind of data.
    pub parameters: Vec<Fitted>,
    /// Whether they agree with those of the other kinds. The step's parameters are then fitted to
    /// all kinds together.
    pub agrees: bool,
    /// Root mean square residual of this kind's held-out data before any effect was added.
    pub gap_before: f64,
    /// Root mean square residual of this kind's held-out data with the next model.
    pub gap_after: f64,
    /// Unit of both root mean squares.
    pub unit: String,
}

/// A place at which runs meet a wall, or miss it.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ContactPlace {
    /// Track.
    pub track: String,
    /// Mean start of the contact over the runs that hit \[m\].
    pub from_m: f64,
    /// Mean end of the contact over the runs that hit \[m\].
    pub to_m: f64,
    /// Mean force of the runs that hit, positive to the left \[N\].
    pub force_n: f64,
    /// Standard deviation of the force between runs \[N\].
    pub spread_n: f64,
    /// Number of runs on the track.
    pub runs: usize,
    /// Number of runs that hit.
    pub hit: usize,
    /// Contacts by driver.
    pub drivers: Vec<DriverContacts>,
    /// The runs that hit, the held-out ones last.
    pub contacts: Vec<RunContact>,
}

impl ContactPlace {
    /// Track, place and number of runs that hit.
    fn in_words(&self) -> String {
        let [from, to, hit] = [self.from_m.round(), self.to_m.round(), self.hit as f64];
        let plural = if self.hit == 1 { "" } else { "s" };
        format!("{} {from}-{to} m ({hit} run{plural})", self.track)
            .trim_start()
            .to_owned()
    }
}

/// Number and magnitude of the forces of contacts with walls.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ContactForces {
    /// Number of contacts.
    pub contacts: usize,
    /// Number of runs that hit at least once.
    pub hit: usize,
    /// Number of runs on the tracks with these contacts.
    pub runs: usize,
    /// Median of the peak forces \[N\].
    pub median_n: f64,
    /// Smallest peak force \[N\].
    pub min_n: f64,
    /// Largest peak force \[N\].
    pub max_n: f64,
}

impl ContactForces {
    /// The forces of all contacts at these places; `None` without contacts.
    pub fn of(places: &[ContactPlace]) -> Option<Self> {
        let contacts = places.iter().flat_map(|place| &place.contacts);
        let hit: BTreeSet<&str> = contacts.clone().map(|one| one.run.as_str()).collect();
        let tracks = places
            .iter()
            .map(|place| (place.track.as_str(), place.runs));
        let tracks: BTreeMap<&str, usize> = tracks.collect();
        let mut forces: Vec<f64> = contacts.map(|one| one.force_n.abs()).collect();
        forces.sort_by(f64::total_cmp);
        let (half, last) = (forces.len() / 2, forces.len().checked_sub(1)?);
        Some(Self {
            contacts: forces.len(),
            hit: hit.len(),
            runs: tracks.values().sum(),
            median_n: 0.5 * (forces[half] + forces[last - half]),
            min_n: forces[0],
            max_n: forces[last],
        })
    }

    /// Median and range.
    fn in_words(&self) -> String {
        let Self {
            contacts,
            median_n,
            min_n,
            max_n,
            ..
        } = self;
        if *contacts == 1 {
            return format!("{median_n:.0} N");
        }
        format!("{median_n:.0} N (median of {contacts} contacts, {min_n:.0} to {max_n:.0} N)")
    }
}

/// Contacts of one driver at a place.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct DriverContacts {
    /// Driver.
    pub driver: String,
    /// Number of the driver's runs on the track.
    pub runs: usize,
    /// Number of runs that hit.
    pub hit: usize,
    /// Mean force of the runs that hit \[N\].
    pub force_n: f64,
}

/// The contact of one run at a place.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RunContact {
    /// Run.
    pub run: String,
    /// Driver.
    pub driver: String,
    /// Start of the contact \[m\].
    pub from_m: f64,
    /// End of the contact \[m\].
    pub to_m: f64,
    /// Peak of the force, from the balance of lateral forces \[N\].
    pub force_n: f64,
    /// Standard error of the peak \[N\].
    pub error_n: f64,
}

/// Root mean square residuals of the data that were held out.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct HeldOut {
    /// Kind of the held-out items: `run`, `segment`, `row` or `measurement`.
    pub what: String,
    /// Names of the held-out items.
    pub runs: Vec<String>,
    /// Root mean square residual before any effect was added.
    pub gap_before: f64,
    /// Root mean square residual after the last step.
    pub gap_after: f64,
    /// Unit of both root mean squares.
    pub unit: String,
    /// Residuals by channel.
    pub channels: Vec<ChannelGap>,
}

impl HeldOut {
    /// Number and kind of the held-out items.
    pub fn in_words(&self) -> String {
        match self.runs.len() {
            1 => format!("one held-out {}", self.what),
            count => format!("{count} held-out {}s", self.what),
        }
    }
}

/// Root mean square residual of one channel.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct ChannelGap {
    /// Channel.
    pub channel: String,
    /// Unit.
    pub unit: String,
    /// Root mean square before any effect was added.
    pub before: f64,
    /// Root mean square after the last step.
    pub after: f64,
    /// Root mean square that the stated or estimated sensor noise alone would cause.
    pub noise: f64,
}

/// Residual misfit of a model that repeats from run to run, in one channel.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Remaining {
    /// Channel.
    pub channel: String,
    /// Unit of the channel.
    pub unit: String,
    /// Root mean square of the repeatable residual.
    pub repeatable: f64,
    /// Ratio of the repeatable mean square to that with only friction and grip refitted.
    pub share: Interval,
    /// Ratio of the repeatable mean square to the total mean square of the channel. The rest is
    /// sensor noise and differences between runs.
    pub of_misfit: Interval,
    /// Whether this ratio is small enough for the model to be adequate.
    pub is_small: bool,
    /// Places with most of the repeatable residual.
    #[serde(rename = "where")]
    pub places: Vec<String>,
}

impl Remaining {
    /// Share of the repeatable mean square that the effects explain; `None` if its interval is 0 to
    /// 1, which states nothing.
    pub fn explained(&self) -> Option<Interval> {
        let Interval { value, low, high } = self.share;
        (high < 1.0 || low > 0.0).then_some(Interval {
            value: 1.0 - value,
            low: 1.0 - high,
            high: 1.0 - low,
        })
    }
}

/// A model that may be written to `model.next.toml`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ModelKind {
    /// The model with the effects of the report's steps.
    WithEffect,
    /// The given model with friction and grip refitted.
    Refitted,
    /// The model as given.
    #[default]
    AsGiven,
}

/// Root mean square of one quantity over the held-out runs, for each model.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Baseline {
    /// A force channel, or a column of the replay (`replay v_mps`).
    pub quantity: String,
    /// Unit.
    pub unit: String,
    /// Root mean square of the model as given.
    pub as_given: f64,
    /// With friction and grip refitted; absent where that model cannot be simulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refitted: Option<f64>,
    /// With the effects that were found; absent without any, or where it cannot be simulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub with_effect: Option<f64>,
}

/// A model that was fitted but is not written.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Withheld {
    /// Kind of the model.
    pub model: ModelKind,
    /// Effects of the model that the given model does not have.
    pub effects: Vec<String>,
    /// Reason why it is not written.
    pub reason: String,
}

/// Smallest detectable size of an effect.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Detectable {
    /// Effect.
    pub effect: String,
    /// Parameter.
    pub parameter: String,
    /// Smallest size that would be found with a probability of 90 %.
    pub size: f64,
    /// Unit.
    pub unit: String,
    /// Fraction of the effect that remains after a refit of the base parameters.
    pub left_after_refit: f64,
    /// The most similar candidate.
    pub most_like: String,
    /// Partial correlation with the most similar candidate, given the base parameters.
    pub correlation: f64,
}

/// A bin in which the residual is significant.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Bin {
    /// Channel.
    pub channel: String,
    /// Column.
    pub column: String,
    /// Lower end of the bin, in the column's unit.
    pub from: f64,
    /// Upper end of the bin.
    pub to: f64,
    /// Mean residual in the bin.
    pub mean: f64,
    /// Standard error of the mean, from the scatter over runs.
    pub error: f64,
    /// Unit of mean and error.
    pub unit: String,
    /// p-value, corrected for all bins.
    pub p_value: f64,
}

/// The means of one channel's residual, run by run.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ByRun {
    /// Channel.
    pub channel: String,
    /// Unit of the means.
    pub unit: String,
    /// p-value of the difference between sessions before any effect was added; 1 where it is
    /// unknown.
    pub sessions_differ_before: f64,
    /// p-value of the difference between sessions after the last step; 1 if it is unknown.
    pub sessions_differ_after: f64,
    /// Runs, session by session.
    pub runs: Vec<RunMean>,
}

/// A run's mean residual.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RunMean {
    /// Run.
    pub run: String,
    /// Its session.
    pub session: String,
    /// Its track.
    pub track: String,
    /// Mean before any effect was added.
    pub before: f64,
    /// Mean after the last step.
    pub after: f64,
}

/// The whole report.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
#[schemars(title = "report.json")]
pub struct Report {
    /// The outcome.
    pub verdict: Verdict,
    /// The outcome in a sentence.
    pub sentence: String,
    /// Fraction of the repeatable misfit that is explained, and the remaining misfit with its
    /// places; empty if the data are not runs.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub explained: String,
    /// Whether the remaining repeatable misfit is a small fraction in every channel.
    pub adequate: bool,
    /// Remaining repeatable misfit by channel; empty if the data are not runs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub remaining: Vec<Remaining>,
    /// Installation errors within their tolerances, which are accounted for and are no findings.
    pub within_tolerance: Vec<Tolerated>,
    /// Significant zero offsets of sensors by session, which are accounted for and are no findings.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub session_offsets: Vec<SessionOffset>,
    /// The effects that were found, in the order of the search.
    pub steps: Vec<Step>,
    /// Residuals of the held-out data.
    pub held_out: HeldOut,
    /// The model that is written to `model.next.toml`.
    pub written: ModelKind,
    /// Comparison of models on the same held-out runs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub baselines: Vec<Baseline>,
    /// Models that are not written, with the reason.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub withheld: Vec<Withheld>,
    /// Base parameters whose refitted values are outside their plausible range.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub implausible: Vec<Fitted>,
    /// Smallest detectable sizes of effects.
    pub minimum_detectable: Vec<Detectable>,
    /// Recommended next measurement.
    pub next_experiment: String,
    /// Next runs that would distinguish the members of a class according to simulations, the best
    /// first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub next_runs: Vec<NextRuns>,
    /// Base parameters of the next model with intervals for their true values. The intervals
    /// include the uncertainty due to installation errors, and the shift by the estimated
    /// installation errors, which a model file does not state.
    pub base: Vec<Fitted>,
    /// Significant bins before any effect was added.
    pub bins: Vec<Bin>,
    /// Significant bins after the last step.
    pub bins_after: Vec<Bin>,
    /// Mean residuals by run and session; empty if the data are not runs.
    pub by_run: Vec<ByRun>,
    /// Whether the residual has no significant structure after the last step.
    pub clean: bool,
    /// Pictures of the report's page.
    #[serde(skip)]
    pub pictures: Vec<Picture>,
    /// Root mean square residuals of the training data by channel.
    pub training: Vec<ChannelGap>,
    /// Effects that could not be tested, with the reason.
    pub untestable: Vec<(String, String)>,
    /// Remarks.
    pub remarks: Vec<String>,
    /// Runs with gaps: missing values, and the fraction of samples used; absent without gaps.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gaps: Vec<kufe_sled::SampleCoverage>,
    /// Kind of data.
    pub data: String,
    /// Seed.
    pub seed: u64,
    /// Version of the program.
    pub version: String,
}

/// Runs that could be driven next, with the evidence expected of them.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct NextRuns {
    /// Number of runs in one session.
    pub runs: usize,
    /// Track.
    pub track: String,
    /// Difference from the present runs.
    pub change: String,
    /// Speed at the start \[m/s\].
    pub start_speed_mps: f64,
    /// Mass of the sled with its crew \[kg\].
    pub mass_kg: f64,
    /// Ice temperature \[deg C\].
    pub ice_c: f64,
    /// Air temperature \[deg C\].
    pub air_c: f64,
    /// Air pressure \[Pa\].
    pub air_pa: f64,
    /// Relative humidity \[%\], if it is known.
    pub humidity_pct: Option<f64>,
    /// Noise of the sensors, if a better sensor is proposed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise: Option<kufe_sled::Noise>,
    /// The two members of the class that these runs distinguish least.
    pub between: [String; 2],
    /// Expected log-likelihood ratio of these two.
    pub expected_evidence: f64,
    /// Whether the runs would distinguish the two with a probability of 90 %.
    pub splits: bool,
}

/// A picture for the page.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Title.
    pub title: String,
    /// Meaning of the marks; empty if the legend states it.
    pub caption: String,
    /// Contents.
    pub plot: Plot,
}

/// The contents of a picture.
#[derive(Clone, Debug, PartialEq)]
pub enum Plot {
    /// Points as a function of one column.
    Scatter(Scatter),
    /// Residuals along a track, run by run, before and after the effects are added.
    Strip(Strip),
    /// Measured and simulated peak pressures of measurements without a map.
    Peaks(Vec<Peak>),
    /// Measured and simulated pressure maps.
    Maps(Maps),
}

/// Points as a function of one column.
#[derive(Clone, Debug, PartialEq)]
pub struct Scatter {
    /// Alternative text.
    pub label: String,
    /// Column of `x`; its suffix is the unit.
    pub x_name: String,
    /// Quantity and unit of the points.
    pub y_name: String,
    /// Abscissae, common to all series.
    pub x: Vec<f64>,
    /// Sets of points.
    pub series: Vec<Series>,
    /// A curve through the points; `None` draws a line at 0.
    pub curve: Option<Curve>,
}

/// Residuals along a track, run by run, before and after the effects are added.
#[derive(Clone, Debug, PartialEq)]
pub struct Strip {
    /// Channel.
    pub channel: String,
    /// Unit of the channel.
    pub unit: String,
    /// Track.
    pub track: String,
    /// Start of the first stretch [m].
    pub from_m: f64,
    /// Length of a stretch [m].
    pub step_m: f64,
    /// Places of the effects that were found.
    pub places: Vec<Place>,
    /// The runs.
    pub runs: Vec<StripRun>,
    /// Model discrepancy of each stretch after the last step, common to all runs; may be empty.
    pub discrepancy: Vec<f64>,
}

/// Measured and simulated pressure maps on the pixels of the former, row by row from the lower
/// left.
#[derive(Clone, Debug, PartialEq)]
pub struct Maps {
    /// Measured map.
    pub measured: Map,
    /// Simulation before any effect was added [Pa].
    pub before: Vec<f64>,
    /// Simulation after the last step [Pa]; empty if no effect was added.
    pub after: Vec<f64>,
}

/// The largest pressure of one measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Peak {
    /// Row, with force and radius.
    pub name: String,
    /// Whether the measurement was held out of the search.
    pub not_seen: bool,
    /// Measured pressure [Pa].
    pub measured: f64,
    /// Standard deviation of the measured pressure [Pa].
    pub sd: f64,
    /// Simulation before any effect was added [Pa].
    pub before: f64,
    /// Simulation after the last step [Pa]; `None` if no effect was added.
    pub after: Option<f64>,
}

/// A stretch of a track on which an effect acts.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// The effect.
    pub effect: String,
    /// Start of the stretch [m].
    pub from: f64,
    /// End of the stretch [m].
    pub to: f64,
}

/// One run along its track.
#[derive(Clone, Debug, PartialEq)]
pub struct StripRun {
    /// Run.
    pub run: String,
    /// Its session.
    pub session: String,
    /// Mean residual of each stretch before any effect was added; NaN where the run has no samples.
    pub before: Vec<f64>,
    /// Mean residual of each stretch after the last step.
    pub after: Vec<f64>,
}

/// One set of points.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Name.
    pub name: String,
    /// Values.
    pub y: Vec<f64>,
    /// Standard deviations of the values; empty if they are not drawn.
    pub sd: Vec<f64>,
}

/// A curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Name.
    pub name: String,
    /// Abscissae.
    pub x: Vec<f64>,
    /// Ordinates.
    pub y: Vec<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(track: &str, from_m: f64, forces: &[(&str, f64)]) -> ContactPlace {
        let contact = |(run, force_n): &(&str, f64)| RunContact {
            run: (*run).to_owned(),
            driver: String::new(),
            from_m,
            to_m: from_m + 10.0,
            force_n: *force_n,
            error_n: 10.0,
        };
        ContactPlace {
            track: track.to_owned(),
            from_m,
            to_m: from_m + 10.2,
            force_n: 0.0,
            spread_n: 0.0,
            runs: 4,
            hit: forces.len(),
            drivers: Vec::new(),
            contacts: forces.iter().map(contact).collect(),
        }
    }

    #[test]
    fn contacts_state_force_place_and_share_of_the_runs() {
        let mut step = Step {
            contacts: vec![
                place("east", 20.0, &[("a", -900.0)]),
                place("east", 60.0, &[("a", 500.0), ("b", 700.0)]),
                place("west", 10.0, &[("c", 400.0)]),
            ],
            ..Step::default()
        };
        assert_eq!(step.contacts_in_words(), None);
        step.contact_forces = ContactForces::of(&step.contacts);
        assert_eq!(
            step.contacts_in_words().unwrap(),
            "600 N (median of 4 contacts, 400 to 900 N) in 3 of 8 runs, at east 60-70 m (2 runs), east 20-30 m (1 run), west 10-20 m (1 run)"
        );
        assert_eq!(ContactForces::of(&[place("east", 20.0, &[])]), None);
    }

    #[test]
    fn offsets_of_a_sensor_are_one_line() {
        let offset = |sensor: &str, session: &str, value: f64| SessionOffset {
            sensor: sensor.to_owned(),
            session: session.to_owned(),
            value,
            error: 6.25e-5,
            unit: "rad".to_owned(),
            tolerance: 1e-3,
        };
        let offsets = [
            offset("delta_rad", "d1", 3e-4),
            offset("alpha_rad", "d1", -2e-3),
            offset("alpha_rad", "d2", 1.25e-3),
        ];
        let lines = SessionOffset::by_sensor(&offsets);
        let lines: Vec<String> = lines
            .iter()
            .map(|one| SessionOffset::in_words(one))
            .collect();
        assert_eq!(
            lines,
            [
                "zero offset of alpha_rad: -2.00 to 1.25 mrad in 2 sessions, standard error 0.06 mrad",
                "zero offset of delta_rad: 300.00 µrad in session d1, standard error 62.50 µrad"
            ]
        );
    }
}
