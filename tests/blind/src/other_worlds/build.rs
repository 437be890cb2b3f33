//! A campaign of a world, as files.

use super::files::{model_file, run_file, track_file};
use super::gauge::{Gauge, Start};
use super::hidden::{Acts, Effect, Hidden};
use super::plan::Plan;
use super::recorder::Recorder;
use super::ride::{RATE_HZ, Way};
use super::road::Road;
use super::runners::Sled;
use super::walls::Walls;
use super::wrong::{CHANNELS, World, Wrong};
use crate::cases::answer::{Answer, Case, Hides};
use crate::cases::label::Label;
use crate::world::noise::Source;

/// Longest run [s].
const SECONDS: f64 = 20.0;

/// Builds the campaign of a world, with an effect hidden in it or none.
pub fn build(world: World, effect: Option<Effect>, label: &Label, seed: u64) -> Case {
    let source = &mut Source::new(seed, &label.id());
    let wrong = Wrong::draw(world, source);
    let stated = stated_sled(source);
    let mut sled = stated;
    sled.inertia_kgm2 = [0, 1].map(|i| stated.inertia_kgm2[i] * wrong.inertia[i]);
    sled.centre_ahead(wrong.centre_m);
    let roads = ["eibe", "fichte"].map(|name| Road::draw(name, source));
    let mut hidden = effect.map(|effect| {
        let sign = if effect.both { source.sign() } else { 1.0 };
        let from = source.uniform(0.4, 0.7) * roads[0].length_m;
        Hidden {
            effect,
            size: sign * effect.size,
            place_m: [from.round(), (from + 15.0).round()],
            strength: 1.0,
        }
    });
    let walls = hidden.as_ref().and_then(|h| match h.effect.acts {
        Acts::Bumper(hits) => Some((Walls::draw(hits, &roads, source), h.size)),
        _ => None,
    });
    let places = match &walls {
        Some((walls, _)) => walls.stretches(&roads),
        None => Vec::new(),
    };
    let wanted = label.share.filter(|_| wrong.noise.is_none());
    let campaign = Campaign {
        wrong: &wrong,
        roads: &roads,
        walls,
        apart: wanted.map(|_| (seed, label.id())),
    };
    let mut gauge = Gauge {
        wrong: &wrong,
        sled: &sled,
        roads: &roads,
        starts: Vec::new(),
        seconds: SECONDS,
        seed,
    };
    let mut share = 0.0;
    if let (Some(share_wanted), Some(effect)) = (wanted, &mut hidden) {
        campaign.runs(&mut source.clone(), |start, _, _| gauge.starts.push(start));
        (*effect, share) = gauge.sized(effect, share_wanted);
        gauge.starts.clear();
    }
    let truth = hidden.as_ref().map_or(sled, |h| sled.with(h));
    let recorder = Recorder {
        sled: &truth,
        wrong: &wrong,
        fault: hidden.as_ref().and_then(Hidden::fault),
    };
    let mut files = Vec::new();
    let mut index = String::from("run,file,track,driver,driver_class,session,ice_c,air_c,air_pa\n");
    campaign.runs(source, |start, line, source| {
        let way = Way {
            sled: &truth,
            road: &roads[start.track],
            plan: &start.plan,
            rate_hz: RATE_HZ,
            seconds: SECONDS,
        };
        let hidden = hidden.as_ref().filter(|h| h.is_felt_on(start.track));
        let rows = recorder.record(&way.ridden(hidden), source);
        files.push((format!("{}.csv", start.name), run_file(&rows).into_bytes()));
        index.push_str(line);
        gauge.starts.push(start);
    });
    // Without noise nothing is a share of it.
    if let (None, Some(effect)) = (wanted, &hidden)
        && wrong.noise != Some(0.0)
    {
        share = gauge.share(effect);
    }
    if !wrong.bare {
        files.extend(roads.iter().map(|road| track_file(road, &wrong)));
    }
    files.push(("runs.csv".to_owned(), index.into_bytes()));
    files.push((
        "model.toml".to_owned(),
        model_file(&stated, &wrong, source).into_bytes(),
    ));
    let base = [
        ("friction.longitudinal.mu", truth.mu),
        ("friction.front.mu_zeta", truth.grip[0][0]),
        ("friction.front.k_n_per_rad", truth.grip[0][3]),
        ("friction.rear.mu_zeta", truth.grip[1][0]),
        ("friction.rear.k_n_per_rad", truth.grip[1][3]),
    ];
    Case {
        files,
        fresh: Vec::new(),
        answer: Answer {
            family: label.family.to_owned(),
            name: label.name.clone(),
            wanted_share: label.share,
            seed,
            data: "runs.csv".to_owned(),
            model: Some("model.toml".to_owned()),
            hides: hidden
                .iter()
                .map(|h| hides(h, share, roads[0].name, &places))
                .collect(),
            tolerated: [really_off(&wrong), wall_of_two_runs(&gauge.starts)].concat(),
            too_little_to_name: false,
            base: base.iter().map(|(k, v)| ((*k).to_owned(), *v)).collect(),
        },
    }
}

