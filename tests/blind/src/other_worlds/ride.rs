//! The ride: speed, course and yaw down a road, stepped once a millisecond.

use super::hidden::{Acts, Force, Hidden};
use super::plan::Plan;
use super::road::{Here, Road};
use super::runners::{Now, Push, Sled, push};

/// Steps a second of what is recorded.
pub const RATE_HZ: f64 = 1000.0;

/// One millisecond of truth.
#[derive(Debug, Clone, Copy, Default)]
pub struct Truth {
    /// Specific force at the centre of gravity [m/s2].
    pub felt: [f64; 3],
    /// Roll, pitch and yaw rate [rad/s].
    pub rate: [f64; 3],
    /// Their derivatives [rad/s2].
    pub rate_slope: [f64; 3],
    /// Speed [m/s].
    pub v: f64,
    /// Course against the sled's axis [rad].
    pub beta: f64,
    /// Steering [rad].
    pub steer: f64,
    /// Roll split [rad].
    pub split: f64,
}

/// What a plan has drawn over time, at one time.
#[derive(Debug, Clone, Copy)]
struct Drawn {
    /// Steering and roll split [rad].
    steer: f64,
    split: f64,
    /// Roll and pitch rate, each with its derivative [rad/s, rad/s2].
    rough: [[f64; 2]; 2],
}

impl Drawn {
    fn at(plan: &Plan, t: f64) -> Drawn {
        Drawn {
            steer: plan.steer.at(t),
            split: plan.split.at(t),
            rough: [0, 1].map(|i| plan.rough[i].with_slope_at(t)),
        }
    }
}

/// Distance, offset from the line, heading from the line, speed, course, yaw rate, steering, and
/// the slips that forces follow.
type State = [f64; 9];

struct Ride<'a> {
    sled: &'a Sled,
    road: &'a Road,
    plan: &'a Plan,
    hidden: Option<&'a Hidden>,
    rate_hz: f64,
}

