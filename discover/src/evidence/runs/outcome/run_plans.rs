//! Plans for runs, and their simulation with a model.

use kufe_sled::{
    Conditions, Driver, Model, Noise, SimulateOptions, Track, TrackShape, Vehicle, record,
    simulate, simulated_entry,
};

use crate::evidence::runs::campaign::Campaign;
use crate::evidence::runs::model::residual_model::ResidualModel;
use crate::evidence::runs::outcome::next_model::next_model;
use crate::evidence::runs::recordings::frame::Frame;
use crate::evidence::runs::recordings::prepare::Data;
use crate::evidence::runs::recordings::smooth_run::{frame, signal_kernel};
use crate::evidence::runs::recordings::survey::Surveys;
use crate::finding::NextRuns;

/// Factors of the start speed, of plans that change one condition as a team can between two
/// sessions.
const SPEEDS: [f64; 2] = [0.7, 1.3];
/// Factors of the mass.
const MASSES: [f64; 2] = [0.9, 1.1];
/// Changes of the ice temperature [K].
const ICE_K: [f64; 2] = [-5.0, 5.0];
/// Changes of the relative humidity [%].
const HUMIDITY_PCT: [f64; 2] = [-25.0, 25.0];
/// Changes of the air pressure [Pa].
const AIR_PA: [f64; 2] = [-3000.0, 3000.0];
/// Ratio of a better instrument's noise to the usual noise.
const NOISE_RATIO: f64 = 0.25;
/// Longest simulated run [s].
const MAX_S: f64 = 150.0;
/// Time step [s].
const STEP_S: f64 = 2.5e-3;

/// Number of runs of a plan, all in one session.
pub const RUNS: usize = 3;

/// Runs that could be driven next.
#[derive(Clone)]
pub struct Plan {
    track: Track,
    start_speed_mps: f64,
    conditions: Conditions,
    mass_kg: f64,
    /// Sensor noise with a better instrument; `None`: usual noise.
    pub noise: Option<Noise>,
    change: String,
}

/// Mean conditions of a campaign.
fn usual(training: &[Frame]) -> Conditions {
    let mean = |value: &dyn Fn(&Frame) -> f64| {
        training.iter().map(value).sum::<f64>() / training.len().max(1) as f64
    };
    let stated =
        |frame: &Frame, name: &str| frame.condition(name).iter().sum::<f64>() / frame.len() as f64;
    Conditions {
        ice_c: mean(&|f| stated(f, "ice_c")),
        air_c: mean(&|f| f.air_c),
        air_pa: mean(&|f| f.air_pa),
        humidity_pct: mean(&|f| stated(f, "humidity_pct")),
        distance_m: 0.0,
        mass_kg: f64::NAN,
    }
}

/// A condition changed by each of these steps, within limits; nothing if it is not stated (NaN).
fn changed(usual: f64, steps: [f64; 2], [low, high]: [f64; 2]) -> impl Iterator<Item = f64> {
    let steps = steps.into_iter().filter(move |_| !usual.is_nan());
    steps.map(move |step| (usual + step).clamp(low, high))
}

/// Plans for each track: unchanged conditions, then one change each.
pub fn plans(data: &Data, training: &[Frame], model: &Model) -> Vec<Plan> {
    let first = training.iter().filter_map(|frame| frame.v.first());
    let mut speeds: Vec<f64> = first.copied().collect();
    speeds.sort_by(f64::total_cmp);
    let speed = speeds.get(speeds.len() / 2).copied().unwrap_or(10.0);
    let conditions = usual(training);
    let mut plans = Vec::new();
    for track in data.downhill_tracks() {
        let same = Plan {
            track,
            start_speed_mps: speed,
            conditions,
            mass_kg: model.sled.mass_kg,
            noise: None,
            change: "as before".to_owned(),
        };
        let mut add = |change: String, apply: &dyn Fn(&mut Plan)| {
            let mut plan = Plan {
                change,
                ..same.clone()
            };
            apply(&mut plan);
            plans.push(plan);
        };
        add("as before".to_owned(), &|_| {});
        for factor in SPEEDS {
            let change = format!("started at {:.1} m/s instead of {speed:.1}", factor * speed);
            add(change, &|p| p.start_speed_mps *= factor);
        }
        for factor in MASSES {
            let mass = factor * model.sled.mass_kg;
            let change = format!("with {mass:.0} kg instead of {:.0}", model.sled.mass_kg);
            add(change, &|p| {
                p.mass_kg = mass;
                p.conditions.mass_kg = mass;
            });
        }
        for ice in changed(conditions.ice_c, ICE_K, [f64::NEG_INFINITY, -0.5]) {
            let change = format!("on ice of {ice:.1} °C instead of {:.1}", conditions.ice_c);
            add(change, &|p| p.conditions.ice_c = ice);
        }
        let usual = conditions.humidity_pct;
        for humidity in changed(usual, HUMIDITY_PCT, [5.0, 100.0]) {
            let change = format!("in air of {humidity:.0} % humidity instead of {usual:.0}");
            add(change, &|p| p.conditions.humidity_pct = humidity);
        }
        for step in AIR_PA {
            let change = format!("at {:+.0} hPa of air pressure", 0.01 * step);
            add(change, &|p| p.conditions.air_pa += step);
        }
        for (instrument, reduce) in INSTRUMENTS {
            let Some(mut noise) = model.noise else { break };
            reduce(&mut noise);
            let change = format!("with {instrument} of a quarter of the noise");
            add(change, &|p| p.noise = Some(noise));
        }
    }
    plans
}

