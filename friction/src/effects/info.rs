//! What is known of an effect before it is fitted.

/// A parameter of an effect: name, unit and the range that physics allows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Key in `model.toml`, with its unit as a suffix.
    pub name: &'static str,
    /// Unit as it is printed; empty for a pure number.
    pub unit: &'static str,
    /// Smallest admissible value.
    pub low: f64,
    /// Largest admissible value.
    pub high: f64,
    /// Value when the key is absent; 0 for an amplitude, which switches the effect off.
    pub default: f64,
    /// Order of magnitude of a noticeable change; steps of differences are taken from it. 0 for a setting that is not fitted.
    pub typical: f64,
}

impl Parameter {
    /// An amplitude: 0 means off.
    pub const fn amplitude(
        name: &'static str,
        unit: &'static str,
        low: f64,
        high: f64,
        typical: f64,
    ) -> Self {
        Self {
            name,
            unit,
            low,
            high,
            default: 0.0,
            typical,
        }
    }

    /// A setting that shapes the effect and is not fitted with it.
    pub const fn setting(
        name: &'static str,
        unit: &'static str,
        low: f64,
        high: f64,
        default: f64,
    ) -> Self {
        Self {
            name,
            unit,
            low,
            high,
            default,
            typical: 0.0,
        }
    }

    /// Whether the parameter is an amplitude, fitted to data.
    pub fn is_amplitude(&self) -> bool {
        self.typical != 0.0
    }
}

/// The level on which an effect varies, and with it the unit that randomisation must move as one piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Within a run, from sample to sample.
    Sample,
    /// From run to run.
    Run,
    /// From session to session.
    Session,
    /// The same in all runs on one track.
    Track,
}

/// A quantity beyond the required columns that an effect needs to be told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// Normal force [N].
    Load,
    /// Speed [m/s].
    Speed,
    /// Distance along the track [m].
    Distance,
    /// Time since the start [s].
    Time,
    /// Ice temperature [deg C].
    IceTemperature,
    /// Air temperature [deg C].
    AirTemperature,
    /// Air pressure [Pa].
    AirPressure,
    /// Relative humidity [%].
    Humidity,
    /// Distance run on this finish before the run [m].
    Wear,
    /// Slip angle [rad].
    Slip,
    /// Steering angle [rad].
    Steering,
    /// Roll-split angle [rad].
    RollSplit,
    /// Roll rate [rad/s].
    RollRate,
    /// Vertical acceleration [m/s2].
    VerticalAcceleration,
    /// Longitudinal acceleration [m/s2].
    LongitudinalAcceleration,
    /// The track's slope over distance [rad].
    Slope,
}

impl Column {
    /// The column's name in the files.
    pub fn name(self) -> &'static str {
        match self {
            Column::Load => "fz_n",
            Column::Speed => "v_mps",
            Column::Distance => "s_m",
            Column::Time => "t_s",
            Column::IceTemperature => "ice_c",
            Column::AirTemperature => "air_c",
            Column::AirPressure => "air_pa",
            Column::Humidity => "humidity_pct",
            Column::Wear => "distance_m",
            Column::Slip => "alpha_rad",
            Column::Steering => "delta_rad",
            Column::RollSplit => "gamma_rad",
            Column::RollRate => "roll_rate_radps",
            Column::VerticalAcceleration => "az_mps2",
            Column::LongitudinalAcceleration => "ax_mps2",
            Column::Slope => "slope_rad",
        }
    }
}

/// What an effect is called and what it takes.
#[derive(Clone, Copy, Debug)]
pub struct Info {
    /// Name as in `[effects.NAME]`.
    pub name: &'static str,
    /// One line for reports.
    pub summary: &'static str,
    /// The level on which it varies.
    pub level: Level,
    /// Parameters in the order in which they are passed.
    pub parameters: &'static [Parameter],
    /// What must be recorded for the effect to be testable.
    pub needs: &'static [Column],
    /// What would tell this effect from those that look like it.
    pub decides: &'static str,
}
