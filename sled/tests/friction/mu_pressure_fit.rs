//! The quadratic fit mu(p): the table of the paper, SciPy, and coverage on simulated specimens.

use std::process::Command;

use kufe_sled::Error;
use kufe_sled::friction::{Experiment, MuFit, Weighting, ZetaActsOn, fit_mu, read_experiments};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

fn paper() -> Vec<Experiment> {
    let text = include_str!("../data/ice_house.csv");
    read_experiments("ice_house.csv", text.as_bytes()).expect("reads")
}

fn weighted() -> MuFit {
    fit_mu(&paper(), Weighting::Both, 0.95).expect("fits")
}

#[test]
fn unweighted_fit_of_the_rounded_table_equals_the_published_one() {
    let fit = fit_mu(&paper(), Weighting::None, 0.95).expect("fits");
    assert!((fit.b - 0.0864).abs() < 0.00005, "{}", fit.b);
    assert!((fit.c - 1.986).abs() < 0.0005, "{}", fit.c);
    assert!((fit.d - 14.51).abs() < 0.005, "{}", fit.d);
}

#[test]
fn weighted_fit_is_consistent_with_the_stated_errors() {
    let fit = weighted();
    println!("{fit:?} {:?}", fit.least_friction());
    assert_eq!(fit.freedom, 4);
    let p_value = fit.p_value.expect("weighted");
    assert!(p_value > 0.05, "{p_value}");
    let least = fit.least_friction().expect("a minimum");
    assert!(
        least.p_pa.covers(11.42e6) && least.mu.covers(3.18e-3),
        "{least:?}"
    );
    assert!(least.p_pa.low > 10e6 && least.p_pa.high < 13e6, "{least:?}");
}

/// Runs Python with the table on standard input; `None` without the interpreter or a module.
fn python(script: &str) -> Option<Vec<f64>> {
    let interpreter = kufe_outside::python("numpy, scipy")?;
    let table = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/ice_house.csv");
    let output = Command::new(interpreter)
        .args(["-W", "ignore", "-c", script, table])
        .output()
        .expect("KUFE_PYTHON runs");
    let reported = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{reported}");
    let text = String::from_utf8_lossy(&output.stdout);
    Some(
        text.split_whitespace()
            .map(|word| word.parse().expect("number"))
            .collect(),
    )
}

#[test]
fn weighted_fit_and_covariance_equal_an_independent_orthogonal_regression() {
    // Reference: SciPy's least squares with the true pressures as unknowns and a numerical
    // Jacobian.
    const SCRIPT: &str = r#"
import csv, sys
import numpy as np
from scipy.optimize import least_squares
from scipy.stats import chi2
rows = list(csv.DictReader(open(sys.argv[1])))
p, sp, m, sm = (np.array([float(r[k]) for r in rows]) * f for k, f in
    [("p_max_pa", 1e-6), ("p_max_sd_pa", 1e-6), ("mu", 1e3), ("mu_sd", 1e3)])
def residual(u):
    b, c, d = u[:3]
    x = u[3:]
    return np.r_[(m - (b*x*x - c*x + d)) / sm, (p - x) / sp]
start = np.polyfit(p, m, 2)
fit = least_squares(residual, np.r_[start[0], -start[1], start[2], p], x_scale="jac", jac="3-point",
    xtol=1e-15, ftol=1e-15, gtol=1e-15)
cov = np.linalg.inv(fit.jac.T @ fit.jac)[:3, :3]
s = 2 * fit.cost
print(*fit.x[:3], *cov.ravel(), s, chi2.sf(s, len(p) - 3))
"#;
    let Some(values) = python(SCRIPT) else {
        return;
    };
    let fit = weighted();
    let close = |ours: f64, theirs: f64, tolerance: f64| {
        assert!((ours / theirs - 1.0).abs() < tolerance, "{ours} {theirs}");
    };
    close(fit.b, values[0], 1e-5);
    close(fit.c, values[1], 1e-5);
    close(fit.d, values[2], 1e-5);
    for i in 0..3 {
        for j in 0..3 {
            close(fit.covariance[(i, j)], values[3 + 3 * i + j], 1e-3);
        }
    }
    close(fit.chi2, values[12], 1e-7);
    close(fit.p_value.expect("weighted"), values[13], 1e-6);
}

