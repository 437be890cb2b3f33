//! `kufe discover` on friction experiments and with bad input, as a user meets it.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

type Outcome = Result<(), Box<dyn std::error::Error>>;

/// The published table of seven specimens.
const TABLE: &str = "\
specimen,p_max_pa,p_max_sd_pa,mu,mu_sd
Alpha 1,7.7e6,0.4e6,0.0045,0.0004
Alpha 2,8.6e6,0.5e6,0.0038,0.0004
Beta 1,13.6e6,0.7e6,0.0042,0.0004
Beta 2,16.0e6,0.9e6,0.0046,0.0004
Gamma 1,10.9e6,0.6e6,0.0030,0.0003
Gamma 2,11.8e6,0.6e6,0.0027,0.0003
Gamma 3,9.6e6,0.5e6,0.0033,0.0003
";

const MODEL: &str = "\
[sled]
mass_kg = 390.0
j_yy_kgm2 = 145.0
j_zz_kgm2 = 150.0
l_f_m = 0.82
l_r_m = 0.88
cda_m2 = 0.28
[friction.longitudinal]
b = 0.088
c = 2.01
d = 14.66
mu_cap = 0.007
[friction.front]
mu_zeta = 2.577
c = 0.024
e = 0.99
k_n_per_rad = 10522.0
[friction.rear]
mu_zeta = 3.288
c = 0.076
e = 0.99
k_n_per_rad = 49776.0
";

fn discover(folder: &Path, data: &str, further: &[&str]) -> std::io::Result<Output> {
    Command::new(env!("CARGO_BIN_EXE_kufe"))
        .current_dir(folder)
        .args(["discover", data, "--model", "model.toml", "-o", "out"])
        .args(further)
        .output()
}

fn refused(table: &str, parts: &[&str]) -> Outcome {
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("model.toml"), MODEL)?;
    std::fs::write(folder.path().join("experiments.csv"), table)?;
    let output = discover(folder.path(), "experiments.csv", &[])?;
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(3), "{told}");
    for part in parts {
        assert!(told.contains(part), "{part} not in {told}");
    }
    assert!(!folder.path().join("out/report.json").exists());
    Ok(())
}

#[test]
fn nothing_is_found_in_the_seven_points_and_the_next_model_is_accepted() -> Outcome {
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("model.toml"), MODEL)?;
    std::fs::write(folder.path().join("experiments.csv"), TABLE)?;
    let output = discover(folder.path(), "experiments.csv", &["--json"])?;
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{told}");
    let printed: Value = serde_json::from_slice(&output.stdout)?;
    assert_eq!(printed["verdict"], "none");
    assert_eq!(printed["steps"], Value::Array(Vec::new()));
    let out = folder.path().join("out");
    let written: Value = serde_json::from_slice(&std::fs::read(out.join("report.json"))?)?;
    assert_eq!(written, printed);
    let page = std::fs::read_to_string(out.join("report.html"))?;
    assert!(page.contains("7 points") && page.ends_with("</html>\n"));
    // What is written as the next model is read as a model, and has nothing to find either.
    std::fs::copy(
        out.join("model.next.toml"),
        folder.path().join("model.toml"),
    )?;
    let again = discover(folder.path(), "experiments.csv", &["--json"])?;
    let again: Value = serde_json::from_slice(&again.stdout)?;
    assert_eq!(again["verdict"], "none");
    Ok(())
}

#[test]
fn two_runs_of_the_command_write_the_same_bytes() -> Outcome {
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("model.toml"), MODEL)?;
    std::fs::write(folder.path().join("experiments.csv"), TABLE)?;
    let one = discover(
        folder.path(),
        "experiments.csv",
        &["--json", "--threads", "1"],
    )?;
    let two = discover(
        folder.path(),
        "experiments.csv",
        &["--json", "--threads", "2"],
    )?;
    assert!(!one.stdout.is_empty());
    assert_eq!(one.stdout, two.stdout);
    Ok(())
}

#[test]
fn a_copied_row_a_missing_column_and_a_word_for_a_number_are_refused() -> Outcome {
    let copied = format!("{TABLE}Delta,7.7e6,0.4e6,0.0045,0.0004\n");
    refused(&copied, &["experiments.csv", "row 2", "row 9"])?;
    let without = TABLE.replace("mu_sd", "deviation");
    refused(&without, &["experiments.csv", "mu_sd"])?;
    let word = TABLE.replace("0.0030", "slow");
    refused(&word, &["experiments.csv", "mu", "slow"])
}

