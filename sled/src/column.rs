//! Quantities that runs record or state, with name in files, unit and label.

use serde::Deserialize;

/// Declares [`Column`]: variant, name in files, unit, label.
macro_rules! columns {
    ($($column:ident $name:literal [$unit:literal] $label:literal)*) => {
        /// A quantity that is recorded or stated.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
        pub enum Column {
            $(
                #[doc = concat!($label, " [", $unit, "].")]
                #[serde(rename = $name)]
                $column,
            )*
        }

        impl Column {
            /// All of them; the sensors come first, in the order of [`Sensor::ALL`].
            pub const ALL: &[Column] = &[$(Column::$column),*];

            /// Name in files; its ending is the unit.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Column::$column => $name,)*
                }
            }

            /// Label in print.
            pub const fn label(self) -> &'static str {
                match self {
                    $(Column::$column => $label,)*
                }
            }
        }
    };
}

columns! {
    LongitudinalAcceleration "ax_mps2" ["m/s2"] "specific force forward"
    LateralAcceleration "ay_mps2" ["m/s2"] "specific force to the left"
    VerticalAcceleration "az_mps2" ["m/s2"] "specific force upward"
    RollRate "roll_rate_radps" ["rad/s"] "roll rate"
    PitchRate "pitch_rate_radps" ["rad/s"] "pitch rate"
    YawRate "yaw_rate_radps" ["rad/s"] "yaw rate"
    Speed "v_mps" ["m/s"] "speed"
    Slip "alpha_rad" ["rad"] "slip angle"
    Steering "delta_rad" ["rad"] "steering"
    RollSplit "gamma_rad" ["rad"] "roll split"
    Time "t_s" ["s"] "time"
    Distance "s_m" ["m"] "distance"
    Load "fz_n" ["N"] "normal force"
    IceTemperature "ice_c" ["deg C"] "temperature of the ice"
    AirTemperature "air_c" ["deg C"] "temperature of the air"
    AirPressure "air_pa" ["Pa"] "air pressure"
    Humidity "humidity_pct" ["%"] "relative humidity"
    Wear "distance_m" ["m"] "distance on this finish before the run"
    Slope "slope_rad" ["rad"] "slope"
    Film "film" [""] "friction of groove and film over the mean of its table"
    ContactLength "contact_length_m" ["m"] "length of the contact"
    ContactWidth "contact_width_m" ["m"] "mean width of the contact"
    Roughness "roughness_m" ["m"] "roughness of steel and ice together"
}

impl Column {
    /// The column of this name.
    pub fn named(name: &str) -> Option<Column> {
        Column::ALL.iter().copied().find(|c| c.name() == name)
    }
}

/// Number of recorded sensors.
pub const SENSORS: usize = 10;

/// Names of the columns that sensors record, in the order of [`Sensor::ALL`].
pub const COLUMNS: [&str; SENSORS] = {
    let mut names = [""; SENSORS];
    let mut i = 0;
    while i < SENSORS {
        names[i] = Column::ALL[i].name();
        i += 1;
    }
    names
};

/// A recorded channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(try_from = "Column")]
pub enum Sensor {
    /// Specific force forward [m/s2].
    Ax,
    /// Specific force to the left [m/s2].
    Ay,
    /// Specific force up [m/s2].
    Az,
    /// Roll rate [rad/s].
    RollRate,
    /// Pitch rate [rad/s].
    PitchRate,
    /// Yaw rate [rad/s].
    YawRate,
    /// Speed [m/s].
    Speed,
    /// Slip angle [rad].
    Slip,
    /// Steering angle [rad].
    Steering,
    /// Roll-split angle [rad].
    RollSplit,
}

impl Sensor {
    /// The axes of the accelerometer.
    pub const ACCELEROMETER: [Sensor; 3] = [Sensor::Ax, Sensor::Ay, Sensor::Az];
    /// The axes of the gyroscope.
    pub const GYROSCOPE: [Sensor; 3] = [Sensor::RollRate, Sensor::PitchRate, Sensor::YawRate];
    /// All sensors, in the order of their columns.
    pub const ALL: [Sensor; SENSORS] = [
        Sensor::Ax,
        Sensor::Ay,
        Sensor::Az,
        Sensor::RollRate,
        Sensor::PitchRate,
        Sensor::YawRate,
        Sensor::Speed,
        Sensor::Slip,
        Sensor::Steering,
        Sensor::RollSplit,
    ];

    /// The column's name in a run's file.
    pub const fn name(self) -> &'static str {
        COLUMNS[self as usize]
    }

    /// The sensor of this column.
    pub fn named(name: &str) -> Option<Sensor> {
        Sensor::ALL.into_iter().find(|sensor| sensor.name() == name)
    }
}

impl TryFrom<Column> for Sensor {
    type Error = String;

    fn try_from(column: Column) -> Result<Self, String> {
        let name = column.name();
        Sensor::named(name).ok_or_else(|| format!("{name}: expected a column of a sensor"))
    }
}
