//! `kufe press` and `kufe friction` on a runner that slides on ice that yields.

use serde_json::Value;

use crate::kufe::{Bench, json, names, refused, succeeds};

/// A sharp runner at 20 m/s on ice of -5 C, with `more` in the table `[sliding]`.
fn case(more: &str) -> String {
    format!(
        "[runner]\nshape = {{ kind = \"bob\", length_m = 1.0, rocker_radius_m = 30.0, section_radius_m = 0.004, width_m = 0.008, height_m = 0.030 }}\n\
         [ice]\nyoungs_modulus_pa = 9.0e9\npoissons_ratio = 0.33\nthickness_m = \"half-space\"\n\
         [load]\nfz_n = 950.0\ntilt = \"fixed\"\n[accuracy]\np_max = 0.02\n[sliding]\nv_mps = 20.0\nice_c = -5.0\n{more}"
    )
}

fn number(result: &Value, key: &str) -> f64 {
    result[key].as_f64().unwrap_or_else(|| panic!("no {key}"))
}

/// One run and a second one in its groove: figures, files, balances and the groove of the second.
#[test]
fn a_sliding_case_has_its_groove_its_film_and_its_friction() {
    let bench = Bench::new();
    bench.write("front.toml", case(""));
    bench.succeeds(&["press", "front.toml", "-o", "front"]);
    let found = names(&bench.path("front"));
    for name in ["film.csv", "groove.exr", "groove.png", "result.json"] {
        assert!(found.iter().any(|n| n == name), "{found:?}");
    }
    let front = json(&bench.path("front/result.json"));
    // H = 14.7 MPa + 0.6 MPa/K 5 K.
    assert_eq!(number(&front, "hardness_pa"), 17.7e6);
    assert!((number(&front, "p_max_pa") / 17.7e6 - 1.0).abs() < 1e-9);
    // Boundary elements' figures: tests/data/groove.csv.
    let near = |key: &str, expected: f64, share: f64| {
        let found = number(&front, key);
        assert!((found / expected - 1.0).abs() < share, "{key}: {found}");
    };
    near("groove_depth_m", 3.554e-5, 0.02);
    near("mu_ploughing", 4.7585e-4, 0.03);
    near("load_ahead_m", 14.2e-3, 0.03);
    near("front_m", 49.0e-3, 0.03);
    near("fz_n", 950.0, 1e-6);
    let parts = number(&front, "mu_ploughing") + number(&front, "mu_viscous");
    assert!((number(&front, "mu") / parts - 1.0).abs() < 1e-12);
    assert!(number(&front, "mu_error") < 0.05 * parts);
    assert!(number(&front, "film_max_m") > number(&front, "film_mean_m"));
    // The film's rows carry the load: the trapezoidal rule over width times pressure.
    let film = std::fs::read_to_string(bench.path("front/film.csv")).expect("film.csv");
    let rows: Vec<Vec<f64>> = film
        .lines()
        .skip(1)
        .map(|row| {
            row.split(',')
                .map(|cell| cell.parse().expect("a number"))
                .collect()
        })
        .collect();
    let load: f64 = rows
        .windows(2)
        .map(|w| 0.5 * (w[0][0] - w[1][0]) * (w[0][1] * w[0][2] + w[1][1] * w[1][2]))
        .sum();
    assert!((load / 950.0 - 1.0).abs() < 0.05, "{load}");
    // No station carries more than the ice can, the first ones that much, and towards the back ever less.
    assert!(rows.is_sorted_by(|a, b| a[2] >= b[2]), "{rows:?}");
    assert!((rows[0][2] / 17.7e6 - 1.0).abs() < 1e-6, "{:?}", rows[0]);
    assert!(rows.iter().all(|row| row[4] <= 0.0 && row[3] > 0.0));

    // What coarser meshes change is within both errors.
    bench.write(
        "coarse.toml",
        case("").replace("p_max = 0.02", "p_max = 0.1"),
    );
    bench.succeeds(&["press", "coarse.toml", "-o", "coarse"]);
    let coarse = json(&bench.path("coarse/result.json"));
    for (key, error) in [
        ("mu", "mu_error"),
        ("film_mean_m", "film_mean_error_m"),
        ("film_max_m", "film_max_error_m"),
        ("melt_rate_kgps", "melt_rate_error_kgps"),
    ] {
        let apart = (number(&coarse, key) - number(&front, key)).abs();
        let stated = number(&coarse, error) + number(&front, error);
        assert!(apart <= stated, "{key}: {apart:e} of {stated:e}");
    }

    bench.write("rear.toml", case("previous = \"front\"\n"));
    bench.succeeds(&["press", "rear.toml", "-o", "rear"]);
    let rear = json(&bench.path("rear/result.json"));
    assert!(number(&rear, "mu_ploughing") < 0.8 * number(&front, "mu_ploughing"));
    assert!(number(&rear, "groove_depth_m") > number(&front, "groove_depth_m"));
}

