//! A campaign: what is drawn for it, and its runs.

use super::faults::{Faults, Session};
use super::hidden::{Acts, Hidden, Secret};
use super::recorder::{Recorder, Row};
use super::ride::{Driver, Plan, Ride};
use super::sled::Sled;
use super::track::Track;
use crate::world::noise::{Smooth, Source};
use crate::world::sled::Conditions;

/// Longest run [s].
const SECONDS: f64 = 60.0;
/// Fresh runs, all of one session that is not among the data.
const FRESH_RUNS: usize = 4;

/// Everything that is drawn for a campaign before what is hidden.
#[derive(Debug, Clone)]
pub struct Campaign {
    /// What is wrong with it.
    pub faults: Faults,
    /// The true sled.
    pub sled: Sled,
    /// Two tracks.
    pub tracks: [Track; 2],
    /// Error of the surveyed slope of each.
    pub survey: [Smooth; 2],
    /// Warm stretch of each: from, to [m].
    warm_m: [[f64; 2]; 2],
    /// Sessions; the last one is that of the fresh runs.
    pub sessions: Vec<Session>,
    /// Runs of all sessions, in order.
    pub runs: Vec<Run>,
    seed: u64,
    id: String,
}

/// Who drove when and where.
#[derive(Debug, Clone)]
pub struct Run {
    /// Its name.
    pub name: String,
    /// Place of its session.
    pub session: usize,
    /// Place within the session.
    pub order: usize,
    /// Place of its track.
    pub track: usize,
    /// Driver.
    pub driver: &'static str,
}

impl Campaign {
    /// Draws a campaign; `scale` is that of the faults, all else is the same at every scale.
    pub fn draw(scale: f64, seed: u64, id: &str) -> Self {
        let source = &mut Source::new(seed, &format!("{id} campaign"));
        let tracks = ["alder", "birch"].map(|name| Track::draw(name, source));
        let warm_m = [0, 1].map(|k: usize| {
            let from = source.uniform(0.3, 0.6) * tracks[k].length_m;
            [from, from + source.uniform(40.0, 80.0)]
        });
        let survey = [(); 2].map(|()| Smooth::new(1e-3 * scale, 0.004, 0.02, source));
        let count = 4 + (5.0 * source.uniform(0.0, 1.0)) as usize;
        let frosty = (count as f64 * source.uniform(0.0, 1.0)) as usize;
        let mut sessions = Vec::new();
        let mut runs = Vec::new();
        for session in 0..=count {
            sessions.push(Session::draw(scale, session == frosty, source));
            let of = match session == count {
                true => FRESH_RUNS,
                false => 2 + (4.0 * source.uniform(0.0, 1.0)) as usize,
            };
            runs.extend((0..of).map(|order| Run {
                name: format!("s{:02}r{}", session + 1, order + 1),
                session,
                order,
                track: if session == count {
                    order % 2
                } else {
                    session % 2
                },
                driver: ["east", "north", "west"][(session + order) % 3],
            }));
        }
        let (faults, sled) = Faults::draw(scale, &mut Source::new(seed, &format!("{id} faults")));
        Self {
            faults,
            sled,
            tracks,
            survey,
            warm_m,
            sessions,
            runs,
            seed,
            id: id.to_owned(),
        }
    }

    /// Where a wall would be, on the first track: from, to [m].
    pub fn wall_m(&self) -> [f64; 2] {
        let from = (0.45 * self.tracks[0].length_m).round();
        [from, from + 15.0]
    }

    /// Air of a run.
    pub fn conditions(&self, run: &Run) -> Conditions {
        let [air_c, air_pa] = self.sessions[run.session].air;
        Conditions {
            air_c,
            air_pa,
            ..Conditions::default()
        }
    }

    /// Surveyed slope, downhill positive [rad].
    pub fn surveyed(&self, run: &Run, s: f64) -> f64 {
        self.tracks[run.track].at(s).fall + self.survey[run.track].at(s)
    }