#[test]
fn cells_columns_and_files_that_are_wrong_are_named_with_their_place() -> Outcome {
    let empty = TABLE.replace("8.6e6,0.5e6,0.0038", "8.6e6,0.5e6,");
    refused(
        &empty,
        &["experiments.csv", "row 3", "column mu:", "\"\"", "a number"],
    )?;
    let nan = TABLE.replace("16.0e6,0.9e6", "NaN,0.9e6");
    refused(&nan, &["row 5", "p_max_pa", "NaN"])?;
    let mpa = TABLE.replace("0.0042", "4.2");
    refused(&mpa, &["row 4", "mu", "4.2", "from 0 to 1"])?;
    let one: String = TABLE.lines().take(2).map(|l| format!("{l}\n")).collect();
    refused(&one, &["experiments.csv: rows", "found 1", "at least 5"])?;
    refused(
        "specimen,p_max_pa,p_max_sd_pa,mu,mu_sd\n",
        &["experiments.csv", "no rows"],
    )?;
    refused(
        "a,b\n1,2\n",
        &["experiments.csv", "a, b", "runs.csv", "pressures.csv"],
    )?;
    let ragged = TABLE.replace("0.0030,0.0003", "0.0030");
    refused(&ragged, &["experiments.csv", "line: 6"])?;
    let twice = TABLE.replace("p_max_sd_pa", "mu");
    refused(&twice, &["experiments.csv", "`mu`", "twice"])?;
    let gap = TABLE
        .replace("mu_sd", "mu_sd,ice_c")
        .replace("0004\n", "0004,-5\n")
        .replace("0003\n", "0003,\n");
    refused(&gap, &["row 6", "ice_c", "\"\"", "a number"])
}

#[test]
fn missing_files_folders_and_unknown_effects_are_named() -> Outcome {
    let folder = tempfile::tempdir()?;
    let at = folder.path();
    let told = |output: &Output| String::from_utf8_lossy(&output.stderr).into_owned();
    std::fs::write(at.join("experiments.csv"), TABLE)?;
    let output = discover(at, "experiments.csv", &[])?;
    assert_eq!(output.status.code(), Some(3));
    assert!(told(&output).contains("model.toml"), "{}", told(&output));
    std::fs::write(at.join("model.toml"), MODEL)?;
    let output = discover(at, "nowhere.csv", &[])?;
    assert_eq!(output.status.code(), Some(3));
    assert!(told(&output).contains("nowhere.csv"), "{}", told(&output));
    let output = discover(at, ".", &[])?;
    assert_eq!(output.status.code(), Some(3));
    for part in ["a folder", "such as ./experiments.csv"] {
        assert!(told(&output).contains(part), "{}", told(&output));
    }
    for (effect, parts) in [
        (
            "[effects.rust]\nslope = 1.0\n",
            ["rust", "unknown effect", "temperature"],
        ),
        (
            "[effects.temperature]\nslope = 1.0\n",
            ["temperature", "`slope`", "slope_per_k"],
        ),
        (
            "[effects.temperature]\nslope_per_k = -0.01\n",
            ["ice_c", "missing", "temperature"],
        ),
        (
            "[effects.mine]\nexpression = \"v_mps *\"\nchannel = \"friction\"\n",
            ["mine", "expression", "the end"],
        ),
        (
            "[effects.mine]\nexpression = \"vmps\"\nchannel = \"friction\"\n",
            ["mine", "vmps", "v_mps"],
        ),
    ] {
        std::fs::write(at.join("model.toml"), format!("{MODEL}{effect}"))?;
        let output = discover(at, "experiments.csv", &[])?;
        assert_eq!(output.status.code(), Some(3), "{}", told(&output));
        for part in parts {
            assert!(
                told(&output).contains(part),
                "no {part} in {}",
                told(&output)
            );
        }
    }
    Ok(())
}

/// A normal variate from a congruential sequence (the sum of twelve uniform ones).
fn normal(state: &mut u64) -> f64 {
    let mut sum = -6.0;
    for _ in 0..12 {
        *state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        sum += (*state >> 11) as f64 / (1u64 << 53) as f64;
    }
    sum
}

