//! The quantities that an effect may need to be told.

/// A quantity that an effect needs, recorded or stated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// Normal force [N]; of a run, from its vertical acceleration.
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
    /// Pitch rate [rad/s].
    PitchRate,
    /// Yaw rate [rad/s].
    YawRate,
    /// Longitudinal acceleration [m/s2].
    LongitudinalAcceleration,
    /// Lateral acceleration [m/s2].
    LateralAcceleration,
    /// Vertical acceleration [m/s2].
    VerticalAcceleration,
    /// The track's slope over distance [rad].
    Slope,
    /// Friction of groove and film by the tables that a model names, over each table's mean.
    Film,
}

impl Column {
    /// All of them.
    pub const ALL: [Column; 20] = [
        Column::Load,
        Column::Speed,
        Column::Distance,
        Column::Time,
        Column::IceTemperature,
        Column::AirTemperature,
        Column::AirPressure,
        Column::Humidity,
        Column::Wear,
        Column::Slip,
        Column::Steering,
        Column::RollSplit,
        Column::RollRate,
        Column::PitchRate,
        Column::YawRate,
        Column::LongitudinalAcceleration,
        Column::LateralAcceleration,
        Column::VerticalAcceleration,
        Column::Slope,
        Column::Film,
    ];

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
            Column::PitchRate => "pitch_rate_radps",
            Column::YawRate => "yaw_rate_radps",
            Column::LongitudinalAcceleration => "ax_mps2",
            Column::LateralAcceleration => "ay_mps2",
            Column::VerticalAcceleration => "az_mps2",
            Column::Slope => "slope_rad",
            Column::Film => "film",
        }
    }
}