    /// Draws a run, and the sled with the crew as it sits in it.
    fn plan(&self, run: &Run) -> (Plan, Sled) {
        let c = self.faults.scale;
        let source = &mut Source::new(self.seed, &format!("{} {}", self.id, run.name));
        let own = &mut Source::new(self.seed, &format!("{} snow {}", self.id, run.session));
        let session = &self.sessions[run.session];
        let track = &self.tracks[run.track];
        let frost = 1.0 + session.frost * (-(run.order as f64) / 1.5).exp();
        let [from, to] = self.warm_m[run.track];
        let mut sled = self.sled;
        sled.centre_ahead(0.01 * c * source.normal());
        let plan = Plan {
            driver: Driver::Follows(Smooth::new(0.002 * (1.0 + c), 0.15, 1.4, source)),
            start_mps: 10.5 + 0.4 * source.normal(),
            air: self.conditions(run).air_density(),
            wind_mps: session.wind_mps,
            gusts: Some(Smooth::new(c, 0.05, 0.5, source)),
            ice_c: session.ice_c[0] + 0.4 * run.order as f64,
            ice_along: Some(Smooth::new(1.0, 0.002, 0.01, own)),
            ice_per_k: self.faults.ice_per_k,
            factors: [session.factors[0] * frost, session.factors[1]],
            warm: [from, to, 0.1 * c, 0.05 * c],
            brake: [track.length_m - 40.0, 400.0 * c],
            left_m: 0.01 * c * source.normal(),
            runner_c: Some(Smooth::new(1.0, 0.03, 0.4, source)),
            snow: Some(Smooth::new(1.0, 0.01, 0.05, own)),
            chips_s: [(); 4].map(|()| source.uniform(2.0, 26.0)),
            has_wall: run.track == 0,
        };
        (plan, sled)
    }

    /// Drives and records a run.
    pub fn record(&self, run: &Run, secret: &Secret, rate_hz: f64, noisy: bool) -> Vec<Row> {
        let (plan, sled) = self.plan(run);
        let sled = altered(&sled, secret);
        let ride = Ride {
            sled: &sled,
            track: &self.tracks[run.track],
            plan: &plan,
            secret,
            rate_hz,
        };
        let recorder = Recorder {
            sled: &sled,
            faults: &self.faults,
            secret,
            rate_hz,
        };
        let source = &mut Source::new(self.seed, &format!("{} noise {}", self.id, run.name));
        let session = &self.sessions[run.session];
        recorder.record(&ride.ridden(SECONDS), session, noisy.then_some(source))
    }

    /// The model that the finder gets: the weighed sled with one track and friction that is a
    /// little off; and the true friction, `mu`, stiffness [N/rad] and `mu_zeta` of the axles.
    pub fn stated(&self) -> (f64, [[f64; 2]; 2]) {
        let off = self.faults.stated.map(|error| 1.0 + error);
        let [front, rear] = self.sled.one_track();
        let lateral = [
            [front[0] * off[1], front[1] * off[2]],
            [rear[0] * off[3], rear[1] * off[4]],
        ];
        (self.sled.mu * off[0], lateral)
    }
}

/// The sled as what is hidden makes it.
fn altered(sled: &Sled, secret: &Secret) -> Sled {
    let mut sled = *sled;
    sled.mass_kg += secret.of(Acts::Mass);
    sled.j_zz_kgm2 *= 1.0 + secret.of(Acts::YawInertia);
    sled.centre_ahead(secret.of(Acts::Centre));
    sled
}

impl Hidden {
    /// Stretches as answers have them.
    pub fn places(&self, campaign: &Campaign) -> Vec<(String, f64, f64)> {
        let [from, to] = self.place_m;
        match self.effect.acts {
            Acts::Wall => vec![(campaign.tracks[0].name.to_owned(), from, to)],
            _ => Vec::new(),
        }
    }
}