/// Sixty rows of eight sessions with mu times `factor(ice_c, v_mps)` of the published law, and noise of 3 per cent.
fn table(factor: impl Fn(f64, f64) -> f64) -> String {
    let mut state = 11;
    let mut text =
        String::from("specimen,p_max_pa,p_max_sd_pa,mu,mu_sd,session,ice_c,air_c,v_mps,lab\n");
    for k in 0..60 {
        let p = 7.0 + 9.0 * f64::from(k % 7) / 6.0;
        let session = k / 8;
        let ice = -2.0 - 1.3 * f64::from((session * 5) % 8) + 0.3 * normal(&mut state);
        let v = 5.0 + 0.35 * f64::from((k * 17) % 60);
        let law = 1e-3 * (0.088 * p * p - 2.01 * p + 14.66);
        let mu = law * factor(ice, v) + 0.03 * law * normal(&mut state);
        text += &format!(
            "s{k},{:.0},1e4,{mu:.7},{:.7},d{session},{ice:.3},3.0,{v:.2},west\n",
            1e6 * p,
            0.03 * law
        );
    }
    text
}

fn report(folder: &Path, model: &str) -> Result<Value, Box<dyn std::error::Error>> {
    std::fs::write(folder.join("model.toml"), model)?;
    let output = discover(folder, "experiments.csv", &["--json"])?;
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    Ok(serde_json::from_slice(&output.stdout)?)
}

fn next(folder: &Path) -> Result<String, std::io::Error> {
    std::fs::read_to_string(folder.join("out/model.next.toml"))
}

#[test]
fn constant_and_absent_columns_list_the_effects_that_need_them() -> Outcome {
    let folder = tempfile::tempdir()?;
    let constant: String = table(|_, _| 1.0)
        .lines()
        .enumerate()
        .map(|(k, line)| {
            let mut cells: Vec<&str> = line.split(',').collect();
            if k > 0 {
                cells[6] = "-5.0";
            }
            cells.join(",") + "\n"
        })
        .collect();
    std::fs::write(folder.path().join("experiments.csv"), constant)?;
    let found = report(folder.path(), MODEL)?;
    assert_eq!(found["verdict"], "none", "{}", found["sentence"]);
    for (effect, column) in [
        ("temperature", "ice_c"),
        ("humidity", "humidity_pct"),
        ("load", "fz_n"),
    ] {
        let why = found["untestable"]
            .as_array()
            .and_then(|all| all.iter().find(|one| one[0] == effect))
            .map(|one| one[1].to_string());
        assert!(
            why.clone().is_some_and(|why| why.contains(column)),
            "{effect}: {why:?}"
        );
    }
    Ok(())
}

