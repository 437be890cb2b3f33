//! `kufe compare`: two contacts against their own result files.

use crate::kufe::{Bench, CASE, errors, json, refused};

#[test]
fn a_comparison_has_both_results_their_differences_and_the_force_that_moved() {
    let bench = Bench::new();
    bench.write("light.toml", CASE);
    bench.write("heavy.toml", CASE.replace("fz_n = 1000.0", "fz_n = 1500.0"));
    bench.succeeds(&["press", "light.toml", "-o", "light", "-q"]);
    bench.succeeds(&["press", "heavy.toml", "-o", "heavy", "-q"]);
    bench.succeeds(&["compare", "light", "heavy/", "-o", "compared"]);
    let document = json(&bench.path("compared/comparison.json"));
    let results = ["light", "heavy"].map(|name| json(&bench.path(name).join("result.json")));
    let number = |value: &serde_json::Value| value.as_f64().expect("a number");
    let rows = document["quantities"].as_array().expect("rows");
    let row = |key: &str| {
        let found = rows.iter().find(|row| row["key"] == key);
        found.unwrap_or_else(|| panic!("{key} in {document}"))
    };
    for key in [
        "fz_n",
        "p_max_pa",
        "p_mean_pa",
        "area_m2",
        "length_m",
        "width_m",
        "approach_m",
    ] {
        let [first, second] = results.each_ref().map(|result| number(&result[key]));
        let found = ["first", "second", "difference"].map(|part| number(&row(key)[part]));
        assert_eq!(found, [first, second, second - first], "{key}");
    }
    // Hertz: the peak grows as the third root of the force, 14 %, each known to 2 %.
    assert_eq!(row("p_max_pa")["exceeds_errors"], true);
    // More load raises the pressure everywhere, so that none of it acts elsewhere; a hundredth of
    // the difference of 500 N is that of the interpolation at the rim.
    let moved = number(&document["map"]["moved_n"]);
    assert!((0.0..5.0).contains(&moved), "{moved} N");
    let page = std::fs::read_to_string(bench.path("compared/comparison.html")).expect("a page");
    assert!(page.contains("peak pressure") && page.contains("data:image/png;base64,"));
    assert!(
        page.contains("<h1>light and heavy: peaks of 138."),
        "{page}"
    );

    bench.succeeds(&["compare", "light", "light", "-o", "same"]);
    let same = json(&bench.path("same/comparison.json"));
    for row in same["quantities"].as_array().expect("rows") {
        assert_eq!(number(&row["difference"]), 0.0, "{row}");
        assert_ne!(row["exceeds_errors"], true, "{row}");
    }
    assert_eq!(number(&same["map"]["moved_n"]), 0.0);
    // The load 0.15 m ahead presses another part of the rocker, 50 mm long.
    let ahead = CASE.replace("fz_n = 1000.0", "fz_n = 1000.0\noffset_x_m = 0.15");
    bench.write("ahead.toml", ahead);
    bench.succeeds(&["press", "ahead.toml", "-o", "ahead", "-q"]);
    let warned = errors(&bench.kufe(&["compare", "light", "ahead", "-o", "beside"]));
    assert!(
        warned.contains("the maps do not overlap: their middles are 1"),
        "{warned}"
    );
    let missing = ["compare", "light", "none", "-o", "n"];
    refused(bench.folder.path(), &missing, 3, &["none/result.json"]);
}
