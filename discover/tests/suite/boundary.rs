//! Friction of a melt film with a hidden part of boundary contact, from a second solution of the film's equations.

use std::f64::consts::{PI, SQRT_2};
use std::fmt::Write as _;

use kufe_discover::{Options, Report, Verdict, discover};
use kufe_sled::Model;
use kufe_sled::friction::LongitudinalKeys;
use kufe_sled::friction::film::Patch;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Shear stress of the hidden boundary contact [Pa].
const SHEAR: f64 = 60e3;
/// Relative standard deviation of a measured coefficient.
const SCATTER: f64 = 0.04;

/// A slider and the ice under it.
struct Experiment {
    length_m: f64,
    width_m: f64,
    roughness_m: f64,
    fz_n: f64,
    v_mps: f64,
    ice_c: f64,
}

/// Complementary error function to 1.5e-7 (M. Abramowitz, I.A. Stegun, Handbook of Mathematical Functions, 7.1.26).
fn erfc(x: f64) -> f64 {
    let t = 1.0 / (1.0 + 0.3275911 * x);
    let sum = [
        1.061405429,
        -1.453152027,
        1.421413741,
        -0.284496736,
        0.254829592,
    ]
    .iter()
    .fold(0.0, |sum, a| (sum + a) * t);
    sum * (-x * x).exp()
}

/// mu of the film on a rectangle by implicit Euler steps in u = sqrt(xi), each solved by bisection:
///
/// ```text
/// tau = eta V/h + tau_b erfc(h/(sigma sqrt 2))
/// dh/du = (4 u/V) ((tau V - q_i - q_s)/(rho_w L) - p h^3/(eta w^2))
/// q_i = k_i (T_m - T) sqrt(V/(pi kappa))/u,   q_s = (T_m - T) sqrt(k_s c_s/(pi 10 s))
/// ```
fn friction(of: &Experiment, shear: f64) -> f64 {
    const STEPS: usize = 1500;
    const ETA: f64 = 1.79e-3;
    const MELT: f64 = 999.8 * 3.34e5;
    let (v, p) = (of.v_mps, of.fz_n / (of.length_m * of.width_m));
    let warmer = -7.4e-8 * p - of.ice_c;
    let into_ice = 2.2 * warmer * (v * 917.0 * 2050.0 / (PI * 2.2)).sqrt();
    let into_steel = warmer * (45.0 * 3.6e6 / (PI * 10.0)).sqrt();
    let step = of.length_m.sqrt() / STEPS as f64;
    let stress = |h: f64| ETA * v / h + shear * erfc(h / (of.roughness_m * SQRT_2));
    let (mut h, mut drag) = (0.0, 0.0);
    for n in 1..=STEPS {
        let u = n as f64 * step;
        let next = |end: f64| {
            let melted = (stress(end) * v - into_ice / u - into_steel) / MELT;
            h + step * 4.0 * u / v * (melted - p * end.powi(3) / (ETA * of.width_m.powi(2)))
        };
        let (mut low, mut high) = (0.0, 1e-4);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            match next(middle) > middle {
                true => low = middle,
                false => high = middle,
            }
        }
        h = 0.5 * (low + high);
        drag += stress(h) * of.width_m * 2.0 * u * step;
    }
    drag / of.fz_n
}

/// Eight sliders in each of eight sessions, at speeds of 1 to 25 m/s.
fn draw(random: &mut ChaCha8Rng) -> Vec<(usize, usize, Experiment)> {
    let mut rows = Vec::new();
    let roughness = [0.3e-6, 0.5e-6, 0.8e-6, 0.4e-6];
    for session in 0..8 {
        let ice_c = random.random_range(-12.0..-3.0);
        for slider in 0..8 {
            let fz_n = random.random_range(300.0..1200.0);
            let (length_m, pressure) =
                (0.03 + 0.008 * slider as f64, random.random_range(6e6..15e6));
            let experiment = Experiment {
                length_m,
                width_m: fz_n / (length_m * pressure),
                roughness_m: roughness[slider % roughness.len()],
                fz_n,
                v_mps: 25f64.powf(random.random_range(0.0..1.0)),
                ice_c,
            };
            rows.push((session, slider, experiment));
        }
    }
    rows
}

