//! Documents of friction: over speed and temperature, the optimum, and fits to experiments.

use kufe_sled::friction::{
    Estimate, Experiment, GlidePair, IceHouse, LeastFriction, MuFit, PressureLaw, SHARE_LEFT_OUT,
    SpecimenFriction, Weighting, ZetaActsOn,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::results::contact::Friction;
use crate::results::quantity::*;
use crate::results::record::CaseRecord;

/// Friction of one runner at one speed and temperature.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FrictionRow {
    /// The runner.
    pub case: String,
    /// Temperature of the ice [C].
    pub ice_c: f64,
    /// Speed [m/s].
    pub v_mps: f64,
    /// Coefficient of friction with its parts.
    #[serde(flatten)]
    pub friction: Friction,
    /// Depth of the groove.
    #[serde(flatten)]
    pub groove_depth: Measured<GrooveDepth>,
    /// Mean thickness of the film [m].
    pub film_mean_m: f64,
    /// Hardness: pressure at which the ice yields [Pa].
    pub hardness_pa: f64,
}

/// Runners that have the least friction at one speed and temperature, within their errors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FastestRunners {
    /// Speed [m/s].
    pub v_mps: f64,
    /// Temperature of the ice [C].
    pub ice_c: f64,
    /// The runners.
    pub cases: Vec<String>,
}

/// Friction over speed and temperature.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FrictionTable {
    /// The points of all runners.
    pub points: Vec<FrictionRow>,
    /// Version of kufe.
    pub version: String,
    /// The cases.
    pub cases: Vec<CaseRecord>,
    /// The fastest of several runners.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub fastest: Vec<FastestRunners>,
}

/// The runner with the least friction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FrictionOptimum {
    /// Speed [m/s].
    pub v_mps: f64,
    /// Temperature of the ice [C].
    pub ice_c: f64,
    /// The varied parameters.
    pub parameters: Vec<OptimalParameter>,
    /// Coefficient of friction.
    #[serde(flatten)]
    pub mu: Measured<Mu>,
    /// Part of the coefficient due to ploughing.
    pub mu_ploughing: f64,
    /// Part of the coefficient due to the melt film.
    pub mu_viscous: f64,
    /// Part of the coefficient due to boundary contact.
    pub mu_boundary: f64,
    /// Relative root mean square residual of the fitted response at the solved runners.
    pub response_scatter: f64,
    /// Relative difference of the response to the solved coefficient at the optimum.
    pub response_miss: f64,
    /// The runners that were solved.
    pub solved: Vec<SolvedRunner>,
    /// Version of kufe.
    pub version: String,
    /// The case.
    pub case: CaseRecord,
}

/// A parameter at the optimum.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OptimalParameter {
    /// Key of the parameter.
    pub key: String,
    /// Value at the optimum.
    pub value: f64,
    /// Lower bound of the search.
    pub low: f64,
    /// Upper bound of the search.
    pub high: f64,
    /// Whether the value lies on a bound.
    pub on_bound: bool,
    /// Lower end of the values whose friction equals the optimum within the errors.
    pub flat_from: f64,
    /// Upper end of the values whose friction equals the optimum within the errors.
    pub flat_to: f64,
}

/// A runner that was solved for a search.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SolvedRunner {
    /// Values of the parameters.
    pub values: Vec<f64>,
    /// Coefficient of friction.
    #[serde(flatten)]
    pub mu: Measured<Mu>,
}

/// Friction of one runner under one load by a pressure-dependent law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FrictionByLaw {
    /// Peak pressure.
    #[serde(flatten)]
    pub p_max: Measured<PeakPressure>,
    /// Normal force [N].
    pub fz_n: f64,
    /// Coefficient of friction.
    pub mu: f64,
    /// Coefficient before the effects.
    pub mu_base: f64,
    /// Error of the coefficient due to the error of the pressure.
    pub mu_error: f64,
    /// Whether the law depends on the pressure.
    pub depends_on_pressure: bool,
    /// Whether the coefficient is capped at the largest value of the law.
    pub capped: bool,
    /// Slip angle [rad].
    pub alpha_rad: f64,
    /// Force along the runner [N].
    pub fx_n: f64,
    /// Speed [m/s].
    pub v_mps: f64,
    /// Power [W].
    pub power_w: f64,
    /// Effects of the model that were applied.
    pub effects: Vec<String>,
    /// Effects of the model on other quantities.
    pub effects_not_concerned: Vec<String>,
    /// Wall time [s].
    pub seconds: f64,
    /// Version of kufe.
    pub version: String,
}

/// A fit of the coefficient of friction as a function of pressure.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PressureFit {
    /// The coefficients with their intervals.
    pub parameters: QuadraticLaw,
    /// The law in words.
    pub unit: &'static str,
    /// Covariance of b, c and d.
    pub covariance_bcd: [[f64; 3]; 3],
    /// How the points were weighted.
    pub weighting: Weighting,
    /// Confidence level of the intervals.
    pub confidence: f64,
    /// Weighted sum of squares.
    pub chi2: f64,
    /// Number of points less number of parameters.
    pub degrees_of_freedom: usize,
    /// Probability of a larger sum of squares.
    pub p_value: Option<f64>,
    /// Pressure and coefficient at the minimum of the law.
    pub least_friction: Option<LeastFriction>,
    /// Largest coefficient of the law.
    pub mu_cap: f64,
    /// Asperity factor.
    pub zeta: f64,
    /// Whether the asperity factor multiplies the pressure or the coefficient.
    pub zeta_acts_on: ZetaActsOn,
    /// The specimens and the fitted coefficient.
    pub specimens: Vec<FittedSpecimen>,
    /// Version of kufe.
    pub version: &'static str,
}