#[test]
fn a_hidden_temperature_is_named_and_acts_in_the_next_model() -> Outcome {
    let folder = tempfile::tempdir()?;
    let at = folder.path();
    std::fs::write(
        at.join("experiments.csv"),
        table(|ice, _| 1.0 - 0.03 * (ice + 5.0)),
    )?;
    let found = report(at, MODEL)?;
    let step = &found["steps"][0];
    assert_eq!(step["effect"], "temperature", "{}", found["sentence"]);
    let slope = &step["parameters"][0];
    assert!(
        slope["low"].as_f64() < Some(-0.03) && slope["high"].as_f64() > Some(-0.03),
        "{slope}"
    );
    // With the next model nothing is left to be found.
    let text = next(at)?;
    let again = report(at, &text)?;
    assert_eq!(again["verdict"], "none", "{}", again["sentence"]);
    // `friction`, `simulate`, `validate` and `evaluate` act on it: colder ice is slower.
    let kufe = |words: &[&str]| -> Result<String, Box<dyn std::error::Error>> {
        let output = Command::new(env!("CARGO_BIN_EXE_kufe"))
            .current_dir(at)
            .args(words)
            .output()?;
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(0), "{words:?}: {told}");
        Ok(String::from_utf8(output.stdout)?)
    };
    std::fs::write(at.join("next.toml"), &text)?;
    let mut off = kufe_sled::Model::load(&at.join("next.toml"))?;
    let value = slope["value"].as_f64().ok_or("no size")?;
    assert_eq!(
        off.effects["temperature"]["slope_per_k"].as_float(),
        Some(value)
    );
    off.effects.clear();
    std::fs::write(at.join("off.toml"), off.to_toml())?;
    std::fs::write(
        at.join("case.toml"),
        "[runner]\nshape = { kind = \"paraboloid\", rocker_radius_m = 30.0, section_radius_m = 0.5 }\n\
         [ice]\nyoungs_modulus_pa = 9.0e9\npoissons_ratio = 0.33\nthickness_m = \"half-space\"\n\
         [load]\nfz_n = 200.0\ntilt = \"fixed\"\npitch_rad = 0.0\nroll_rad = 0.0\n",
    )?;
    let mu = |model: &str| -> Result<f64, Box<dyn std::error::Error>> {
        let words = [
            "friction",
            "case.toml",
            "--speed",
            "30",
            "--ice-c",
            "-12",
            "--model",
            model,
            "--json",
        ];
        let printed: Value = serde_json::from_str(&kufe(&words)?)?;
        printed["mu"].as_f64().ok_or_else(|| "no mu".into())
    };
    let ratio = mu("next.toml")? / mu("off.toml")?;
    assert!((ratio - (1.0 + value * -7.0)).abs() < 1e-9, "{ratio}");
    // Runs need a law of their own for mu: the next model's effect on a constant one.
    for name in ["next", "off"] {
        let mut model = kufe_sled::Model::load(&at.join(format!("{name}.toml")))?;
        model.friction.longitudinal = kufe_friction::LongitudinalKeys {
            mu: Some(0.005),
            ..Default::default()
        };
        std::fs::write(at.join(format!("{name}_run.toml")), model.to_toml())?;
    }
    kufe_sled::sample_data::sample_track("west")
        .write_csv(std::fs::File::create(at.join("track_w.csv"))?)?;
    let end = |model: &str, out: &str| -> Result<f64, Box<dyn std::error::Error>> {
        let drive = [
            "--ice-c",
            "-12",
            "--no-noise",
            "--rate",
            "100",
            "--step",
            "2.5e-3",
            "-o",
            out,
        ];
        kufe(&[&["simulate", model, "track_w.csv"], &drive[..]].concat())?;
        let text = std::fs::read_to_string(at.join(out).join("run_001.csv"))?;
        let mut lines = text.lines();
        let header = lines.next().ok_or("no header")?;
        let place = header
            .split(',')
            .position(|name| name == "v_mps")
            .ok_or("no speed")?;
        let last = lines.next_back().ok_or("no rows")?;
        Ok(last.split(',').nth(place).ok_or("short row")?.parse()?)
    };
    assert!(end("next_run.toml", "slow")? < end("off_run.toml", "fast")?);
    let results = |command: &str, file: &str| -> Result<[Value; 2], Box<dyn std::error::Error>> {
        let mut both = [Value::Null, Value::Null];
        for (k, name) in ["next_run", "off_run"].into_iter().enumerate() {
            let model = format!("{name}.toml");
            let out = format!("{command}_{name}");
            kufe(&[command, "slow/runs.csv", "--model", &model, "-o", &out])?;
            let mut told: Value =
                serde_json::from_slice(&std::fs::read(at.join(&out).join(file))?)?;
            both[k] = told["runs"].take();
        }
        Ok(both)
    };
    let [with, without] = results("evaluate", "evaluation.json")?;
    assert_ne!(with, without);
    let [with, without] = results("validate", "validation.json")?;
    assert!(with.is_array() && without.is_array());
    Ok(())
}

#[test]
fn an_effect_of_ones_own_is_found_and_acts() -> Outcome {
    let folder = tempfile::tempdir()?;
    let at = folder.path();
    // An oscillation over speed that no effect of the catalogue has.
    std::fs::write(
        at.join("experiments.csv"),
        table(|_, v| 1.0 + 0.08 * (1.3 * v).sin()),
    )?;
    let own = "[effects.ripple]\nexpression = \"sin(1.3 * v_mps)\"\nchannel = \"friction\"\nunit = \"\"\nlow = -0.01\nhigh = 0.01\n";
    let found = report(at, &format!("{MODEL}{own}"))?;
    assert_eq!(found["verdict"], "named", "{}", found["sentence"]);
    assert_eq!(found["steps"][0]["effect"], "ripple");
    let value = found["steps"][0]["parameters"][0]["value"].as_f64();
    // 8 per cent of a mean coefficient of 0.0036.
    assert!(
        value.is_some_and(|v| (v / 2.9e-4 - 1.0).abs() < 0.3),
        "{value:?}"
    );
    let text = next(at)?;
    let again = report(at, &text)?;
    assert_eq!(again["verdict"], "none", "{}", again["sentence"]);
    Ok(())
}

#[test]
fn too_few_twins_are_wrong_usage() -> Outcome {
    let folder = tempfile::tempdir()?;
    let output = discover(folder.path(), "experiments.csv", &["--twins", "2"])?;
    assert_eq!(output.status.code(), Some(2));
    Ok(())
}
