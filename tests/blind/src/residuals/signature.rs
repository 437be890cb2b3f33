//! How an effect would look in the residuals, how large it is against the noise, and which
//! other effects look the same.

use crate::residuals::inverse::{Residual, low_pass, residuals};
use crate::residuals::least_squares::{cosine, dot, project_out, variance};
use crate::residuals::sizing::{Wanted, sized};
use crate::world::campaign::Campaign;
use crate::world::drive::{SAMPLE_S, Truth};
use crate::world::hidden::{Hidden, Kind};
use crate::world::noise::Source;
use crate::world::sensors::{Lag, Noise, measure};
use crate::world::sled::{Sled, forces};

/// Low-pass before the residuals are compared: all channels but the speed's [Hz].
pub const CUTOFF_HZ: f64 = 20.0;
/// Low-pass of the speed's derivative [Hz].
pub const SPEED_CUTOFF_HZ: f64 = 5.0;
/// Every so many rows are compared.
pub const STRIDE: usize = 4;
/// Rows at both ends that belong to the filter.
pub const ENDS: usize = 20;

/// Residual channels that an effect is judged in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channels {
    /// `x_mps2` and `v_mps2`.
    Longitudinal,
    /// `y_mps2` and `yaw_radps2`.
    Lateral,
}

/// The undisturbed campaign (one run of each session) and its noise, ready to compare effects in.
#[derive(Debug)]
pub struct Gauge {
    campaign: Campaign,
    sled: Sled,
    runs: Vec<usize>,
    truths: Vec<Vec<Truth>>,
    clean: Vec<Vec<Residual>>,
    noise_sd: [f64; 4],
    base: [Vec<Vec<f64>>; 2],
}

impl Gauge {
    /// Drives the undisturbed runs and measures what the noise alone leaves in the residuals.
    pub fn new(campaign: &Campaign, sled: &Sled, noise: &Noise, seed: u64) -> Self {
        // one run a session, the first, the second, and so on, so that what changes from run to run
        // shows
        let sessions = campaign
            .runs
            .iter()
            .map(|run| run.session)
            .max()
            .unwrap_or(0);
        let runs: Vec<usize> = (1..=sessions)
            .filter_map(|session| {
                let of: Vec<usize> = (0..campaign.runs.len())
                    .filter(|&k| campaign.runs[k].session == session)
                    .collect();
                of.get(session % of.len().max(1)).copied()
            })
            .collect();
        let mut still = campaign.clone();
        for run in &mut still.runs {
            run.at.session_mu = 1.0;
            run.at.session_grip = 1.0;
        }
        let truths: Vec<Vec<Truth>> = runs.iter().map(|&k| still.truth(k, sled, &[])).collect();
        let mut gauge = Self {
            campaign: still,
            sled: sled.clone(),
            runs,
            truths,
            clean: Vec::new(),
            noise_sd: [1.0; 4],
            base: [Vec::new(), Vec::new()],
        };
        gauge.clean = gauge.recorded(sled, &Noise::none(), &[], seed);
        let noisy = gauge.recorded(sled, noise, &[], seed);
        let parts = gauge.channels(&noisy);
        gauge.noise_sd = [0, 1, 2, 3].map(|c| variance(&parts[c]).sqrt().max(1e-12));
        gauge.base = [Channels::Longitudinal, Channels::Lateral].map(|c| gauge.base_columns(c));
        gauge
    }

    /// Standard deviations that the noise alone leaves in `x, v, y, yaw`.
    pub fn noise_sd(&self) -> [f64; 4] {
        self.noise_sd
    }

    fn recorded(
        &self,
        stated: &Sled,
        noise: &Noise,
        hidden: &[Hidden],
        seed: u64,
    ) -> Vec<Vec<Residual>> {
        self.runs
            .iter()
            .zip(&self.truths)
            .map(|(&k, truths)| {
                let source = &mut Source::new(seed, &format!("gauge of run {k}"));
                let samples = measure(&self.sled, truths, noise, hidden, source);
                let slope = |s: f64| self.campaign.surveyed_slope(k, s);
                residuals(stated, &self.campaign.runs[k].at, &samples, &slope)
            })
            .collect()
    }

