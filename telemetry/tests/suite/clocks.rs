//! Loggers with clocks of their own, brought together by what they share.

use crate::truth::{COLUMNS, Logger, Writes, column, import, recording};

fn same(x: f64) -> f64 {
    x
}

fn kmh(x: f64) -> f64 {
    3.6 * x
}

fn negative_degrees(x: f64) -> f64 {
    -x.to_degrees()
}

fn in_g(x: f64) -> f64 {
    x / 9.806_65
}

const MAPPING: &str = r#"
clock = "imu"
[logger.imu]
files = "imu_*.csv"
time = "time"
[logger.gps]
files = "gps_*.csv"
time = "time"
[logger.steer]
files = "steer_*.csv"
time = "time"
time_unit = "ms"
also.yaw_rate_radps = { from = "yaw_rate_radps", unit = "rad/s" }
[channels]
ax_mps2 = { logger = "imu", from = "ax_mps2", unit = "g" }
ay_mps2 = { logger = "imu", from = "ay_mps2", unit = "g" }
az_mps2 = { logger = "imu", from = "az_mps2", unit = "g" }
roll_rate_radps = { logger = "imu", from = "roll_rate_radps", unit = "deg/s", sign = -1 }
pitch_rate_radps = { logger = "imu", from = "pitch_rate_radps", unit = "deg/s", sign = -1 }
yaw_rate_radps = { logger = "imu", from = "yaw_rate_radps", unit = "deg/s", sign = -1 }
v_mps = { logger = "gps", from = "v_mps", unit = "km/h" }
alpha_rad = { logger = "steer", from = "alpha_rad" }
delta_rad = { logger = "steer", from = "delta_rad", unit = "deg", sign = -1 }
gamma_rad = { logger = "steer", from = "gamma_rad" }
"#;

/// Delays of the loggers `gps` and `steer` relative to `imu` [s]: that of a day's time, and a switch-on
/// later.
const DELAYS: [f64; 2] = [47_159.327_3, -3.214_8];

/// What the three loggers write, with so much noise [share of what good sensors have].
fn folder(noise: f64, seed: u64) -> tempfile::TempDir {
    let imu: [Writes; 6] = [
        ("ax_mps2", &in_g, 0.2 * noise),
        ("ay_mps2", &in_g, 0.2 * noise),
        ("az_mps2", &in_g, 0.2 * noise),
        ("roll_rate_radps", &negative_degrees, 0.002 * noise),
        ("pitch_rate_radps", &negative_degrees, 0.002 * noise),
        ("yaw_rate_radps", &negative_degrees, 0.002 * noise),
    ];
    let gps: [Writes; 1] = [("v_mps", &kmh, 0.03 * noise)];
    let steer: [Writes; 4] = [
        ("alpha_rad", &same, 0.0),
        ("delta_rad", &negative_degrees, 0.0),
        ("gamma_rad", &same, 0.0),
        ("yaw_rate_radps", &same, 0.01 * noise),
    ];
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, logger: Logger, from, to, seed| {
        std::fs::write(folder.path().join(name), recording(&logger, from, to, seed)).unwrap();
    };
    write(
        "imu_r1.csv",
        Logger {
            rate_hz: 500.0,
            delay_s: 0.0,
            time: 1.0,
            columns: &imu,
        },
        0.0,
        60.0,
        seed,
    );
    write(
        "gps_r1.csv",
        Logger {
            rate_hz: 20.0,
            delay_s: DELAYS[0],
            time: 1.0,
            columns: &gps,
        },
        2.0,
        63.0,
        seed + 1000,
    );
    write(
        "steer_r1.csv",
        Logger {
            rate_hz: 200.0,
            delay_s: DELAYS[1],
            time: 1e3,
            columns: &steer,
        },
        -1.0,
        58.0,
        seed + 2000,
    );
    folder
}

