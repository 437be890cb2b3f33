//! Time integration of a simulated run by a multistep method of order 4.

use crate::conditions::Conditions;
use crate::error::Error;
use crate::model::vehicle::{Vehicle, refuse_effects};
use crate::record::needs::refuse_drag_without_air;
use crate::simulate::driver::{Driver, Steering};
use crate::simulate::dynamics::{
    Before, COUNT, Instant, N, S, TIME, Unknowns, VX, WallContact, World,
};
use crate::track::table::{IceAlong, TrackShape};

/// Work and energy over a simulation [J].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EnergyBalance {
    /// Kinetic energy at the start.
    pub kinetic_start_j: f64,
    /// Kinetic energy at the end.
    pub kinetic_end_j: f64,
    /// Work of gravity.
    pub gravity_j: f64,
    /// Work of the ice, negative.
    pub ice_j: f64,
    /// Work of the air, negative.
    pub air_j: f64,
    /// Work of wall contacts.
    pub wall_j: f64,
}

impl EnergyBalance {
    /// Imbalance of work and kinetic energy, relative to the largest term.
    pub fn relative_error(&self) -> f64 {
        let work = self.gravity_j + self.ice_j + self.air_j + self.wall_j;
        let kinetic = self.kinetic_end_j.max(self.kinetic_start_j);
        let scale = kinetic.max(self.gravity_j.abs());
        (self.kinetic_end_j - self.kinetic_start_j - work).abs() / scale
    }
}

/// A simulated run without its sensors.
#[derive(Clone, Debug)]
pub struct Simulated {
    /// One instant per output sample.
    pub instants: Vec<Instant>,
    /// Offset to the left of the ideal line at each sample [m].
    pub offset_m: Vec<f64>,
    /// Time between samples [s].
    pub dt_s: f64,
    /// Whether the finish was reached before the time limit.
    pub finished: bool,
    /// Work and energy.
    pub energy: EnergyBalance,
    /// Steps taken.
    pub steps: usize,
}

/// Drives a sled down a track.
///
/// Integrates the equations of motion in `dynamics.rs` by Adams-Bashforth steps of order 4, started
/// by Runge-Kutta, from the track's start to its finish. A step needs one evaluation of the forces,
/// which a real-time simulator can afford. Deterministic: equal arguments give equal bits.
///
/// The method is stable for `h lambda < 0.3`, with lambda the fastest rate of slip and yaw, which
/// grows with the ratio of load to speed and of wheelbase to radius of gyration. Lambda is computed
/// ten times per second of the run, and an output interval is divided into as many steps as
/// stability requires.
///
/// # Errors
/// [`Error::KeyRange`] for options out of range, [`Error::Stopped`] where the sled comes to rest or
/// leaves the track.
pub fn simulate(
    vehicle: &Vehicle,
    track: &TrackShape,
    driver: &Driver,
    options: &SimulateOptions,
) -> Result<Simulated, Error> {
    let vehicle = &vehicle.on_run(&track.name, &options.conditions);
    let conditions = vehicle.conditions.complete(&options.conditions);
    refuse_unstated(vehicle, &conditions, &track.ice, "simulation")?;
    let variation = driver.variation(track.start_m, track.finish_m, options.seed);
    let world = World {
        vehicle,
        shape: track,
        conditions,
        ice: &track.ice,
        density: options.conditions.air_density(),
        steering: Steering::Driver(driver, variation),
        contacts: &options.contacts,
        cross_curvature: options.cross_curvature_1pm,
    };
    let mut start: Unknowns = [0.0; COUNT];
    (start[S], start[VX]) = (track.start_m, options.start_speed_mps);
    let (simulated, trouble) = integrate(&world, start, track.finish_m, options)?;
    trouble.map_or(Ok(simulated), Err)
}

/// Refuses conditions of ice and air that the vehicle needs and that neither `conditions` nor the
/// track state.
pub(crate) fn refuse_unstated(
    vehicle: &Vehicle,
    conditions: &Conditions,
    ice: &IceAlong,
    who: &str,
) -> Result<(), Error> {
    let mut absent = conditions.absent();
    absent.retain(|name| *name != "ice_c" || ice.points().is_empty());
    refuse_effects(&vehicle.effects, &absent, who)?;
    vehicle.refuse_unstated_ice(!absent.contains(&"ice_c"), who)?;
    refuse_drag_without_air(&vehicle.sled, conditions, who)
}

