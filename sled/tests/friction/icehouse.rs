//! Ice-house evaluation of glides that are integrated from the equation of motion.

use kufe_sled::friction::{
    GlideEntry, GlideRun, IceHouse, air_density, evaluate_glide, evaluate_ice_house, fit_line,
    read_glide, read_glide_index,
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

const SLOPE: f64 = 0.12 * std::f64::consts::PI / 180.0;

/// A sled that is pushed for 2 s and glides for at most 45 m.
struct Glide {
    mu: f64,
    climb: f64,
    mass: f64,
    cda: f64,
    speed_sd: f64,
    correlation: f64,
    with_distance: bool,
}

const PLAIN: Glide = Glide {
    mu: 0.0040,
    climb: SLOPE,
    mass: 105.0,
    cda: 0.30,
    speed_sd: 0.0,
    correlation: 0.0,
    with_distance: false,
};

impl Glide {
    fn entry(&self, run: &str, specimen: &str, direction: &str) -> GlideEntry {
        let row = format!(
            "run,file,specimen,direction,mass_kg,cda_m2,air_c,air_pa\n{run},{run}.csv,{specimen},{direction},{},{},2.0,94700\n",
            self.mass, self.cda
        );
        read_glide_index("glides.csv", row.as_bytes())
            .expect("reads")
            .remove(0)
    }

    /// Fourth-order Runge-Kutta at 1 ms, written every 10 ms.
    fn file(&self, seed: u64) -> String {
        let density = air_density(94_700.0, 2.0);
        let acceleration = |t: f64, v: f64| {
            let push = if t < 2.0 { 1.2 } else { 0.0 };
            let drag = 0.5 * density * self.cda * v * v.abs() / self.mass;
            push - drag - 9.81 * (self.mu * self.climb.cos() * v.signum() + self.climb.sin())
        };
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = move || -> f64 { StandardNormal.sample(&mut rng) };
        let mut error = normal();
        let (mut t, mut s, mut v) = (0.0, 0.0, 0.1);
        let mut text = String::from(if self.with_distance {
            "t_s,v_mps,s_m\n"
        } else {
            "t_s,v_mps\n"
        });
        let mut step = 0;
        while s < 47.0 && (t < 2.0 || v > 0.3) {
            if step % 10 == 0 {
                error = self.correlation * error
                    + (1.0 - self.correlation * self.correlation).sqrt() * normal();
                let seen = v + self.speed_sd * error;
                text += &format!("{t:.3},{seen:.9}");
                text += &if self.with_distance {
                    format!(",{s:.9}\n")
                } else {
                    "\n".into()
                };
            }
            let h = 1e-3;
            let k1 = acceleration(t, v);
            let k2 = acceleration(t + h / 2.0, v + h / 2.0 * k1);
            let k3 = acceleration(t + h / 2.0, v + h / 2.0 * k2);
            let k4 = acceleration(t + h, v + h * k3);
            s += h * v + h * h / 6.0 * (k1 + k2 + k3);
            v += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
            t += h;
            step += 1;
        }
        text
    }

    fn run(&self, name: &str, specimen: &str, direction: &str, seed: u64) -> GlideRun {
        let trace = read_glide(name, self.file(seed).as_bytes()).expect("reads");
        evaluate_glide(&self.entry(name, specimen, direction), &trace).expect("evaluates")
    }
}

/// Pairs of glides of one specimen on the sloping rink.
fn house(glide: &Glide, pairs: u64, seed: u64) -> IceHouse {
    let mut runs = Vec::new();
    for i in 0..pairs {
        let down = Glide {
            climb: -glide.climb,
            ..*glide
        };
        runs.push(glide.run(&format!("u{i}"), "A", "uphill", 2 * (1000 * seed + i)));
        runs.push(down.run(&format!("d{i}"), "A", "downhill", 2 * (1000 * seed + i) + 1));
    }
    evaluate_ice_house(runs).expect("evaluates")
}

#[test]
fn exact_glides_recover_friction_and_slope() {
    for with_distance in [false, true] {
        let house = house(
            &Glide {
                with_distance,
                ..PLAIN
            },
            1,
            0,
        );
        let mu = house.specimens[0].mu.value;
        assert!((mu / PLAIN.mu - 1.0).abs() < 1e-4, "{mu}");
        assert!(
            (house.slope_rad.value / SLOPE - 1.0).abs() < 1e-4,
            "{}",
            house.slope_rad.value
        );
    }
}

#[test]
fn a_slope_larger_than_the_friction_cancels_if_the_glide_decelerates() {
    // The air drag is 1.5 N at 3 m/s. The weight component along the slope exceeds the friction by
    // 0.4 N.
    let glide = Glide {
        mu: 0.0020,
        climb: 0.0024,
        ..PLAIN
    };
    let house = house(&glide, 1, 0);
    assert!(
        house.runs[1].line.slope > 0.3,
        "{}",
        house.runs[1].line.slope
    );
    let mu = house.specimens[0].mu.value;
    assert!((mu / glide.mu - 1.0).abs() < 1e-3, "{mu}");
}

#[test]
fn speeds_in_km_per_h_are_detected_by_a_drag_above_the_losses() {
    // The air drag equals the friction. At a speed 3.6 times as high the ratio is 3.6.
    let run = |name: &str, direction: &str, seed: u64| {
        let glide = Glide {
            mu: 0.0010,
            climb: 0.0,
            speed_sd: 1e-6,
            ..PLAIN
        };
        let mut trace = read_glide(name, glide.file(seed).as_bytes()).expect("reads");
        trace.v.iter_mut().for_each(|v| *v *= 3.6);
        trace.s.iter_mut().for_each(|s| *s *= 3.6);
        evaluate_glide(&glide.entry(name, "A", direction), &trace).expect("evaluates")
    };
    let reported = evaluate_ice_house(vec![run("1", "up", 1), run("2", "down", 2)]);
    let reported = reported.expect_err("refused").to_string();
    for part in ["specimen A: mu = -0.", "above 0", "km/h: divide by 3.6"] {
        assert!(reported.contains(part), "{reported}");
    }
}

#[test]
fn neglecting_the_air_drag_changes_the_resistance() {
    // The air drag of the simulated sled is several per cent of its friction, so that the test
    // above depends on it.
    let mut run = PLAIN.run("u", "A", "uphill", 0);
    run.entry.cda_m2 = 0.0;
    let trace = read_glide("u", PLAIN.file(0).as_bytes()).expect("reads");
    let without = evaluate_glide(&run.entry, &trace).expect("evaluates");
    let with = PLAIN.run("u", "A", "uphill", 0);
    assert!(without.resistance() > 1.05 * with.resistance());
}

#[test]
fn intervals_cover_friction_and_slope_with_white_and_with_correlated_noise() {
    for (correlation, speed_sd) in [(0.0, 0.03), (0.95, 0.03)] {
        let noisy = Glide {
            correlation,
            speed_sd,
            ..PLAIN
        };
        let (mut mu, mut slope, seeds) = (0, 0, 60);
        for seed in 0..seeds {
            let house = house(&noisy, 1, seed + 1);
            mu += u32::from(house.specimens[0].mu.covers(PLAIN.mu));
            slope += u32::from(house.slope_rad.covers(SLOPE));
        }
        println!("noise correlation {correlation}: mu {mu}, slope {slope} of {seeds}");
        assert!(
            mu >= 54 && slope >= 54,
            "{correlation}: mu {mu}, slope {slope} of {seeds}"
        );
    }
}

#[test]
fn scatter_between_pairs_enters_the_standard_error() {
    // The friction differs from pair to pair. The lines are nearly exact, the mean of the specimen
    // is not.
    let mut covered = 0;
    for seed in 0..40 {
        let mut rng = ChaCha8Rng::seed_from_u64(900 + seed);
        let mut runs = Vec::new();
        for i in 0..4 {
            let kick: f64 = StandardNormal.sample(&mut rng);
            let up = Glide {
                mu: PLAIN.mu + 0.2e-3 * kick,
                speed_sd: 0.01,
                ..PLAIN
            };
            let down = Glide {
                climb: -SLOPE,
                ..up
            };
            runs.push(up.run(&format!("u{i}"), "A", "uphill", seed * 8 + i));
            runs.push(down.run(&format!("d{i}"), "A", "downhill", 7000 + seed * 8 + i));
        }
        let house = evaluate_ice_house(runs).expect("evaluates");
        let specimen = &house.specimens[0];
        assert!(
            specimen.mu_se > 2.0 * specimen.mu_se_lines || specimen.mu_se == specimen.mu_se_lines
        );
        covered += u32::from(specimen.mu.covers(PLAIN.mu));
    }
    assert!(covered >= 36, "{covered} of 40");
}

#[test]
fn unpaired_runs_are_reported_and_excluded() {
    let glide = Glide {
        speed_sd: 0.01,
        ..PLAIN
    };
    let down = Glide {
        climb: -SLOPE,
        ..glide
    };
    let runs = vec![
        glide.run("1", "A", "uphill", 1),
        down.run("2", "A", "downhill", 2),
        glide.run("3", "A", "uphill", 3),
        glide.run("4", "B", "uphill", 4),
    ];
    let house = evaluate_ice_house(runs).expect("evaluates");
    assert_eq!(house.unpaired, ["3", "4"]);
    assert_eq!(house.specimens.len(), 1);
    let single = evaluate_ice_house(vec![glide.run("1", "A", "uphill", 1)]);
    assert!(single.is_err());
}

#[test]
fn other_direction_names_define_the_sign_of_the_slope() {
    let down = Glide {
        climb: -SLOPE,
        ..PLAIN
    };
    let runs = vec![
        down.run("1", "A", "north", 1),
        PLAIN.run("2", "A", "south", 2),
    ];
    let house = evaluate_ice_house(runs).expect("evaluates");
    assert_eq!(house.directions, ["north", "south"]);
    assert!((house.slope_rad.value + SLOPE).abs() < 1e-6);
}

#[test]
fn standard_error_of_a_line_matches_the_scatter_of_slopes() {
    for correlation in [0.0, 0.8, 0.95] {
        let mut slopes = Vec::new();
        let mut stated = 0.0;
        for seed in 0..400 {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let mut error: f64 = StandardNormal.sample(&mut rng);
            let x: Vec<f64> = (0..600).map(|i| f64::from(i) * 0.01).collect();
            let y: Vec<f64> = x
                .iter()
                .map(|x| {
                    let kick: f64 = StandardNormal.sample(&mut rng);
                    error =
                        correlation * error + (1.0f64 - correlation * correlation).sqrt() * kick;
                    2.0 - 3.0 * x + error
                })
                .collect();
            let line = fit_line(&x, &y).expect("a line");
            slopes.push(line.slope);
            stated += line.slope_se.powi(2) / 400.0;
        }
        let mean = slopes.iter().sum::<f64>() / 400.0;
        let variance = slopes.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / 399.0;
        // The relative standard error of a variance of 400 draws is 7 %.
        let ratio = (stated / variance).sqrt();
        assert!((mean + 3.0).abs() < 4.0 * (variance / 400.0).sqrt());
        assert!(
            (0.87..1.13).contains(&ratio),
            "correlation {correlation}: {ratio}"
        );
    }
}

#[test]
fn glides_in_km_per_h_pushed_or_listed_twice_are_refused() {
    let with_distance = Glide {
        with_distance: true,
        ..PLAIN
    };
    let kmh: String = with_distance.file(0).lines().enumerate().fold(
        String::new(),
        |text, (row, line)| match line.split(',').collect::<Vec<_>>()[..] {
            [t, v, s] if row > 0 => {
                let v = 3.6 * v.parse::<f64>().expect("a speed");
                format!("{text}{t},{v},{s}\n")
            }
            _ => format!("{text}{line}\n"),
        },
    );
    let reported = read_glide("run.csv", kmh.as_bytes()).expect_err("refused");
    let reported = reported.to_string();
    for part in ["run.csv", "row 2", "v_mps", "m/s", "ratio 3.60", "km/h"] {
        assert!(reported.contains(part), "{reported}");
    }
    // Downhill, the weight component exceeds the friction.
    let pushed = Glide {
        climb: -0.02,
        ..PLAIN
    };
    let trace = read_glide("run.csv", pushed.file(0).as_bytes()).expect("reads");
    let reported = evaluate_glide(&PLAIN.entry("1", "A", "up"), &trace);
    let reported = reported.expect_err("refused").to_string();
    assert!(
        reported.contains("force along the glide") && reported.contains("accelerates"),
        "{reported}"
    );

    let twice = vec![
        PLAIN.run("1", "A", "uphill", 0),
        PLAIN.run("2", "A", "downhill", 0),
    ];
    let reported = evaluate_ice_house(twice).expect_err("refused").to_string();
    assert!(
        reported.contains("runs \"1\" and \"2\"") && reported.contains("same samples"),
        "{reported}"
    );
}

#[test]
fn faulty_files_are_reported_with_row_and_column() {
    let good = PLAIN.file(0);
    let lines: Vec<&str> = good.lines().collect();
    let with = |row: usize, line: &str| {
        let mut lines = lines.clone();
        lines[row - 1] = line;
        lines.join("\n")
    };
    let gap = [&lines[..40], &lines[90..]].concat().join("\n");
    for (text, parts) in [
        (
            good.replace("v_mps", "v_kmh"),
            vec!["run.csv", "v_mps", "missing", "v_kmh"],
        ),
        (with(40, "0.38,NaN"), vec!["row 40", "v_mps", "NaN"]),
        (
            with(40, "0.38,85.0"),
            vec!["row 40", "v_mps", "85.0", "m/s"],
        ),
        (
            with(40, "0.10,1.0"),
            vec!["row 40", "t_s", "0.1", "after 0.37"],
        ),
        (gap, vec!["row 41", "t_s", "no gap"]),
        (lines[..4].join("\n"), vec!["run.csv", "samples: 3", "30"]),
        (
            with(40, "0.38"),
            vec!["run.csv", "row 40: found 1 cells, expected 2"],
        ),
    ] {
        let reported = read_glide("run.csv", text.as_bytes())
            .expect_err("refused")
            .to_string();
        for part in parts {
            assert!(reported.contains(part), "{reported}");
        }
    }
    let header = "run,file,specimen,direction,mass_kg,cda_m2,air_c,air_pa";
    let row = "1,1.csv,A,up,105,0.3,2,94700";
    for (text, parts) in [
        (
            format!("{header},colour\n{row},red\n"),
            vec!["glides.csv", "column colour is unknown"],
        ),
        (
            format!("{header}\n{row}\n{row}\n"),
            vec!["row 3", "column run", "no run before"],
        ),
        (
            format!("{header}\n{row}\n2{}\n", &row[1..]),
            vec!["row 3", "column file", "1.csv", "run 1 has this one"],
        ),
        (
            format!("{header}\n{}\n", row.replace("94700", "947")),
            vec!["row 2", "air_pa", "947"],
        ),
        (
            format!("{header}\n{}\n", row.replace(",2,", ",275.15,")),
            vec!["row 2", "air_c", "275.15"],
        ),
        (
            format!("{header}\n{}\n", row.replace("105", "-5")),
            vec!["row 2", "mass_kg", "-5"],
        ),
        (
            format!("{header}\n{row}\n2,b,A,down,105,0.3,2,94700\n3,c,A,left,105,0.3,2,94700\n"),
            vec!["row 4", "direction", "left", "up or down"],
        ),
        (
            format!("{header}\n"),
            vec!["glides.csv", ": 0, expected at least"],
        ),
    ] {
        let reported = read_glide_index("glides.csv", text.as_bytes())
            .expect_err("refused")
            .to_string();
        for part in parts {
            assert!(reported.contains(part), "{reported}");
        }
    }
    let still: String = (0..100)
        .map(|i| format!("{},0.0\n", f64::from(i) * 0.01))
        .collect();
    let trace = read_glide("x", format!("t_s,v_mps\n{still}").as_bytes()).expect("reads");
    let reported = evaluate_glide(&PLAIN.entry("x", "A", "up"), &trace)
        .expect_err("refused")
        .to_string();
    assert!(reported.contains("distance glided [m] = 0"), "{reported}");
}