/// A sensor's name, and the change of the noise by a better one.
type Instrument = (&'static str, fn(&mut Noise));

/// Sensors that plans improve.
const INSTRUMENTS: [Instrument; 6] = [
    ("an accelerometer", |n| n.accel_mps2 *= NOISE_RATIO),
    ("a gyroscope", |n| n.rate_radps *= NOISE_RATIO),
    ("a speed sensor", |n| n.speed_mps *= NOISE_RATIO),
    ("a slip sensor", |n| n.slip_rad *= NOISE_RATIO),
    ("a steering sensor", |n| n.steer_rad *= NOISE_RATIO),
    ("a roll-split sensor", |n| n.roll_split_rad *= NOISE_RATIO),
];

impl Plan {
    /// The plan with its expected evidence.
    pub fn next_runs(&self, [a, b]: [&str; 2], expected_evidence: f64, splits: bool) -> NextRuns {
        NextRuns {
            runs: RUNS,
            track: self.track.name.clone(),
            change: self.change.clone(),
            start_speed_mps: self.start_speed_mps,
            mass_kg: self.mass_kg,
            ice_c: self.conditions.ice_c,
            air_c: self.conditions.air_c,
            air_pa: self.conditions.air_pa,
            humidity_pct: Some(self.conditions.humidity_pct).filter(|h| h.is_finite()),
            noise: self.noise,
            between: [a.to_owned(), b.to_owned()],
            expected_evidence,
            splits,
        }
    }
}

/// A simulated run of a plan, processed as a recorded one; `None` if it cannot be simulated.
pub fn simulated_run(
    campaign: &Campaign,
    model: &ResidualModel,
    plan: &Plan,
    noise: Option<&Noise>,
) -> Option<Frame> {
    let already = campaign.given.effects.active.len();
    let written = next_model(campaign.model, model, already);
    let vehicle = Vehicle::with_effects(&written).ok()?;
    let recorded_dt = campaign.training.first()?.recorded_dt;
    let options = SimulateOptions {
        step_s: STEP_S,
        rate_hz: (1.0 / recorded_dt).round(),
        start_speed_mps: plan.start_speed_mps,
        most_s: MAX_S,
        conditions: plan.conditions,
        ..SimulateOptions::default()
    };
    let driver = Driver::of_skill(0.9);
    let done = simulate(&vehicle, &TrackShape::new(&plan.track), &driver, &options).ok()?;
    let entry = simulated_entry("planned", &plan.track, "planned", plan.conditions);
    let run = record(&done, &vehicle, noise, entry, options.seed);
    let slopes = plan.track.s_m.iter().copied();
    let profile = slopes.zip(plan.track.slope_rad.iter().copied()).collect();
    let surveys = Surveys::from([(plan.track.name.clone(), profile)]);
    let rules = &campaign.rules().recordings;
    frame(&run, &signal_kernel(run.dt_s, rules), &surveys, rules).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_condition_that_is_not_stated_is_not_changed() {
        let limits = [f64::NEG_INFINITY, -0.5];
        assert!(changed(-4.0, ICE_K, limits).eq([-9.0, -0.5]));
        assert_eq!(changed(f64::NAN, ICE_K, limits).count(), 0);
    }
}
