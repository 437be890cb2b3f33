//! Cases made of runs.

use std::fmt::Write as _;

use crate::cases::answer::{Answer, Case, Hides};
use crate::cases::gliding::glide;
use crate::cases::label::Label;
use crate::residuals::signature::{Channels, Gauge};
use crate::world::campaign::{Campaign, Layout};
use crate::world::drive::{SAMPLE_S, Truth};
use crate::world::hidden::{Hidden, Kind, Place};
use crate::world::noise::Source;
use crate::world::sensors::{Noise, Sample};
use crate::world::sled::{Conditions, Sled};

/// Ways to build a campaign.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs)]
pub enum Recipe {
    White,
    Coloured,
    UnstatedNoise,
    Quiet,
    SessionDrift,
    Survey,
    Mistuned,
    WrongSurvey,
    Single(Kind),
    Late(Kind, u32),
    Pair(Kind, Kind),
    TiedHumidity,
    TwoSessions(Kind),
    NewTrack(Kind),
    Film,
    FilmOnOneTrack,
}

/// Cosine of two signatures from which on the data cannot tell the effects apart.
const SAME: f64 = 0.9;

/// Builds a campaign with what the recipe hides, and its answer.
pub fn build(label: &Label, recipe: Recipe, seed: u64) -> Case {
    let source = &mut Source::new(seed, &label.id());
    let case_seed = seed ^ ((source.uniform(0.0, 1.0) * 2f64.powi(52)) as u64) << 8;
    let mut layout = Layout::default();
    let mut noise = Noise::default();
    let mut mistuning = 0.03;
    let mut stated_survey_rad = layout.survey_sd_rad;
    let mut tolerated: Vec<String> = Vec::new();
    let mut kinds: Vec<Kind> = Vec::new();
    let mut state_noise = true;
    match recipe {
        Recipe::White => noise.colour = 0.0,
        Recipe::Coloured => noise.colour = 0.85,
        Recipe::UnstatedNoise => state_noise = false,
        Recipe::Quiet => noise = noise.times(0.25),
        Recipe::SessionDrift => layout.session_drift = 0.05,
        Recipe::Survey => {
            layout.survey_sd_rad = 0.002;
            stated_survey_rad = 0.002;
        }
        Recipe::Mistuned => mistuning = 0.2,
        Recipe::WrongSurvey => layout.survey_sd_rad = 5.0 * stated_survey_rad,
        Recipe::Single(kind) | Recipe::Late(kind, _) => kinds.push(kind),
        Recipe::Pair(a, b) => kinds.extend([a, b]),
        Recipe::TiedHumidity => {
            layout.humidity_tied = true;
            kinds.push(Kind::Temperature);
        }
        Recipe::TwoSessions(kind) => {
            layout.sessions = vec![0, 0];
            layout.runs_a_session = 6;
            kinds.push(kind);
        }
        Recipe::Film | Recipe::FilmOnOneTrack => {
            if recipe == Recipe::FilmOnOneTrack {
                layout.sessions = vec![0; 12];
            }
            // Better sensors, as stated in the model: the film's share of the friction is small.
            noise = noise.times(0.3);
            tolerated.extend(["load".to_owned(), "plowing".to_owned()]);
        }
        Recipe::NewTrack(kind) => {
            layout.tracks[2] = ("dorn", 560.0, 0.135);
            layout.sessions = vec![0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 2, 2];
            kinds.push(kind);
        }
    }
    if matches!(recipe, Recipe::Survey | Recipe::WrongSurvey) {
        // the survey is wrong in these, and saying so is true
        tolerated.extend(["track-profile".to_owned(), "slope".to_owned()]);
    }
    let stated_noise = match recipe {
        Recipe::Film | Recipe::FilmOnOneTrack => noise,
        _ => Noise::default(),
    };
    let mut sled = draw_sled(source);
    let mut campaign = Campaign::draw(&layout, case_seed);
    let film = matches!(recipe, Recipe::Film | Recipe::FilmOnOneTrack);
    let gauge =
        (film || !kinds.is_empty()).then(|| Gauge::new(&campaign, &sled, &noise, case_seed));
    let mut hidden = Vec::new();
    let mut hides = Vec::new();
    if let (true, Some(gauge)) = (film, &gauge) {
        hides = glide(&mut campaign, &mut sled, gauge, SAME);
    }
    for (kind, gauge) in kinds
        .into_iter()
        .zip(std::iter::repeat(gauge.as_ref()).flatten())
    {
        let size = match recipe {
            Recipe::Late(_, ms) => Size::Stated(1e-3 * f64::from(ms)),
            _ => Size::Share(label.share.unwrap_or(0.02)),
        };
        let (effect, answer) = hide(kind, size, gauge, &campaign, &layout, source);
        hidden.push(effect);
        hides.push(answer);
    }
    // An effect that makes the sled slide away is made smaller: nobody measures such runs.
    let truths = loop {
        let truths: Vec<Vec<Truth>> = (0..campaign.runs.len())
            .map(|k| campaign.truth(k, &sled, &hidden))
            .collect();
        let slip = |truth: &Truth| truth.velocity_mps[1].atan2(truth.velocity_mps[0]).abs();
        let slides = truths.iter().flatten().any(|t| slip(t) > 0.25);
        let Some(gauge) = gauge.as_ref().filter(|_| slides && !hidden.is_empty()) else {
            break truths;
        };
        for (effect, answer) in hidden.iter_mut().zip(&mut hides) {
            effect.size *= 0.7;
            answer.size = as_stated(effect.kind, effect.size);
            let channels = channels(effect.kind);
            answer.share = gauge.share(&gauge.signature(effect, channels));
        }
    };
    campaign.misjudge_tracks(&hidden);

    let mut files = Vec::new();
    let mut index = String::from("run,file,track,driver,driver_class,session,ice_c,air_c,air_pa\n");
    for (k, run) in campaign.runs.iter().enumerate() {
        let samples = campaign.recorded(k, &sled, &truths[k], &hidden, &noise, case_seed);
        let at = &run.at;
        let file = format!("{}.csv", run.name);
        let _ = writeln!(
            index,
            "{},{file},{},{},{},{},{},{},{}",
            run.name,
            at.track,
            run.driver,
            run.driver_class,
            run.session,
            at.ice_c,
            at.air_c,
            at.air_pa
        );
        files.push((file, run_file(&samples, at).into_bytes()));
    }
    for (k, track) in campaign.tracks.iter().enumerate() {
        let table = track.table(&|s| campaign.survey_error(k, s));
        files.push((format!("track_{}.csv", track.name), table.into_bytes()));
    }
    files.push(("runs.csv".to_owned(), index.into_bytes()));
    let stated = state_noise.then_some(&stated_noise);
    let model = model_file(&sled, &hidden, mistuning, stated_survey_rad, stated, source);
    files.push(("model.toml".to_owned(), model.into_bytes()));

    let base = [
        ("friction.longitudinal.mu", sled.mu),
        ("friction.front.mu_zeta", sled.front.mu_zeta),
        ("friction.front.k_n_per_rad", sled.front.k_n_per_rad),
        ("friction.rear.mu_zeta", sled.rear.mu_zeta),
        ("friction.rear.k_n_per_rad", sled.rear.k_n_per_rad),
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
            hides,
            tolerated,
            // one of two equivalent names states more than the data determine
            too_little_to_name: matches!(recipe, Recipe::TwoSessions(_)) || label.family == "twin",
            base: base.iter().map(|(k, v)| ((*k).to_owned(), *v)).collect(),
        },
    }
}