/// Interval at which the step length is checked [s].
const CHECK_INTERVAL_S: f64 = 0.1;
/// Largest product of step length and fastest rate; the stability limit of Adams-Bashforth is 0.3.
const MAX_STEP_RATE: f64 = 0.2;
/// Smallest step [s].
const MIN_STEP_S: f64 = 1e-6;

/// Integrates from `start` to the distance `finish_m`. The second result is the error if the motion
/// left the range of the model before.
///
/// # Errors
/// [`Error::KeyRange`] for options out of range.
pub(crate) fn integrate(
    world: &World,
    start: Unknowns,
    finish_m: f64,
    options: &SimulateOptions,
) -> Result<(Simulated, Option<Error>), Error> {
    let min_substeps = steps_an_interval(options)?;
    let dt_s = 1.0 / options.rate_hz;
    let check_interval = (CHECK_INTERVAL_S / dt_s).ceil() as usize;
    let (mut substeps, mut h) = (min_substeps, dt_s / min_substeps as f64);
    let (start_s, mut y) = (start[TIME], start);
    let kinetic_start_j = world.kinetic_energy(&y);
    let mut before = Before::default();
    // Accelerations of the first instant are unknown; a few iterations determine them.
    for _ in 0..4 {
        before = world.before(&world.rates(&y, &before).1, &before, h);
    }
    let mut then = [before; 2];
    let expected = ((finish_m - start[S]) / start[VX] / dt_s) as usize;
    let mut instants = Vec::with_capacity(expected.min(1 << 16));
    let mut offset_m = Vec::with_capacity(expected.min(1 << 16));
    // Rates of the last four steps, newest first, and the number of steps of equal length.
    let (mut past, mut equal_steps) = ([[0.0; COUNT]; 4], 0);
    let mut steps = 0;
    // Number of output intervals, and of steps in the current one.
    let (mut intervals, mut substep) = (0, 0);
    let mut trouble = None;
    let finished = loop {
        let t_s = start_s + intervals as f64 / options.rate_hz + substep as f64 * h;
        let now = before;
        let extrapolated = |of: fn(&Before) -> f64| 3.0 * (of(&now) - of(&then[0])) + of(&then[1]);
        before.growth = extrapolated(|before| before.growth);
        before.roll_accel = extrapolated(|before| before.roll_accel);
        then = [now, then[0]];
        let (rates, mut instant) = world.rates(&y, &before);
        before = world.before(&instant, &before, h);
        past.rotate_right(1);
        past[0] = rates;
        let finished = y[S] >= finish_m;
        if (substep == 0 || finished)
            && let Some(what) = world.trouble(&y)
        {
            trouble = Some(stopped(world, &y, t_s, instants.last(), what));
            break false;
        }
        if substep == 0 {
            instant.state.t_s = t_s;
            instants.push(instant);
            offset_m.push(y[N]);
        }
        if finished {
            break true;
        }
        if t_s - start_s >= options.most_s {
            break false;
        }
        if substep == 0 && intervals % check_interval == 0 {
            let needed = match stable_substeps(world.fastest_rate(&y, &rates, &before), dt_s) {
                Ok(needed) => needed.max(min_substeps),
                Err(what) => {
                    trouble = Some(stopped(world, &y, t_s, None, what));
                    break false;
                }
            };
            if needed > substeps || 2 * needed <= substeps {
                (substeps, h, equal_steps) = (needed, dt_s / needed as f64, 0);
                then = [now; 2];
            }
        }
        y = if equal_steps < 3 {
            runge_kutta(world, &y, &rates, &before, h)
        } else {
            adams_bashforth(&y, &past, h)
        };
        (steps, equal_steps, substep) = (steps + 1, equal_steps + 1, substep + 1);
        if substep == substeps {
            (intervals, substep) = (intervals + 1, 0);
        }
    };
    let [.., gravity_j, ice_j, air_j, wall_j, _] = y;
    let simulated = Simulated {
        instants,
        offset_m,
        dt_s,
        finished,
        energy: EnergyBalance {
            kinetic_start_j,
            kinetic_end_j: world.kinetic_energy(&y),
            gravity_j,
            ice_j,
            air_j,
            wall_j,
        },
        steps,
    };
    Ok((simulated, trouble))
}

/// Number of steps in an output interval `dt_s` [s] that are stable at the fastest `rate` of slip and
/// yaw [1/s].
///
/// # Errors
/// The reason if only steps below [`MIN_STEP_S`] are stable.
fn stable_substeps(rate: f64, dt_s: f64) -> Result<usize, String> {
    if rate * MIN_STEP_S > MAX_STEP_RATE {
        return Err(format!(
            "slip and yaw change at {rate:.0} 1/s: no step of {MIN_STEP_S} s or more is stable"
        ));
    }
    Ok((dt_s * rate / MAX_STEP_RATE).ceil() as usize)
}