#[test]
fn three_loggers_with_their_own_clocks_units_and_signs_give_the_run_back() {
    let folder = folder(0.0, 1);
    let imported = import(folder.path(), MAPPING).unwrap();
    let (run, note) = (&imported[0].run, &imported[0].note);
    for (name, delay) in [("gps", DELAYS[0]), ("steer", DELAYS[1])] {
        let clock = &note.loggers[name].clock;
        assert_eq!(clock.source, "found");
        // The error is that of the delay found, which a sensor's own lag is part of.
        assert!(
            clock
                .delay_includes
                .is_some_and(|what| what.contains("lag"))
        );
        // Sensors without noise: the residual is that of splines between 20 samples a second and of
        // 9.80665 rounded to nine decimals.
        assert!(
            (clock.delay_s - delay).abs() < 2e-4,
            "{name}: {:?} for {delay}",
            clock
        );
    }
    // An error of the delay may put the first sample just after a row.
    let first_row = 2.0 - 1e-3..2.0 + 0.01 + 1e-3;
    assert!(first_row.contains(&note.start_s), "{}", note.start_s);
    assert!(
        (run.len() as f64 / 100.0 - 56.0).abs() < 0.1,
        "{}",
        run.len()
    );
    for name in COLUMNS {
        let values = run.column(name).unwrap();
        let largest = (0..600)
            .map(|i| column(name, f64::from(i) * 0.1).abs())
            .fold(0.0, f64::max);
        let inner = values.iter().enumerate().take(values.len() - 200).skip(200);
        for (row, value) in inner {
            let error = (value - column(name, note.start_s + row as f64 * 0.01)).abs();
            // 0.2 ms at 2 pi 1.3 Hz, and the spline.
            assert!(
                error < 3e-3 * largest,
                "{name}, row {row}: {error:.2e} of {largest}"
            );
        }
    }
}

#[test]
fn the_stated_error_of_a_delay_is_that_of_many_noisy_runs() {
    let (mut gps, mut steer) = (Vec::new(), Vec::new());
    for seed in 0..24 {
        let folder = folder(1.0, 10 + seed);
        let imported = import(folder.path(), MAPPING).unwrap();
        for (name, delay, scores) in [
            ("gps", DELAYS[0], &mut gps),
            ("steer", DELAYS[1], &mut steer),
        ] {
            let clock = &imported[0].note.loggers[name].clock;
            let relation = &clock.relations[0];
            // These runs have none of the slip that the stated error of a speed includes.
            let neglected: f64 = if name == "gps" { 0.03 } else { 0.0 };
            let sd_s = (relation.delay_sd_s.powi(2) - neglected.powi(2)).sqrt();
            scores.push((relation.delay_s - delay) / sd_s);
            // A sensor's noise of one run leaves some milliseconds.
            assert!(sd_s < 0.02, "{name}, seed {seed}: {relation:?}");
            assert!(
                (clock.delay_s - delay).abs() < 0.02,
                "{name}, seed {seed}: {clock:?}"
            );
        }
    }
    for (name, scores) in [("gps", gps), ("steer", steer)] {
        let rms = (scores.iter().map(|z| z * z).sum::<f64>() / scores.len() as f64).sqrt();
        // Of 24 the root mean square scatters by 15 %; Bartlett's weights cut what residuals take
        // back later, so that errors are stated up to twice too large, never much too small.
        assert!((0.4..1.4).contains(&rms), "{name}: {rms} of {scores:.2?}");
    }
}

/// The noise of the speeds is so large that it dominates their derivatives above 1 Hz.
#[test]
fn the_stated_error_of_the_delay_of_noisy_speeds_is_that_of_many_runs() {
    let mapping = r#"
clock = "imu"
[logger.imu]
files = "imu_*.csv"
time = "time"
[logger.gps]
files = "gps_*.csv"
time = "time"
also.v_mps = { from = "v_mps", unit = "m/s" }
[channels]
v_mps = { logger = "imu", from = "v_mps", unit = "m/s" }
delta_rad = { logger = "gps", from = "delta_rad", unit = "rad" }
"#;
    let columns: [Writes; 2] = [("v_mps", &same, 1.0), ("delta_rad", &same, 0.0)];
    let score = |seed: u64| {
        let folder = tempfile::tempdir().unwrap();
        for (name, delay_s, seed) in [("imu", 0.0, seed), ("gps", 3.217, seed + 1000)] {
            let logger = Logger {
                rate_hz: 100.0,
                delay_s,
                time: 1.0,
                columns: &columns,
            };
            let text = recording(&logger, 0.0, 60.0, seed);
            std::fs::write(folder.path().join(format!("{name}_r1.csv")), text).unwrap();
        }
        let imported = import(folder.path(), mapping).unwrap();
        let clock = &imported[0].note.loggers["gps"].clock;
        (clock.delay_s - 3.217) / clock.delay_sd_s.unwrap()
    };
    let squares: f64 = (0..24).map(|seed| score(10 + seed).powi(2)).sum();
    let rms = (squares / 24.0).sqrt();
    // As above; the narrowest band is chosen by its stated error, which understates it a little.
    assert!((0.4..1.6).contains(&rms), "{rms}");
}

