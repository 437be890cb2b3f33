//! Residuals of a model on one run: the force balances of the sled ([`Balance`]).
//!
//! Balances are taken at the rate of the retained samples and low-passed afterwards, all terms
//! alike: a product of two smoothed signals is not the smoothed product.

use std::borrow::Cow;
use std::sync::OnceLock;

use kufe_sled::effects::{Active, Forces, OperatingPoint, Relaxed, Sensor, Signals};
use kufe_sled::friction::film::Patch;
use kufe_sled::friction::sin_cos_near;
use kufe_sled::{
    Balance, Conditions, GRAVITY, LawForces, Motion, Sled, State, Vehicle, aero, from_sensors,
    slips, to_centre_of_gravity,
};

use crate::evidence::runs::model::channels::Channels;
use crate::evidence::runs::model::instant::Instant;
use crate::evidence::runs::model::residual_jacobian::ResidualJacobian;
use crate::evidence::runs::model::residual_model::{
    BALANCES, CHANNELS, ChannelRows, ResidualModel, TRACK,
};
use crate::evidence::runs::recordings::frame::Frame;
use crate::evidence::runs::recordings::survey::interpolate;

/// Knots of the form error of an axle's lateral law, as fractions of the peak force.
const FORM_KNOTS: [f64; 4] = [0.1, 0.3, 0.6, 1.0];
/// Number of form errors: one per knot and axle, and one that depends on the load.
pub const FORM_ERRORS: usize = 2 * FORM_KNOTS.len() + 1;
/// Reference load, at which the load-dependent form error is 0 [N].
const FORM_LOAD_N: f64 = 2000.0;

/// Lower bound of the speed in slip angles [m/s].
const MIN_SPEED: f64 = 0.5;

impl ResidualModel {
    /// Residuals of one run, low-passed and thinned to rows.
    pub fn residuals(&self, frame: &Frame) -> ChannelRows {
        self.sample_residuals(frame)
            .map(|channel| frame.rows(&channel))
    }

    /// Residuals of one run at every retained sample.
    pub fn sample_residuals(&self, frame: &Frame) -> ChannelRows {
        let mut rows: ChannelRows = std::array::from_fn(|_| Vec::with_capacity(frame.len()));
        let on_run = ModelOnRun::new(self, frame);
        for i in 0..frame.len() {
            let values = on_run.channel_residuals(i);
            for (row, value) in rows.iter_mut().zip(values) {
                row.push(value);
            }
        }
        if frame.slope.is_empty() {
            rows[TRACK].clear();
        }
        rows
    }

    /// The track channel at every retained sample; zeros without a survey.
    pub fn track_residual(&self, frame: &Frame) -> Vec<f64> {
        let on_run = ModelOnRun::new(self, frame);
        let residual = |i: usize| on_run.track_residual(i, &on_run.measured(i));
        (0..frame.len()).map(residual).collect()
    }
}

/// A model on one run: the vehicle with the effects that act there, and the weather.
pub struct ModelOnRun<'a> {
    residual_model: &'a ResidualModel,
    frame: &'a Frame,
    channels: Channels<'a>,
    /// Constants corrected for installation errors.
    sled: Sled,
    vehicle: Vehicle,
    air_density: f64,
    /// Whether an effect changes a sensor's reading.
    corrects: bool,
    humidity: Option<&'a Vec<f64>>,
    ice: Option<&'a Vec<f64>>,
    wear: Option<&'a Vec<f64>>,
    /// Surveyed slope of each sample [rad].
    slopes: OnceLock<Cow<'a, [f64]>>,
    /// Relaxation length of the lateral forces [m].
    relaxation: Option<f64>,
    /// Change of slip rate by relaxation, by sample, front and rear [rad/s].
    slip_rate_lag: OnceLock<Vec<[f64; 2]>>,
}

