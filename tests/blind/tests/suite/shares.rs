//! Sizes of hidden effects in the other worlds, measured again from the files that are written.

use std::collections::BTreeMap;

use kufe_blind::answer::Case;
use kufe_blind::catalogue::chosen;
use kufe_blind::inverse::{low_pass, residuals};
use kufe_blind::sensors::Sample;
use kufe_blind::sled::{Conditions, Lateral, Sled};

/// A run as its files have it: channels, weather, and the surveyed slope, metre by metre.
struct Run {
    rows: Vec<[f64; 10]>,
    at: Conditions,
    slope_rad: Vec<f64>,
}

fn table(text: &str) -> Vec<Vec<String>> {
    let cells = |line: &str| line.split(',').map(str::to_owned).collect();
    text.lines().skip(1).map(cells).collect()
}

fn number(cell: &str) -> f64 {
    cell.parse().unwrap()
}

/// The runs of a case, and its sled with the friction that it truly has.
fn read(case: &Case) -> (Vec<Run>, Sled) {
    let files: BTreeMap<&str, &str> = case
        .files
        .iter()
        .map(|(name, bytes)| (name.as_str(), std::str::from_utf8(bytes).unwrap()))
        .collect();
    let runs = table(files["runs.csv"]).into_iter().map(|line| {
        let track = table(files[format!("track_{}.csv", line[2]).as_str()]);
        let rows = table(files[line[1].as_str()]);
        Run {
            rows: rows
                .iter()
                .map(|row| std::array::from_fn(|c| number(&row[c + 1])))
                .collect(),
            at: Conditions {
                track: line[2].clone(),
                ice_c: number(&line[6]),
                air_c: number(&line[7]),
                air_pa: number(&line[8]),
                humidity_pct: 50.0,
                worn_m: 0.0,
                session_mu: 1.0,
                session_grip: 1.0,
                glide: None,
            },
            slope_rad: track.iter().map(|row| number(&row[1])).collect(),
        }
    });
    let model: toml::Table = files["model.toml"].parse().unwrap();
    let of = |key: &str| model["sled"][key].as_float().unwrap();
    let base: BTreeMap<&str, f64> = case.answer.base.iter().map(|(k, v)| (&**k, *v)).collect();
    let law = |side: &str| Lateral {
        mu_zeta: base[format!("friction.{side}.mu_zeta").as_str()],
        k_n_per_rad: base[format!("friction.{side}.k_n_per_rad").as_str()],
        c: model["friction"][side]["c"].as_float().unwrap(),
        e: model["friction"][side]["e"].as_float().unwrap(),
    };
    let sled = Sled {
        mass_kg: of("mass_kg"),
        j_yy_kgm2: of("j_yy_kgm2"),
        j_zz_kgm2: of("j_zz_kgm2"),
        l_f_m: of("l_f_m"),
        l_r_m: of("l_r_m"),
        accel_m: [of("accel_x_m"), of("accel_y_m"), of("accel_z_m")],
        slip_x_m: of("slip_x_m"),
        cda_m2: of("cda_m2"),
        yaw_drag_per_deg: of("yaw_drag_per_deg"),
        mu: base["friction.longitudinal.mu"],
        front: law("front"),
        rear: law("rear"),
    };
    (runs.collect(), sled)
}

/// What an inversion leaves of rows, by channel: along, of the speed, across, about the vertical;
/// low-passed or as it is.
fn residuals_of(run: &Run, rows: &[[f64; 10]], sled: &Sled, filtered: bool) -> [Vec<f64>; 4] {
    let samples: Vec<Sample> = rows
        .iter()
        .map(|r| Sample {
            t_s: 0.0,
            accel_mps2: [r[0], r[1], r[2]],
            rates_radps: [r[3], r[4], r[5]],
            v_mps: r[6],
            alpha_rad: r[7],
            delta_rad: r[8],
            gamma_rad: r[9],
            extra: 0.0,
        })
        .collect();
    let slope = |s: f64| {
        let k = (s as usize).min(run.slope_rad.len() - 2);
        let f = s - k as f64;
        -(run.slope_rad[k] * (1.0 - f) + run.slope_rad[k + 1] * f)
    };
    let all = residuals(sled, &run.at, &samples, &slope);
    let pick = [
        all.iter().map(|r| r.x_mps2).collect::<Vec<f64>>(),
        all.iter().map(|r| r.v_mps2).collect(),
        all.iter().map(|r| r.y_mps2).collect(),
        all.iter().map(|r| r.yaw_radps2).collect(),
    ];
    let mut cutoffs = [20.0, 5.0, 20.0, 20.0].into_iter();
    pick.map(|mut values| {
        let cutoff_hz = cutoffs.next().unwrap();
        if filtered {
            low_pass(&mut values, cutoff_hz);
        }
        values
    })
}

