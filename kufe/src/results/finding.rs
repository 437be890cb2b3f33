//! `report.json`: what a search for missing effects has found, with the pictures of its page.
//!
//! [`Report`] is the whole document; [`Picture`]s are on the page alone.

use schemars::JsonSchema;
use serde::Serialize;

/// A value with its 95 % interval.
pub use kufe_sled::friction::Estimate as Interval;

use crate::case::effects::Map;

/// The outcome in one word.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// One effect, distinguished from all others.
    Named,
    /// One of a class that these data cannot split.
    OneOf,
    /// A law outside the catalogue, written as a formula.
    Law,
    /// The conclusion changes with the stated survey deviation.
    DependsOn,
    /// A place or a bin, no name.
    Located,
    /// A misfit that repeats from run to run, without a name or a significant bin.
    Inadequate,
    /// Nothing is significant.
    #[default]
    None,
    /// Something differs, but these data cannot say what.
    NotIdentifiable,
}

/// A fitted parameter.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Fitted {
    /// Key, as in `[effects.NAME]`.
    pub name: String,
    /// Value.
    pub value: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Unit.
    pub unit: String,
}

/// An error of the installation within its tolerance.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Tolerated {
    /// What it is, such as the delay of a channel.
    pub what: String,
    /// By how much.
    pub size: f64,
    /// Its unit.
    pub unit: String,
}

/// A rival and why it is in the class or not.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Rival {
    /// Name of the effect.
    pub effect: String,
    /// Parameter.
    pub parameter: String,
    /// Size that would fit, in its unit.
    pub size: f64,
    /// Unit.
    pub unit: String,
    /// T of the rival alone.
    pub t: f64,
    /// What it explains, in units of the noise's variance.
    pub gain: f64,
    /// Partial correlation with the named effect, given the base.
    pub correlation: f64,
    /// T of the named effect once the rival has taken its part; small: the data cannot tell them
    /// apart.
    pub t_of_named_beyond: f64,
    /// Whether it is in the class.
    pub in_class: bool,
    /// What would decide.
    pub decides: String,
}

/// One effect found.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Step {
    /// Name.
    pub effect: String,
    /// Every effect that the data cannot tell from it, itself included.
    pub class: Vec<String>,
    /// What it means, in a few words; empty for what has no name.
    pub summary: String,
    /// Channel in which it shows most.
    pub channel: String,
    /// Where.
    #[serde(rename = "where")]
    pub place: String,
    /// Outside the catalogue: the formula as the next model has it, whose unit is that of the
    /// step's parameter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub law: Option<String>,
    /// p-value over all effects that were tested.
    pub p_value: f64,
    /// The same where runs are independent of one another; absent where it was judged otherwise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub p_runs: Option<f64>,
    /// The same where sessions are independent and the runs of one may share a fault; absent with a
    /// single session.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub p_sessions: Option<f64>,
    /// Parameters.
    pub parameters: Vec<Fitted>,
    /// Root mean square of the channel's residual before.
    pub gap_before: f64,
    /// After.
    pub gap_after: f64,
    /// Unit of the two.
    pub unit: String,
    /// Share of the explainable misfit that is explained on the held-out runs, by all steps of the
    /// channel; on the fitted ones where there are too few to hold any out.
    pub explainable_gap_closed: Interval,
    /// The rivals, best first.
    pub rivals: Vec<Rival>,
    /// Where runs meet a wall, each with a force of its own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub contacts: Vec<ContactPlace>,
    /// Evidence of each kind of data of a campaign by itself.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub evidence: Vec<OfKind>,
}

/// Evidence of one kind of data of a campaign.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct OfKind {
    /// Kind of data.
    pub data: String,
    /// Sizes.
    pub parameters: Vec<Fitted>,
    /// Whether it agrees with the other kinds: the step's parameters are then those of all
    /// together.
    pub agrees: bool,
    /// Gap of this kind's held-out data before.
    pub gap_before: f64,
    /// With the next model.
    pub gap_after: f64,
    /// Unit of the two.
    pub unit: String,
}

/// A place at which runs meet a wall, or miss it.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ContactPlace {
    /// Track.
    pub track: String,
    /// Mean stretch of the runs that hit, from \[m\].
    pub from_m: f64,
    /// To \[m\].
    pub to_m: f64,
    /// Mean force of the runs that hit, positive to the left \[N\].
    pub force_n: f64,
    /// Its standard deviation from run to run \[N\].
    pub spread_n: f64,
    /// Number of runs on the track.
    pub runs: usize,
    /// Number of those that hit.
    pub hit: usize,
    /// The same by driver.
    pub drivers: Vec<DriverContacts>,
    /// The runs that hit, the held-out ones last.
    pub contacts: Vec<RunContact>,
}

/// How a driver meets a place.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct DriverContacts {
    /// Driver.
    pub driver: String,
    /// Runs on the track.
    pub runs: usize,
    /// Those that hit.
    pub hit: usize,
    /// Mean force of those \[N\].
    pub force_n: f64,
}