#[test]
fn weighted_fit_equals_odrpack() {
    const SCRIPT: &str = r#"
import csv, sys
import numpy as np
from scipy import odr
rows = list(csv.DictReader(open(sys.argv[1])))
p, sp, m, sm = (np.array([float(r[k]) for r in rows]) * f for k, f in
    [("p_max_pa", 1e-6), ("p_max_sd_pa", 1e-6), ("mu", 1e3), ("mu_sd", 1e3)])
model = odr.Model(lambda u, x: u[0]*x*x - u[1]*x + u[2])
out = odr.ODR(odr.RealData(p, m, sx=sp, sy=sm), model, beta0=[0.09, 2.0, 14.0], sstol=1e-15, partol=1e-15).run()
print(*out.beta, out.sum_square)
"#;
    let Some(values) = python(SCRIPT) else {
        return;
    };
    let fit = weighted();
    for (ours, theirs) in [fit.b, fit.c, fit.d, fit.chi2].into_iter().zip(values) {
        assert!((ours / theirs - 1.0).abs() < 1e-5, "{ours} {theirs}");
    }
}

#[test]
fn intervals_cover_the_truth_at_the_stated_rate() {
    let truth = |p: f64| 1e-3 * (0.088 * p * p - 2.01 * p + 14.66);
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut normal = move || -> f64 { StandardNormal.sample(&mut rng) };
    let draws = 400;
    let (mut band, mut place, mut accepted) = (0, 0, 0);
    for _ in 0..draws {
        let experiments: Vec<Experiment> = (0..12)
            .map(|i| {
                let p = 7.5 + 0.75 * f64::from(i);
                Experiment {
                    specimen: format!("{i}"),
                    p_max_pa: 1e6 * (p + 0.2 * normal()),
                    p_max_sd_pa: 0.2e6,
                    mu: truth(p) + 0.15e-3 * normal(),
                    mu_sd: 0.15e-3,
                    ..Default::default()
                }
            })
            .collect();
        let fit = fit_mu(&experiments, Weighting::Both, 0.95).expect("fits");
        band += u32::from(fit.band(10e6).covers(truth(10.0)));
        let least = fit.least_friction().expect("a minimum");
        place += u32::from(least.p_pa.covers(1e6 * 2.01 / 0.176));
        accepted += u32::from(fit.p_value.expect("weighted") > 0.05);
    }
    // Binomial distribution with 0.95 and 400 draws: 380 +- 4.4.
    println!("{band} {place} {accepted} of {draws}");
    for covered in [band, place, accepted] {
        assert!(
            (364..=396).contains(&covered),
            "{band} {place} {accepted} of {draws}"
        );
    }
}

#[test]
fn intervals_cover_the_truth_with_common_pressure_errors_per_specimen() {
    let [b, c, d] = [0.088, 2.01, 14.66];
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut normal = move || -> f64 { StandardNormal.sample(&mut rng) };
    let draws = 200;
    let mut covered = [0; 3];
    for _ in 0..draws {
        let mut experiments = Vec::new();
        for specimen in 0..7 {
            let p = 8.0 + 1.2 * f64::from(specimen);
            let stated = 1e6 * (p + 0.3 * normal());
            experiments.extend((0..6).map(|_| Experiment {
                specimen: format!("{specimen}"),
                p_max_pa: stated,
                p_max_sd_pa: 0.3e6,
                mu: 1e-3 * (b * p * p - c * p + d + 0.15 * normal()),
                mu_sd: 0.15e-3,
                ..Default::default()
            }));
        }
        let fit = fit_mu(&experiments, Weighting::Both, 0.95).expect("fits");
        assert_eq!(fit.freedom, 4);
        for (k, off) in [fit.b - b, fit.c - c, fit.d - d].into_iter().enumerate() {
            covered[k] += u32::from(off.abs() < fit.quantile * fit.covariance[(k, k)].sqrt());
        }
    }
    // Binomial distribution with 0.95 and 200 draws: 190 +- 3.1.
    println!("{covered:?} of {draws}");
    assert!(
        covered.iter().all(|n| (180..=199).contains(n)),
        "{covered:?} of {draws}"
    );
}