fn draw_sled(source: &mut Source) -> Sled {
    let mut sled = Sled::default();
    let mut about = |value: f64, spread: f64| value * (1.0 + source.uniform(-spread, spread));
    sled.mass_kg = about(sled.mass_kg, 0.03).round();
    sled.mu = about(sled.mu, 0.1);
    sled.front.k_n_per_rad = about(sled.front.k_n_per_rad, 0.1);
    sled.front.mu_zeta = about(sled.front.mu_zeta, 0.1);
    sled.rear.k_n_per_rad = about(sled.rear.k_n_per_rad, 0.1);
    sled.rear.mu_zeta = about(sled.rear.mu_zeta, 0.1);
    sled
}

/// The size in the sense in which a model states it: here tracks climb where their slope is
/// positive, a model's slopes fall.
fn as_stated(kind: Kind, size: f64) -> f64 {
    match kind {
        Kind::Slope | Kind::TrackProfile => -size,
        _ => size,
    }
}

/// The channels in which an effect shows.
fn channels(kind: Kind) -> Channels {
    if kind.entry().longitudinal {
        Channels::Longitudinal
    } else {
        Channels::Lateral
    }
}

/// How large an effect is to be.
#[derive(Clone, Copy)]
enum Size {
    /// This share of the noise's variance.
    Share(f64),
    /// As its law states it.
    Stated(f64),
}