/// A run without most of its noise, its accelerometer reading what the laws say; else columns
/// together could say what the noise is.
fn calm(run: &Run, sled: &Sled) -> Vec<[f64; 10]> {
    let mut rows = run.rows.clone();
    for c in 0..10 {
        let mut values: Vec<f64> = rows.iter().map(|row| row[c]).collect();
        low_pass(&mut values, 8.0);
        for (row, value) in rows.iter_mut().zip(values) {
            row[c] = value;
        }
    }
    let off = residuals_of(run, &rows, sled, false);
    for (k, row) in rows.iter_mut().enumerate() {
        row[0] -= off[0][k];
        row[1] -= off[2][k];
    }
    rows
}

/// What of a series is faster than 6 Hz.
fn roughness(values: Vec<f64>) -> Vec<f64> {
    let mut slow = values.clone();
    low_pass(&mut slow, 6.0);
    values.iter().zip(&slow).map(|(x, y)| x - y).collect()
}

/// Rows that read off in a channel: late (0), scaled (1) or biased (2) by so much.
fn read_off(rows: &[[f64; 10]], (c, what, by): (usize, usize, f64)) -> Vec<[f64; 10]> {
    let mut other = rows.to_vec();
    for k in 1..other.len() - 1 {
        other[k][c] = match what {
            0 => rows[k][c] - by * 50.0 * (rows[k + 1][c] - rows[k - 1][c]),
            1 => rows[k][c] * (1.0 + by),
            _ => rows[k][c] + by,
        };
    }
    other
}

/// Mean squares by channel of the residual of a case after the refit and of what tolerances explain
/// on it, in units of `sd`, by normal equations as in a textbook; across and about the vertical
/// over what they are from 6 Hz on, where there is noise alone: it goes with the stiffness of the
/// sled.
fn mean_squares(case: &Case, sd: [f64; 4]) -> [f64; 4] {
    let (runs, sled) = read(case);
    let delays = (0..10).map(|c| (c, 0, 0.002));
    let scales = (0..6).map(|c| (c, 1, 0.005)).chain([(8, 1, 0.01)]);
    let biases = (0..6).map(|c| (c, 2, if c < 3 { 0.02 } else { 0.001 }));
    let channels: Vec<(usize, usize, f64)> = delays.chain(scales).chain(biases).collect();
    let changes: [fn(&mut Sled); 13] = [
        |s| s.accel_m[0] += 0.02,
        |s| s.accel_m[1] += 0.02,
        |s| s.accel_m[2] += 0.02,
        |s| s.slip_x_m += 0.02,
        |s| s.say_centre_back(0.02),
        |s| s.mass_kg *= 1.01,
        |s| s.j_yy_kgm2 *= 1.05,
        |s| s.j_zz_kgm2 *= 1.05,
        |s| s.mu *= 1.05,
        |s| s.front.mu_zeta *= 1.05,
        |s| s.front.k_n_per_rad *= 1.05,
        |s| s.rear.mu_zeta *= 1.05,
        |s| s.rear.k_n_per_rad *= 1.05,
    ];
    let count = channels.len() + changes.len();
    let mut columns: Vec<[Vec<f64>; 4]> = vec![Default::default(); count];
    let mut target: [Vec<f64>; 4] = Default::default();
    let mut rough: [Vec<f64>; 4] = Default::default();
    for run in &runs {
        let calm = calm(run, &sled);
        let base = residuals_of(run, &calm, &sled, true);
        let put = |column: &mut [Vec<f64>; 4], part: [Vec<f64>; 4]| {
            for c in 0..4 {
                let inside = &part[c][20..part[c].len() - 20];
                column[c].extend(inside.iter().step_by(4).map(|x| x / sd[c]));
            }
        };
        let less = |mut part: [Vec<f64>; 4]| {
            for c in 0..4 {
                part[c].iter_mut().zip(&base[c]).for_each(|(x, y)| *x -= y);
            }
            part
        };
        let own = residuals_of(run, &run.rows, &sled, true);
        put(&mut rough, own.clone().map(roughness));
        put(&mut target, own);
        for (column, &channel) in columns.iter_mut().zip(&channels) {
            let mut part = less(residuals_of(run, &read_off(&calm, channel), &sled, true));
            // Derivatives of yaw rate and speed, too, are what the laws say.
            let (balance, off) = match channel {
                (5, what, by) => (3, (what, by)),
                (6, what, by) => (1, (what, by)),
                _ => (0, (2, 0.0)),
            };
            for k in 1..base[balance].len() - 1 {
                part[balance][k] -= match off {
                    (0, by) => -by * 50.0 * (base[balance][k + 1] - base[balance][k - 1]),
                    (1, by) => by * base[balance][k],
                    _ => 0.0,
                };
            }
            put(column, part);
        }
        for (column, change) in columns[channels.len()..].iter_mut().zip(&changes) {
            let mut other = sled.clone();
            change(&mut other);
            put(column, less(residuals_of(run, &calm, &other, true)));
        }
    }
    let dot = |a: &[Vec<f64>; 4], b: &[Vec<f64>; 4]| -> f64 {
        let pairs = a.iter().flatten().zip(b.iter().flatten());
        pairs.map(|(x, y)| x * y).sum()
    };
    // Gauss and Jordan on (C'C + prior | C'y): the last five, the base, are free.
    let mut system: Vec<Vec<f64>> = (0..count)
        .map(|i| {
            let mut row: Vec<f64> = (0..count).map(|j| dot(&columns[i], &columns[j])).collect();
            row[i] += if i < count - 5 { 1.0 } else { 1e-9 * row[i] };
            row.push(dot(&columns[i], &target));
            row
        })
        .collect();
    for i in 0..count {
        let pivot = system[i][i];
        let row: Vec<f64> = system[i].iter().map(|x| x / pivot).collect();
        for (k, other) in system.iter_mut().enumerate() {
            let by = if k == i { 0.0 } else { other[i] };
            other.iter_mut().zip(&row).for_each(|(x, r)| *x -= by * r);
        }
        system[i] = row;
    }
    let spent: f64 = system[..count - 5]
        .iter()
        .map(|row| row[count].powi(2))
        .sum();
    std::array::from_fn(|c| {
        let mut rest = target[c].clone();
        for (column, row) in columns.iter().zip(&system) {
            for (x, part) in rest.iter_mut().zip(&column[c]) {
                *x -= row[count] * part;
            }
        }
        let mean = |values: &[f64]| values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64;
        (mean(&rest) + spent / rest.len() as f64) / if c < 2 { 1.0 } else { mean(&rough[c]) }
    })
}