impl<'a> ModelOnRun<'a> {
    pub fn new(residual_model: &'a ResidualModel, frame: &'a Frame) -> Self {
        let mut vehicle = residual_model.scaled_vehicle();
        let effects = residual_model.effects.on_track(&frame.track);
        let delays = effects.delays();
        vehicle.effects = effects.in_time();
        if let Some(contacts) = &residual_model.contacts {
            vehicle.effects.active.extend(contacts.of_run(frame));
        }
        let installation = &residual_model.installation;
        vehicle.sled = frame.sled(vehicle.sled);
        let sled = installation.corrected_constants(vehicle.sled);
        let mut channels = installation.corrected_channels(frame, &Sensor::ALL, &delays);
        installation.correct_coupling(&mut channels);
        Self {
            residual_model,
            frame,
            channels,
            sled,
            corrects: vehicle.effects.active.iter().any(Active::moves_signals),
            relaxation: vehicle.effects.relaxation(),
            vehicle,
            air_density: aero::air_density(frame.air_pa, frame.air_c),
            humidity: frame.extra.get("humidity_pct"),
            ice: frame.extra.get("ice_c"),
            wear: frame.extra.get("distance_m"),
            slopes: OnceLock::new(),
            slip_rate_lag: OnceLock::new(),
        }
    }

    /// Slip rate with relaxation minus slip rate without, by sample, front and rear [rad/s].
    fn slip_rate_lag(&self, distance: f64) -> &[[f64; 2]] {
        self.slip_rate_lag.get_or_init(|| {
            let (mut relaxed, dt) = (Relaxed::default(), self.frame.sample_s());
            let lag = |i: usize| {
                let (_, state, _) = self.state_and_motion(i, &self.measured(i));
                let followed = state.followed_rates(&mut relaxed, dt, distance);
                [0, 1].map(|k| followed[k] - state.slip_rate_radps[k])
            };
            (0..self.frame.len()).map(lag).collect()
        })
    }

    /// The surveyed slope along the run; an integrated distance is corrected with the speed.
    fn slopes(&self) -> &[f64] {
        self.slopes.get_or_init(|| {
            let frame = self.frame;
            let as_read = Cow::Borrowed(frame.slope.as_slice());
            if frame.slope.is_empty() || !frame.s_of_speed {
                return as_read;
            }
            let correction = |i: usize| self.measured(i)[Sensor::Speed] - frame.v[i];
            let speed_correction: Vec<f64> = (0..frame.len()).map(correction).collect();
            if speed_correction.iter().all(|dv| *dv == 0.0) {
                return as_read;
            }
            let samples = frame.s.iter().zip(&speed_correction);
            let slopes = samples.scan(0.0, |distance_correction, (s, dv)| {
                *distance_correction += dv * frame.sample_s();
                Some(interpolate(&frame.survey, s + *distance_correction))
            });
            Cow::Owned(slopes.collect())
        })
    }

    /// The signals of a sample, corrected by the active effects.
    pub fn measured(&self, i: usize) -> Signals {
        self.corrected(i, self.channels.signals(i, self.sled))
    }

    /// Corrects the signals of a sample by the active effects.
    fn corrected(&self, i: usize, mut signals: Signals) -> Signals {
        if self.corrects {
            let v = self.channels.value(Sensor::Speed)[i];
            let at = self.operating_point(i, v);
            self.vehicle.effects.correct(&at, &mut signals);
        }
        signals
    }

    /// Time, place and weather of a sample at a speed [m/s].
    fn operating_point(&self, i: usize, v: f64) -> OperatingPoint {
        let frame = self.frame;
        OperatingPoint {
            t: frame.t[i],
            s: frame.s[i],
            v,
            fz: f64::NAN,
            conditions: Conditions {
                ice_c: self.ice.map_or(frame.ice_c, |x| x[i]),
                air_c: frame.air_c,
                air_pa: frame.air_pa,
                humidity_pct: self.humidity.map_or(frame.humidity_pct, |x| x[i]),
                distance_m: self.wear.map_or(frame.distance_before, |x| x[i]),
                mass_kg: f64::NAN,
            },
            air_density: self.air_density,
            drag_area: self.vehicle.sled.cda_m2,
            film: f64::NAN,
            patch: Patch::UNKNOWN,
        }
    }