fn table(shear: f64, seed: u64) -> String {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut text = String::from(
        "specimen,session,p_max_pa,p_max_sd_pa,mu,mu_sd,fz_n,v_mps,ice_c,contact_length_m,contact_width_m,roughness_m\n",
    );
    for (session, slider, of) in draw(&mut random) {
        let mu = friction(&of, shear);
        let noise: f64 = StandardNormal.sample(&mut random);
        let pressure = of.fz_n / (of.length_m * of.width_m);
        let _ = writeln!(
            text,
            "s{slider},{session},{pressure:.0},0,{:.7},{:.7},{:.1},{:.4},{:.3},{:.6},{:.8},{}",
            mu * (1.0 + SCATTER * noise),
            SCATTER * mu,
            of.fz_n,
            of.v_mps,
            of.ice_c,
            of.length_m,
            of.width_m,
            of.roughness_m
        );
    }
    text
}

fn model() -> Model {
    let mut model = Model::published();
    model.friction.longitudinal = LongitudinalKeys {
        film: Some(true),
        ..LongitudinalKeys::default()
    };
    model
}

fn searched(shear: f64, seed: u64) -> (Report, Model) {
    let folder = tempfile::tempdir().unwrap();
    let [data, file] = ["experiments.csv", "model.toml"].map(|name| folder.path().join(name));
    std::fs::write(&data, table(shear, seed)).unwrap();
    std::fs::write(&file, model().to_toml()).unwrap();
    let options = Options {
        seed,
        ..Options::default()
    };
    let found = discover(&data, Some(&file), &options, &|_| {}).unwrap();
    let next = Model::from_toml(found.next_model.as_deref().unwrap(), "model.next.toml").unwrap();
    println!("{}", found.report.sentence);
    (found.report, next)
}

#[test]
fn the_second_solution_is_that_of_the_film() {
    let mut random = ChaCha8Rng::seed_from_u64(9);
    for (_, _, of) in draw(&mut random).iter().take(16) {
        let patch = Patch {
            length: of.length_m,
            width: of.width_m,
            roughness: of.roughness_m,
        };
        for shear in [0.0, SHEAR] {
            let first = patch.friction(of.fz_n, of.v_mps, of.ice_c, shear).unwrap();
            let error = friction(of, shear) / first - 1.0;
            assert!(error.abs() < 3e-3, "{error}");
        }
    }
}

#[test]
fn a_hidden_boundary_share_is_named_with_its_shear_stress() {
    let (mut named, mut covered) = (0, 0);
    for seed in 1..=8 {
        let (report, next) = searched(SHEAR, seed);
        let first = report.steps.first().unwrap_or_else(|| panic!("{report:?}"));
        assert!(
            first.class.iter().any(|name| name == "boundary"),
            "{report:?}"
        );
        assert!(report.held_out.gap_after < report.held_out.gap_before);
        if first.effect != "boundary" {
            continue;
        }
        named += 1;
        let shear = &first.parameters[0];
        covered += usize::from((shear.low..=shear.high).contains(&SHEAR));
        let written = next.effects["boundary"]["shear_pa"].as_float().unwrap();
        assert_eq!(written, shear.value);
    }
    // A 95 % interval misses one in twenty.
    assert!(named == 8 && covered >= 7, "{named}, {covered}");
}

#[test]
fn a_table_without_the_contact_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let [data, file] = ["experiments.csv", "model.toml"].map(|name| folder.path().join(name));
    let text = table(0.0, 1).replace("contact_width_m", "width_m");
    std::fs::write(&data, text).unwrap();
    std::fs::write(&file, model().to_toml()).unwrap();
    let refused = discover(&data, Some(&file), &Options::default(), &|_| {}).err();
    let reported = refused.unwrap().to_string();
    assert!(
        reported.contains("experiments.csv") && reported.contains("column `contact_width_m`"),
        "{reported}"
    );
}

#[test]
fn the_film_alone_has_nothing_to_find() {
    for seed in 11..=18 {
        let (report, next) = searched(0.0, seed);
        assert_eq!(report.verdict, Verdict::None, "{report:?}");
        let zeta = next.friction.longitudinal.zeta.unwrap();
        assert!((zeta - 1.0).abs() < 0.03, "{zeta}");
    }
}