/// The contact of one run at a place.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RunContact {
    /// Run.
    pub run: String,
    /// Driver.
    pub driver: String,
    /// From \[m\].
    pub from_m: f64,
    /// To \[m\].
    pub to_m: f64,
    /// Peak of the force, set by the side balance \[N\].
    pub force_n: f64,
    /// Its standard error \[N\].
    pub error_n: f64,
}

/// The gap on runs that were held out.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct HeldOut {
    /// What one of them is: `run`, `segment`, `row` or `measurement`.
    pub what: String,
    /// Their names.
    pub runs: Vec<String>,
    /// Root mean square before.
    pub gap_before: f64,
    /// After.
    pub gap_after: f64,
    /// Unit.
    pub unit: String,
    /// By channel: name, unit, before, after.
    pub channels: Vec<ChannelGap>,
}

/// The gap of one channel.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct ChannelGap {
    /// Channel.
    pub channel: String,
    /// Unit.
    pub unit: String,
    /// Root mean square before.
    pub before: f64,
    /// After.
    pub after: f64,
    /// What the stated or estimated sensor noise alone would give.
    pub noise: f64,
}

/// Residual misfit of a model that repeats from run to run, in one channel.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Remaining {
    /// Channel.
    pub channel: String,
    /// Its unit.
    pub unit: String,
    /// Root mean square of what repeats.
    pub repeatable: f64,
    /// Its share of what repeats with friction and grip refitted alone, as mean squares.
    pub share: Interval,
    /// Its share of the whole mean square of the channel; the sensors' noise and what differs from
    /// run to run are the rest.
    pub of_misfit: Interval,
    /// Whether that share is small enough for the model to be adequate.
    pub is_small: bool,
    /// Where most of it is.
    #[serde(rename = "where")]
    pub places: Vec<String>,
}

/// A model that may be written to `model.next.toml`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ModelKind {
    /// With the effects of the report's steps.
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
    /// Of the model as given.
    pub as_given: f64,
    /// With friction and grip refitted; absent where that model cannot be simulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refitted: Option<f64>,
    /// With the effects that were found; absent where none was, or where it cannot be simulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub with_effect: Option<f64>,
}

/// A model that was fitted but is not written.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Withheld {
    /// Which one.
    pub model: ModelKind,
    /// The effects that it has and the model as given has not.
    pub effects: Vec<String>,
    /// Why it is not written.
    pub reason: String,
}

/// Smallest sizes of effects that would have been found.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Detectable {
    /// Effect.
    pub effect: String,
    /// Parameter.
    pub parameter: String,
    /// Smallest size that would be found nine times in ten.
    pub size: f64,
    /// Unit.
    pub unit: String,
    /// Share of the effect that a refit of the base leaves.
    pub left_after_refit: f64,
    /// The candidate that resembles it most.
    pub most_like: String,
    /// Partial correlation with it, given the base.
    pub correlation: f64,
}

/// A bin in which the residual is significant.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Bin {
    /// Channel.
    pub channel: String,
    /// Column.
    pub column: String,
    /// From, in the column's unit.
    pub from: f64,
    /// To.
    pub to: f64,
    /// Mean residual there.
    pub mean: f64,
    /// Its standard error over runs.
    pub error: f64,
    /// Unit of the two.
    pub unit: String,
    /// p-value over all bins.
    pub p_value: f64,
}

/// The means of one channel's residual, run by run.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ByRun {
    /// Channel.
    pub channel: String,
    /// Unit of the means.
    pub unit: String,
    /// Probability that sessions differ this much by chance, before any effect was added; 1 where
    /// it is not known.
    pub sessions_differ_before: f64,
    /// The same after.
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
    /// Mean after.
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
    /// What share of the repeatable misfit the answer explains, what remains and where; empty where
    /// the data are no runs.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub explained: String,
    /// Whether nothing that repeats from run to run remains above a small share in any channel.
    pub adequate: bool,
    /// What remains of it by channel; empty where the data are no runs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub remaining: Vec<Remaining>,
    /// What the installation is off by within its tolerances: allowed for, and no finding.
    pub within_tolerance: Vec<Tolerated>,
    /// The effects found, in order.
    pub steps: Vec<Step>,
    /// Locked-away data.
    pub held_out: HeldOut,
    /// The model that is written to `model.next.toml`.
    pub written: ModelKind,
    /// Three models on the same held-out runs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub baselines: Vec<Baseline>,
    /// Models that are not written, and why.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub withheld: Vec<Withheld>,
    /// Base parameters that a refit moves out of their plausible range.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub implausible: Vec<Fitted>,
    /// Smallest sizes of effects that would have been found.
    pub minimum_detectable: Vec<Detectable>,
    /// What to measure next.
    pub next_experiment: String,
    /// The next runs that would split a class, by simulating them, the best first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub next_runs: Vec<NextRuns>,
    /// Base parameters as the next model states them, with intervals for what is true: as wide as
    /// what the installation leaves open of them, and by as much as its errors, which a model file
    /// does not state, have moved them.
    pub base: Vec<Fitted>,
    /// Significant bins before any effect was added.
    pub bins: Vec<Bin>,
    /// Significant bins after.
    pub bins_after: Vec<Bin>,
    /// Mean residuals by run and session; empty where the data are no runs.
    pub by_run: Vec<ByRun>,
    /// Whether the residual is clean after the last step.
    pub clean: bool,
    /// Pictures of the report's page.
    #[serde(skip)]
    pub pictures: Vec<Picture>,
    /// Training gap by channel.
    pub training: Vec<ChannelGap>,
    /// Effects that could not be tested, and why.
    pub untestable: Vec<(String, String)>,
    /// Remarks.
    pub remarks: Vec<String>,
    /// Runs with gaps: what is not there, and how much takes part; absent where there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gaps: Vec<kufe_sled::SampleCoverage>,
    /// Kind of data.
    pub data: String,
    /// Seed.
    pub seed: u64,
    /// Version of the program.
    pub version: String,
}

