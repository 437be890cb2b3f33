//! The lateral fit on samples drawn from a known model.

use kufe_sled::friction::{Interval, LateralFitOptions, LateralSample, MagicFormula, fit_lateral};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

fn covers(interval: Interval, truth: f64) -> bool {
    let high = interval.high.unwrap_or(f64::INFINITY);
    (interval.low.unwrap()..=high).contains(&truth)
}

/// Runs with slowly varying slip and load. The force error and the slip noise are Gaussian; the
/// force error is correlated in time.
struct Track {
    runs: u32,
    samples: usize,
    slip_rms: f64,
    slip_sd: f64,
    force_sd: f64,
}

impl Track {
    fn drive(&self, truth: &MagicFormula, seed: u64) -> Vec<LateralSample> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = move || -> f64 { StandardNormal.sample(&mut rng) };
        let mut out = Vec::new();
        for cluster in 0..self.runs {
            let (mut slip, mut load, mut error) = (normal(), normal(), normal());
            let level = 0.3 * self.force_sd * normal();
            for _ in 0..self.samples {
                // Correlation times of 0.2 s, 0.5 s and 0.1 s at 100 Hz.
                let walk = |state: f64, keep: f64, kick: f64| {
                    keep * state + (1.0 - keep * keep).sqrt() * kick
                };
                slip = walk(slip, 0.95, normal());
                load = walk(load, 0.98, normal());
                error = walk(error, 0.90, normal());
                let fz = (2500.0 + 1000.0 * load).max(150.0);
                let alpha = self.slip_rms * slip;
                out.push(LateralSample {
                    alpha: alpha + self.slip_sd * normal(),
                    fz,
                    fy: truth.force(alpha, fz) + level + self.force_sd * error,
                    cluster,
                });
            }
        }
        out
    }
}

#[test]
fn exact_data_recover_the_parameters() {
    for truth in [MagicFormula::PUBLISHED_FRONT, MagicFormula::PUBLISHED_REAR] {
        let track = Track {
            runs: 4,
            samples: 500,
            slip_rms: 0.02,
            slip_sd: 0.0,
            force_sd: 0.0,
        };
        let options = LateralFitOptions {
            c: truth.c,
            ..Default::default()
        };
        let fit = fit_lateral(&track.drive(&truth, 1), &options).expect("fits");
        assert!((fit.k_n_per_rad.value / truth.k_n_per_rad - 1.0).abs() < 1e-5);
        assert!((fit.mu_zeta_c.value / truth.mu_zeta_c() - 1.0).abs() < 1e-5);
    }
}

#[test]
#[ignore = "slow study: .ci/slow"]
fn corrected_intervals_cover_the_truth_where_least_squares_is_biased() {
    let cases = [
        (MagicFormula::PUBLISHED_FRONT, 0.006),
        (MagicFormula::PUBLISHED_REAR, 0.004),
    ];
    for (truth, slip_rms) in cases {
        let track = Track {
            runs: 12,
            samples: 1500,
            slip_rms,
            slip_sd: 0.0015,
            force_sd: 25.0,
        };
        let options = LateralFitOptions {
            slip_sd: track.slip_sd,
            ..Default::default()
        };
        let seeds = 40;
        let (mut k, mut p, mut uncorrected) = (0, 0, 0);
        let (mut mean, mut mean_uncorrected) = (0.0, 0.0);
        for seed in 0..seeds {
            let samples = track.drive(&truth, seed);
            let fit = fit_lateral(&samples, &options).expect("fits");
            assert!(fit.c_held && fit.mu_zeta_c_determined && fit.clusters == 12);
            k += u32::from(covers(fit.k_n_per_rad, truth.k_n_per_rad));
            p += u32::from(covers(fit.mu_zeta_c, truth.mu_zeta_c()));
            mean += (fit.k_n_per_rad.value / truth.k_n_per_rad).ln() / seeds as f64;
            let naive = fit_lateral(&samples, &LateralFitOptions::default()).expect("fits");
            uncorrected += u32::from(covers(naive.k_n_per_rad, truth.k_n_per_rad));
            mean_uncorrected += (naive.k_n_per_rad.value / truth.k_n_per_rad).ln() / seeds as f64;
        }
        println!(
            "covered of {seeds}: K {k}, P {p}, K uncorrected {uncorrected}; mean ln ratio {mean:.4}, uncorrected {mean_uncorrected:.4}"
        );
        assert!(k >= 36 && p >= 36, "covered {k} and {p} of {seeds}");
        assert!(mean.abs() < 0.01, "bias {mean}");
        assert!(
            uncorrected <= 8 && mean_uncorrected < -0.05,
            "uncorrected covers {uncorrected}, bias {mean_uncorrected}"
        );
    }
}

