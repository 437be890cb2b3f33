//! `kufe friction`: runners side by side, and the one with the least friction within bounds.

use serde_json::Value;

use crate::kufe::{Bench, names, refused, succeeds};

/// A runner of these radii [m] on ice.
fn case(rocker: f64, section: f64) -> String {
    format!(
        "[runner]\nshape = {{ kind = \"bob\", length_m = 1.0, rocker_radius_m = {rocker}, section_radius_m = {section}, width_m = 0.008, height_m = 0.030 }}\n\
         [ice]\nyoungs_modulus_pa = 9.0e9\npoissons_ratio = 0.33\nthickness_m = \"half-space\"\n\
         [load]\nfz_n = 950.0\ntilt = \"fixed\"\n[accuracy]\np_max = 0.02\n"
    )
}

const AT: [&str; 5] = ["--groove", "--v-mps", "30", "--ice-c", "-8"];

fn reported(bench: &Bench, cases: &[&str], more: &[&str]) -> Value {
    let words = [&["friction"], cases, &AT, &["--json"], more].concat();
    serde_json::from_str(&succeeds(bench.folder.path(), &words)).expect("JSON")
}

fn number(value: &Value, key: &str) -> f64 {
    value[key]
        .as_f64()
        .unwrap_or_else(|| panic!("no {key}: {value}"))
}

/// A dense scan over the rocker and the search over the same bounds find the same least friction; where a scanned runner loses more
/// than its error it is outside the range that is as good as the best, and equals the best inside.
#[test]
#[ignore = "slow study: .ci/slow"]
fn the_search_finds_the_least_friction_of_a_dense_scan() {
    let bench = Bench::new();
    let rockers: Vec<f64> = (0..10).map(|k| 15.0 + 5.0 * f64::from(k)).collect();
    let files: Vec<String> = rockers.iter().map(|r| format!("r{r}.toml")).collect();
    for (rocker, file) in rockers.iter().zip(&files) {
        bench.write(file, case(*rocker, 0.004));
    }
    let files: Vec<&str> = files.iter().map(String::as_str).collect();
    let scan = reported(&bench, &files, &[]);
    let mu: Vec<f64> = scan["points"]
        .as_array()
        .expect("points")
        .iter()
        .map(|p| number(p, "mu"))
        .collect();
    let least = mu.iter().copied().fold(f64::INFINITY, f64::min);
    let span = ["--optimise", "rocker_radius_m=15:60", "-o", "out"];
    let found = reported(&bench, &["r30.toml"], &span);
    assert_eq!(
        names(&bench.path("out")),
        ["friction.csv", "friction.json", "friction.png"]
    );
    let (best, error) = (number(&found, "mu"), number(&found, "mu_error"));
    assert!((best - least).abs() <= error, "{best} {error} {least}");
    assert!(number(&found, "response_miss").abs() < 0.01, "{found}");
    let rocker = &found["parameters"][0];
    assert_eq!(rocker["on_bound"], false);
    let (from, to) = (number(rocker, "flat_from"), number(rocker, "flat_to"));
    for (r, mu) in rockers.iter().zip(&mu) {
        let inside = (from..=to).contains(r);
        assert!(!inside || *mu < best + 2.0 * error, "{r} {mu} {found}");
        assert!(inside || *mu > best, "{r} {mu} {found}");
    }
    // A blunter section has less friction, up to the bound.
    let blunt = reported(
        &bench,
        &["r30.toml"],
        &["--optimise", "section_radius_m=0.004:0.008"],
    );
    let section = &blunt["parameters"][0];
    assert!(
        section["on_bound"] == true && number(section, "value") == 0.008,
        "{blunt}"
    );
    assert!(number(&blunt, "mu") < best - error);
}

#[test]
fn the_fastest_runner_is_named_where_the_errors_allow() {
    let bench = Bench::new();
    bench.write("sharp.toml", case(30.0, 0.004));
    bench.write("same.toml", case(31.0, 0.004));
    bench.write("blunt.toml", case(30.0, 0.008));
    let far = reported(&bench, &["sharp.toml", "blunt.toml"], &["-o", "out"]);
    assert_eq!(far["fastest"][0]["cases"], serde_json::json!(["blunt"]));
    let near = reported(&bench, &["sharp.toml", "same.toml"], &[]);
    assert_eq!(
        near["fastest"][0]["cases"],
        serde_json::json!(["sharp", "same"])
    );
    let csv = std::fs::read_to_string(bench.path("out/friction.csv")).expect("friction.csv");
    let first: Vec<&str> = csv
        .lines()
        .map(|l| l.split(',').next().unwrap_or(""))
        .collect();
    assert_eq!(first, ["case", "sharp", "blunt"]);
}

#[test]
fn an_impossible_search_is_refused_with_its_place() {
    let bench = Bench::new();
    let folder = bench.folder.path();
    bench.write("case.toml", case(30.0, 0.004));
    for (parameter, code, parts) in [
        (
            "rocker_radius_m=15",
            2,
            ["KEY=LOW:HIGH", "rocker_radius_m=15"],
        ),
        (
            "rocker_radius_m=60:15",
            2,
            ["upper bound = 15", "above the lower"],
        ),
        ("rocker_radius_m=a:15", 2, ["\"a\"", "a number"]),
        (
            "rocker_radius_m=1:2,rocker_radius_m=1:3",
            2,
            ["one parameter or two", "once"],
        ),
        (
            "edge_radius_m=1:2",
            3,
            ["runner.shape.edge_radius_m", "section_radius_m"],
        ),
        (
            "section_radius_m=0.003:0.008",
            3,
            ["section_radius_m = 0.003", "runner.shape"],
        ),
    ] {
        let words = [
            &["friction", "case.toml"],
            &AT[..],
            &["--optimise", parameter],
        ]
        .concat();
        refused(folder, &words, code, &parts);
    }
    let two = [
        "friction",
        "case.toml",
        "--groove",
        "--v-mps",
        "5,30",
        "--ice-c",
        "-8",
        "--optimise",
        "rocker_radius_m=15:60",
    ];
    refused(folder, &two, 2, &["one --v-mps"]);
}
