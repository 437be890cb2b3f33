//! A table of the reference runner against Hertz's closed form.

use kufe_contact::hertz;
use serde_json::Value;

use crate::kufe::Bench;

const ROCKER: f64 = 30.0;
const SECTION: f64 = 0.005;
const FORCES: [f64; 8] = [250.0, 370.0, 550.0, 820.0, 1220.0, 1810.0, 2690.0, 4000.0];
/// Relative radii of rocker and track [m].
const RADII: [f64; 8] = [15.0, 22.0, 30.0, 45.0, 70.0, 105.0, 160.0, 250.0];

#[test]
fn sixty_four_fields_have_the_peaks_of_hertz() {
    let bench = Bench::new();
    bench.write(
        "case.toml",
        format!(
            "[runner]\nshape = {{ kind = \"paraboloid\", rocker_radius_m = {ROCKER:.1}, section_radius_m = {SECTION} }}\n\
             [ice]\nyoungs_modulus_pa = 9.0e9\npoissons_ratio = 0.33\nthickness_m = \"half-space\"\n\
             [load]\nfz_n = 1000.0\n"
        ),
    );
    let curvatures = RADII.map(|radius| 1.0 / ROCKER - 1.0 / radius);
    bench.write(
        "table.toml",
        format!(
            "case = \"case.toml\"\n[axes]\nfz_n = {{ values = {FORCES:?} }}\n\
             curvature_1pm = {{ values = {curvatures:?} }}\n[accuracy]\np_max = 0.005\nchecks = 0\n"
        ),
    );
    let printed = bench.succeeds(&["lut", "table.toml", "-o", "t.lut", "--json"]);
    let summary: Value = serde_json::from_str(&printed).expect("JSON");
    assert_eq!(summary["solves"], 64);

    let text = std::fs::read_to_string(bench.path("t.lut")).expect("the table");
    let table: Value = serde_json::from_str(&text).expect("JSON");
    let modulus = 9.0e9 / (1.0 - 0.33 * 0.33);
    let figure = |name: &str, i: usize, j: usize| {
        let (name, list) = match name.strip_suffix("_error") {
            Some(name) => (name, "errors"),
            None => (name, "values"),
        };
        let value = table["quantities"][name][list][i][j].as_f64();
        value.unwrap_or_else(|| panic!("{name} at {i}, {j} is no number"))
    };
    let mut worst = [0.0f64; 2];
    for (i, force) in FORCES.into_iter().enumerate() {
        for (j, radius) in RADII.into_iter().enumerate() {
            let exact = hertz(radius, SECTION, modulus, force).unwrap();
            let p_max = (figure("p_max", i, j) / exact.p_max - 1.0).abs();
            let approach = (figure("approach", i, j) / exact.approach - 1.0).abs();
            let estimate = figure("p_max_error", i, j) / exact.p_max;
            assert!(p_max <= 0.005, "{force} N, {radius} m: off by {p_max}");
            assert!(
                p_max <= estimate,
                "{force} N, {radius} m: off by {p_max}, {estimate} estimated"
            );
            assert!(approach <= 0.01, "{force} N, {radius} m: {approach}");
            worst = [worst[0].max(p_max), worst[1].max(approach)];
        }
    }
    println!(
        "64 fields in {} s; p_max within {:.2e}, approach within {:.2e} of Hertz",
        summary["seconds"], worst[0], worst[1]
    );
}
