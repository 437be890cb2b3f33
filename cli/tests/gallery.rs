//! The gallery's luge steels have the order of the source paper's four specimens.

#[allow(dead_code)]
mod kufe;

use std::path::Path;

use kufe::Bench;
use serde_json::Value;

fn p_max(bench: &Bench, name: &str) -> f64 {
    let case = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../docs/gallery/{name}.toml"));
    let case = case.to_string_lossy();
    let said = bench.succeeds(&["press", &case, "-o", name, "--json"]);
    let result: Value = serde_json::from_str(&said).expect("JSON");
    result["p_max_pa"].as_f64().expect("a number")
}

/// The paper's table: Alpha 1 (high rocker, round) 7.7, Alpha 2 (low, round) 8.6, Beta 1 (high, sharp) 13.6, Beta 2 (low,
/// sharp) 16.0 MPa.
#[test]
fn a_smaller_rocker_radius_and_a_sharper_section_press_harder() {
    let bench = Bench::new();
    let p = ["alpha-1", "alpha-2", "beta-1", "beta-2"].map(|name| p_max(&bench, name));
    assert!(p.windows(2).all(|w| w[0] < 0.97 * w[1]), "{p:?}");
    assert!(p[2] > 1.5 * p[1], "{p:?}");
}
