//! Replay of a run by the model: agreement, differences and their position.

use std::process::Command;

use kufe_sled::sample_data::sample_track;
use kufe_sled::{
    Driver, Inputs, Model, Noise, OnGaps, Replay, Run, RunFormat, RunnerLaw, SimulateOptions,
    Track, TrackShape, Vehicle, WallContact, read_for_replay, record, replay, simulate,
    simulated_entry, write_run,
};

fn vehicle() -> Vehicle {
    Vehicle::new(&Model::published()).unwrap()
}

fn options(rate_hz: f64) -> SimulateOptions {
    SimulateOptions {
        rate_hz,
        ..SimulateOptions::default()
    }
}

/// A run of an unskilled driver with perfect sensors.
fn simulated_run(vehicle: &Vehicle, track: &Track, options: &SimulateOptions) -> Run {
    let driver = Driver::of_skill(0.6);
    let simulated = simulate(vehicle, &TrackShape::new(track), &driver, options).unwrap();
    let entry = simulated_entry("r", track, "d", options.conditions);
    record(&simulated, vehicle, None, entry, 1)
}

fn replay_of(run: &Run, vehicle: &Vehicle, track: &Track) -> Replay {
    let inputs = Inputs::of(run, vehicle, track.s_m[0]).unwrap();
    replay(&inputs, vehicle, &TrackShape::new(track), &options(500.0)).unwrap()
}

fn rms(replay: &Replay, column: &str) -> f64 {
    let found = replay.differences.iter().find(|d| d.column == column);
    found.unwrap().rms
}

#[test]
fn a_replay_reproduces_the_simulated_run() {
    let (vehicle, track) = (vehicle(), sample_track("west"));
    let run = simulated_run(&vehicle, &track, &options(500.0));
    let back = replay_of(&run, &vehicle, &track);
    assert!(
        back.stopped.is_none() && back.sections.is_empty(),
        "{back:?}"
    );
    assert!(back.to_m > 1499.0, "{}", back.to_m);
    // The low-pass filter at 20 Hz changes the first samples, which shifts the start by 2e-5 s. The
    // error of steps of 1 ms is smaller.
    for (column, most) in [
        ("t_s", 4e-5),
        ("v_mps", 4e-6),
        ("alpha_rad", 1e-6),
        ("yaw_rate_radps", 1e-6),
        ("gamma_rad", 1e-6),
    ] {
        println!("{column}: {:.1e}", rms(&back, column));
        assert!(
            rms(&back, column) < most,
            "{column}: {}",
            rms(&back, column)
        );
    }
    assert!(back.mean_force_n.abs() < 0.01, "{}", back.mean_force_n);
}

#[test]
fn the_start_is_averaged_over_several_readings() {
    let (vehicle, track, noise) = (vehicle(), sample_track("west"), 0.3);
    let shape = TrackShape::new(&track);
    let driven = simulate(&vehicle, &shape, &Driver::of_skill(0.6), &options(100.0)).unwrap();
    let sensors = Noise {
        speed_mps: noise,
        ..Noise::default()
    };
    let truth = driven.instants[0].state.v_mps;
    let (mut first, mut started) = (0.0, 0.0);
    for seed in 1..=12 {
        let entry = simulated_entry("r", &track, "d", options(100.0).conditions);
        let run = record(&driven, &vehicle, Some(&sensors), entry, seed);
        let inputs = Inputs::of(&run, &vehicle, track.s_m[0]).unwrap();
        let back = replay_of(&run, &vehicle, &track);
        first += (inputs.readings[0].values[0] - truth).powi(2) / 12.0;
        started += (back.simulated.instants[0].state.v_mps - truth).powi(2) / 12.0;
    }
    // Half a second has twenty independent values, each with the root of 0.4 of the noise.
    assert!(first.sqrt() > 0.5 * noise, "{first}");
    assert!(
        started.sqrt() < 2.0 * noise * (0.4_f64 / 20.0).sqrt(),
        "{started}"
    );
}