    /// Sled, state and motion of a sample, from its corrected signals.
    fn motion(&self, i: usize, signals: &Signals) -> (Sled, State, Motion) {
        let (sled, mut state, motion) = self.state_and_motion(i, signals);
        if let Some(distance) = self.relaxation {
            let slip_rate_lag = self.slip_rate_lag(distance)[i];
            (0..2).for_each(|k| state.slip_rate_radps[k] += slip_rate_lag[k]);
        }
        (sled, state, motion)
    }

    /// Sled, state and motion of a sample without relaxation.
    fn state_and_motion(&self, i: usize, signals: &Signals) -> (Sled, State, Motion) {
        let sled = signals.sled;
        let mut bounded = *signals;
        bounded[Sensor::Speed] = signals[Sensor::Speed].max(MIN_SPEED);
        let at = self.operating_point(i, bounded[Sensor::Speed]);
        let (state, motion) = from_sensors(&sled, &bounded, &at);
        (sled, state, motion)
    }

    /// The state of a sample that friction is evaluated at.
    pub fn state(&self, i: usize) -> State {
        let (sled, state, motion) = self.motion(i, &self.measured(i));
        Balance::new(&sled, &state, &motion).state
    }

    /// A sample with the base laws evaluated.
    pub fn instant(&self, i: usize) -> Instant {
        self.instant_of(i, &self.measured(i))
    }

    /// A sample with the base laws evaluated, from its corrected signals.
    fn instant_of(&self, i: usize, signals: &Signals) -> Instant {
        let (sled, state, motion) = self.motion(i, signals);
        let balance = Balance::new(&sled, &state, &motion);
        let laws = balance.laws(&self.vehicle);
        Instant::new(&self.vehicle, balance, laws, signals)
    }

    /// A sample with balance and base laws linearised about the sample `known` of a similar motion.
    pub fn instant_near(&self, i: usize, signals: &Signals, known: &Instant) -> Instant {
        let (sled, state, motion) = self.motion(i, signals);
        let balance = Balance::near(&sled, &state, &motion, &known.balance);
        let laws = balance.laws_near(&self.vehicle, &known.balance, &known.laws);
        Instant::new(&self.vehicle, balance, laws, signals)
    }

    /// Derivatives of the balances of a sample by its corrected readings; `None` if effects act on
    /// the forces, whose derivatives are not included, and for a sled at rest.
    pub fn residual_jacobian(&self, at: &Instant) -> Option<ResidualJacobian> {
        let is_moving = at.signals[Sensor::Speed] > MIN_SPEED;
        let has_closed_form = is_moving && at.forces == at.laws.forces;
        has_closed_form
            .then(|| ResidualJacobian::new(&at.balance, &self.vehicle, &at.laws, &at.signals))
    }

    /// Derivatives of the balances of a sample by its uncorrected readings and the constants of the
    /// sled; by differences if effects act.
    pub fn jacobian_of_readings(&self, i: usize, at: &Instant) -> ResidualJacobian {
        let analytic = self.residual_jacobian(at);
        if let (Some(jacobian), false) = (analytic, self.corrects) {
            return jacobian;
        }
        let residuals = at.residuals();
        let read = self.channels.signals(i, self.sled);
        ResidualJacobian::of_differences(|perturb| {
            let mut signals = read;
            perturb(&mut signals);
            let signals = self.corrected(i, signals);
            match &analytic {
                Some(jacobian) => jacobian.between(&at.signals, &signals),
                None => {
                    let perturbed = self.instant_near(i, &signals, at).residuals();
                    std::array::from_fn(|c| perturbed[c] - residuals[c])
                }
            }
        })
    }