/// The error of a simulation that cannot continue: at the `last` instant if the motion is no longer
/// finite.
fn stopped(world: &World, y: &Unknowns, t_s: f64, last: Option<&Instant>, what: String) -> Error {
    let (s_m, t_s, what) = match last.filter(|_| !y[S].is_finite()) {
        Some(Instant { state, .. }) => (state.s_m, state.t_s, what + &world.not_finite(state)),
        None => (y[S], t_s, what),
    };
    Error::Stopped { s_m, t_s, what }
}

/// Adams-Bashforth step of order 4, with one evaluation of the forces per step.
///
/// `y + h/24 (55 f_0 - 59 f_-1 + 37 f_-2 - 9 f_-3)`
fn adams_bashforth(y: &Unknowns, past: &[Unknowns; 4], h: f64) -> Unknowns {
    std::array::from_fn(|i| {
        let mean = 55.0 * past[0][i] - 59.0 * past[1][i] + 37.0 * past[2][i] - 9.0 * past[3][i];
        y[i] + h / 24.0 * mean
    })
}

/// Classical Runge-Kutta step of order 4, which starts the multistep method.
fn runge_kutta(world: &World, y: &Unknowns, k1: &Unknowns, before: &Before, h: f64) -> Unknowns {
    let k2 = world.rates(&ahead(y, k1, 0.5 * h), before).0;
    let k3 = world.rates(&ahead(y, &k2, 0.5 * h), before).0;
    let k4 = world.rates(&ahead(y, &k3, h), before).0;
    std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
}

fn ahead(y: &Unknowns, rates: &Unknowns, h: f64) -> Unknowns {
    std::array::from_fn(|i| y[i] + h * rates[i])
}

/// Options of a simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulateOptions {
    /// Largest step [s]; the actual step divides the output interval.
    pub step_s: f64,
    /// Output rate [Hz].
    pub rate_hz: f64,
    /// Speed at the start [m/s].
    pub start_speed_mps: f64,
    /// Largest simulated time [s].
    pub most_s: f64,
    /// Ice and air.
    pub conditions: Conditions,
    /// Forces from outside, e.g. of walls.
    pub contacts: Vec<WallContact>,
    /// Curvature of the channel's cross-section [1/m].
    pub cross_curvature_1pm: f64,
    /// Seed of the driver's noise and, independently, of the sensor noise.
    pub seed: u64,
}

impl Default for SimulateOptions {
    fn default() -> Self {
        SimulateOptions {
            step_s: 1e-3,
            rate_hz: 500.0,
            start_speed_mps: 10.0,
            most_s: 600.0,
            conditions: Conditions {
                ice_c: -8.0,
                air_c: 0.0,
                air_pa: 95_000.0,
                ..Conditions::UNSTATED
            },
            contacts: Vec::new(),
            cross_curvature_1pm: 0.25,
            seed: 1,
        }
    }
}

impl SimulateOptions {
    /// The first option out of its range: name, value, smallest and largest value.
    pub fn out_of_range(&self) -> Option<(&'static str, f64, [f64; 2])> {
        let ranges = [
            ("step_s", self.step_s, [1e-6, 0.01]),
            ("rate_hz", self.rate_hz, [1.0, 10_000.0]),
            ("start_speed_mps", self.start_speed_mps, [1.0, 60.0]),
            ("most_s", self.most_s, [0.1, 3600.0]),
            ("cross_curvature_1pm", self.cross_curvature_1pm, [0.0, 2.0]),
        ];
        let outside = |(_, value, [low, high]): &(_, f64, [f64; 2])| !(low..=high).contains(&value);
        ranges.into_iter().find(outside)
    }
}

/// Number of steps per output interval.
pub(crate) fn steps_an_interval(options: &SimulateOptions) -> Result<usize, Error> {
    if let Some((key, value, [low, high])) = options.out_of_range() {
        return Err(Error::KeyRange {
            file: "simulation".to_string(),
            key: format!("{key} (from {low} to {high})"),
            value,
            expected: "a number in that range",
        });
    }
    let steps = 1.0 / (options.rate_hz * options.step_s) - 1e-9;
    Ok(steps.ceil().max(1.0) as usize)
}