/// Runs that could be driven next, and what they are expected to tell.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct NextRuns {
    /// How many, in one session.
    pub runs: usize,
    /// Track.
    pub track: String,
    /// Difference from the runs at hand.
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
    /// Relative humidity \[%\], where it is known.
    pub humidity_pct: Option<f64>,
    /// The sensors' noise, where one of them is a better one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise: Option<kufe_sled::Noise>,
    /// The two members of the class that they tell apart least.
    pub between: [String; 2],
    /// Logarithm of the likelihood ratio of these two that is to be expected.
    pub expected_evidence: f64,
    /// Whether that would tell them apart nine times in ten.
    pub splits: bool,
}

/// A picture for the page.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Title.
    pub title: String,
    /// What its marks mean; empty where its key says it.
    pub caption: String,
    /// Contents.
    pub plot: Plot,
}

/// The contents of a picture.
#[derive(Clone, Debug, PartialEq)]
pub enum Plot {
    /// Points over one column.
    Scatter(Scatter),
    /// Residuals along a track, run by run, before and after.
    Strip(Strip),
    /// Largest pressures of measurements without a map, with the simulated ones.
    Peaks(Vec<Peak>),
    /// A measured map and the simulated ones.
    Maps(Maps),
}

/// Points over one column.
#[derive(Clone, Debug, PartialEq)]
pub struct Scatter {
    /// Alternative text.
    pub label: String,
    /// Column of `x`, whose suffix states the unit.
    pub x_name: String,
    /// What the points are, with unit.
    pub y_name: String,
    /// Places along the column.
    pub x: Vec<f64>,
    /// Points at all places.
    pub series: Vec<Series>,
    /// A curve through them; a line at 0 where there is none.
    pub curve: Option<Curve>,
}

/// Residuals along a track, run by run, before and after.
#[derive(Clone, Debug, PartialEq)]
pub struct Strip {
    /// Channel.
    pub channel: String,
    /// Its unit.
    pub unit: String,
    /// Track.
    pub track: String,
    /// Where the first stretch begins [m].
    pub from_m: f64,
    /// Length of a stretch [m].
    pub step_m: f64,
    /// Where effects were found.
    pub places: Vec<Place>,
    /// The runs.
    pub runs: Vec<StripRun>,
    /// Model discrepancy of each stretch, common to all runs, after; empty without one.
    pub discrepancy: Vec<f64>,
}

/// A measured map and the simulated ones on its pixels, row by row from the lower left.
#[derive(Clone, Debug, PartialEq)]
pub struct Maps {
    /// Measured map.
    pub measured: Map,
    /// Simulated before any effect was added [Pa].
    pub before: Vec<f64>,
    /// Simulated after [Pa]; empty where nothing was added.
    pub after: Vec<f64>,
}

/// The largest pressure of one measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Peak {
    /// Row, with force and radius.
    pub name: String,
    /// Whether the search had not seen it.
    pub not_seen: bool,
    /// Measured [Pa].
    pub measured: f64,
    /// Its standard deviation [Pa].
    pub sd: f64,
    /// Simulated before any effect was added [Pa].
    pub before: f64,
    /// Simulated after [Pa]; nothing where nothing was added.
    pub after: Option<f64>,
}

/// Where an effect acts along a track.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// The effect.
    pub effect: String,
    /// From [m].
    pub from: f64,
    /// To [m].
    pub to: f64,
}

/// One run along its track.
#[derive(Clone, Debug, PartialEq)]
pub struct StripRun {
    /// Run.
    pub run: String,
    /// Its session.
    pub session: String,
    /// Mean residual of each stretch before any effect was added; NaN where the run has none.
    pub before: Vec<f64>,
    /// After.
    pub after: Vec<f64>,
}

/// One set of points.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Name.
    pub name: String,
    /// Values.
    pub y: Vec<f64>,
    /// Their standard deviations; empty where they are not drawn.
    pub sd: Vec<f64>,
}

/// A curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Name.
    pub name: String,
    /// Places.
    pub x: Vec<f64>,
    /// Values.
    pub y: Vec<f64>,
}