    /// Differences to the clean residuals by channel, low-passed and thinned.
    fn channels(&self, of: &[Vec<Residual>]) -> [Vec<f64>; 4] {
        let pick: [fn(&Residual) -> f64; 4] =
            [|r| r.x_mps2, |r| r.v_mps2, |r| r.y_mps2, |r| r.yaw_radps2];
        let cutoff = [CUTOFF_HZ, SPEED_CUTOFF_HZ, CUTOFF_HZ, CUTOFF_HZ];
        std::array::from_fn(|c| {
            let mut all = Vec::new();
            for (run, clean) in of.iter().zip(&self.clean) {
                let mut values: Vec<f64> = run
                    .iter()
                    .zip(clean)
                    .map(|(a, b)| pick[c](a) - pick[c](b))
                    .collect();
                low_pass(&mut values, cutoff[c]);
                let ends = ENDS.min(values.len() / 2);
                let inside = ends..values.len() - ends;
                all.extend(values[inside].iter().step_by(STRIDE));
            }
            all
        })
    }

    /// An effect's residuals, undisturbed motion, before any refit.
    fn raw(&self, effect: &Hidden) -> [Vec<f64>; 4] {
        match effect.kind {
            Kind::Mass => {
                let mut stated = self.sled.clone();
                stated.mass_kg -= effect.size;
                self.channels(&self.recorded(&stated, &Noise::none(), &[], 0))
            }
            Kind::YawInertia => {
                let mut stated = self.sled.clone();
                stated.j_zz_kgm2 /= 1.0 + effect.size;
                self.channels(&self.recorded(&stated, &Noise::none(), &[], 0))
            }
            Kind::CgPlace => {
                let mut stated = self.sled.clone();
                stated.say_centre_back(effect.size);
                self.channels(&self.recorded(&stated, &Noise::none(), &[], 0))
            }
            kind if kind.is_of_a_sensor() => self.channels(&self.recorded(
                &self.sled,
                &Noise::none(),
                std::slice::from_ref(effect),
                0,
            )),
            _ => self.channels(&self.forced(effect)),
        }
    }

    /// Residuals of an effect inside the forces or the survey, from the motion as it was.
    fn forced(&self, effect: &Hidden) -> Vec<Vec<Residual>> {
        let mut surveyed = self.campaign.clone();
        surveyed.misjudge_tracks(std::slice::from_ref(effect));
        let one = std::slice::from_ref(effect);
        self.runs
            .iter()
            .zip(self.truths.iter().zip(&self.clean))
            .map(|(&k, (truths, clean))| {
                let at = &self.campaign.runs[k].at;
                let mut front = Lag::new(effect.size);
                let mut rear = Lag::new(effect.size);
                truths
                    .iter()
                    .zip(clean)
                    .map(|(truth, clean)| {
                        let mut motion = truth.motion;
                        if effect.kind == Kind::RelaxationLength {
                            let step = motion.v_mps * SAMPLE_S;
                            motion.slip_f_rad = front.next(motion.slip_f_rad, step);
                            motion.slip_r_rad = rear.next(motion.slip_r_rad, step);
                        }
                        let with = forces(&self.sled, at, &motion, one);
                        let without = forces(&self.sled, at, &truth.motion, &[]);
                        let x = (with.x_n - without.x_n) / self.sled.mass_kg;
                        let slope = surveyed.surveyed_slope(k, motion.s_m)
                            - self.campaign.surveyed_slope(k, motion.s_m);
                        Residual {
                            x_mps2: clean.x_mps2 + x,
                            v_mps2: clean.v_mps2 + x + 9.81 * slope,
                            y_mps2: clean.y_mps2 + (with.y_n - without.y_n) / self.sled.mass_kg,
                            yaw_radps2: clean.yaw_radps2
                                + (with.yaw_nm - without.yaw_nm) / self.sled.j_zz_kgm2,
                        }
                    })
                    .collect()
            })
            .collect()
    }