/// What every run of a campaign shares.
struct Campaign<'a> {
    wrong: &'a Wrong,
    roads: &'a [Road; 2],
    /// Walls that some runs hit, and the bumper's lever [m].
    walls: Option<(Walls, f64)>,
    /// Seed and name where each run has a stream of its own, so that runs can be drawn before it is
    /// known how large the effect is.
    apart: Option<(u64, String)>,
}

impl Campaign<'_> {
    /// Draws every run, and hands it over with its line of the index and the source that its noise
    /// comes from.
    fn runs(&self, source: &mut Source, mut each: impl FnMut(Start, &str, &mut Source)) {
        let [sessions, a_session] = self.wrong.runs;
        for session in 0..sessions {
            let track = session % 2;
            let ice_c = (10.0 * source.uniform(-14.0, -3.0)).round() / 10.0;
            let air_c = (10.0 * source.uniform(-6.0, 6.0)).round() / 10.0;
            let air_pa = source.uniform(91_000.0, 96_000.0).round();
            let factors = [(); 2].map(|()| 1.0 + self.wrong.session * source.normal());
            for run in 0..a_session {
                let name = format!("r{:02}", session * a_session + run + 1);
                let mut apart = self
                    .apart
                    .as_ref()
                    .map(|(seed, id)| Source::new(*seed, &format!("{id} {name}")));
                let source = apart.as_mut().unwrap_or(&mut *source);
                let driver = ["north", "south", "west"][(session + run) % 3];
                let own = &mut Source::new(9, &format!("{driver}{track}"));
                let mut plan = Plan::draw(self.wrong.line_m, own, source);
                plan.factors = factors;
                plan.ice_c = ice_c;
                plan.air = air_pa / (287.05 * (air_c + 273.15));
                let road = &self.roads[track];
                if source.uniform(0.0, 1.0) < self.wrong.wall {
                    let from = source.uniform(0.2, 0.8) * road.length_m;
                    let force = source.sign() * source.uniform(300.0, 1500.0);
                    plan.wall = Some([from, from + source.uniform(3.0, 10.0), force]);
                }
                if let Some((walls, lever_m)) = &self.walls {
                    let who = (session + run) % 3;
                    plan.bumps = walls.of_run(track, who, *lever_m, source);
                }
                let line = format!(
                    "{name},{name}.csv,{},{driver},all,{},{ice_c},{air_c},{air_pa}\n",
                    road.name,
                    session + 1
                );
                each(Start { name, track, plan }, &line, source);
            }
        }
    }
}

/// Names of what the world itself has wrong, which are no false claims in it: a sled that climbs
/// the banks feels another slope than the table's, a channel is late that lags three of the default
/// tolerance's deviations behind the middle of all, and so far a gyroscope's bias or scale is off.
fn really_off(wrong: &Wrong) -> Vec<String> {
    const LATE_S: f64 = 3.0 * 0.002;
    const BIAS_RADPS: f64 = 3.0 * 0.001;
    const SCALE: f64 = 3.0 * 0.005;
    const GYROS: [[&str; 2]; 3] = [
        ["roll-rate-bias", "roll-rate-scale"],
        ["pitch-rate-bias", "pitch-rate-scale"],
        ["yaw-rate-bias", "yaw-rate-scale"],
    ];
    const LAGS: [(usize, &str); 7] = [
        (3, "roll-rate-lag"),
        (4, "pitch-rate-lag"),
        (5, "yaw-rate-lag"),
        (6, "speed-lag"),
        (7, "slip-lag"),
        (8, "steer-lag"),
        (9, "roll-split-lag"),
    ];
    let mut names = if wrong.line_m > 0.0 {
        vec!["track-profile", "slope"]
    } else {
        Vec::new()
    };
    let mut sorted = wrong.delay_s;
    sorted.sort_by(f64::total_cmp);
    let middle = 0.5 * (sorted[CHANNELS / 2 - 1] + sorted[CHANNELS / 2]);
    let late = LAGS.iter().filter(|(channel, _)| {
        let behind = wrong.delay_s[*channel] - middle;
        behind.abs() > LATE_S
    });
    names.extend(late.map(|(_, name)| *name));
    for (axis, [bias, scale]) in GYROS.into_iter().enumerate() {
        let off = [
            (bias, wrong.gyro_bias_radps[axis].abs() > BIAS_RADPS),
            (scale, wrong.gyro_scale[axis].abs() > SCALE),
        ];
        names.extend(
            off.into_iter()
                .filter(|(_, off)| *off)
                .map(|(name, _)| name),
        );
    }
    names.into_iter().map(str::to_owned).collect()
}