    /// Residuals with each form error of the lateral laws in turn, of relative size f.
    ///
    /// With P the peak force and r the ratio of the force to P, a form error changes the force of
    /// an axle by `f P` times a hat function of r: piecewise linear, 1 at its knot and 0 at the
    /// other knots and at r = 0. The last form error multiplies all lateral forces by `1 + f ln(N /
    /// 2000 N)`, with N the axle's load.
    pub fn residuals_with_form_errors(
        &self,
        at: &Instant,
        f: f64,
    ) -> [[f64; BALANCES]; FORM_ERRORS] {
        let laws = [&self.vehicle.front.lateral, &self.vehicle.rear.lateral];
        let load = at.seen.load.map(|load| load.max(1.0));
        std::array::from_fn(|form| {
            let mut forces = at.forces;
            let (axle, knot) = (form / FORM_KNOTS.len(), form % FORM_KNOTS.len());
            match forces.across.get_mut(axle) {
                Some(across) => {
                    let peak = laws[axle].peak() * load[axle];
                    let r = (across.abs() / peak).min(1.0);
                    let from = knot.checked_sub(1).map_or(0.0, |before| FORM_KNOTS[before]);
                    let at = FORM_KNOTS[knot];
                    let to = FORM_KNOTS.get(knot + 1).copied().unwrap_or(2.0 * at);
                    let rising = (r - from) / (at - from);
                    let hat = rising.min((to - r) / (to - at)).clamp(0.0, 1.0);
                    *across += across.signum() * f * peak * hat;
                }
                None => {
                    for (across, load) in forces.across.iter_mut().zip(load) {
                        *across *= 1.0 + f * (load / FORM_LOAD_N).ln();
                    }
                }
            }
            at.residuals_with_forces(&forces)
        })
    }

    /// Residuals with base multiplier `b` changed by a small `step`.
    pub fn residuals_with_base_step(&self, at: &Instant, b: usize, step: f64) -> [f64; BALANCES] {
        let share = step / self.residual_model.base[b];
        let mut forces = with_base_step(&at.laws, &self.vehicle, b, share);
        self.vehicle.effects.act(&at.seen, &mut forces);
        at.residuals_with_forces(&forces)
    }

    /// Residual along the path of the sled [m/s2]; 0 without a survey. The slope is positive
    /// downhill.
    fn track_residual(&self, i: usize, signals: &Signals) -> f64 {
        let Some(slope) = self.slopes().get(i) else {
            return 0.0;
        };
        let slope = slope + self.vehicle.effects.slope(self.frame.s[i]);
        let (sled, rates) = (&signals.sled, signals.rates());
        let speed = signals[Sensor::Speed].max(MIN_SPEED);
        let alpha = slips(sled, signals[Sensor::Slip], rates[2], speed, 0.0).cog;
        let (sine, cosine) = sin_cos_near(alpha, 0.0, (0.0, 1.0));
        let place = [sled.accel_x_m, sled.accel_y_m, sled.accel_z_m];
        let turning = signals.angular_acceleration();
        let [longitudinal, lateral, _] =
            to_centre_of_gravity(signals.acceleration(), rates, turning, place);
        signals.rate(Sensor::Speed) - GRAVITY * libm::sin(slope) - longitudinal * cosine
            + lateral * sine
    }

    /// Residuals of all channels at a sample.
    pub fn channel_residuals(&self, i: usize) -> [f64; CHANNELS] {
        let at = self.instant(i);
        let [along, side, yaw] = at.residuals();
        [along, side, yaw, self.track_residual(i, &at.signals)]
    }

    /// Scale of a sensor's reading.
    pub fn scale(&self, sensor: Sensor) -> f64 {
        self.channels.scale(sensor)
    }

    /// Residuals of a sample with this model. `at` is the sample of a model with the same base
    /// laws, which are reused if both models correct the signals alike.
    pub fn residuals_reusing(&self, i: usize, at: &Instant) -> [f64; BALANCES] {
        let signals = self.measured(i);
        if signals == at.signals && self.relaxation.is_none() {
            let mut forces = at.laws.forces;
            self.vehicle.effects.act(&at.seen, &mut forces);
            return at.residuals_with_forces(&forces);
        }
        self.instant_of(i, &signals).residuals()
    }