/// Sizes an effect and writes down its answer.
fn hide(
    kind: Kind,
    size: Size,
    gauge: &Gauge,
    campaign: &Campaign,
    layout: &Layout,
    source: &mut Source,
) -> (Hidden, Hides) {
    let entry = kind.entry();
    let channels = channels(kind);
    let sign = if entry.both_signs { source.sign() } else { 1.0 };
    let mut effect = Hidden::new(kind, sign * entry.start);
    if matches!(
        kind,
        Kind::Asperities | Kind::GripPatch | Kind::WallContact | Kind::TrackProfile
    ) {
        let track = &campaign.tracks[0];
        let count = if kind == Kind::WallContact { 2 } else { 1 };
        for i in 0..count {
            let from = source.uniform(0.25 + 0.35 * f64::from(i), 0.5 + 0.35 * f64::from(i))
                * (track.length_m() - 60.0);
            let length = if kind == Kind::WallContact {
                source.uniform(8.0, 18.0)
            } else {
                source.uniform(35.0, 70.0)
            };
            effect.places.push(Place {
                track: track.name.clone(),
                from_m: from.round(),
                to_m: (from + length).round(),
            });
        }
    }
    let reached = match size {
        Size::Share(share) => gauge.scale(&mut effect, channels, share),
        Size::Stated(size) => {
            effect.size = size;
            gauge.share(&gauge.signature(&effect, channels))
        }
    };
    let mut class: Vec<String> = gauge
        .rivals(&effect, channels, SAME)
        .into_iter()
        .map(|(name, _)| name.to_owned())
        .collect();
    if layout.humidity_tied
        && kind == Kind::Temperature
        && !class.iter().any(|name| name == "humidity")
    {
        class.push("humidity".to_owned());
    }
    let answer = Hides {
        effect: entry.name.to_owned(),
        class,
        key: entry.key.to_owned(),
        size: as_stated(kind, effect.size),
        unit: entry.unit.to_owned(),
        share: reached,
        places: effect
            .places
            .iter()
            .map(|p| (p.track.clone(), p.from_m, p.to_m))
            .collect(),
    };
    (effect, answer)
}

fn run_file(samples: &[Sample], at: &Conditions) -> String {
    let mut text = String::with_capacity(samples.len() * 110);
    text.push_str("t_s,ax_mps2,ay_mps2,az_mps2,roll_rate_radps,pitch_rate_radps,yaw_rate_radps,v_mps,alpha_rad,delta_rad,gamma_rad,runner_c,humidity_pct,distance_m\n");
    for (i, s) in samples.iter().enumerate() {
        let [ax, ay, az] = s.accel_mps2;
        let [p, q, r] = s.rates_radps;
        let _ = writeln!(
            text,
            "{:.2},{ax:.4},{ay:.4},{az:.4},{p:.5},{q:.5},{r:.5},{:.4},{:.6},{:.6},{:.6},{:.3},{},{}",
            i as f64 * SAMPLE_S,
            s.v_mps,
            s.alpha_rad,
            s.delta_rad,
            s.gamma_rad,
            s.extra - 3.0,
            at.humidity_pct,
            at.worn_m
        );
    }
    text
}

