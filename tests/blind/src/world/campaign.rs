//! A campaign: tracks, sessions and runs, driven and recorded.

use crate::world::drive::{Plan, Truth, drive};
use crate::world::hidden::{Hidden, Kind};
use crate::world::noise::{Smooth, Source};
use crate::world::sensors::{Noise, Sample, measure};
use crate::world::sled::{Conditions, Sled};
use crate::world::track::Track;

/// How large a campaign is and what varies in it without a cause.
#[derive(Debug, Clone)]
pub struct Layout {
    /// Track lengths and grades.
    pub tracks: Vec<(&'static str, f64, f64)>,
    /// Track of each session.
    pub sessions: Vec<usize>,
    /// Runs in each session.
    pub runs_a_session: usize,
    /// Longest duration of a run [s].
    pub duration_s: f64,
    /// Relative standard deviation of unexplained session factors on friction and grip.
    pub session_drift: f64,
    /// True error of the surveyed slope profile, a standard deviation [rad].
    pub survey_sd_rad: f64,
    /// Whether humidity follows the ice temperature exactly.
    pub humidity_tied: bool,
    /// Whether later sessions are always colder.
    pub cooling: bool,
}

impl Default for Layout {
    fn default() -> Self {
        Self {
            tracks: vec![
                ("aalen", 520.0, 0.105),
                ("birk", 480.0, 0.115),
                ("curd", 500.0, 0.095),
            ],
            sessions: vec![0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2],
            runs_a_session: 3,
            duration_s: 22.0,
            session_drift: 0.0,
            survey_sd_rad: 0.0008,
            humidity_tied: false,
            cooling: false,
        }
    }
}

/// One run of a campaign.
#[derive(Debug, Clone)]
pub struct Run {
    /// Its name.
    pub name: String,
    /// Session, counted from 1.
    pub session: usize,
    /// Index of its track.
    pub track: usize,
    /// Driver's name.
    pub driver: &'static str,
    /// Driver's class.
    pub driver_class: &'static str,
    /// Ice and air.
    pub at: Conditions,
    /// What was drawn for its course.
    pub plan: Plan,
}

/// A campaign before it is driven.
#[derive(Debug, Clone)]
pub struct Campaign {
    /// The tracks.
    pub tracks: Vec<Track>,
    /// Errors of their surveyed slope [rad].
    pub survey: Vec<Smooth>,
    /// Constant errors of their surveyed slope [rad].
    pub survey_offset_rad: f64,
    /// Errors of the surveyed slope on stretches of track.
    pub survey_patches: Vec<Hidden>,
    /// The runs, in the order they were made.
    pub runs: Vec<Run>,
}

const DRIVERS: [(&str, &str, f64); 4] = [
    ("A1", "top", 0.8),
    ("A2", "top", 0.9),
    ("B1", "advanced", 1.1),
    ("C1", "junior", 1.4),
];

impl Campaign {
    /// Draws tracks, weather and drivers.
    pub fn draw(layout: &Layout, seed: u64) -> Self {
        let source = &mut Source::new(seed, "campaign");
        let tracks: Vec<Track> = layout
            .tracks
            .iter()
            .map(|(name, length, grade)| Track::draw(name, *length, *grade, source))
            .collect();
        let survey = tracks
            .iter()
            .map(|_| Smooth::new(layout.survey_sd_rad, 0.004, 0.03, source))
            .collect();
        let mut runs = Vec::new();
        for (index, &track) in layout.sessions.iter().enumerate() {
            let ice_c = if layout.cooling {
                -2.0 - 1.2 * index as f64
            } else {
                source.uniform(-12.0, -1.5)
            };
            let humidity = source.uniform(45.0, 95.0);
            let base = Conditions {
                track: tracks[track].name.clone(),
                ice_c: round(ice_c, 2),
                air_c: round(ice_c + source.uniform(0.5, 7.0), 2),
                air_pa: round(source.uniform(91_500.0, 97_500.0), 0),
                humidity_pct: round(
                    if layout.humidity_tied {
                        70.0 + 3.0 * (ice_c + 5.0)
                    } else {
                        humidity
                    },
                    2,
                ),
                worn_m: 0.0,
                session_mu: 1.0 + layout.session_drift * source.normal(),
                session_grip: 1.0 + layout.session_drift * source.normal(),
                glide: None,
            };
            for turn in 0..layout.runs_a_session {
                let (driver, driver_class, skill) = DRIVERS[(turn + index) % DRIVERS.len()];
                let mut at = base.clone();
                at.worn_m = turn as f64 * tracks[track].length_m();
                at.ice_c = round(at.ice_c + 0.15 * source.normal(), 2);
                at.air_c = round(at.air_c + 0.3 * source.normal(), 2);
                runs.push(Run {
                    name: format!("s{:02}r{}", index + 1, turn + 1),
                    session: index + 1,
                    track,
                    driver,
                    driver_class,
                    at,
                    plan: Plan::draw(layout.duration_s, skill, source),
                });
            }
        }
        Self {
            tracks,
            survey,
            survey_offset_rad: 0.0,
            survey_patches: Vec::new(),
            runs,
        }
    }

    /// Drives one run.
    pub fn truth(&self, index: usize, sled: &Sled, hidden: &[Hidden]) -> Vec<Truth> {
        let run = &self.runs[index];
        drive(sled, &self.tracks[run.track], &run.at, &run.plan, hidden)
    }

    /// Drives and records one run.
    pub fn record(
        &self,
        index: usize,
        sled: &Sled,
        hidden: &[Hidden],
        noise: &Noise,
        seed: u64,
    ) -> Vec<Sample> {
        let truths = self.truth(index, sled, hidden);
        self.recorded(index, sled, &truths, hidden, noise, seed)
    }

    /// Records a run that was driven.
    pub fn recorded(
        &self,
        index: usize,
        sled: &Sled,
        truths: &[Truth],
        hidden: &[Hidden],
        noise: &Noise,
        seed: u64,
    ) -> Vec<Sample> {
        let source = &mut Source::new(seed, &format!("sensors of run {index}"));
        measure(sled, truths, noise, hidden, source)
    }

    /// Error of a track's surveyed slope at a distance [rad].
    pub fn survey_error(&self, track: usize, s_m: f64) -> f64 {
        let name = &self.tracks[track].name;
        let patches: f64 = self
            .survey_patches
            .iter()
            .map(|p| p.size * p.inside(name, s_m))
            .sum();
        // a surveyed slope that is too low by an effect's size leaves a true slope of survey + size
        self.survey[track].at(s_m) - self.survey_offset_rad - patches
    }

    /// Surveyed slope of a run's track at a distance [rad].
    pub fn surveyed_slope(&self, index: usize, s_m: f64) -> f64 {
        let track = self.runs[index].track;
        let table = &self.tracks[track];
        table.at(&table.slope_rad, s_m) + self.survey_error(track, s_m)
    }

    /// Applies the hidden effects that live in the survey rather than in the sled.
    pub fn misjudge_tracks(&mut self, hidden: &[Hidden]) {
        for effect in hidden {
            match effect.kind {
                Kind::Slope => self.survey_offset_rad += effect.size,
                Kind::TrackProfile => self.survey_patches.push(effect.clone()),
                _ => {}
            }
        }
    }
}

fn round(value: f64, digits: i32) -> f64 {
    let scale = 10f64.powi(digits);
    (value * scale).round() / scale
}
