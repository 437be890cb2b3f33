//! The published friction table has nothing to find; a real car on a real track has.

use kufe_outside::not_here;
use std::path::Path;

use kufe_discover::{Options, Verdict, discover};

const LINEAR_CAR: &str = "[sled]\nmass_kg = 1.0\nj_yy_kgm2 = 1.4\nj_zz_kgm2 = 1.4\nl_f_m = 1.33\nl_r_m = 1.07\ncda_m2 = 0.0\n\
[friction.longitudinal]\nmu = 1e-12\n\
[friction.front]\nmu_zeta = 1e4\nc = 1.0\ne = 0.0\nk_n_per_rad = 50.0\n\
[friction.rear]\nmu_zeta = 1e4\nc = 1.0\ne = 0.0\nk_n_per_rad = 80.0\n";

fn write(folder: &Path, name: &str, text: &str) -> std::path::PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

#[test]
fn nothing_is_found_in_the_published_seven_point_table() {
    let folder = tempfile::tempdir().unwrap();
    let data = write(
        folder.path(),
        "experiments.csv",
        "specimen,mu,mu_sd,p_max_pa,p_max_sd_pa\n\
Alpha 1,0.0045,0.0004,7.7e6,0.4e6\nAlpha 2,0.0038,0.0004,8.6e6,0.5e6\nBeta 1,0.0042,0.0004,13.6e6,0.7e6\n\
Beta 2,0.0046,0.0004,16.0e6,0.9e6\nGamma 1,0.0030,0.0003,10.9e6,0.6e6\nGamma 2,0.0027,0.0003,11.8e6,0.6e6\n\
Gamma 3,0.0033,0.0003,9.6e6,0.5e6\n",
    );
    let text = LINEAR_CAR.replace(
        "mu = 1e-12",
        "b = 0.088\nc = 2.01\nd = 14.66\nmu_cap = 0.007",
    );
    let model = write(folder.path(), "model.toml", &text);
    let report = discover(&data, Some(&model), &Options::default(), &|_| {})
        .unwrap()
        .report;
    assert_eq!(report.verdict, Verdict::None, "{}", report.sentence);
    assert!(report.sentence.contains("7 points"), "{}", report.sentence);
}

#[test]
fn a_copied_row_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let rows = "a,0.0045,0.0004,7.7e6,0.4e6\nb,0.0038,0.0004,8.6e6,0.5e6\nc,0.0042,0.0004,13.6e6,0.7e6\n\
d,0.0046,0.0004,16.0e6,0.9e6\ne,0.0038,0.0004,8.6e6,0.5e6\n";
    let data = write(
        folder.path(),
        "experiments.csv",
        &format!("specimen,mu,mu_sd,p_max_pa,p_max_sd_pa\n{rows}"),
    );
    let model = write(folder.path(), "model.toml", LINEAR_CAR);
    let message = discover(&data, Some(&model), &Options::default(), &|_| {})
        .err()
        .unwrap()
        .to_string();
    assert!(
        message.contains("row 3") && message.contains("row 6"),
        "{message}"
    );
}

#[test]
fn a_real_car_saturates() {
    let Some(folder) = std::env::var_os("KUFE_DATA") else {
        not_here("KUFE_DATA is not set");
        return;
    };
    let run = Path::new(&folder).join("revs/run.csv");
    if !run.is_file() {
        not_here(&format!("{} is not there", run.display()));
        return;
    }
    let out = tempfile::tempdir().unwrap();
    let index = format!(
        "run,file,track,driver,driver_class,session,ice_c,air_c,air_pa\nr1,{},track,d,x,a,-5,20,101000\n",
        run.display()
    );
    let data = write(out.path(), "runs.csv", &index);
    let model = write(out.path(), "model.toml", LINEAR_CAR);
    let report = discover(&data, Some(&model), &Options::default(), &|_| {})
        .unwrap()
        .report;
    println!("{}", report.sentence);
    assert_eq!(report.steps[0].effect, "saturation");
    let side = report
        .held_out
        .channels
        .iter()
        .find(|c| c.channel == "side")
        .unwrap();
    assert!(
        side.after <= 0.56,
        "held-out side force per mass: {} to {} m/s2",
        side.before,
        side.after
    );
}
