//! No result is taken for another's: whatever a case reads counts, by its content.

use std::time::{Duration, SystemTime};

use crate::kufe::{Bench, errors, json};

/// A hull and a buffer of its own, a measured section and a measured ice surface, each with two contents.
const BODIES: [(&str, &str); 3] = [
    (
        "section",
        "shape = { kind = \"bob\", length_m = 1.0, rocker_radius_m = 30.0, section_radius_m = 0.005, width_m = 0.010, height_m = 0.030 }\n[runner.section]\nprofile = \"part\"",
    ),
    (
        "surface",
        "shape = { kind = \"bob\", length_m = 1.0, rocker_radius_m = 30.0, section_radius_m = 0.005, width_m = 0.010, height_m = 0.030 }",
    ),
    ("hull", "hull = \"part\""),
];

fn case(kind: &str, file: &str) -> String {
    let (_, runner) = BODIES
        .iter()
        .find(|(name, _)| *name == kind)
        .expect("a known kind");
    let surface = match kind {
        "surface" => format!("surface = \"{file}\"\n"),
        _ => String::new(),
    };
    format!(
        "[runner]\n{}\n[ice]\nyoungs_modulus_pa = 9.0e9\npoissons_ratio = 0.33\nthickness_m = 0.05\n{surface}\
         [load]\nfz_n = 1000.0\n[accuracy]\np_max = 0.05\n",
        runner.replace("part", file)
    )
}

fn section(radius: f64) -> String {
    let mut text = String::from("y_m,z_m\n");
    for i in -20..=20 {
        let y = 2e-4 * f64::from(i);
        text += &format!("{y},{}\n", y * y / (2.0 * radius));
    }
    text
}

fn surface(height: f64) -> String {
    let mut text = String::from("x_m,y_m,z_m\n");
    for i in -10..=10 {
        for j in -1..=1 {
            let (x, y) = (0.1 * f64::from(i), 0.1 * f64::from(j));
            text += &format!("{x},{y},{}\n", height * x * x);
        }
    }
    text
}

/// The file's name, and writes one of its two contents under an old time stamp.
fn write(bench: &Bench, kind: &str, second: bool) -> &'static str {
    let name = match kind {
        "section" => "section.csv",
        "surface" => "ice.csv",
        _ => "bob.obj",
    };
    match kind {
        "section" => bench.write(name, section(if second { 0.006 } else { 0.005 })),
        "surface" => bench.write(name, surface(if second { 1e-3 } else { 0.0 })),
        _ => {
            let length = if second { "0.9" } else { "1.0" };
            let words = [
                "hull",
                "bob",
                "--length-m",
                length,
                "-o",
                name,
                "-q",
                "--force",
            ];
            bench.succeeds(&words);
        }
    }
    let old = SystemTime::now() - Duration::from_secs(10 * 24 * 3600);
    let file = std::fs::File::options()
        .write(true)
        .open(bench.path(name))
        .expect("there");
    file.set_modified(old).expect("a time stamp");
    name
}

#[test]
fn a_step_is_solved_again_when_a_file_of_its_case_changes_whatever_its_time_stamp() {
    for (kind, _) in BODIES {
        let bench = Bench::new();
        let name = write(&bench, kind, false);
        bench.write("case.toml", case(kind, name));
        let words = ["press", "case.toml", "-o", "out", "--fz-n", "800,1000"];
        bench.succeeds(&words);
        let before = json(&bench.path("out/step-001/result.json"));
        assert!(bench.succeeds(&words).contains("2 of them there already"));
        // Another name for the same content is the same case's content; an older file moved into place is another.
        write(&bench, kind, true);
        let printed = bench.succeeds(&words);
        assert!(!printed.contains("there already"), "{kind}: {printed}");
        let after = json(&bench.path("out/step-001/result.json"));
        assert_ne!(before["content_sha256"], after["content_sha256"], "{kind}");
        assert_ne!(before["approach_m"], after["approach_m"], "{kind}");
    }
}

#[test]
fn a_changed_buffer_of_a_gltf_file_counts() {
    let bench = Bench::new();
    let body = |height: f32| -> Vec<u8> {
        let corners = [
            [-0.5f32, -0.005],
            [0.5, -0.005],
            [-0.5, 0.005],
            [0.5, 0.005],
        ];
        corners
            .iter()
            .flat_map(|[x, y]| [*x, *y, height])
            .flat_map(f32::to_le_bytes)
            .collect()
    };
    bench.write("body.bin", body(0.0));
    bench.write(
        "body.gltf",
        r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[-0.5,-0.005,0],"max":[0.5,0.005,0]}],
"bufferViews":[{"buffer":0,"byteLength":48}],"buffers":[{"byteLength":48,"uri":"body.bin"}]}"#,
    );
    bench.write("case.toml", case("hull", "body.gltf"));
    let loaded = |bench: &Bench| {
        kufe::jobs::case_file::LoadedCase::read(&bench.path("case.toml"))
            .and_then(|case| case.content())
            .expect("a case")
    };
    let before = loaded(&bench);
    assert_eq!(before, loaded(&bench));
    bench.write("body.bin", body(0.001));
    assert_ne!(before, loaded(&bench));
}

#[test]
fn a_mesh_of_a_runner_counts() {
    let bench = Bench::new();
    let runner = "mesh = \"runner.vtu\"\nelastic = true";
    bench.write(
        "case.toml",
        case("hull", "x.obj").replace("hull = \"x.obj\"", runner),
    );
    let content = |text: &str| {
        bench.write("runner.vtu", text);
        kufe::jobs::case_file::LoadedCase::read(&bench.path("case.toml"))
            .and_then(|case| case.content())
            .expect("a case")
    };
    assert_ne!(content("one"), content("two"));
    assert_eq!(content("one"), content("one"));
}

#[test]
fn points_of_a_plan_belong_to_the_content_of_every_file() {
    for (kind, _) in BODIES {
        let bench = Bench::new();
        let name = write(&bench, kind, false);
        bench.write("case.toml", case(kind, name));
        bench.write(
            "t.toml",
            "case = \"case.toml\"\n[axes]\nfz_n = { values = [800.0, 1000.0] }\ncurvature_1pm = { values = [0.0] }\n\
             [accuracy]\np_max = 0.05\nchecks = 0\n",
        );
        bench.succeeds(&["lut", "plan", "t.toml", "-o", "plan", "--shards", "2", "-q"]);
        bench.succeeds(&["lut", "run", "plan", "--shard", "1/2", "-q"]);
        write(&bench, kind, true);
        let output = bench.kufe(&["lut", "run", "plan", "--shard", "2/2"]);
        assert_eq!(output.status.code(), Some(3), "{kind}");
        assert!(
            errors(&output).contains("case_sha256"),
            "{kind}: {}",
            errors(&output)
        );
        // Back again, the point solved before is still there.
        write(&bench, kind, false);
        let printed = bench.succeeds(&["lut", "run", "plan", "--shard", "1/2"]);
        assert!(
            printed.contains("0 points solved, 1 were there"),
            "{kind}: {printed}"
        );
    }
}