#[test]
fn a_clock_that_cannot_be_found_is_refused_and_may_be_stated() {
    let folder = folder(0.0, 1);
    let reported = |mapping: &str| import(folder.path(), mapping).map(|_| ()).unwrap_err();
    let unrelated = MAPPING.replace(
        "also.yaw_rate_radps = { from = \"yaw_rate_radps\", unit = \"rad/s\" }",
        "",
    );
    let error = reported(&unrelated);
    assert!(
        error.starts_with("run r1: the clock of logger \"steer\": no channels of it are related"),
        "{error}"
    );
    let wrong = MAPPING.replace(
        "also.yaw_rate_radps = { from",
        "also.yaw_rate_radps = { sign = -1, from",
    );
    assert!(
        reported(&wrong).contains("the clock of logger \"steer\""),
        "{}",
        reported(&wrong)
    );
    let stated = unrelated.replace(
        "time_unit = \"ms\"",
        "time_unit = \"ms\"\ndelay_s = -3.2148",
    );
    let imported = import(folder.path(), &stated).unwrap();
    let clock = &imported[0].note.loggers["steer"].clock;
    assert_eq!(
        (clock.source, clock.delay_s, clock.delay_sd_s),
        ("stated", -3.2148, None)
    );
    let by_run = format!("{unrelated}\n[[run]]\nname = \"r1\"\ndelay_s.steer = -3.2\n");
    let imported = import(folder.path(), &by_run).unwrap();
    assert_eq!(imported[0].note.loggers["steer"].clock.delay_s, -3.2);
    let short = MAPPING.replace("clock = \"imu\"\n", "");
    assert!(
        reported(&short)
            .contains("clock: found nothing, expected the logger whose clock the runs keep")
    );
}

#[test]
fn half_a_second_at_the_end_stop_moves_no_clock() {
    let folder = folder(0.0, 1);
    let path = folder.path().join("imu_r1.csv");
    let text = std::fs::read_to_string(&path).unwrap();
    let clipped = text.lines().map(|line| {
        let mut cells: Vec<&str> = line.split(',').collect();
        let time: f64 = cells[0].parse().unwrap_or(0.0);
        if (20.0..20.5).contains(&time) {
            cells[1] = "16.0";
            cells[2] = "-16.0";
        }
        cells.join(",") + "\n"
    });
    std::fs::write(&path, clipped.collect::<String>()).unwrap();
    let imported = import(folder.path(), MAPPING).unwrap();
    let found = &imported[0].note.loggers["gps"];
    assert!((found.clock.delay_s - DELAYS[0]).abs() < 2e-3, "{found:?}");
    let remarks = &imported[0].note.remarks;
    let stop = "ax_mps2 stays at its extreme 16 g for 250 samples";
    assert!(
        remarks.iter().any(|text| text.contains(stop)),
        "{remarks:?}"
    );
}

#[test]
fn a_speed_that_a_logger_repeats_until_the_next_is_not_late() {
    let folder = folder(0.0, 1);
    let path = folder.path().join("gps_r1.csv");
    let text = std::fs::read_to_string(&path).unwrap();
    // 20 values a second in 200 rows a second.
    let mut repeated = "time,v_mps\n".to_string();
    for line in text.lines().skip(1) {
        let (time, speed) = line.split_once(',').unwrap();
        let time: f64 = time.parse().unwrap();
        for k in 0..10 {
            repeated += &format!("{:.9},{speed}\n", time + 0.005 * f64::from(k));
        }
    }
    std::fs::write(&path, repeated).unwrap();
    let imported = import(folder.path(), MAPPING).unwrap();
    let (run, note) = (&imported[0].run, &imported[0].note);
    let delay = note.loggers["gps"].clock.delay_s;
    assert!((delay - DELAYS[0]).abs() < 2e-3, "{delay}");
    let speed = &note.channels["v_mps"];
    assert!((speed.rate_hz - 20.0).abs() < 0.01 && speed.missing_rows == 0);
    assert_eq!(speed.samples, speed.expected_samples);
    // As repeated it is 25 ms late: 0.05 m/s. At the ends the last value is repeated.
    let speeds = run.columns["v_mps"].iter().enumerate();
    for (row, speed) in speeds.skip(50).take(run.len() - 100) {
        let exact = column("v_mps", note.start_s + row as f64 / note.rate_hz);
        assert!(
            (speed - exact).abs() < 0.01,
            "row {row}: {speed} for {exact}"
        );
    }
}