impl Ride<'_> {
    /// How the state changes, given how fast the speed changes now.
    fn slopes(&self, drawn: &Drawn, x: &State, v_slope: f64) -> (State, Truth) {
        let [s, _, heading, v, beta, r, steer, followed @ ..] = *x;
        // Half a metre before and behind, for how the frame's turning changes.
        let [last, here, next] = self.road.around(s, 0.5);
        let way = v * (heading + beta).cos();
        let [p, q] = rates(&here, way, heading, drawn);
        let heading_slope = r - way * here.turn[2];
        let turn_s = [0, 1].map(|a| next.turn[a] - last.turn[a]);
        let (sin_h, cos_h) = heading.sin_cos();
        let turned = [
            here.turn[0] * cos_h + here.turn[1] * sin_h,
            -here.turn[0] * sin_h + here.turn[1] * cos_h,
        ];
        let way_slope = v_slope * (heading + beta).cos();
        let p_slope = way_slope * turned[0]
            + way * way * (turn_s[0] * cos_h + turn_s[1] * sin_h)
            + way * heading_slope * turned[1]
            + drawn.rough[0][1];
        let q_slope = way_slope * turned[1] + way * way * (-turn_s[0] * sin_h + turn_s[1] * cos_h)
            - way * heading_slope * turned[0]
            + drawn.rough[1][1];
        let gravity = self.gravity(&here, heading, beta);
        let (vx, vy) = (v * beta.cos(), v * beta.sin());
        let up = p * vy - q * vx - gravity[2];
        let sled = self.sled;
        let base = sled.axle_m[0] + sled.axle_m[1];
        let front = (sled.axle_m[1] * sled.mass_kg * up - sled.inertia_kgm2[0] * q_slope) / base;
        let split = here.turn[0] * base + drawn.split;
        let slip = |place: f64| -(vy + r * place).atan2(vx);
        let steer_slope = (self.wish(drawn, x, &here) - steer) / 0.05;
        let slips = [slip(sled.axle_m[0]) + steer, slip(-sled.axle_m[1])];
        let behind = self.hidden.map_or(0.0, |h| h.force(Force::Relaxation));
        let (slip, slip_slopes) = match behind > 0.0 {
            // dalpha'/dt = v (alpha - alpha')/sigma, no faster than a step can follow.
            true => {
                let rate = (v / behind).min(self.rate_hz);
                let slopes = [0, 1].map(|i| rate * (slips[i] - followed[i]));
                (followed, slopes)
            }
            false => (slips, [0.0; 2]),
        };
        let now = Now {
            v,
            beta,
            slip,
            steer,
            split,
            load: [front, sled.mass_kg * up - front],
            pitch: q,
            ice_c: self.plan.ice_c,
            air: self.plan.air,
            wall: self.wall(s),
        };
        let mut all = push(sled, &now, self.plan.factors, self.hidden);
        if let Some(hidden) = self.hidden {
            for bump in &self.plan.bumps {
                let [x, y, turn] = bump.push(s).map(|part| hidden.strength * part);
                all.x += x;
                all.y += y;
                all.turn += turn;
            }
        }
        let Push { x: fx, y: fy, turn } = all;
        let (ax, ay) = (
            fx / sled.mass_kg + gravity[0],
            fy / sled.mass_kg + gravity[1],
        );
        let r_slope = turn / sled.inertia_kgm2[1];
        let slopes = [
            way,
            v * (heading + beta).sin(),
            heading_slope,
            ax * beta.cos() + ay * beta.sin(),
            (ay * beta.cos() - ax * beta.sin()) / v - r,
            r_slope,
            steer_slope,
            slip_slopes[0],
            slip_slopes[1],
        ];
        let truth = Truth {
            felt: [fx / sled.mass_kg, fy / sled.mass_kg, up],
            rate: [p, q, r],
            rate_slope: [p_slope, q_slope, r_slope],
            v,
            beta,
            steer,
            split,
        };
        (slopes, truth)
    }

    /// Gravity in the body's frame: where a way up the bank costs height the body's own heading
    /// decides, else slope and bank are those along the course.
    fn gravity(&self, here: &Here, heading: f64, beta: f64) -> [f64; 3] {
        let angle = if self.plan.climbs { heading } else { -beta };
        Road::gravity(here, angle)
    }

    fn wall(&self, s: f64) -> f64 {
        let own = self
            .plan
            .wall
            .filter(|[from, to, _]| (*from..*to).contains(&s));
        let hidden = self
            .hidden
            .filter(|h| h.effect.acts == Acts::Wall && (h.place_m[0]..h.place_m[1]).contains(&s));
        own.map_or(0.0, |[.., force]| force) + hidden.map_or(0.0, |h| h.size)
    }

    /// What the driver steers for: the road's turn, the side force, his line, and something of his
    /// own.
    fn wish(&self, drawn: &Drawn, x: &State, here: &Here) -> f64 {
        let sled = self.sled;
        let way = x[3];
        let yaw = way * here.turn[2];
        let side =
            sled.mass_kg * (way * yaw + super::road::GRAVITY * here.bank.sin() * here.fall.cos());
        let base = sled.axle_m[0] + sled.axle_m[1];
        let bend =
            side / base * (sled.axle_m[1] / sled.grip[0][3] - sled.axle_m[0] / sled.grip[1][3]);
        let course = x[2] + x[4];
        // Only where drivers have lines of their own, which then climb.
        let line = if self.plan.climbs {
            self.plan.line.at(x[0])
        } else {
            0.0
        };
        let aim = base * yaw / way + bend - 0.3 * course - 0.006 * (x[1] - line);
        (aim + drawn.steer).clamp(-0.12, 0.12)
    }
}

fn rates(here: &Here, way: f64, heading: f64, drawn: &Drawn) -> [f64; 2] {
    let (sine, cosine) = heading.sin_cos();
    [
        way * (here.turn[0] * cosine + here.turn[1] * sine) + drawn.rough[0][0],
        way * (-here.turn[0] * sine + here.turn[1] * cosine) + drawn.rough[1][0],
    ]
}

/// A sled, a road and a plan, and how finely they are ridden.
#[derive(Debug, Clone, Copy)]
pub struct Way<'a> {
    /// The true sled.
    pub sled: &'a Sled,
    /// The road.
    pub road: &'a Road,
    /// What was drawn for the run.
    pub plan: &'a Plan,
    /// Steps a second.
    pub rate_hz: f64,
    /// Longest duration [s].
    pub seconds: f64,
}

