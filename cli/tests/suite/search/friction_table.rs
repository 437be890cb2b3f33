//! Friction experiments to search, and the search.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

/// The published table of seven specimens.
pub const TABLE: &str = "\
specimen,p_max_pa,p_max_sd_pa,mu,mu_sd
Alpha 1,7.7e6,0.4e6,0.0045,0.0004
Alpha 2,8.6e6,0.5e6,0.0038,0.0004
Beta 1,13.6e6,0.7e6,0.0042,0.0004
Beta 2,16.0e6,0.9e6,0.0046,0.0004
Gamma 1,10.9e6,0.6e6,0.0030,0.0003
Gamma 2,11.8e6,0.6e6,0.0027,0.0003
Gamma 3,9.6e6,0.5e6,0.0033,0.0003
";

pub const MODEL: &str = "\
[sled]
mass_kg = 390.0
j_yy_kgm2 = 145.0
j_zz_kgm2 = 150.0
l_f_m = 0.82
l_r_m = 0.88
cda_m2 = 0.28
[friction.longitudinal]
b = 0.088
c = 2.01
d = 14.66
mu_cap = 0.007
[friction.front]
mu_zeta = 2.577
c = 0.024
e = 0.99
k_n_per_rad = 10522.0
[friction.rear]
mu_zeta = 3.288
c = 0.076
e = 0.99
k_n_per_rad = 49776.0
";

pub fn discover(folder: &Path, data: &str, further: &[&str]) -> std::io::Result<Output> {
    Command::new(env!("CARGO_BIN_EXE_kufe"))
        .current_dir(folder)
        .args(["discover", data, "--model", "model.toml", "-o", "out"])
        .args(further)
        .output()
}

/// A normal variate from a congruential sequence (the sum of twelve uniform ones).
fn normal(state: &mut u64) -> f64 {
    let mut sum = -6.0;
    for _ in 0..12 {
        *state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        sum += (*state >> 11) as f64 / (1u64 << 53) as f64;
    }
    sum
}

/// Sixty rows of eight sessions with mu times `factor(ice_c, v_mps)` of the published law, and noise of 3 per cent.
pub fn table(factor: impl Fn(f64, f64) -> f64) -> String {
    let mut state = 11;
    let mut text =
        String::from("specimen,p_max_pa,p_max_sd_pa,mu,mu_sd,session,ice_c,air_c,v_mps,lab\n");
    for k in 0..60 {
        let p = 7.0 + 9.0 * f64::from(k % 7) / 6.0;
        let session = k / 8;
        let ice = -2.0 - 1.3 * f64::from((session * 5) % 8) + 0.3 * normal(&mut state);
        let v = 5.0 + 0.35 * f64::from((k * 17) % 60);
        let law = 1e-3 * (0.088 * p * p - 2.01 * p + 14.66);
        let mu = law * factor(ice, v) + 0.03 * law * normal(&mut state);
        text += &format!(
            "s{k},{:.0},1e4,{mu:.7},{:.7},d{session},{ice:.3},3.0,{v:.2},west\n",
            1e6 * p,
            0.03 * law
        );
    }
    text
}

pub fn report(folder: &Path, model: &str) -> Result<Value, Box<dyn std::error::Error>> {
    std::fs::write(folder.join("model.toml"), model)?;
    let output = discover(folder, "experiments.csv", &["--json"])?;
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    Ok(serde_json::from_slice(&output.stdout)?)
}

pub fn next(folder: &Path) -> Result<String, std::io::Error> {
    std::fs::read_to_string(folder.join("out/model.next.toml"))
}