/// The model file as the finder gets it: geometry as measured, friction somewhat off.
fn model_file(
    sled: &Sled,
    hidden: &[Hidden],
    mistuning: f64,
    survey_rad: f64,
    noise: Option<&Noise>,
    source: &mut Source,
) -> String {
    let wrong_mass: f64 = hidden
        .iter()
        .filter(|e| e.kind == Kind::Mass)
        .map(|e| e.size)
        .sum();
    let wrong_inertia: f64 = hidden
        .iter()
        .filter(|e| e.kind == Kind::YawInertia)
        .map(|e| 1.0 + e.size)
        .product();
    let mut sled = sled.clone();
    for effect in hidden.iter().filter(|e| e.kind == Kind::CgPlace) {
        sled.say_centre_back(effect.size);
    }
    let mut off = |value: f64| {
        let error = (mistuning * source.normal()).clamp(-2.0 * mistuning, 2.0 * mistuning);
        value * (1.0 + error)
    };
    let mut text = String::new();
    let [x, y, z] = sled.accel_m;
    let _ = write!(
        text,
        "[sled]\nmass_kg = {:.4}\nj_yy_kgm2 = {:?}\nj_zz_kgm2 = {:?}\nl_f_m = {:?}\nl_r_m = {:?}\n\
         accel_x_m = {x:?}\naccel_y_m = {y:?}\naccel_z_m = {z:?}\nslip_x_m = {:?}\ncda_m2 = {:?}\nyaw_drag_per_deg = {:?}\n\n\
         [friction.longitudinal]\nmu = {:.6}\n\n",
        sled.mass_kg - wrong_mass,
        sled.j_yy_kgm2,
        sled.j_zz_kgm2 / wrong_inertia,
        sled.l_f_m,
        sled.l_r_m,
        sled.slip_x_m,
        sled.cda_m2,
        sled.yaw_drag_per_deg,
        off(sled.mu)
    );
    for (name, law) in [("front", &sled.front), ("rear", &sled.rear)] {
        let _ = write!(
            text,
            "[friction.{name}]\nmu_zeta = {:.5}\nc = {:?}\ne = {:?}\nk_n_per_rad = {:.2}\n\n",
            off(law.mu_zeta),
            law.c,
            law.e,
            off(law.k_n_per_rad)
        );
    }
    let _ = write!(text, "[survey]\nslope_sd_rad = {survey_rad:?}\n");
    if let Some(n) = noise {
        let _ = write!(
            text,
            "\n[noise]\naccel_mps2 = {:?}\nrate_radps = {:?}\nspeed_mps = {:?}\nslip_rad = {:?}\nsteer_rad = {:?}\nroll_split_rad = {:?}\n",
            n.accel_mps2, n.rate_radps, n.speed_mps, n.slip_rad, n.steer_rad, n.roll_split_rad
        );
    }
    // The sensors of this world are where the model states, and none is late.
    text.push_str(
        "\n[tolerances]\ndelay_s = 0.0\nplace_m = 0.0\ngyro_scale = 0.0\ngyro_bias_radps = 0.0\naccel_scale = 0.0\n\
         accel_bias_mps2 = 0.0\nmass = 0.0\ninertia = 0.0\nsteer_scale = 0.0\nmisalignment_rad = 0.0\n\
         gyro_g_sensitivity_radps_per_mps2 = 0.0\nsession_offset_rad = 0.0\nlateral_form = 0.0\n",
    );
    text
}
