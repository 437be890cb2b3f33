//! What ice and air do to the sled.

use super::hidden::{Acts, Force, Hidden};

/// The true sled; places from the centre of gravity [m].
#[derive(Debug, Clone, Copy)]
pub struct Sled {
    /// Mass [kg].
    pub mass_kg: f64,
    /// Pitch and yaw inertia [kg m2].
    pub inertia_kgm2: [f64; 2],
    /// Front and rear axle, both positive [m].
    pub axle_m: [f64; 2],
    /// Accelerometer [m].
    pub accel_m: [f64; 3],
    /// Slip sensor [m].
    pub slip_m: f64,
    /// Drag area [m2] and its growth a degree of drift.
    pub drag: [f64; 2],
    /// Friction along the runners.
    pub mu: f64,
    /// Of both runners: peak over load, shape, bend, stiffness [N/rad].
    pub grip: [[f64; 4]; 2],
}

impl Sled {
    /// The true sled where this effect is hidden.
    pub fn with(mut self, hidden: &Hidden) -> Sled {
        match hidden.effect.acts {
            Acts::Mass => self.mass_kg += hidden.size,
            Acts::YawInertia => self.inertia_kgm2[1] *= 1.0 + hidden.size,
            Acts::Centre => self.centre_ahead(hidden.size),
            _ => {}
        }
        self
    }

    /// Puts the true centre of gravity so far ahead of the model's [m].
    pub fn centre_ahead(&mut self, by: f64) {
        self.axle_m = [self.axle_m[0] - by, self.axle_m[1] + by];
        self.accel_m[0] -= by;
        self.slip_m -= by;
    }
}

#[cfg(test)]
impl Sled {
    /// The published sled.
    pub fn published() -> Sled {
        Sled {
            mass_kg: 390.0,
            inertia_kgm2: [145.0, 150.0],
            axle_m: [0.82, 0.88],
            accel_m: [-0.35, 0.0, 0.12],
            slip_m: -0.60,
            drag: [0.28, 0.0694],
            mu: 0.004,
            grip: [
                [2.577, 0.024, 0.99, 10_522.0],
                [3.288, 0.076, 0.99, 49_776.0],
            ],
        }
    }
}

/// One instant as ice and air see it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Now {
    /// Speed [m/s].
    pub v: f64,
    /// Course against the sled's axis, left positive [rad].
    pub beta: f64,
    /// Slip of both runners [rad], as their forces follow it.
    pub slip: [f64; 2],
    /// Steering and roll split [rad].
    pub steer: f64,
    /// Roll split [rad].
    pub split: f64,
    /// Load of both axles in the body's frame [N].
    pub load: [f64; 2],
    /// Pitch rate [rad/s].
    pub pitch: f64,
    /// Ice temperature [deg C].
    pub ice_c: f64,
    /// Air density [kg/m3].
    pub air: f64,
    /// Push of a wall, left positive [N].
    pub wall: f64,
}

/// Forces along and across [N] and yaw moment [N m].
#[derive(Debug, Clone, Copy, Default)]
pub struct Push {
    /// Along x [N].
    pub x: f64,
    /// Along y [N].
    pub y: f64,
    /// About z [N m].
    pub turn: f64,
}

/// `F = D sin(C atan(B a - E (B a - atan(B a))))`, `D = m F_z`, `B = K/(C D)`.
fn side_force([peak, shape, bend, stiffness]: [f64; 4], slip: f64, load: f64) -> f64 {
    let d = peak * load.max(1.0);
    let x = stiffness * slip / (shape * d);
    d * (shape * (x - bend * (x - x.atan())).atan()).sin()
}