fn built(id: &str, seed: u64) -> Case {
    chosen(id).unwrap()[0].build(seed).unwrap()
}

#[test]
fn the_share_in_an_answer_is_that_of_the_files() {
    // Weights as the noise has them, roughly; then what noise alone leaves in two campaigns.
    let sd = [0.035, 0.13, 0.06, 0.095];
    let nulls = [1, 2].map(|seed| mean_squares(&built("clean-null/none", seed), sd));
    for (id, pair) in [
        ("clean-effect/slip-offset@0.06", [2, 3]),
        ("clean-effect/unknown:pitch_rate_radps", [2, 3]),
        ("clean-effect/speed-bias", [0, 1]),
        ("clean-effect/yaw-inertia", [2, 3]),
    ] {
        let case = built(id, 1);
        let squares = mean_squares(&case, sd);
        let over = pair.map(|c| 2.0 * squares[c] / (nulls[0][c] + nulls[1][c]) - 1.0);
        let measured = over.into_iter().fold(0.0, f64::max);
        let stated = case.answer.hides[0].share;
        // Noise of a campaign scatters by 2 % from what its roughness states, that of those with
        // nothing hidden with it; columns here come from what was recorded, the hidden effect with
        // it.
        assert!(
            (measured - stated).abs() < 0.04 + 0.15 * stated,
            "{id}: {measured} measured, {stated} stated"
        );
    }
}

#[test]
fn a_case_of_a_stated_size_is_the_same_bits_for_its_seed() {
    let [a, b] = [(); 2].map(|()| built("few-effect/speed-grip@0.02", 1));
    assert_eq!(a.files, b.files);
    let [a, b] = [a, b].map(|case| serde_json::to_string(&case.answer).unwrap());
    assert_eq!(a, b);
    assert!(
        (built("few-effect/slip-offset@0.06", 1).answer.hides[0].share / 0.06 - 1.0).abs() < 0.05
    );
}

#[test]
fn a_size_is_meant_only_where_it_is_asked_for() {
    let ids = |names: &str| -> Vec<String> {
        let specs = chosen(names).unwrap();
        specs.iter().map(|spec| spec.id()).collect()
    };
    assert_eq!(ids("clean-effect/speed-grip"), ["clean-effect/speed-grip"]);
    assert_eq!(
        ids("clean-effect/speed-grip@0.02"),
        ["clean-effect/speed-grip@0.02"]
    );
    assert!(ids("clean-effect/@0.02").len() > 40);
    assert!(
        ids("all")
            .iter()
            .all(|id| !id.contains("-effect/") || !id.contains('@'))
    );
    assert_eq!(ids("longitudinal/speed").len(), 3);
}
