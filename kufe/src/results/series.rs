//! `table.json`: the contacts of a series.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::results::contact::{ContactResult, Friction};
use crate::results::quantity::*;

/// One contact of a series.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "row of table.json")]
#[non_exhaustive]
pub struct SeriesRow {
    /// Its number, from 1.
    pub step: usize,
    /// Its folder in the output folder.
    pub folder: String,
    /// The varied keys of the case.
    #[serde(flatten)]
    pub varied: VariedKeys,
    /// The numbers of the contact; absent if it has no solution.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub result: Option<SeriesResult>,
    /// Why there is no solution, or why the requested accuracy was not reached.
    pub error: Option<String>,
}

/// The keys of a case that a series varies; keys that it does not vary are absent.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct VariedKeys {
    /// Radius of the rocker [m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rocker_radius_m: Option<f64>,
    /// Radius of the track; `inf` on a straight [m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius_m: Option<Radius>,
    /// Pitch [rad].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pitch_rad: Option<f64>,
    /// Roll [rad].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub roll_rad: Option<f64>,
    /// Normal force [N].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fz_n: Option<f64>,
}

/// A radius; JSON has the word `inf` for an infinite one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Radius {
    /// A finite radius [m].
    Finite(f64),
    /// `inf` or `-inf`.
    Word(String),
}

impl From<f64> for Radius {
    fn from(radius: f64) -> Self {
        if radius.is_finite() {
            Radius::Finite(radius)
        } else {
            Radius::Word(radius.to_string())
        }
    }
}

impl Radius {
    /// The radius, infinite on a straight [m].
    pub fn metres(&self) -> f64 {
        match self {
            Radius::Finite(radius) => *radius,
            Radius::Word(word) => word.parse().unwrap_or(f64::NAN),
        }
    }
}

impl VariedKeys {
    /// The keys and their values, in order.
    pub fn named(&self) -> Vec<(&'static str, String)> {
        let keys = [
            ("rocker_radius_m", self.rocker_radius_m),
            ("radius_m", self.radius_m.as_ref().map(Radius::metres)),
            ("pitch_rad", self.pitch_rad),
            ("roll_rad", self.roll_rad),
            ("fz_n", self.fz_n),
        ];
        let varied = keys.into_iter();
        varied
            .filter_map(|(key, value)| Some((key, value?.to_string())))
            .collect()
    }
}

/// The numbers of a contact that a series lists.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct SeriesResult {
    /// Peak pressure.
    #[serde(flatten)]
    pub p_max: Measured<PeakPressure>,
    /// Mean pressure.
    #[serde(flatten)]
    pub p_mean: Measured<MeanPressure>,
    /// Contact area.
    #[serde(flatten)]
    pub area: Measured<Area>,
    /// Contact length.
    #[serde(flatten)]
    pub length: Measured<Length>,
    /// Contact width.
    #[serde(flatten)]
    pub width: Measured<Width>,
    /// Approach.
    #[serde(flatten)]
    pub approach: Measured<Approach>,
    /// Residual of the complementarity conditions.
    pub kkt_residual: f64,
    /// Unknowns of the finest mesh.
    pub dofs: usize,
    /// Iterations on all meshes.
    pub iterations: usize,
    /// Wall time [s].
    pub seconds: f64,
    /// Largest shear stress under the surface.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub max_shear: Option<Measured<MaxShear>>,
    /// Its depth.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub max_shear_depth: Option<Measured<MaxShearDepth>>,
    /// As [`ContactResult::p_max_hull_pa`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub p_max_hull_pa: Option<f64>,
    /// As [`ContactResult::p_max_noise_pa`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub p_max_noise_pa: Option<f64>,
    /// As [`ContactResult::approach_hull_m`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub approach_hull_m: Option<f64>,
    /// As [`ContactResult::approach_noise_m`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub approach_noise_m: Option<f64>,
    /// Largest von Mises stress of a runner that deforms [Pa].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub runner_von_mises_max_pa: Option<f64>,
    /// Peak pressure by boundary elements.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub check_p_max: Option<Measured<CheckPeak>>,
    /// Coefficient of friction with its parts.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub friction: Option<Friction>,
    /// Depth of the groove.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub groove_depth: Option<Measured<GrooveDepth>>,
    /// Mean thickness of the melt film.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub film_mean: Option<Measured<FilmMean>>,
}

impl SeriesResult {
    /// The numbers that the page of a series can draw.
    pub const DRAWN: [Description; 11] = [
        PeakPressure::DESCRIPTION,
        MeanPressure::DESCRIPTION,
        Area::DESCRIPTION,
        Length::DESCRIPTION,
        Width::DESCRIPTION,
        Approach::DESCRIPTION,
        Mu::DESCRIPTION,
        MuPloughing::DESCRIPTION,
        MuViscous::DESCRIPTION,
        MuBoundary::DESCRIPTION,
        GrooveDepth::DESCRIPTION,
    ];
}

impl From<&ContactResult> for SeriesResult {
    fn from(result: &ContactResult) -> Self {
        let line = result.subsurface.as_ref();
        let shear = line.and_then(|line| line.shear.as_ref());
        let sliding = result.sliding.as_ref();
        SeriesResult {
            p_max: result.p_max,
            p_mean: result.p_mean,
            area: result.area,
            length: result.length,
            width: result.width,
            approach: result.approach,
            kkt_residual: result.kkt_residual,
            dofs: result.dofs,
            iterations: result.iterations,
            seconds: result.seconds,
            max_shear: shear.map(|shear| shear.shear),
            max_shear_depth: shear.map(|shear| shear.depth),
            p_max_hull_pa: result.p_max_hull_pa,
            p_max_noise_pa: result.p_max_noise_pa,
            approach_hull_m: result.approach_hull_m,
            approach_noise_m: result.approach_noise_m,
            runner_von_mises_max_pa: result.runner.as_ref().map(|r| r.runner_von_mises_max_pa),
            check_p_max: result.check.as_ref().map(|check| check.p_max),
            friction: sliding.map(|s| s.friction),
            groove_depth: sliding.map(|s| s.groove_depth),
            film_mean: sliding.map(|s| s.film_mean),
        }
    }
}