/// A wall is really there where two runs of a track happen to meet theirs within a stretch of 15 m,
/// as long as a hidden one is.
fn wall_of_two_runs(starts: &[Start]) -> Vec<String> {
    const APART_M: f64 = 15.0;
    let middles = starts.iter().filter_map(|start| {
        let [from, to, _] = start.plan.wall?;
        Some((start.track, 0.5 * (from + to)))
    });
    let mut middles: Vec<(usize, f64)> = middles.collect();
    middles.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let close = |pair: &[(usize, f64)]| pair[0].0 == pair[1].0 && pair[1].1 - pair[0].1 < APART_M;
    if middles.windows(2).any(close) {
        vec!["wall-contact".to_owned()]
    } else {
        Vec::new()
    }
}

fn hides(hidden: &Hidden, share: f64, track: &str, walls: &[(String, f64, f64)]) -> Hides {
    let effect = &hidden.effect;
    let places = match effect.acts {
        Acts::Wall => vec![(track.to_owned(), hidden.place_m[0], hidden.place_m[1])],
        _ => walls.to_vec(),
    };
    Hides {
        effect: effect.name.to_owned(),
        class: effect.class.iter().map(|name| (*name).to_owned()).collect(),
        key: effect.key.to_owned(),
        size: hidden.size,
        unit: effect.unit.to_owned(),
        share,
        places,
    }
}

fn stated_sled(source: &mut Source) -> Sled {
    let mut about = |value: f64, spread: f64| value * (1.0 + source.uniform(-spread, spread));
    Sled {
        mass_kg: about(390.0, 0.03).round(),
        inertia_kgm2: [145.0, 150.0],
        axle_m: [0.82, 0.88],
        accel_m: [-0.35, 0.0, 0.12],
        slip_m: -0.60,
        drag: [0.28, 0.0694],
        mu: about(0.004, 0.1),
        grip: [
            [about(2.577, 0.1), 0.024, 0.99, about(10_522.0, 0.1)],
            [about(3.288, 0.1), 0.076, 0.99, about(49_776.0, 0.1)],
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::super::{EFFECTS, WORLDS};
    use super::*;

    #[test]
    fn the_same_seed_gives_the_same_files_and_none_says_what_is_hidden() {
        let label = Label {
            family: "few-effect",
            name: "speed-grip".to_owned(),
            share: None,
        };
        let [a, b] = [(); 2].map(|()| build(World::Few, Some(EFFECTS[5]), &label, 3));
        assert_eq!(a.files, b.files);
        for (name, bytes) in &a.files {
            let text = String::from_utf8_lossy(bytes);
            assert!(
                !text.contains("speed-grip") && !text.contains("few"),
                "{name}"
            );
        }
        assert_eq!(a.answer.hides[0].effect, "speed-grip");
    }

    #[test]
    fn a_lag_is_really_there_only_where_a_channel_is_late_beside_the_others() {
        let mut wrong = Wrong::draw(World::Clean, &mut Source::new(1, "w"));
        wrong.delay_s = [0.010; CHANNELS];
        assert!(really_off(&wrong).is_empty(), "one clock is no fault");
        wrong.delay_s[5] = 0.018;
        wrong.delay_s[7] = 0.015;
        assert_eq!(really_off(&wrong), ["yaw-rate-lag"]);
    }

    #[test]
    fn a_wall_is_there_where_two_runs_of_one_track_meet_it() {
        let starts = |walls: [Option<(usize, f64)>; 3]| -> Vec<Start> {
            let start = |wall: Option<(usize, f64)>| Start {
                name: "r".to_owned(),
                track: wall.map_or(0, |(track, _)| track),
                plan: Plan {
                    wall: wall.map(|(_, from)| [from, from + 6.0, 500.0]),
                    ..Plan::draw(
                        0.0,
                        &mut Source::new(4, "driver"),
                        &mut Source::new(3, "run"),
                    )
                },
            };
            walls.map(start).into()
        };
        let none = [Some((0, 200.0)), Some((1, 203.0)), Some((0, 300.0))];
        assert!(wall_of_two_runs(&starts(none)).is_empty());
        let one = [Some((0, 200.0)), None, Some((0, 209.0))];
        assert_eq!(wall_of_two_runs(&starts(one)), ["wall-contact"]);
    }

    #[test]
    fn worlds_are_wrong_in_their_own_way_only() {
        let clean = Wrong::draw(World::Clean, &mut Source::new(1, "w"));
        for world in WORLDS {
            let wrong = Wrong::draw(world, &mut Source::new(1, "w"));
            assert_eq!(wrong.delay_s != clean.delay_s, world == World::Delays);
            assert_eq!(wrong.gyro_scale != clean.gyro_scale, world == World::Gyros);
            assert_eq!(wrong.bare, world == World::Bare);
            assert_eq!(wrong.wall > 0.0, world == World::Walls);
        }
    }
}