#[test]
fn c_is_not_determined_for_a_runner_and_is_for_a_tyre() {
    let track = Track {
        runs: 10,
        samples: 1000,
        slip_rms: 0.05,
        slip_sd: 0.0,
        force_sd: 40.0,
    };
    let runner = MagicFormula::PUBLISHED_REAR;
    let fit = fit_lateral(&track.drive(&runner, 3), &LateralFitOptions::default()).expect("fits");
    assert!(fit.c_held && fit.rank == 2, "{:?}", fit.combinations);
    let last = fit.combinations[2];
    assert!(last.exponents[2].abs() > 0.99, "{last:?}");
    let tyre = MagicFormula {
        mu_zeta: 1.1,
        c: 1.5,
        e: 0.2,
        k_n_per_rad: 60e3,
    };
    let options = LateralFitOptions {
        e: 0.2,
        ..Default::default()
    };
    let mut covered = [0; 3];
    for seed in 0..100 {
        let fit = fit_lateral(&track.drive(&tyre, seed), &options).expect("fits");
        assert!(!fit.c_held && fit.rank == 3, "{:?}", fit.combinations);
        covered[0] += u32::from(covers(fit.c, tyre.c));
        covered[1] += u32::from(covers(fit.mu_zeta, tyre.mu_zeta));
        covered[2] += u32::from(covers(fit.k_n_per_rad, tyre.k_n_per_rad));
    }
    println!("{covered:?} of 100");
    assert!(covered.iter().all(|&n| n >= 90), "{covered:?} of 100");
}

#[test]
fn small_slip_determines_k_alone() {
    let truth = MagicFormula::PUBLISHED_REAR;
    let track = Track {
        runs: 10,
        samples: 500,
        slip_rms: 0.0004,
        slip_sd: 0.0001,
        force_sd: 20.0,
    };
    let options = LateralFitOptions {
        slip_sd: 0.0001,
        ..Default::default()
    };
    let mut covered = 0;
    for seed in 0..20 {
        let fit = fit_lateral(&track.drive(&truth, seed), &options).expect("fits");
        assert!(!fit.mu_zeta_c_determined, "{fit:?}");
        assert_eq!(fit.mu_zeta_c.high, None);
        covered += u32::from(covers(fit.k_n_per_rad, truth.k_n_per_rad));
    }
    assert!(covered >= 18, "{covered} of 20");
}

#[test]
fn linear_attenuation_is_corrected_for_noise_of_half_the_slip() {
    // In the linear range the corrected score is the classical 1 / (1 - noise / signal).
    let truth = MagicFormula {
        mu_zeta: 1e4,
        ..MagicFormula::PUBLISHED_REAR
    };
    let track = Track {
        runs: 20,
        samples: 4000,
        slip_rms: 0.001,
        slip_sd: 0.0005,
        force_sd: 5.0,
    };
    let options = LateralFitOptions {
        slip_sd: 0.0005,
        ..Default::default()
    };
    let fit = fit_lateral(&track.drive(&truth, 8), &options).expect("fits");
    assert!(
        (fit.k_n_per_rad.value / truth.k_n_per_rad - 1.0).abs() < 0.01,
        "{fit:?}"
    );
    let attenuation = fit.attenuation_of_plain_least_squares;
    assert!((attenuation - 0.8).abs() < 0.02, "{attenuation}");
}

#[test]
fn invalid_samples_are_refused_by_name() {
    let options = LateralFitOptions::default();
    let reported = |samples: &[LateralSample], options: &LateralFitOptions| {
        fit_lateral(samples, options)
            .expect_err("refused")
            .to_string()
    };
    let sample = LateralSample {
        alpha: 0.01,
        fz: 1000.0,
        fy: 50.0,
        cluster: 0,
    };
    assert!(reported(&[sample; 3], &options).contains("3, expected at least 20"));
    let nan = LateralSample {
        fy: f64::NAN,
        ..sample
    };
    assert!(reported(&[nan; 30], &options).contains("lateral force = NaN"));
    let degrees = LateralSample {
        alpha: 2.0,
        ..sample
    };
    assert!(reported(&[degrees; 30], &options).contains("slip angle = 2"));
    let lifted = LateralSample { fz: -1.0, ..sample };
    assert!(reported(&[lifted; 30], &options).contains(": 0, expected at least"));
    let backwards = LateralSample {
        fy: -50.0,
        ..sample
    };
    assert!(reported(&[backwards; 30], &options).contains("check the signs"));
    let noise = LateralFitOptions {
        slip_sd: 0.01,
        ..options
    };
    assert!(reported(&[sample; 30], &noise).contains("within its noise"));
}

#[test]
fn load_noise_of_two_percent_changes_parameters_by_less_than_half_a_percent() {
    let truth = MagicFormula::PUBLISHED_FRONT;
    let track = Track {
        runs: 12,
        samples: 1500,
        slip_rms: 0.01,
        slip_sd: 0.0,
        force_sd: 10.0,
    };
    let mut rng = ChaCha8Rng::seed_from_u64(77);
    let (mut k, mut p) = (0.0, 0.0);
    for seed in 0..10 {
        let exact = track.drive(&truth, seed);
        let noisy: Vec<LateralSample> = exact
            .iter()
            .map(|s| {
                let kick: f64 = StandardNormal.sample(&mut rng);
                LateralSample {
                    fz: s.fz + 50.0 * kick,
                    ..*s
                }
            })
            .collect();
        let options = LateralFitOptions::default();
        let with = fit_lateral(&noisy, &options).expect("fits").law();
        let without = fit_lateral(&exact, &options).expect("fits").law();
        k += (with.k_n_per_rad / without.k_n_per_rad).ln() / 10.0;
        p += (with.mu_zeta_c() / without.mu_zeta_c()).ln() / 10.0;
    }
    println!("load noise moves ln K by {k:.5}, ln P by {p:.5}");
    assert!(k.abs() < 0.005 && p.abs() < 0.005, "{k} {p}");
}