/// Forces at an instant; `friction` and `grip` are the session's factors.
pub fn push(sled: &Sled, now: &Now, [friction, grip]: [f64; 2], hidden: Option<&Hidden>) -> Push {
    let hidden = hidden.filter(|h| matches!(h.effect.acts, Acts::Force(_)));
    let of = |force: Force| hidden.map_or(0.0, |h| h.force(force));
    let mut mu = sled.mu * friction;
    let mut hold = grip;
    if hidden.is_some() {
        mu *= 1.0 + of(Force::Temperature) * (now.ice_c + 5.0);
        mu *= (now.v / 20.0).powf(of(Force::Speed));
        hold *= 1.0 + of(Force::SpeedGrip) * (now.v - 25.0);
        hold *= 1.0 + of(Force::TemperatureGrip) * (now.ice_c + 5.0);
        hold *= 1.0 + of(Force::PitchGrip) * now.pitch.abs();
        hold *= 1.0 + of(Force::PitchDip) * (-((now.pitch + 0.4) / 0.15).powi(2)).exp();
        hold *= 1.0 + of(Force::ProductGrip) * now.v * now.split;
        hold *= 1.0 + of(Force::HumpGrip) * (-((now.v - 22.0) / 3.0).powi(2)).exp();
    }
    let (worn, dragged) = (of(Force::LoadGrip), of(Force::SlipDrag));
    let across = |runner: usize, load: f64| {
        let force = side_force(sled.grip[runner], now.slip[runner], load);
        if worn != 0.0 {
            return hold * (load.max(100.0) / 2000.0).powf(worn) * force;
        }
        hold * force
    };
    let cosines = now.slip.map(f64::cos);
    let along = |runner: usize, load: f64| {
        let mut push = -mu * load.max(0.0) * cosines[runner];
        if dragged != 0.0 {
            push -= dragged * (across(runner, load) * now.slip[runner]).abs();
        }
        push
    };
    let ((sin_g, cos_g), (sin_d, cos_d)) = (now.split.sin_cos(), now.steer.sin_cos());
    // The front runner is rotated in the body: its own load follows from the axle's by a fixed
    // point.
    let mut own = now.load[0] / cos_g;
    for _ in 0..6 {
        let y = across(0, own) + of(Force::Camber) * now.split * own;
        let last = own;
        own = (now.load[0] - sin_g * (sin_d * along(0, own) + cos_d * y)) / cos_g;
        if own == last {
            break;
        }
    }
    let (fx, fy) = (
        along(0, own),
        across(0, own) + of(Force::Camber) * now.split * own,
    );
    let flat = sin_d * fx + cos_d * fy;
    let front = [cos_d * fx - sin_d * fy, cos_g * flat - sin_g * own];
    let rear = [along(1, now.load[1]), across(1, now.load[1])];
    let area = sled.drag[0]
        * (1.0 + (sled.drag[1] + of(Force::AeroYaw)) * now.beta.to_degrees().abs())
        + of(Force::DragArea);
    let air = 0.5 * now.air * area * now.v * now.v;
    Push {
        x: front[0] + rear[0] - air * now.beta.cos(),
        y: front[1] + rear[1] - air * now.beta.sin() + now.wall,
        turn: sled.axle_m[0] * front[1] - sled.axle_m[1] * rear[1],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::other_worlds::EFFECTS;
    use crate::other_worlds::plan::Plan;
    use crate::other_worlds::ride::{RATE_HZ, Way};
    use crate::other_worlds::road::Road;
    use crate::world::noise::Source;

    #[test]
    fn a_force_with_a_relaxation_length_is_late_by_that_length_over_the_speed() {
        let source = &mut Source::new(5, "ride");
        let road = Road::draw("birke", source);
        let plan = Plan::draw(0.0, &mut Source::new(6, "driver"), source);
        let effect = *EFFECTS
            .iter()
            .find(|e| e.name == "relaxation-length")
            .unwrap();
        let hidden = Hidden {
            effect,
            size: 0.05,
            place_m: [0.0; 2],
            strength: 1.0,
        };
        let sled = Sled::published();
        let way = Way {
            sled: &sled,
            road: &road,
            plan: &plan,
            rate_hz: RATE_HZ,
            seconds: 10.0,
        };
        let (truths, added) = way.parted(Some(&hidden), 1);
        // To first order the pushes are those of slips that were there sigma/v before.
        let slip = |k: usize, place: f64| {
            let t = &truths[k];
            -(t.beta.sin() + t.rate[2] * place / t.v).atan2(t.beta.cos())
        };
        let slips = |k: usize| {
            let front = slip(k, sled.axle_m[0]) + truths[k].steer;
            [front, slip(k, -sled.axle_m[1])]
        };
        let half = 0.5 * sled.mass_kg;
        for of in [0, 1] {
            let (mut both, mut squares) = (0.0, 0.0);
            for k in (2000..truths.len() - 20).step_by(7) {
                let t = &truths[k];
                let pushed = |slip| {
                    let now = Now {
                        v: t.v,
                        slip,
                        load: [half * t.felt[2]; 2],
                        ..Now::default()
                    };
                    let push = push(&sled, &now, [1.0; 2], None);
                    [push.y / sled.mass_kg, push.turn / sled.inertia_kgm2[1]][of]
                };
                let (last, now, next) = (slips(k - 10), slips(k), slips(k + 10));
                let late = hidden.size / t.v / 0.02;
                let before = std::array::from_fn(|i| now[i] - late * (next[i] - last[i]));
                let lack = pushed(before) - pushed(now);
                both += lack * added[k][1 + of];
                squares += lack * lack;
            }
            let share = both / squares;
            assert!((share - 1.0).abs() < 0.1, "{of} {share}");
        }
    }
}