    /// Stacks two channels, each in units of its noise.
    fn stack(&self, parts: &[Vec<f64>; 4], channels: Channels) -> Vec<f64> {
        let pair = match channels {
            Channels::Longitudinal => [0, 1],
            Channels::Lateral => [2, 3],
        };
        pair.iter()
            .flat_map(|&c| parts[c].iter().map(move |x| x / self.noise_sd[c]))
            .collect()
    }

    /// Residuals' derivatives to the base parameters that a refit may move.
    fn base_columns(&self, channels: Channels) -> Vec<Vec<f64>> {
        let changes: Vec<fn(&mut Sled)> = match channels {
            Channels::Longitudinal => vec![|s| s.mu *= 1.02],
            Channels::Lateral => vec![
                |s| s.front.mu_zeta *= 1.02,
                |s| s.front.k_n_per_rad *= 1.02,
                |s| s.rear.mu_zeta *= 1.02,
                |s| s.rear.k_n_per_rad *= 1.02,
            ],
        };
        changes
            .iter()
            .map(|change| {
                let mut sled = self.sled.clone();
                change(&mut sled);
                self.stack(
                    &self.channels(&self.recorded(&sled, &Noise::none(), &[], 0)),
                    channels,
                )
            })
            .collect()
    }

    fn base(&self, channels: Channels) -> &[Vec<f64>] {
        match channels {
            Channels::Longitudinal => &self.base[0],
            Channels::Lateral => &self.base[1],
        }
    }

    /// The runs that it compares effects in.
    pub fn runs(&self) -> &[usize] {
        &self.runs
    }

    /// An effect's stacked residuals before a base refit, each channel in units of its noise.
    pub fn unfitted(&self, effect: &Hidden, channels: Channels) -> Vec<f64> {
        self.stack(&self.raw(effect), channels)
    }

    /// An effect's signature: its stacked residuals less what a base refit takes away.
    pub fn signature(&self, effect: &Hidden, channels: Channels) -> Vec<f64> {
        project_out(self.base(channels), &self.unfitted(effect, channels))
    }

    /// Its share: variance over the noise variance, in the channel where that is larger.
    pub fn share(&self, signature: &[f64]) -> f64 {
        let (a, b) = signature.split_at(signature.len() / 2);
        let mean_square = |x: &[f64]| dot(x, x) / x.len().max(1) as f64;
        mean_square(a).max(mean_square(b))
    }

    /// Scales an effect to a share of the noise variance, within its plausible limit.
    pub fn scale(&self, effect: &mut Hidden, channels: Channels, share: f64) -> f64 {
        let wanted = Wanted {
            share,
            within: 0.02,
            bounds: [0.0, effect.kind.entry().limit],
        };
        let sign = effect.size.signum();
        let (size, reached) = sized(effect.size.abs(), 2.0, wanted, |size| {
            effect.size = sign * size;
            self.share(&self.signature(effect, channels))
        });
        effect.size = sign * size;
        reached
    }

    /// Names whose signature has a cosine of at least `above` (in size) with the effect's.
    pub fn rivals(
        &self,
        effect: &Hidden,
        channels: Channels,
        above: f64,
    ) -> Vec<(&'static str, f64)> {
        let own = self.signature(effect, channels);
        let base = self.base(channels);
        let longitudinal = channels == Channels::Longitudinal;
        let mut found: Vec<(&'static str, f64)> = crate::world::hidden::ENTRIES
            .iter()
            .filter(|entry| entry.longitudinal == longitudinal && entry.kind != effect.kind)
            .filter(|entry| !entry.name.starts_with("unknown"))
            .filter(|entry| {
                !matches!(
                    entry.kind,
                    Kind::Asperities | Kind::GripPatch | Kind::WallContact | Kind::TrackProfile
                )
            })
            .map(|entry| {
                let raw = self.unfitted(&Hidden::new(entry.kind, entry.start), channels);
                (entry.name, cosine(&own, &project_out(base, &raw)))
            })
            .filter(|(_, c)| c.abs() >= above)
            .collect();
        found.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
        found
    }
}