    /// Residuals of a sample with one more effect of small size, which `at` excludes. `jacobian`
    /// contains the derivatives of the residuals of `at`, if known.
    pub fn residuals_with_effect(
        &self,
        i: usize,
        effect: &Active,
        at: &Instant,
        jacobian: Option<&ResidualJacobian>,
    ) -> [f64; BALANCES] {
        if !effect.acts_on(&self.frame.track) {
            return at.residuals();
        }
        if !effect.moves_signals() {
            return at.residuals_with_force_effect(effect);
        }
        let mut signals = at.signals;
        effect.correct(&at.seen.point, &mut signals);
        // Another reading changes the motion; a sensor effect changes no force.
        if let Some(jacobian) = jacobian {
            let residuals = at.residuals();
            let change = jacobian.between(&at.signals, &signals);
            return std::array::from_fn(|c| residuals[c] + change[c]);
        }
        let other = self.instant_near(i, &signals, at);
        other.residuals_with_force_effect(effect)
    }
}

/// Forces of the base laws to first order, with base parameter `b` changed by a relative `share`.
fn with_base_step(laws: &LawForces, vehicle: &Vehicle, b: usize, share: f64) -> Forces {
    let mut forces = laws.forces;
    let across = &mut forces.across;
    let (front, rear) = (&vehicle.front.lateral, &vehicle.rear.lateral);
    let [by_front, by_rear] = &laws.lateral;
    match b {
        0 => forces.along.iter_mut().for_each(|f| *f *= 1.0 + share),
        1 => across[0] += front.mu_zeta * share * by_front.mu_zeta,
        2 => across[0] += front.k_n_per_rad * share * by_front.k_n_per_rad,
        3 => across[1] += rear.mu_zeta * share * by_rear.mu_zeta,
        _ => across[1] += rear.k_n_per_rad * share * by_rear.k_n_per_rad,
    }
    forces
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use kufe_sled::Model;
    use kufe_sled::effects::{Channel, Custom, Effects, Kind};
    use kufe_sled::sample_data::{drive_sample, sample_plan};

    use super::*;
    use crate::evidence::runs::model::residual_model::BASE;
    use crate::evidence::runs::recordings::prepare::prepare;
    use crate::procedure::rules::Rules;

    /// The functions of the knots, each times its knot, add up to r.
    #[test]
    fn deviations_of_the_form_span_a_factor_of_the_lateral_forces() {
        let published = Model::published();
        let mut plan = sample_plan(4);
        plan.truncate(2);
        let recorded = drive_sample(&plan, &published).expect("runs");
        let data = prepare(&recorded, &published, &BTreeMap::new(), &Rules::default());
        let data = data.expect("frames");
        let vehicle = Vehicle::new(&published).expect("the published model");
        let model = ResidualModel::new(vehicle, [1.0; BASE], Effects::default());
        let on_run = ModelOnRun::new(&model, &data.frames[0]);
        let grip = Active {
            name: String::new(),
            kind: Kind::Custom(Custom::new(Channel::Grip, "1", None).expect("a formula")),
            values: vec![0.01],
            track: None,
        };
        for i in (0..data.frames[0].len()).step_by(50) {
            let at = on_run.instant(i);
            let own = at.residuals();
            let scaled = on_run.residuals_with_effect(i, &grip, &at, None);
            let deviating = on_run.residuals_with_form_errors(&at, 0.01);
            for c in 0..BALANCES {
                let of_axle = |axle: usize| -> f64 {
                    let own_knots = &deviating[axle * FORM_KNOTS.len()..];
                    let each = FORM_KNOTS.iter().zip(own_knots);
                    each.map(|(r, with)| r * (with[c] - own[c])).sum()
                };
                let sum = of_axle(0) + of_axle(1);
                assert!(
                    (sum - (scaled[c] - own[c])).abs() < 1e-9 * (1.0 + sum.abs()),
                    "{i} {c}"
                );
            }
        }
    }
}
