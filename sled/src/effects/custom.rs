//! Effects that a person adds in `model.toml`, as an expression of columns.
//!
//! ```toml
//! [effects.my-drag]
//! expression = "v_mps^2 * abs(delta_rad)"   # times `value`
//! channel = "longitudinal"                  # or "lateral" (force on the body [N]), "friction" (added to mu), "grip" (times the side forces)
//! unit = "N s2/(m2 rad)"
//! value = 0.0                               # 0 or absent: a candidate, not yet switched on
//! low = -10.0
//! high = 10.0
//! ```

use kufe_friction::effects::Expression;

use super::{Conditions, Forces, State};

/// Where an effect of one's own acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Force on the body, forward [N].
    Longitudinal,
    /// Force on the body at the centre of gravity, to the left [N].
    Lateral,
    /// Added to the friction coefficient of both runners.
    Friction,
    /// The side forces of both runners are multiplied by 1 + value * expression.
    Grip,
}

/// An effect of one's own: amplitude times expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Custom {
    /// What it acts on.
    pub channel: Channel,
    /// The formula.
    pub expression: Expression,
    /// The formula as it was written.
    pub text: String,
    /// Unit of the amplitude.
    pub unit: String,
    /// Smallest admissible amplitude.
    pub low: f64,
    /// Largest admissible amplitude.
    pub high: f64,
}

/// The columns that an expression may use.
pub const COLUMNS: &[&str] = &[
    "t_s",
    "s_m",
    "v_mps",
    "fz_n",
    "fz_f_n",
    "fz_r_n",
    "alpha_rad",
    "alpha_f_rad",
    "alpha_r_rad",
    "delta_rad",
    "gamma_rad",
    "roll_rate_radps",
    "roll_acceleration_radps2",
    "yaw_rate_radps",
    "ax_mps2",
    "ay_mps2",
    "az_mps2",
    "ice_c",
    "air_c",
    "air_pa",
    "humidity_pct",
    "distance_m",
];

/// The value of a column of [`COLUMNS`]; NaN for any other name.
pub fn column(name: &str, at: &State) -> f64 {
    match name {
        "fz_n" => at.load[0] + at.load[1],
        "fz_f_n" => at.load[0],
        "fz_r_n" => at.load[1],
        "alpha_rad" => at.chassis_slip,
        "alpha_f_rad" => at.slip[0],
        "alpha_r_rad" => at.slip[1],
        "delta_rad" => at.steering,
        "gamma_rad" => at.roll_split,
        "roll_rate_radps" => at.roll_rate,
        "roll_acceleration_radps2" => at.roll_acceleration,
        "yaw_rate_radps" => at.yaw_rate,
        "ax_mps2" => at.acceleration[0],
        "ay_mps2" => at.acceleration[1],
        "az_mps2" => at.acceleration[2],
        _ => condition(name, &at.conditions),
    }
}

/// The value of a column that a friction coefficient may depend on without a sled around it; NaN for any other name.
fn condition(name: &str, c: &Conditions) -> f64 {
    match name {
        "t_s" => c.t,
        "s_m" => c.s,
        "v_mps" => c.v,
        "fz_n" => c.fz,
        "ice_c" => c.ice_c,
        "air_c" => c.air_c,
        "air_pa" => c.air_pa,
        "humidity_pct" => c.humidity_pct,
        "distance_m" => c.distance,
        _ => f64::NAN,
    }
}

/// Whether expressions may use a column of this name.
pub fn is_column(name: &str) -> bool {
    COLUMNS.contains(&name)
}

impl Custom {
    /// What an amplitude adds to the friction coefficient of a specimen, whose conditions alone are known; NaN where the
    /// expression asks for more, 0 on channels other than friction.
    pub fn coefficient(&self, amplitude: f64, at: &Conditions) -> f64 {
        match self.channel {
            Channel::Friction => amplitude * self.expression.evaluate(|name| condition(name, at)),
            _ => 0.0,
        }
    }

    /// Changes the forces.
    pub fn act(&self, amplitude: f64, at: &State, forces: &mut Forces) {
        if amplitude == 0.0 {
            return;
        }
        let value = amplitude * self.expression.evaluate(|name| column(name, at));
        match self.channel {
            Channel::Longitudinal => forces.body_along += value,
            Channel::Lateral => forces.body_across += value,
            Channel::Friction => {
                for runner in 0..2 {
                    forces.along[runner] -= value * at.load[runner].max(0.0);
                }
            }
            Channel::Grip => {
                for across in &mut forces.across {
                    *across *= 1.0 + value;
                }
            }
        }
    }
}