/// A straight track of constant slope.
fn slide(slope: f64) -> Track {
    let s_m: Vec<f64> = (0..=60).map(|i| 10.0 * f64::from(i)).collect();
    let all = |value: f64| vec![value; s_m.len()];
    Track {
        ice: kufe_sled::IceAlong::default(),
        name: "slide".to_string(),
        slope_rad: all(slope),
        curvature_1pm: all(0.0),
        bank_rad: all(0.0),
        s_m,
    }
}

#[test]
fn ten_percent_more_friction_equals_a_constant_force() {
    let (slope, mu, v0) = (0.08_f64, 0.008, 10.0_f64);
    let mut vehicle = vehicle();
    vehicle.sled.cda_m2 = 0.0;
    let set_friction = |vehicle: &mut Vehicle, mu| {
        for runner in [&mut vehicle.front, &mut vehicle.rear] {
            runner.longitudinal = RunnerLaw::Fixed(mu);
        }
    };
    set_friction(&mut vehicle, mu);
    let track = slide(slope);
    let driver = Driver {
        noise_rad: 0.0,
        wander_m: 0.0,
        ..Driver::of_skill(1.0)
    };
    let simulated = simulate(&vehicle, &TrackShape::new(&track), &driver, &options(500.0)).unwrap();
    let entry = simulated_entry("r", &track, "d", options(500.0).conditions);
    let run = record(&simulated, &vehicle, None, entry, 1);
    set_friction(&mut vehicle, 1.1 * mu);
    let back = replay_of(&run, &vehicle, &track);
    // v^2 = v0^2 + 2 g s (sin(slope) - mu cos(slope))
    let speed = |mu: f64, s: f64| {
        (v0 * v0 + 2.0 * kufe_sled::GRAVITY * s * (slope.sin() - mu * slope.cos())).sqrt()
    };
    // The start has the mean energy of the run over half a second.
    let early: Vec<f64> = back.compared.iter().map(|at| at.s_m).take(51).collect();
    let more = early
        .iter()
        .map(|s| speed(mu, *s).powi(2) - speed(1.1 * mu, *s).powi(2));
    let more = more.sum::<f64>() / early.len() as f64;
    for at in back.compared.iter().skip(20) {
        let [measured, model] = at.values[0];
        let expected = speed(mu, at.s_m) - (speed(1.1 * mu, at.s_m).powi(2) + more).sqrt();
        // The low-pass filter extends the record by odd reflection. The error for a parabola is
        // 1e-5 of the speed.
        assert!(
            (measured - model - expected).abs() < 2e-4,
            "at {} m: {}, expected {expected}",
            at.s_m,
            measured - model
        );
    }
    let force = 0.1 * mu * vehicle.sled.mass_kg * kufe_sled::GRAVITY * slope.cos();
    assert!(
        (back.mean_force_n / force - 1.0).abs() < 1e-3,
        "{}",
        back.mean_force_n
    );
    // The missing force is the same everywhere: no section differs significantly.
    assert!(back.sections.is_empty(), "{:?}", back.sections);
}

#[test]
fn an_unmodelled_push_is_located() {
    let (vehicle, track) = (vehicle(), sample_track("west"));
    let pushed = SimulateOptions {
        contacts: vec![WallContact {
            s_m: 800.0,
            length_m: 15.0,
            force_n: 900.0,
            x_m: 0.3,
        }],
        ..options(500.0)
    };
    let back = replay_of(&simulated_run(&vehicle, &track, &pushed), &vehicle, &track);
    for column in ["alpha_rad", "yaw_rate_radps"] {
        let first = back.sections.iter().find(|s| s.column == column).unwrap();
        assert!(
            first.from_m < 815.0 && first.to_m > 800.0 && first.to_m - first.from_m < 80.0,
            "{first:?}"
        );
    }
}

