//! What a case hides: the effects, by the names under which they are to be found.

use serde::Serialize;

/// An effect that is not in the base model, or a fault of a sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[allow(missing_docs)]
pub enum Kind {
    Temperature,
    Speed,
    Load,
    Plowing,
    Asperities,
    Humidity,
    Wear,
    WarmUp,
    DragArea,
    Headwind,
    AirDensity,
    Slope,
    SlipDrag,
    SteerDrag,
    RollSplitDrag,
    AeroYaw,
    AccelerometerBiasX,
    AccelerometerTiltPitch,
    TrackProfile,
    WallContact,
    LoadTransfer,
    RelaxationLength,
    SpeedGrip,
    TemperatureGrip,
    LoadSensitivity,
    CamberThrust,
    Saturation,
    CombinedSlip,
    GripPatch,
    AccelerometerBiasY,
    AccelerometerTiltRoll,
    LeverArm,
    SlipOffset,
    SlipScale,
    SlipLag,
    SteerOffset,
    Mass,
    BeyondRollRate,
    BeyondExtra,
    BeyondPitchGrip,
    BeyondSpeedHump,
    BeyondProduct,
    YawRateScale,
    YawRateBias,
    SteerLag,
    SpeedScale,
    YawInertia,
    YawRateLag,
    RollRateBias,
    RollRateScale,
    RollRateLag,
    PitchRateBias,
    PitchRateScale,
    PitchRateLag,
    SpeedBias,
    SpeedLag,
    SteerScale,
    RollSplitBias,
    RollSplitScale,
    RollSplitLag,
    AccelerometerScaleY,
    CgPlace,
}

/// Where an effect's first guess of size starts, and which rivals its signature is compared with.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// The effect.
    pub kind: Kind,
    /// Its name in reports.
    pub name: &'static str,
    /// Its parameter's key in `[effects.NAME]`.
    pub key: &'static str,
    /// Its parameter's unit.
    pub unit: &'static str,
    /// A first guess of its size, with its physical sign.
    pub start: f64,
    /// The largest size that is still plausible.
    pub limit: f64,
    /// True where either sign is physical.
    pub both_signs: bool,
    /// True where it acts on the longitudinal channel.
    pub longitudinal: bool,
}

macro_rules! entries {
    ($($kind:ident $name:literal $key:literal $unit:literal $start:literal $limit:literal $both:literal $long:literal;)*) => {
        /// Every effect a run can hide.
        pub const ENTRIES: &[Entry] = &[$(Entry { kind: Kind::$kind, name: $name, key: $key, unit: $unit,
            start: $start, limit: $limit, both_signs: $both, longitudinal: $long }),*];
    };
}