impl<'a> Way<'a> {
    fn ride<'b>(&self, hidden: Option<&'b Hidden>) -> Ride<'b>
    where
        'a: 'b,
    {
        Ride {
            sled: self.sled,
            road: self.road,
            plan: self.plan,
            hidden,
            rate_hz: self.rate_hz,
        }
    }

    /// Rides down the road: Heun's predictor and corrector, with the slope of the speed of the step
    /// before.
    pub fn ridden(&self, hidden: Option<&Hidden>) -> Vec<Truth> {
        let mut truths = Vec::new();
        self.step(&self.ride(hidden), |_, _, truth| truths.push(truth));
        truths
    }

    /// The same, with what the hidden force adds at every so many steps: along and across [m/s2],
    /// about the vertical [rad/s2].
    pub fn parted(&self, hidden: Option<&Hidden>, every: usize) -> (Vec<Truth>, Vec<[f64; 3]>) {
        let (mut truths, mut added) = (Vec::new(), Vec::new());
        let without = self.ride(None);
        let is_force = hidden.is_some_and(Hidden::is_force);
        self.step(&self.ride(hidden), |drawn, x, truth| {
            if is_force && truths.len().is_multiple_of(every) {
                let (_, bare) = without.slopes(drawn, x, 0.0);
                added.push([
                    truth.felt[0] - bare.felt[0],
                    truth.felt[1] - bare.felt[1],
                    truth.rate_slope[2] - bare.rate_slope[2],
                ]);
            }
            truths.push(truth);
        });
        (truths, added)
    }

    fn step(&self, ride: &Ride, mut each: impl FnMut(&Drawn, &State, Truth)) {
        let h = 1.0 / self.rate_hz;
        let mut x: State = [0.0; 9];
        x[3] = self.plan.start_mps;
        let mut v_slope = 0.8;
        let mut now = Drawn::at(self.plan, 0.0);
        for k in 0..(self.seconds * self.rate_hz) as usize {
            let next = Drawn::at(self.plan, (k + 1) as f64 * h);
            let (first, truth) = ride.slopes(&now, &x, v_slope);
            each(&now, &x, truth);
            let guess: State = std::array::from_fn(|i| x[i] + h * first[i]);
            let (second, _) = ride.slopes(&next, &guess, first[3]);
            x = std::array::from_fn(|i| x[i] + 0.5 * h * (first[i] + second[i]));
            v_slope = second[3];
            now = next;
            if x[0] > self.road.length_m - 10.0 || x[3] < 2.0 {
                break;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::road::GRAVITY;
    use super::super::runners::Sled;
    use super::*;
    use crate::world::noise::Source;

    fn way<'a>(sled: &'a Sled, road: &'a Road, plan: &'a Plan, seconds: f64) -> Way<'a> {
        Way {
            sled,
            road,
            plan,
            rate_hz: RATE_HZ,
            seconds,
        }
    }

    #[test]
    fn speed_comes_from_height_and_from_what_is_felt() {
        let source = &mut Source::new(5, "ride");
        let road = Road::draw("birke", source);
        let plan = Plan::draw(0.0, &mut Source::new(6, "driver"), source);
        let truths = way(&Sled::published(), &road, &plan, 15.0).ridden(None);
        let h = 1.0 / RATE_HZ;
        let (mut height, mut work, mut s) = (0.0, 0.0, 0.0);
        for truth in &truths[..truths.len() - 1] {
            let (sine, cosine) = truth.beta.sin_cos();
            work += h * truth.v * (truth.felt[0] * cosine + truth.felt[1] * sine);
            height += h * truth.v * GRAVITY * road.at(s).fall.sin();
            s += h * truth.v;
        }
        let energy = |truth: &Truth| 0.5 * truth.v * truth.v;
        let gained = energy(&truths[truths.len() - 1]) - energy(&truths[0]);
        // The sums are of first order in a step of 1 ms, and the way is a little shorter than the
        // distance driven.
        assert!(
            (gained - height - work).abs() < 2e-3 * height,
            "{gained} {height} {work}"
        );
        assert!(work < 0.0 && height > 100.0);
    }

    #[test]
    fn a_sled_that_steers_left_turns_left_and_is_pushed_there() {
        let source = &mut Source::new(5, "ride");
        let now = Now {
            v: 20.0,
            slip: [0.01, 0.01],
            load: [1900.0, 1900.0],
            air: 1.2,
            ..Now::default()
        };
        let push = push(&Sled::published(), &now, [1.0; 2], None);
        assert!(push.y > 0.0 && push.x < 0.0);
        let front = Now {
            slip: [0.01, 0.0],
            steer: 0.01,
            ..now
        };
        assert!(super::push(&Sled::published(), &front, [1.0; 2], None).turn > 0.0);
        let road = Road::draw("birke", source);
        let plan = Plan::draw(0.0, &mut Source::new(6, "driver"), source);
        let truths = way(&Sled::published(), &road, &plan, 10.0).ridden(None);
        // Where the road turns left the sled does.
        let turns = |truth: &Truth, place: f64| truth.rate[2] * road.at(place).turn[2];
        let mut s = 0.0;
        let mut agree = 0.0;
        for truth in &truths {
            agree += turns(truth, s);
            s += truth.v / RATE_HZ;
        }
        assert!(agree > 0.0);
    }
}