#[test]
fn without_weights_every_specimen_counts_once() {
    let mut experiments = paper();
    let once = fit_mu(&experiments, Weighting::None, 0.95).expect("fits");
    let repeated = vec![experiments[0].clone(); 5];
    experiments.extend(repeated);
    let repeated = fit_mu(&experiments, Weighting::None, 0.95).expect("fits");
    assert_eq!(repeated.freedom, once.freedom);
    assert!((repeated.b / once.b - 1.0).abs() < 1e-9, "{}", repeated.b);
}

#[test]
fn a_straight_line_has_no_minimum() {
    let mut experiments = paper();
    for (i, e) in experiments.iter_mut().enumerate() {
        e.mu = 1e-3 * (6.0 - 0.2e-6 * e.p_max_pa) + [1e-5, -1e-5][i % 2];
    }
    let fit = fit_mu(&experiments, Weighting::Both, 0.95).expect("fits");
    assert_eq!(fit.least_friction(), None);
}

#[test]
fn law_of_the_fit_has_cap_and_zeta() {
    let fit = weighted();
    let law = fit.law(0.007, 1.1, ZetaActsOn::Pressure);
    assert!((law.mu(10e6) - fit.band(11e6).value).abs() < 1e-12);
    assert_eq!(law.mu(40e6), 0.007);
}

#[test]
fn too_few_or_too_similar_specimens_are_refused() {
    let mut experiments = paper();
    let few = fit_mu(&experiments[..3], Weighting::Both, 0.95);
    assert!(
        matches!(
            few,
            Err(Error::TooFew {
                found: 3,
                needed: 4,
                ..
            })
        ),
        "{few:?}"
    );
    for (i, e) in experiments.iter_mut().enumerate() {
        e.p_max_pa = [8e6, 9e6][i % 2];
    }
    let same = fit_mu(&experiments, Weighting::Both, 0.95);
    assert!(matches!(same, Err(Error::Undetermined { .. })), "{same:?}");
    experiments[2].mu_sd = 0.0;
    experiments[0].p_max_pa = 12e6;
    let exact = fit_mu(&experiments, Weighting::Both, 0.95)
        .expect_err("refused")
        .to_string();
    assert!(
        exact.starts_with("experiment 3 (Beta 1): mu_sd = 0:"),
        "{exact}"
    );
}

#[test]
fn faulty_cells_are_reported_by_file_row_and_column() {
    let header = "specimen,p_max_pa,p_max_sd_pa,mu,mu_sd\n";
    for (text, parts) in [
        (
            "specimen,p_max_pa,mu,mu_sd\n",
            vec!["t.csv", "p_max_sd_pa", "missing"],
        ),
        (
            "A,7.7,0.4,0.0045,0.0004\n",
            vec!["row 2", "p_max_pa", "7.7", "Pa"],
        ),
        (
            "A,7.7e6,4e5,0.0045,0.0004\nB,8e6,4e5,nan,0.0004\n",
            vec!["row 3", "column mu", "nan"],
        ),
        ("A,7.7e6,4e5,4.5,0.4\n", vec!["row 2", "column mu", "4.5"]),
        (
            "A,7.7e6,4e5,-0.0045,0.0004\n",
            vec!["row 2", "column mu", "-0.0045", "above 0"],
        ),
        ("A,7.7e6,4e5,,0.4\n", vec!["row 2", "column mu", "nothing"]),
        (
            ",7.7e6,4e5,0.0045,0.0004\n",
            vec!["row 2", "specimen", "a name"],
        ),
        (
            "A,7.7e6,4e5,0.0045\n",
            vec!["t.csv", "row 2: found 4 cells, expected 5"],
        ),
    ] {
        let whole = if text.starts_with("specimen") {
            text.to_string()
        } else {
            format!("{header}{text}")
        };
        let reported = read_experiments("t.csv", whole.as_bytes())
            .expect_err(text)
            .to_string();
        for part in parts {
            assert!(reported.contains(part), "{text}: {reported}");
        }
    }
}

#[test]
fn experiments_round_trip() {
    let mut experiments = paper();
    for e in &mut experiments {
        e.fz_n = Some(981.5);
    }
    let mut file = Vec::new();
    kufe_sled::friction::write_experiments(&experiments, &mut file).expect("writes");
    assert_eq!(
        read_experiments("x", file.as_slice()).expect("reads"),
        experiments
    );
}
