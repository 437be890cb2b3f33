//! Tables of `model.toml`: sled, track survey, sensor noise, tolerances, conditions.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::conditions::Conditions;

/// `[sled]`: a rigid one-track sled in vehicle axes (x forward, y left, z up).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sled {
    /// Mass with crew [kg].
    pub mass_kg: f64,
    /// Pitch moment of inertia [kg m2].
    pub j_yy_kgm2: f64,
    /// Yaw moment of inertia [kg m2].
    pub j_zz_kgm2: f64,
    /// Front axle before the centre of gravity [m].
    pub l_f_m: f64,
    /// Rear axle behind the centre of gravity [m].
    pub l_r_m: f64,
    /// Accelerometer from the centre of gravity, forward [m].
    #[serde(default)]
    pub accel_x_m: f64,
    /// Accelerometer from the centre of gravity, left [m].
    #[serde(default)]
    pub accel_y_m: f64,
    /// Accelerometer from the centre of gravity, up [m].
    #[serde(default)]
    pub accel_z_m: f64,
    /// Slip sensor from the centre of gravity, forward [m].
    #[serde(default)]
    pub slip_x_m: f64,
    /// Drag area [m2].
    pub cda_m2: f64,
    /// Relative growth of the drag area per degree of chassis slip [1/deg].
    #[serde(default = "published_yaw_drag")]
    pub yaw_drag_per_deg: f64,
}

/// The paper's yaw sensitivity: 6.94 % per degree.
fn published_yaw_drag() -> f64 {
    0.0694
}

impl Sled {
    /// Distance between the axles [m].
    pub fn wheelbase_m(&self) -> f64 {
        self.l_f_m + self.l_r_m
    }
}

/// `[survey]`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Survey {
    /// Standard deviation of the slope along the driven line [rad]: error of the survey, and
    /// difference of the driven from the surveyed line, which climbs where the bank grows.
    pub slope_sd_rad: f64,
}

/// `[noise]`: standard deviation of the white noise of each sensor, per sample; 0 where absent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Noise {
    /// Accelerometer, each axis [m/s2].
    pub accel_mps2: f64,
    /// Gyroscope, each axis [rad/s].
    pub rate_radps: f64,
    /// Speed [m/s].
    pub speed_mps: f64,
    /// Slip angle [rad].
    pub slip_rad: f64,
    /// Steering angle [rad].
    pub steer_rad: f64,
    /// Roll-split angle [rad].
    pub roll_split_rad: f64,
}

/// `[tolerances]`: standard deviations of the errors of the installation; 0 for a value that is
/// exactly as stated.
///
/// The defaults are errors of careful work with a tape, a scale, a spirit level and a data sheet.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Tolerances {
    /// Delay of a channel against the others [s].
    pub delay_s: f64,
    /// Places of sensors and of the centre of gravity [m].
    pub place_m: f64,
    /// Scale of a gyroscope's axis.
    pub gyro_scale: f64,
    /// Bias of a gyroscope's axis [rad/s].
    pub gyro_bias_radps: f64,
    /// Scale of an accelerometer's axis.
    pub accel_scale: f64,
    /// Bias of an accelerometer's axis [m/s2].
    pub accel_bias_mps2: f64,
    /// Mass, relative.
    pub mass: f64,
    /// Pitch and yaw inertia, relative.
    pub inertia: f64,
    /// Scale of the steering angle.
    pub steer_scale: f64,
    /// Misalignment of the inertial unit about each axis [rad].
    pub misalignment_rad: f64,
    /// Sensitivity of each gyroscope axis to the vertical acceleration [rad s/m].
    pub gyro_g_sensitivity_radps_per_mps2: f64,
    /// Offset of sensors that are remounted for each session: slip and steering [rad].
    pub session_offset_rad: f64,
    /// Deviation of the lateral forces from the form of their law: relative to the peak force, and
    /// relative per factor e of the load.
    pub lateral_form: f64,
}

impl Default for Tolerances {
    fn default() -> Self {
        Self {
            delay_s: 0.002,
            place_m: 0.02,
            gyro_scale: 0.005,
            gyro_bias_radps: 0.001,
            accel_scale: 0.005,
            accel_bias_mps2: 0.02,
            mass: 0.01,
            inertia: 0.05,
            steer_scale: 0.01,
            misalignment_rad: 0.005,
            gyro_g_sensitivity_radps_per_mps2: 9e-5,
            session_offset_rad: 0.001,
            lateral_form: 0.03,
        }
    }
}

/// `[conditions]`: quantities that only effects need.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ModelConditions {
    /// Relative humidity of the air [%].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub humidity_pct: Option<f64>,
    /// Distance run on this finish of the runners before the run [m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub distance_m: Option<f64>,
}

impl ModelConditions {
    /// The conditions of a run, completed by these.
    pub fn complete(&self, run: &Conditions) -> Conditions {
        let or = |stated: f64, model: Option<f64>| {
            if stated.is_nan() {
                model.unwrap_or(stated)
            } else {
                stated
            }
        };
        Conditions {
            humidity_pct: or(run.humidity_pct, self.humidity_pct),
            distance_m: or(run.distance_m, self.distance_m),
            ..*run
        }
    }
}
