//! Results of other settings or of another version of the numerics are not used again.

use kufe_contact::NUMERICS;
use kufe_files::sha256;

use crate::kufe::{Bench, CASE, errors, json};

/// Changes of a case: a line and its replacement.
const EDITS: [(&str, &str); 9] = [
    ("p_max = 0.02", "p_max = 0.015"),
    ("poissons_ratio = 0.33", "poissons_ratio = 0.31"),
    ("youngs_modulus_pa = 9.0e9", "youngs_modulus_pa = 9.1e9"),
    ("thickness_m = 0.05", "thickness_m = 0.04"),
    (
        "thickness_m = 0.05",
        "thickness_m = 0.05\nhardness_pa = 60e6",
    ),
    ("section_radius_m = 0.005", "section_radius_m = 0.0051"),
    ("radius_m = inf", "radius_m = 90.0"),
    ("fz_n = 1000.0", "fz_n = 1000.0\noffset_x_m = 0.01"),
    (
        "p_max = 0.02",
        "p_max = 0.02\n[solver]\nstiffness = \"assembled\"",
    ),
];

const SERIES: [&str; 7] = [
    "press",
    "case.toml",
    "-o",
    "out",
    "--fz-n",
    "800,1000",
    "-q",
];

fn printed(bench: &Bench) -> String {
    bench.succeeds(&SERIES[..6])
}

#[test]
fn a_step_is_solved_again_when_any_setting_changes() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    bench.succeeds(&SERIES);
    for (line, other) in EDITS {
        let edited = CASE.replacen(line, other, 1);
        assert_ne!(edited, CASE, "{line}");
        bench.write("case.toml", edited);
        let again = printed(&bench);
        assert!(!again.contains("there already"), "{other}: {again}");
        bench.write("case.toml", CASE);
        bench.succeeds(&SERIES);
        assert!(
            printed(&bench).contains("2 of them there already"),
            "{other}"
        );
    }
}

#[test]
fn shards_of_other_settings_are_refused_except_for_other_axes() {
    let table = "case = \"case.toml\"\n[axes]\nfz_n = { values = [800.0, 1000.0] }\ncurvature_1pm = { values = [0.0] }\n\
                 [accuracy]\nchecks = 0\n";
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    bench.write("t.toml", table);
    bench.succeeds(&["lut", "plan", "t.toml", "-o", "plan", "--shards", "2", "-q"]);
    let run = ["lut", "run", "plan", "--shard", "1/2"];
    bench.succeeds(&run);
    let refused = |what: &str| {
        let output = bench.kufe(&run);
        assert_eq!(output.status.code(), Some(3), "{what}");
        let reported = errors(&output);
        assert!(reported.contains("case_sha256"), "{what}: {reported}");
    };
    for (line, other) in EDITS.iter().filter(|edit| edit.0 != "radius_m = inf") {
        bench.write("case.toml", CASE.replacen(line, other, 1));
        refused(other);
    }
    bench.write("case.toml", CASE);
    // The table's own accuracy counts as the case's does.
    bench.write("t.toml", table.replace("checks", "p_max = 0.015\nchecks"));
    refused("p_max of the table");
    bench.write("t.toml", table);
    let there = bench.succeeds(&run);
    assert!(there.contains("0 points solved, 1 were there"), "{there}");
}

/// The content of a case without files is that of the version of the numerics alone.
#[test]
fn results_of_another_version_of_the_numerics_or_of_the_program_are_solved_again() {
    let content = |numerics: u32| sha256(format!("numerics {numerics}").as_bytes());
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    bench.succeeds(&SERIES);
    let path = bench.path("out/step-001/result.json");
    let result = json(&path);
    assert_eq!(result["content_sha256"], content(NUMERICS));
    for (key, other) in [
        ("content_sha256", content(NUMERICS - 1)),
        ("version", "0.0.9".into()),
    ] {
        // The folder's record takes it for what kufe wrote.
        let text = std::fs::read_to_string(&path).expect("a result");
        let current = result[key].as_str().expect("a word");
        let older: String = other;
        let edited = text.replace(current, &older);
        std::fs::write(&path, &edited).expect("a writable file");
        let record = bench.path("out/step-001/.kufe.json");
        let recorded = std::fs::read_to_string(&record).expect("a record");
        let [before, after] = [&text, &edited].map(|text| sha256(text.as_bytes()));
        std::fs::write(&record, recorded.replace(&before, &after)).expect("a writable file");
        let again = printed(&bench);
        assert!(again.contains("1 of them there already"), "{key}: {again}");
        assert_eq!(json(&path)[key], result[key]);
    }
}

/// The groove of the runner that went before is one of the files.
#[test]
fn a_groove_that_is_met_counts() {
    let bench = Bench::new();
    bench.write(
        "case.toml",
        format!("{CASE}[sliding]\nv_mps = 25.0\nice_c = -5.0\nprevious = \"front\"\n"),
    );
    std::fs::create_dir(bench.path("front")).expect("a folder");
    let content = |groove: &str| {
        bench.write("front/groove.exr", groove);
        kufe::jobs::case_file::LoadedCase::read(&bench.path("case.toml"))
            .and_then(|case| case.content())
            .expect("a case")
    };
    assert_ne!(content("one"), content("two"));
    assert_eq!(content("one"), content("one"));
}