#[test]
fn gaps_of_the_steering_are_bridged_and_unused_columns_ignored() {
    let (vehicle, track) = (vehicle(), sample_track("east"));
    let mut run = simulated_run(&vehicle, &track, &options(200.0));
    let folder = tempfile::tempdir().unwrap();
    run.entry.file = folder.path().join("r.csv");
    let written = |run: &Run| {
        let mut file = std::fs::File::create(&run.entry.file).unwrap();
        write_run(run, &mut file, RunFormat::Csv).unwrap();
        read_for_replay(&run.entry, OnGaps::LeaveOut)
    };
    run.columns.get_mut("az_mps2").unwrap()[700..900].fill(f64::NAN);
    let whole = written(&run).unwrap();
    assert!(whole.gaps.is_none(), "{:?}", whole.gaps);

    run.columns.get_mut("delta_rad").unwrap()[2000..2040].fill(f64::NAN);
    let back = replay_of(&written(&run).unwrap(), &vehicle, &track);
    assert_eq!(back.taking_part.gaps.missing["delta_rad"], 40);
    assert_eq!(back.pieces.len(), 2);
    // 0.2 s plus the samples that the filter loses on either side, at the speed there.
    let speed = run.columns["v_mps"][2020];
    assert!(
        back.bridged_m > 0.2 * speed && back.bridged_m < 0.6 * speed,
        "{} m at {speed} m/s",
        back.bridged_m
    );
    assert!(
        back.stopped.is_none() && rms(&back, "t_s") < 0.01,
        "{back:?}"
    );
    let error = read_for_replay(&run.entry, OnGaps::Refuse)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("delta_rad") && error.contains("row 2002"),
        "{error}"
    );

    for name in [
        "ax_mps2",
        "ay_mps2",
        "az_mps2",
        "roll_rate_radps",
        "pitch_rate_radps",
    ] {
        run.columns.remove(name);
    }
    for name in ["alpha_rad", "yaw_rate_radps", "gamma_rad", "s_m"] {
        run.columns.remove(name);
    }
    let least = replay_of(&written(&run).unwrap(), &vehicle, &track);
    let compared: Vec<&str> = least
        .differences
        .iter()
        .map(|d| d.column.as_str())
        .collect();
    assert_eq!(compared, ["t_s", "v_mps"]);
    run.columns.remove("delta_rad");
    let error = written(&run).unwrap_err().to_string();
    assert!(
        error.contains("delta_rad") && error.contains("missing"),
        "{error}"
    );
}

#[test]
fn a_run_that_starts_off_the_track_is_refused_with_its_position() {
    let (vehicle, track) = (vehicle(), sample_track("east"));
    let mut run = simulated_run(&vehicle, &track, &options(200.0));
    for s in run.columns.get_mut("s_m").unwrap() {
        *s += 2000.0;
    }
    let inputs = Inputs::of(&run, &vehicle, 0.0).unwrap();
    let error = replay(&inputs, &vehicle, &TrackShape::new(&track), &options(500.0));
    let error = error.unwrap_err().to_string();
    assert!(
        error.contains("r.csv") && error.contains("2000.0") && error.contains("east"),
        "{error}"
    );
}

/// The same equations, written independently and solved by SciPy's Runge-Kutta method of order 8.
const SCIPY: &str = r#"
import json, sys, numpy as np
from bisect import bisect_right
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
run = np.genfromtxt(sys.argv[1], delimiter=',', names=True)
track = np.genfromtxt(sys.argv[2], delimiter=',', names=True)
m = json.loads(sys.argv[3])
g, cross = 9.81, 0.25
def through(x, y):
    # SciPy's natural spline; a place at a time is evaluated faster by hand.
    spline = CubicSpline(x, y, bc_type='natural')
    knots, pieces = spline.x.tolist(), spline.c.T.tolist()
    def at(s, derivative=0):
        i = min(max(bisect_right(knots, s) - 1, 0), len(pieces) - 1)
        d, (a, b, c, e) = s - knots[i], pieces[i]
        return (3 * a * d + 2 * b) * d + c if derivative else ((a * d + b) * d + c) * d + e
    return at
