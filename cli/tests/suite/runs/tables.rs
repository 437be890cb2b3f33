//! Where runs lie on a table: in the results of commands, and by `kufe lut show --runs`.

use crate::kufe::{Bench, errors};

const TABLE: &str = "case = \"case.toml\"\n[axes]\nfz_n = { values = [1000.0, 1500.0, 2000.0] }\n\
                     curvature_1pm = { values = [0.0, 0.01] }\n";

const TRACK: &str = "s_m,slope_rad,curvature_1pm,bank_rad\n0,0.1,0,0\n50,0.1,0,0\n100,0.1,0.02,0\n150,0.1,0.02,0\n\
                     200,0.1,0,0\n250,0.1,0,0\n300,0.1,0,0\n";

/// A blunt runner, whose pressures are within the published law.
const CASE: &str = "[runner]\nshape = { kind = \"paraboloid\", rocker_radius_m = 30.0, section_radius_m = 0.5 }\n[ice]\n\
                    youngs_modulus_pa = 9.0e9\npoissons_ratio = 0.33\nthickness_m = \"half-space\"\n[load]\nfz_n = 1000.0\n\
                    [accuracy]\np_max = 0.02\n";

/// `N` of the warning `table: N of M samples of the RUNNER runner lie outside`.
fn warned(reported: &str, runner: &str) -> u64 {
    let end = format!(" samples of the {runner} runner lie outside");
    let line = reported
        .lines()
        .find(|line| line.contains(&end))
        .expect(&end);
    let count = line.split(" of ").next().and_then(|l| l.rsplit(' ').next());
    count.expect("a number").parse().expect("a number")
}

#[test]
fn samples_are_drawn_on_their_tables_and_those_outside_counted() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    bench.write("table.toml", TABLE);
    bench.write("track.csv", TRACK);
    bench.succeeds(&["lut", "table.toml", "-o", "narrow.lut"]);
    bench.succeeds(&["init", "--kind", "model", "plain.toml"]);
    let plain = std::fs::read_to_string(bench.path("plain.toml")).expect("a model");
    let law = "b = 0.088\nc = 2.01\nd = 14.66\nfront_table = \"narrow.lut\"\nrear_table = \"narrow.lut\"\n";
    let constant = plain.lines().find(|l| l.starts_with("mu = ")).expect("mu");
    bench.write("model.toml", plain.replacen(constant, law, 1));

    let words = [
        "simulate",
        "model.toml",
        "track.csv",
        "--runs",
        "2",
        "--json",
    ];
    let simulated = bench.kufe(&[&words[..], &["-o", "runs"]].concat());
    let reported = errors(&simulated);
    assert!(simulated.status.success(), "{reported}");
    assert!(warned(&reported, "front") > 0);
    for name in ["table_front.png", "table_rear.png"] {
        assert!(bench.path(&format!("runs/{name}")).exists(), "{name}");
    }

    let words = ["evaluate", "runs/runs.csv", "--model", "model.toml"];
    let evaluated = bench.kufe(&[&words[..], &["-o", "out"]].concat());
    let reported = errors(&evaluated);
    assert!(evaluated.status.success(), "{reported}");
    let own = std::fs::read(bench.path("out/table_front.png")).expect("a picture");

    bench.succeeds(&["report", "out"]);
    let page = std::fs::read_to_string(bench.path("out/report.html")).expect("a page");
    assert_eq!(page.matches("data:image/png").count(), 2);

    // The same samples by `lut show`, by a model without the table.
    let show = ["lut", "show", "narrow.lut", "--json", "-o", "shown.png"];
    let runs = [
        "--runs",
        "runs/runs.csv",
        "--model",
        "plain.toml",
        "--runner",
        "front",
    ];
    let shown = bench.succeeds(&[&show[..], &runs[..]].concat());
    let shown: serde_json::Value = serde_json::from_str(&shown).expect("JSON");
    assert_eq!(shown["outside"], warned(&reported, "front"));
    assert!(shown["samples"].as_u64() > shown["outside"].as_u64());
    let again = std::fs::read(bench.path("shown.png")).expect("a picture");
    assert!(own == again, "two pictures of the same samples");
    bench.succeeds(&show);
    assert!(own != std::fs::read(bench.path("shown.png")).expect("a picture"));

    // Without tables in the model there are no pictures of them, nor such of before.
    let words = ["evaluate", "runs/runs.csv", "--model", "plain.toml"];
    bench.succeeds(&[&words[..], &["-o", "out"]].concat());
    assert!(!bench.path("out/table_front.png").exists());
    let refused = bench.kufe(&["lut", "show", "narrow.lut", "--runs", "runs/runs.csv"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(errors(&refused).contains("--model"));
}