entries! {
    Temperature "temperature" "slope_per_k" "1/K" -0.02 0.08 true true;
    Speed "speed" "exponent" "" -0.3 1.5 true true;
    Load "load" "exponent" "" -0.2 0.8 true true;
    Plowing "plowing" "coefficient" "" 0.001 0.004 false true;
    Asperities "asperities" "excess" "" 0.6 3.0 false true;
    Humidity "humidity" "slope_per_pct" "1/%" 0.01 0.04 true true;
    Wear "wear" "slope_per_km" "1/km" 0.1 0.8 false true;
    WarmUp "warm-up" "excess" "" 0.5 3.0 false true;
    DragArea "drag-area" "cda_m2" "m2" 0.04 0.2 true true;
    Headwind "headwind" "speed_mps" "m/s" 2.0 8.0 true true;
    AirDensity "air-density" "factor" "" -0.12 0.45 true true;
    Slope "slope" "offset_rad" "rad" 0.002 0.01 true true;
    SlipDrag "slip-drag" "factor" "" 0.5 15.0 false true;
    SteerDrag "steer-drag" "coefficient_per_rad" "1/rad" 0.08 0.6 false true;
    RollSplitDrag "roll-split-drag" "coefficient_per_rad" "1/rad" 1.0 20.0 false true;
    AeroYaw "aero-yaw" "per_deg" "1/deg" 0.1 0.6 false true;
    AccelerometerBiasX "accelerometer-bias" "x_mps2" "m/s2" 0.02 0.3 true true;
    AccelerometerTiltPitch "accelerometer-tilt" "pitch_rad" "rad" 0.002 0.03 true true;
    TrackProfile "track-profile" "offset_rad" "rad" 0.006 0.03 true true;
    WallContact "wall-contact" "force_n" "N" 300.0 4000.0 true false;
    LoadTransfer "load-transfer" "per_radps2_squared" "s4/rad2" 0.01 2.0 false false;
    RelaxationLength "relaxation-length" "length_m" "m" 0.5 4.0 false false;
    SpeedGrip "speed-grip" "slope_s_per_m" "s/m" -0.01 0.019 true false;
    TemperatureGrip "temperature-grip" "slope_per_k" "1/K" -0.02 0.08 true false;
    LoadSensitivity "load-sensitivity" "exponent" "" -0.2 0.7 false false;
    CamberThrust "camber-thrust" "coefficient_per_rad" "1/rad" 0.02 0.5 true false;
    Saturation "saturation" "both" "" 5.0 800.0 false false;
    CombinedSlip "combined-slip" "factor" "" 50.0 900.0 false false;
    GripPatch "asperities" "grip_excess" "" -0.3 0.9 false false;
    AccelerometerBiasY "accelerometer-bias" "y_mps2" "m/s2" 0.02 0.3 true false;
    AccelerometerTiltRoll "accelerometer-tilt" "roll_rad" "rad" 0.002 0.03 true false;
    LeverArm "lever-arm" "x_m" "m" 0.08 0.6 true false;
    SlipOffset "slip-offset" "offset_rad" "rad" 0.0006 0.006 true false;
    SlipScale "slip-scale" "factor" "" 0.1 0.5 true false;
    SlipLag "slip-lag" "time_s" "s" 0.02 0.12 false false;
    SteerOffset "steer-offset" "offset_rad" "rad" 0.003 0.03 true false;
    Mass "mass" "excess_kg" "kg" 15.0 60.0 true false;
    BeyondRollRate "unknown:roll_rate_radps" "-" "s/rad" 0.001 0.02 false true;
    BeyondExtra "unknown:runner_c" "-" "1/K" 0.001 0.01 false true;
    BeyondPitchGrip "unknown:pitch_rate_radps" "-" "s/rad" -0.1 0.8 false false;
    BeyondSpeedHump "unknown:v_mps" "-" "" 0.05 0.5 true false;
    BeyondProduct "unknown:v_mps*gamma_rad" "-" "s/(m rad)" 0.05 1.0 true false;
    YawRateScale "yaw-rate-scale" "factor" "" 0.05 0.3 true false;
    YawRateBias "yaw-rate-bias" "offset_radps" "rad/s" 0.004 0.05 true false;
    SteerLag "steer-lag" "time_s" "s" 0.02 0.12 false false;
    SpeedScale "speed-scale" "factor" "" 0.02 0.15 true true;
    YawInertia "yaw-inertia" "factor" "" 0.1 0.5 true false;
    YawRateLag "yaw-rate-lag" "time_s" "s" 0.01 0.12 false false;
    RollRateBias "roll-rate-bias" "offset_radps" "rad/s" 0.02 0.1 true false;
    RollRateScale "roll-rate-scale" "factor" "" 0.05 0.3 true false;
    RollRateLag "roll-rate-lag" "time_s" "s" 0.02 0.12 false false;
    PitchRateBias "pitch-rate-bias" "offset_radps" "rad/s" 0.02 0.1 true false;
    PitchRateScale "pitch-rate-scale" "factor" "" 0.05 0.3 true false;
    PitchRateLag "pitch-rate-lag" "time_s" "s" 0.02 0.12 false false;
    SpeedBias "speed-bias" "offset_mps" "m/s" 0.3 3.0 true true;
    SpeedLag "speed-lag" "time_s" "s" 0.05 0.5 false true;
    SteerScale "steer-scale" "factor" "" 0.05 0.5 true false;
    RollSplitBias "roll-split-bias" "offset_rad" "rad" 0.005 0.1 true false;
    RollSplitScale "roll-split-scale" "factor" "" 0.1 0.5 true false;
    RollSplitLag "roll-split-lag" "time_s" "s" 0.02 0.12 false false;
    AccelerometerScaleY "accelerometer-scale" "y_factor" "" 0.03 0.15 true false;
    CgPlace "cg-place" "x_m" "m" 0.03 0.2 true false;
}

impl Kind {
    /// Whether a sensor is at fault: motion and forces are as they would be without.
    pub fn is_of_a_sensor(self) -> bool {
        use Kind::*;
        matches!(
            self,
            AccelerometerBiasX
                | AccelerometerBiasY
                | AccelerometerTiltPitch
                | AccelerometerTiltRoll
                | AccelerometerScaleY
                | LeverArm
                | SlipOffset
                | SlipScale
                | SlipLag
                | SteerOffset
                | SteerScale
                | SteerLag
                | SpeedBias
                | SpeedScale
                | SpeedLag
                | RollRateBias
                | RollRateScale
                | RollRateLag
                | PitchRateBias
                | PitchRateScale
                | PitchRateLag
                | YawRateBias
                | YawRateScale
                | YawRateLag
                | RollSplitBias
                | RollSplitScale
                | RollSplitLag
        )
    }

    /// Its row in [`ENTRIES`].
    pub fn entry(self) -> &'static Entry {
        ENTRIES
            .iter()
            .find(|entry| entry.kind == self)
            .expect("every kind has a row")
    }
}

/// A stretch of one track.
#[derive(Debug, Clone, Serialize)]
pub struct Place {
    /// Track.
    pub track: String,
    /// From [m].
    pub from_m: f64,
    /// To [m].
    pub to_m: f64,
}

/// One hidden effect with its size.
#[derive(Debug, Clone, Serialize)]
pub struct Hidden {
    /// The effect.
    pub kind: Kind,
    /// Its parameter, in the unit of its entry.
    pub size: f64,
    /// Where it acts, for local effects.
    pub places: Vec<Place>,
}

impl Hidden {
    /// An effect that acts everywhere.
    pub fn new(kind: Kind, size: f64) -> Self {
        Self {
            kind,
            size,
            places: Vec::new(),
        }
    }

    /// 1 inside its places with soft edges of a metre, 0 outside.
    pub fn inside(&self, track: &str, s_m: f64) -> f64 {
        let edge = |x: f64| 0.5 * (1.0 + (x / 1.0).tanh());
        self.places
            .iter()
            .filter(|place| place.track == track)
            .map(|place| edge(s_m - place.from_m) * edge(place.to_m - s_m))
            .sum::<f64>()
            .min(1.0)
    }
}
