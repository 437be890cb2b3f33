//! The gallery's luge steels have the order of the source paper's four specimens.

use std::path::Path;

use serde_json::Value;

use crate::kufe::Bench;

fn p_max(bench: &Bench, name: &str) -> f64 {
    let case = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../docs/gallery/{name}.toml"));
    let case = case.to_string_lossy();
    let printed = bench.succeeds(&["press", &case, "-o", name, "--json"]);
    let result: Value = serde_json::from_str(&printed).expect("JSON");
    result["p_max_pa"].as_f64().expect("a number")
}

/// The paper's table: Alpha 1 (high rocker, round) 7.7, Alpha 2 (low, round) 8.6, Beta 1 (high, sharp) 13.6, Beta 2 (low,
/// sharp) 16.0 MPa.
#[test]
#[ignore = "slow study: .ci/slow"]
fn a_smaller_rocker_radius_and_a_sharper_section_press_harder() {
    let bench = Bench::new();
    let p = ["alpha-1", "alpha-2", "beta-1", "beta-2"].map(|name| p_max(&bench, name));
    assert!(p.windows(2).all(|w| w[0] < 0.97 * w[1]), "{p:?}");
    assert!(p[2] > 1.5 * p[1], "{p:?}");
}

/// All of the ice under the runner is at its bound but for the node that takes the rest of the load.
#[test]
fn ice_that_gives_way_bears_the_whole_load() {
    let bench = Bench::new();
    let case = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/gallery/bounded.toml");
    bench.succeeds(&["press", case]);
    let text = std::fs::read_to_string(bench.path("out/result.json")).expect("result.json");
    let result: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let number = |key: &str| result[key].as_f64().expect(key);
    assert!(
        (number("fz_n") / 1000.0 - 1.0).abs() < 1e-8,
        "{}",
        number("fz_n")
    );
    assert!(number("kkt_residual") < 1e-8 && number("p_max_pa") <= 17.7e6 * (1.0 + 1e-9));
}