#[test]
fn wrong_sliding_cases_are_refused_with_their_place() {
    let bench = Bench::new();
    let folder = bench.folder.path();
    bench.write("gone.toml", case("previous = \"nowhere\"\n"));
    refused(
        folder,
        &["press", "gone.toml"],
        3,
        &["sliding.previous", "groove.exr"],
    );
    bench.write("warm.toml", case("").replace("ice_c = -5.0", "ice_c = 0.0"));
    refused(
        folder,
        &["press", "warm.toml"],
        3,
        &["line 14", "sliding.ice_c = 0", "-50 to -0.1"],
    );
    bench.write(
        "still.toml",
        case("").replace("v_mps = 20.0", "v_mps = 0.0"),
    );
    refused(folder, &["press", "still.toml"], 3, &["sliding.v_mps = 0"]);
    let waves = "[ice.waviness]\namplitude_m = 1e-6\nwavelength_m = 0.1\n";
    bench.write("waves.toml", format!("{}{waves}", case("")));
    refused(
        folder,
        &["press", "waves.toml"],
        3,
        &["sliding", "ice.waviness"],
    );
    // Where a contact at rest is meant a sliding one is not taken for it.
    bench.write("case.toml", case(""));
    refused(
        folder,
        &["friction", "case.toml", "--v-mps", "20"],
        3,
        &["[sliding]", "at rest"],
    );
    refused(
        folder,
        &["friction", "case.toml", "--v-mps", "5,20"],
        2,
        &["several go with --groove"],
    );
    refused(
        folder,
        &["friction", "case.toml", "--v-mps", "20", "-o", "out"],
        2,
        &["--groove is missing: -o writes", "as --ice-c -5"],
    );
    refused(
        folder,
        &["friction", "case.toml", "-o", "out"],
        2,
        &["--v-mps is missing", "--ice-c is missing"],
    );
    let bounds = ["--optimise", "rocker_radius_m=15:60"];
    refused(
        folder,
        &[&["friction", "case.toml", "--v-mps", "20"], &bounds[..]].concat(),
        2,
        &["--groove is missing: --optimise compares"],
    );
    bench.write(
        "heavy.toml",
        case("").replace("fz_n = 950.0", "fz_n = 9.0e4"),
    );
    refused(
        folder,
        &["press", "heavy.toml"],
        3,
        &["heavy.toml", "90000 N", "bears on ice of this hardness"],
    );
    let words = "friction case.toml --groove --v-mps 5 --ice-c 3";
    let words: Vec<&str> = words.split(' ').collect();
    refused(folder, &words, 3, &["sliding.ice_c = 3"]);
}

#[test]
fn friction_over_speed_and_temperature_is_a_table_and_a_picture() {
    let bench = Bench::new();
    bench.write("case.toml", case(""));
    let words = [
        "friction",
        "case.toml",
        "--groove",
        "--v-mps",
        "5,20,35",
        "--ice-c",
        "-10,-3",
        "-o",
        "out",
        "--json",
    ];
    let reported: Value =
        serde_json::from_str(&succeeds(bench.folder.path(), &words)).expect("JSON");
    assert_eq!(
        names(&bench.path("out")),
        ["friction.csv", "friction.json", "friction.png"]
    );
    let points = reported["points"].as_array().expect("points");
    let mu: Vec<f64> = points.iter().map(|point| number(point, "mu")).collect();
    assert_eq!(mu.len(), 6);
    // Faster is dearer; colder ice is harder and its groove shallower.
    assert!(
        mu.chunks(3).all(|row| row[0] < row[1] && row[1] < row[2]),
        "{mu:?}"
    );
    assert!(number(&points[0], "groove_depth_m") < number(&points[3], "groove_depth_m"));
    assert!(mu.iter().all(|mu| (1e-3..8e-3).contains(mu)), "{mu:?}");
    let csv = std::fs::read_to_string(bench.path("out/friction.csv")).expect("friction.csv");
    assert_eq!(csv.lines().count(), 7);
}

#[test]
fn friction_short_of_the_accuracy_is_written_with_its_error() {
    let bench = Bench::new();
    bench.write(
        "case.toml",
        case("").replace("p_max = 0.02", "p_max = 1e-4"),
    );
    let words = [
        "friction",
        "case.toml",
        "--groove",
        "--v-mps",
        "20",
        "--ice-c",
        "-5",
        "-o",
        "out",
    ];
    refused(
        bench.folder.path(),
        &words,
        4,
        &["case.toml: estimated error"],
    );
    let point = &json(&bench.path("out/friction.json"))["points"][0];
    let error = number(point, "mu_error") / number(point, "mu");
    assert!((1e-4..0.05).contains(&error), "{error}");
}

#[test]
fn a_series_slides_in_every_step() {
    let bench = Bench::new();
    bench.write("case.toml", case(""));
    bench.succeeds(&["press", "case.toml", "--fz-n", "500,950", "-o", "out"]);
    let steps = ["step-001", "step-002"].map(|step| bench.path(&format!("out/{step}")));
    for step in &steps {
        assert!(names(step).iter().any(|name| name == "groove.exr"));
    }
    // More load ploughs deeper.
    let [less, more] = steps.map(|step| number(&json(&step.join("result.json")), "groove_depth_m"));
    assert!(less > 0.0 && less < more, "{less} {more}");
}