/// Coefficients of a quadratic law with their intervals.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct QuadraticLaw {
    /// Quadratic coefficient.
    pub b: Estimate,
    /// Linear coefficient.
    pub c: Estimate,
    /// Constant.
    pub d: Estimate,
}

/// A specimen and the fitted coefficient with its band.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FittedSpecimen {
    /// The specimen.
    pub specimen: String,
    /// Measured coefficient.
    pub mu: f64,
    /// Fitted coefficient.
    pub fitted: f64,
    /// Lower end of the band.
    pub low: f64,
    /// Upper end of the band.
    pub high: f64,
}

impl PressureFit {
    /// The document of a fit.
    pub fn new(
        fit: &MuFit,
        law: &PressureLaw,
        experiments: &[Experiment],
        confidence: f64,
    ) -> Self {
        let interval = |value: f64, k: usize| {
            let half = fit.quantile * fit.covariance[(k, k)].sqrt();
            Estimate {
                value,
                low: value - half,
                high: value + half,
            }
        };
        let specimens = experiments.iter().map(|experiment| {
            let fitted = fit.band(experiment.p_max_pa);
            FittedSpecimen {
                specimen: experiment.specimen.clone(),
                mu: experiment.mu,
                fitted: fitted.value,
                low: fitted.low,
                high: fitted.high,
            }
        });
        PressureFit {
            parameters: QuadraticLaw {
                b: interval(fit.b, 0),
                c: interval(fit.c, 1),
                d: interval(fit.d, 2),
            },
            unit: "mu in 1e-3, p in MPa: mu = b p^2 - c p + d",
            covariance_bcd: [0, 1, 2].map(|i| [0, 1, 2].map(|j| fit.covariance[(i, j)])),
            weighting: fit.weighting,
            confidence,
            chi2: fit.chi2,
            degrees_of_freedom: fit.freedom,
            p_value: fit.p_value,
            least_friction: fit.least_friction(),
            mu_cap: law.mu_cap,
            zeta: law.zeta,
            zeta_acts_on: law.zeta_acts_on,
            specimens: specimens.collect(),
            version: env!("CARGO_PKG_VERSION"),
        }
    }
}

/// Gliding runs in an ice house.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct IceHouseResult {
    /// Friction by specimen.
    pub specimens: Vec<SpecimenFriction>,
    /// Slope of the rink [rad].
    pub slope_rad: Estimate,
    /// Direction that climbs where the slope is positive.
    pub uphill: String,
    /// Pairs of runs.
    pub pairs: Vec<GlidePair>,
    /// Runs without a partner.
    pub unpaired: Vec<String>,
    /// Which part of a run is used.
    pub section_rule: String,
    /// The runs.
    pub runs: Vec<GlideResult>,
    /// Version of kufe.
    pub version: &'static str,
}

/// One gliding run.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct GlideResult {
    /// The run.
    pub run: String,
    /// Its specimen.
    pub specimen: String,
    /// Its direction.
    pub direction: String,
    /// Resistance [N].
    pub resistance_n: f64,
    /// Standard error of the resistance [N].
    pub resistance_se_n: f64,
    /// Ratio of resistance to weight.
    pub resistance_over_weight: f64,
    /// Start of the used section [m].
    pub section_from_m: f64,
    /// End of the used section [m].
    pub section_to_m: f64,
    /// Number of samples in the section.
    pub samples: usize,
    /// Mean speed [m/s].
    pub v_mean_mps: f64,
    /// Density of the air [kg/m3].
    pub air_density_kgpm3: f64,
    /// Root mean square residual of the energy [J].
    pub residual_rms_j: f64,
    /// Picture of the run.
    pub picture: String,
}

impl IceHouseResult {
    /// The document of an evaluation; `picture` names the picture of a run.
    pub fn new(house: &IceHouse, picture: impl Fn(usize, &str) -> String) -> Self {
        let runs = house.runs.iter().enumerate().map(|(i, run)| GlideResult {
            run: run.entry.run.clone(),
            specimen: run.entry.specimen.clone(),
            direction: run.entry.direction.clone(),
            resistance_n: -run.line.slope,
            resistance_se_n: run.line.slope_se,
            resistance_over_weight: run.resistance(),
            section_from_m: run.s[run.section.start],
            section_to_m: run.s[run.section.end - 1],
            samples: run.section.len(),
            v_mean_mps: run.v_mean,
            air_density_kgpm3: run.air_density,
            residual_rms_j: run.line.residual_rms,
            picture: picture(i, &run.entry.run),
        });
        IceHouseResult {
            specimens: house.specimens.clone(),
            slope_rad: house.slope_rad,
            uphill: house.directions[0].clone(),
            pairs: house.pairs.clone(),
            unpaired: house.unpaired.clone(),
            section_rule: format!(
                "from the greatest speed on, the central {:.0} % of the distance glided",
                100.0 - 200.0 * SHARE_LEFT_OUT
            ),
            runs: runs.collect(),
            version: env!("CARGO_PKG_VERSION"),
        }
    }
}