#[test]
fn a_column_of_the_other_sign_in_two_loggers_is_told() {
    let folder = folder(0.0, 1);
    let columns: [Writes; 2] = [
        ("v_mps", &kmh, 0.0),
        ("yaw_rate_radps", &negative_degrees, 0.0),
    ];
    let logger = Logger {
        rate_hz: 20.0,
        delay_s: DELAYS[0],
        time: 1.0,
        columns: &columns,
    };
    let text = recording(&logger, 2.0, 63.0, 7);
    std::fs::write(folder.path().join("gps_r1.csv"), text).unwrap();
    let is_reported = |sign: &str| {
        let also = format!(
            "files = \"gps_*.csv\"\nalso.yaw_rate_radps = {{ from = \"yaw_rate_radps\", unit = \"deg/s\"{sign} }}\n"
        );
        let mapping = MAPPING.replace("files = \"gps_*.csv\"\n", &also);
        let imported = import(folder.path(), &mapping).unwrap();
        imported[0].note.remarks.iter().any(|text| {
            text.contains("logger gps: \"yaw_rate_radps in both\" correlates by -1.00: sign = -1")
        })
    };
    assert!(is_reported("") && !is_reported(", sign = -1"));
}

/// A run down a banked track with dips, row by row: time, specific force, rates and speed.
fn on_a_track(seconds: f64, rate_hz: f64) -> Vec<[f64; 8]> {
    let (dt, gravity) = (1.0 / rate_hz, 9.806_65);
    let wave = |t: f64, f: f64| (std::f64::consts::TAU * f * t).sin();
    let turn = |t: f64| 0.45 * wave(t, 0.13) + 0.15 * wave(t, 0.05);
    let slope = |t: f64| 0.1 + 0.06 * wave(t, 0.17) + 0.04 * wave(t, 0.31);
    let bank = |t: f64| -1.8 * turn(t);
    let rate = |angle: &dyn Fn(f64) -> f64, t: f64| (angle(t + 1e-4) - angle(t - 1e-4)) / 2e-4;
    let mut v: f64 = 12.0;
    let row = |i: usize| {
        let t = i as f64 * dt;
        let (st, ct) = slope(t).sin_cos();
        let (sb, cb) = bank(t).sin_cos();
        let (heading_t, slope_t) = (turn(t), rate(&slope, t));
        let roll = rate(&bank, t) - heading_t * st;
        let pitch = slope_t * cb + heading_t * ct * sb;
        let yaw = heading_t * ct * cb - slope_t * sb;
        let ax = -0.4 - 5e-4 * v * v;
        let ay = yaw * v + gravity * ct * sb;
        let az = -pitch * v + gravity * ct * cb;
        let row = [t, ax, ay, az, roll, pitch, yaw, v];
        v += dt * (ax + gravity * st);
        row
    };
    (0..(seconds * rate_hz) as usize).map(row).collect()
}

#[test]
fn a_speed_alone_is_brought_into_place_on_a_banked_and_sloping_track() {
    let late = 3.37;
    let folder = tempfile::tempdir().unwrap();
    let rows = on_a_track(44.0, 100.0);
    let mut imu = COLUMNS[..6]
        .iter()
        .fold("time".to_string(), |head, name| head + "," + name);
    let mut gps = "time,v_mps".to_string();
    for row in &rows {
        let [t, rest @ .., v] = row;
        let cells: Vec<String> = rest.iter().map(|x| format!("{x:.5}")).collect();
        imu += &format!("\n{t:.2},{}", cells.join(","));
        gps += &format!("\n{:.2},{v:.3}", t + late);
    }
    std::fs::write(folder.path().join("imu_r1.csv"), imu + "\n").unwrap();
    std::fs::write(folder.path().join("gps_r1.csv"), gps + "\n").unwrap();
    let from = |logger: &str, name: &str| {
        format!(
            "{name} = {{ logger = \"{logger}\", from = \"{name}\", unit = \"{}\" }}\n",
            kufe_telemetry::column_unit(name)
        )
    };
    let mut mapping = "clock = \"imu\"\n[logger.imu]\nfiles = \"imu_*.csv\"\ntime = \"time\"\n[logger.gps]\nfiles = \"gps_*.csv\"\ntime = \"time\"\n[channels]\n".to_string();
    mapping.extend(COLUMNS[..6].iter().map(|name| from("imu", name)));
    let accelerations = mapping.replace("yaw_rate_radps = ", "# ") + &from("gps", "v_mps");
    mapping += &from("gps", "v_mps");
    let imported = import(folder.path(), &mapping).unwrap();
    let clock = &imported[0].note.loggers["gps"].clock;
    let sd = clock.delay_sd_s.unwrap();
    assert!(
        sd < 0.1 && (clock.delay_s - late).abs() < 3.0 * sd.max(0.01),
        "{clock:?}"
    );
    // Without the direction of gravity nothing relates them.
    let refused = import(folder.path(), &accelerations).unwrap_err();
    assert!(
        refused.contains("no channels of it are related"),
        "{refused}"
    );
}
