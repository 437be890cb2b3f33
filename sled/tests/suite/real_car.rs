//! A real race car (KUFE_DATA): reader, slips at the axles and cornering stiffness per mass.

use std::path::PathBuf;

use kufe_sled::friction::{LateralFitOptions, LateralSample, fit_lateral};
use kufe_sled::{Conditions, Entry, Model, OnGaps, derivative, low_pass, read_run, slips};

/// Gravity, to give each axle its static load per mass [m/s2].
const G: f64 = 9.81;

#[test]
fn race_car_axle_stiffness_per_mass_is_plausible() {
    let Some(data) = std::env::var_os("KUFE_DATA") else {
        kufe_outside::not_here("KUFE_DATA is not set");
        return;
    };
    let file = PathBuf::from(data).join("revs/run.csv");
    let entry = Entry {
        run: "revs".to_string(),
        file,
        track: "road".to_string(),
        driver: "unknown".to_string(),
        driver_class: "unknown".to_string(),
        session: "1".to_string(),
        conditions: Conditions {
            ice_c: 0.0,
            air_c: 20.0,
            air_pa: 101_325.0,
            humidity_pct: f64::NAN,
            distance_m: f64::NAN,
            mass_kg: f64::NAN,
        },
        ..Entry::default()
    };
    let required = [
        "ax_mps2",
        "ay_mps2",
        "yaw_rate_radps",
        "v_mps",
        "alpha_rad",
        "delta_rad",
    ];
    let run = read_run(entry, &required, OnGaps::LeaveOut).unwrap();
    assert_eq!(run.len(), 27_501);
    assert!((run.rate_hz() - 50.0).abs() < 1e-6);

    // Distances from the centre of gravity as stated with the data; the slip is measured there. The
    // mass is not stated: forces are per mass.
    let mut sled = Model::published().sled;
    (sled.l_f_m, sled.l_r_m, sled.slip_x_m) = (1.33, 1.07, 0.0);
    let wheelbase = sled.wheelbase_m();
    // J_zz / m of a car is close to l_f l_r; it enters only through the yaw acceleration.
    let inertia = sled.l_f_m * sled.l_r_m;
    let smooth = |name: &str| low_pass(run.column(name).unwrap(), run.rate_hz(), 5.0);
    let (ay, yaw, v) = (smooth("ay_mps2"), smooth("yaw_rate_radps"), smooth("v_mps"));
    let (alpha, delta) = (smooth("alpha_rad"), smooth("delta_rad"));
    let yaw_accel = derivative(&yaw, run.dt_s);
    let mut samples = [Vec::new(), Vec::new()];
    for i in 0..run.len() {
        let slip = slips(&sled, alpha[i], yaw[i], v[i], delta[i]);
        let front = (sled.l_r_m * ay[i] + inertia * yaw_accel[i]) / wheelbase;
        let rear = (sled.l_f_m * ay[i] - inertia * yaw_accel[i]) / wheelbase;
        let cluster = (i / 500) as u32;
        for (axle, alpha, fy, lever) in [
            (0, slip.front, front, sled.l_r_m),
            (1, slip.rear, rear, sled.l_f_m),
        ] {
            samples[axle].push(LateralSample {
                alpha,
                fz: G * lever / wheelbase,
                fy,
                cluster,
            });
        }
    }
    let mut stiffness = Vec::new();
    for (axle, samples) in ["front", "rear"].iter().zip(&samples) {
        let fit = fit_lateral(samples, &LateralFitOptions::default()).unwrap();
        let k = fit.k_n_per_rad;
        let [low, high] = [k.low, k.high].map(Option::unwrap);
        println!(
            "{axle}: cornering stiffness per mass {:.1} m/s2/rad ({:.1} to {:.1}), residual {:.2} m/s2",
            k.value, low, high, fit.residual_rms_n
        );
        assert!(low < k.value && k.value < high && low > 0.0);
        // Within 30 %: ten-second clusters of a nine-minute record.
        assert!(high - low < 0.6 * k.value);
        // A race car of 1000 kg has some 50 to 200 kN/rad per axle.
        assert!((30.0..300.0).contains(&k.value), "{axle}: {}", k.value);
        stiffness.push((fit, samples));
    }
    // The curve explains at least half the variance of the lateral acceleration.
    for (fit, samples) in &stiffness {
        let power = samples.iter().map(|s| s.fy * s.fy).sum::<f64>() / samples.len() as f64;
        assert!(fit.residual_rms_n.powi(2) < 0.5 * power);
    }
}