slope, curve, bank = (through(track['s_m'], track[c]) for c in ('slope_rad', 'curvature_1pm', 'bank_rad'))
steer = through(run['s_m'], run['delta_rad'])
L = m['l_f'] + m['l_r']
def magic(law, slip, fz):
    mz, c, e, k = law
    d = mz * fz
    x = k * slip / (c * d)
    return d * np.sin(c * np.arctan((1 - e) * x + e * np.arctan(x)))
def altitude(s, n):
    # Along the line it falls by the slope; across, the ice is an arc of the curvature `cross`.
    return np.cos(slope(s)) * (np.cos(bank(s)) - np.cos(bank(s) + cross * n)) / cross
def about(axis, angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array({'x': [[1, 0, 0], [0, c, -s], [0, s, c]], 'z': [[c, -s, 0], [s, c, 0], [0, 0, 1]]}[axis])
def speed(y):
    return np.hypot(y[3], y[4] + m['xs'] * y[5])
def way(y):
    return (about('z', y[2]) @ [y[3], y[4], 0])[:2]
def frame_rates(y):
    # Of the ice's frame under the sled: on the line, tilted by the cross-section.
    s, n = y[:2]
    v = speed(y)
    line = np.array([0, -v * curve(s), -g * np.cos(slope(s)) * np.sin(bank(s)) / v])
    tilted = about('x', cross * n).T @ line
    upright = about('x', bank(s)) @ line
    ds, dn = way(y)
    tilted[0] = bank(s, 1) * ds + cross * dn - np.tan(slope(s)) * upright[2]
    return tilted
def body_rates(y):
    return about('z', y[2]).T @ frame_rates(y)
def once(y, pitch_t):
    s, n, chi, vx, vy, r = y
    th, ph = slope(s), bank(s) + cross * n
    v = speed(y)
    vys = vy + m['xs'] * r
    alpha = -np.arctan2(vys, vx)
    at = lambda x: alpha - r / v * (x - m['xs'])
    delta = steer(s)
    af, ar, ac = at(m['l_f']) + delta, at(-m['l_r']), at(0.0)
    ds, dn = way(y)
    h = 1e-3
    rise = [(altitude(s + h, n) - altitude(s - h, n)) / (2 * h) - np.sin(th),
            (altitude(s, n + h) - altitude(s, n - h)) / (2 * h), np.cos(th) * np.cos(ph)]
    up = about('z', chi).T @ rise
    roll, pitch, _ = body_rates(y)
    az = roll * vy - pitch * vx + g * up[2]
    fz_front = (m['l_r'] * m['mass'] * az - m['jyy'] * pitch_t) / L
    fz_rear = (m['l_f'] * m['mass'] * az + m['jyy'] * pitch_t) / L
    gamma = bank(s + m['l_f']) - bank(s - m['l_r']) + cross * L * np.sin(chi)
    load = fz_front
    for _ in range(20):
        fx, fy = -m['mu'] * load * np.cos(af), magic(m['front'], af, load)
        load = (fz_front - np.sin(gamma) * (np.sin(delta) * fx + np.cos(delta) * fy)) / np.cos(gamma)
    x, yy = np.cos(delta) * fx - np.sin(delta) * fy, np.sin(delta) * fx + np.cos(delta) * fy
    front = [x, np.cos(gamma) * yy - np.sin(gamma) * load]
    rear = [-m['mu'] * fz_rear * np.cos(ar), magic(m['rear'], ar, fz_rear)]
    drag = -0.5 * m['rho'] * m['cda'] * (1 + m['yaw_drag'] * np.degrees(abs(ac))) * v * v
    fx = (front[0] + rear[0] + drag * np.cos(ac)) / m['mass']
    fy = (front[1] + rear[1] - drag * np.sin(ac)) / m['mass']
    vx_t, vy_t = fx - g * up[0] + r * vy, fy - g * up[1] - r * vx
    r_t = (m['l_f'] * front[1] - m['l_r'] * rear[1]) / m['jzz']
    return np.array([ds, dn, r - frame_rates(y)[2], vx_t, vy_t, r_t]), v, alpha
def rates(t, y):
    # The normal forces need the pitch acceleration, and it the accelerations: by iteration.
    pitch_t, h = 0.0, 1e-4
    for _ in range(4):
        out = once(y, pitch_t)
        pitch_t = (body_rates(y + h * out[0])[1] - body_rates(y - h * out[0])[1]) / (2 * h)
    return out
end = lambda t, y: y[0] - m['to']
end.terminal = True
start = [0, 0, 0, m['v0'], 0, 0]
solved = solve_ivp(lambda t, y: rates(t, y)[0], (0, 100), start, method='DOP853', rtol=1e-8, atol=1e-10, events=end)
y = solved.y_events[0][0]
_, v, alpha = rates(0, y)
print(solved.t_events[0][0], v, alpha, y[5])
"#;

#[test]
fn a_replay_equals_scipy_solve_ivp() {
    let track = sample_track("east");
    let vehicle = vehicle();
    let run = simulated_run(&vehicle, &track, &options(100.0));
    let folder = tempfile::tempdir().unwrap();
    let (run_file, track_file) = (folder.path().join("r.csv"), folder.path().join("t.csv"));
    write_run(
        &run,
        &mut std::fs::File::create(&run_file).unwrap(),
        RunFormat::Csv,
    )
    .unwrap();
    track
        .write_csv(std::fs::File::create(&track_file).unwrap())
        .unwrap();
    let (sled, friction) = (&vehicle.sled, Model::published().friction);
    // The model differs from the one that was driven: the result cannot be the recorded run.
    let mut heavier = vehicle.clone();
    heavier.sled.mass_kg *= 1.1;
    heavier.rear.lateral.k_n_per_rad *= 0.8;
    let ours = replay_of(&run, &heavier, &track);
    let law = |law: kufe_sled::friction::MagicFormula| [law.mu_zeta, law.c, law.e, law.k_n_per_rad];
    let to_m = 500.0;
    let parameters = serde_json::json!({
        "mass": heavier.sled.mass_kg, "jyy": sled.j_yy_kgm2, "jzz": sled.j_zz_kgm2,
        "l_f": sled.l_f_m, "l_r": sled.l_r_m, "xs": sled.slip_x_m, "cda": sled.cda_m2,
        "yaw_drag": sled.yaw_drag_per_deg, "mu": 0.004,
        "rho": options(100.0).conditions.air_density(), "to": to_m,
        "v0": ours.simulated.instants[0].state.v_mps,
        "front": law(friction.front), "rear": law(heavier.rear.lateral),
    });
    let Some(interpreter) = kufe_outside::python("numpy, scipy") else {
        return;
    };
    let output = Command::new(interpreter)
        .args(["-c", SCIPY])
        .args([&run_file, &track_file])
        .arg(parameters.to_string())
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let theirs: Vec<f64> = String::from_utf8_lossy(&output.stdout)
        .split_whitespace()
        .map(|number| number.parse().unwrap())
        .collect();
    let at = ours
        .compared
        .windows(2)
        .find(|pair| pair[1].s_m >= to_m)
        .unwrap();
    let share = (to_m - at[0].s_m) / (at[1].s_m - at[0].s_m);
    let between =
        |of: &dyn Fn(&kufe_sled::Compared) -> f64| of(&at[0]) + share * (of(&at[1]) - of(&at[0]));
    let values = [
        between(&|at| at.t_s[1]),
        between(&|at| at.values[0][1]),
        between(&|at| at.values[1][1]),
        between(&|at| at.values[2][1]),
    ];
    println!("kufe {values:?}\nSciPy {theirs:?}");
    // Linear interpolation between samples has an error of 1e-5; the low-pass filter changes the
    // steering by as much.
    for (ours, (theirs, most)) in values
        .iter()
        .zip(theirs.iter().zip([2e-5, 1e-4, 5e-5, 2e-4]))
    {
        assert!((ours - theirs).abs() < most, "kufe {ours}, SciPy {theirs}");
    }
}
