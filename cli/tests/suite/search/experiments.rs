//! `kufe discover` on friction experiments.

use std::process::Command;

use serde_json::Value;

use crate::search::friction_table::{MODEL, TABLE, discover, next, report, table};

type Outcome = Result<(), Box<dyn std::error::Error>>;

#[test]
fn nothing_is_found_in_the_seven_points_and_the_next_model_is_accepted() -> Outcome {
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("model.toml"), MODEL)?;
    std::fs::write(folder.path().join("experiments.csv"), TABLE)?;
    let output = discover(folder.path(), "experiments.csv", &["--json"])?;
    let reported = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{reported}");
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

/// A constant mu for data of a law over pressure: no effect explains the misfit, and the verdict is not `none`.
#[test]
fn a_base_that_does_not_fit_is_reported_and_a_law_over_pressure_fits() -> Outcome {
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("experiments.csv"), table(|_, _| 1.0))?;
    let law = "b = 0.088\nc = 2.01\nd = 14.66\nmu_cap = 0.007";
    let found = report(folder.path(), &MODEL.replace(law, "mu = 0.004"))?;
    assert_eq!(
        found["verdict"], "not-identifiable",
        "{}",
        found["sentence"]
    );
    let reported = format!("{} {}", found["sentence"], found["next_experiment"]);
    assert!(
        reported.contains("chi2") && reported.contains("b, c, d"),
        "{reported}"
    );
    assert_eq!(found["clean"], false);
    assert_eq!(report(folder.path(), MODEL)?["verdict"], "none");
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
fn a_quick_search_selects_without_a_model_to_write() -> Outcome {
    let folder = tempfile::tempdir()?;
    let at = folder.path();
    let rows = table(|ice, _| 1.0 - 0.03 * (ice + 5.0));
    std::fs::write(at.join("experiments.csv"), rows)?;
    std::fs::write(at.join("model.toml"), MODEL)?;
    let output = discover(at, "experiments.csv", &["--quick", "--json"])?;
    let found: Value = serde_json::from_slice(&output.stdout)?;
    assert_eq!(
        found["verdict"], "not-identifiable",
        "{}",
        found["sentence"]
    );
    assert_eq!(found["steps"][0]["effect"], "temperature");
    assert!(at.join("out/report.html").exists() && next(at).is_err());
    // Without an effect both searches end alike.
    std::fs::write(at.join("experiments.csv"), table(|_, _| 1.0))?;
    let output = discover(at, "experiments.csv", &["--quick", "--json"])?;
    let found: Value = serde_json::from_slice(&output.stdout)?;
    assert_eq!(found["verdict"], report(at, MODEL)?["verdict"]);
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
    // With the next model no effect is significant.
    let text = next(at)?;
    let again = report(at, &text)?;
    assert_eq!(again["verdict"], "none", "{}", again["sentence"]);
    // `friction`, `simulate`, `validate` and `evaluate` act on it: colder ice is slower.
    let kufe = |words: &[&str]| -> Result<String, Box<dyn std::error::Error>> {
        let output = Command::new(env!("CARGO_BIN_EXE_kufe"))
            .current_dir(at)
            .args(words)
            .output()?;
        let reported = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(0), "{words:?}: {reported}");
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
            "--v-mps",
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
        model.friction.longitudinal = kufe_sled::friction::LongitudinalKeys {
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
            "--rate-hz",
            "100",
            "--step-s",
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
            let mut reported: Value =
                serde_json::from_slice(&std::fs::read(at.join(&out).join(file))?)?;
            both[k] = reported["runs"].take();
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
fn only_the_chosen_effects_are_searched() -> Outcome {
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("model.toml"), MODEL)?;
    let warm = table(|ice, _| 1.0 - 0.03 * (ice + 5.0));
    std::fs::write(folder.path().join("experiments.csv"), warm)?;
    let names = |only: &str| -> Result<String, Box<dyn std::error::Error>> {
        let found = discover(
            folder.path(),
            "experiments.csv",
            &["--json", "--only", only],
        )?;
        let found: Value = serde_json::from_slice(&found.stdout)?;
        let reported = found["remarks"].to_string();
        assert!(reported.contains(&only.replace(',', ", ")), "{reported}");
        let steps = found["steps"].as_array().ok_or("no steps")?;
        let classes: Vec<String> = steps.iter().map(|s| s["class"].to_string()).collect();
        Ok(classes.join(" "))
    };
    assert_eq!(names("temperature")?, "[\"temperature\"]");
    // Humidity was not recorded; a law of the speed is outside the catalogue.
    assert_eq!(names("humidity")?, "");
    assert!(!names("unknown,humidity")?.contains("\"temperature\""));
    let wrong = discover(
        folder.path(),
        "experiments.csv",
        &["--only", "temperature,damp"],
    )?;
    let reported = String::from_utf8_lossy(&wrong.stderr).into_owned();
    assert_eq!(wrong.status.code(), Some(2), "{reported}");
    assert!(
        reported.contains("\"damp\"")
            && reported.contains("humidity")
            && reported.contains("unknown"),
        "{reported}"
    );
    Ok(())
}

/// A factor on mu over the temperature of the ice [C] and the speed [m/s].
type Law = fn(f64, f64) -> f64;

/// A hump of 18 % over speed, and a parabola of temperature: neither is a line, and each is found as what it is.
#[test]
fn laws_that_are_not_monotonic_are_found_as_parabolas() -> Outcome {
    let hump = |_: f64, v: f64| 1.0 + 0.18 * (-((v - 15.0) / 4.0).powi(2)).exp();
    let parabola = |ice: f64, _: f64| 1.0 + 0.01 * (ice + 6.5).powi(2);
    for (column, law) in [("v_mps", hump as Law), ("ice_c", parabola as Law)] {
        let folder = tempfile::tempdir()?;
        let at = folder.path();
        std::fs::write(at.join("experiments.csv"), table(law))?;
        let found = report(at, MODEL)?;
        let step = &found["steps"][0];
        let name = format!("unknown:{column}*{column}");
        assert_eq!(step["effect"], name, "{}", found["sentence"]);
        let formula = step["law"].as_str().ok_or("no formula")?;
        assert!(
            formula.contains(column) && formula.contains("^2"),
            "{formula}"
        );
        let read = kufe_sled::Model::from_toml(&next(at)?, "next")?;
        assert_eq!(read.effects[&name]["expression"].as_str(), Some(formula));
    }
    Ok(())
}

/// The zero of the force sensor drifts while the table is measured; humidity was made to rise with it.
#[test]
fn what_drifts_row_by_row_is_a_rival_of_a_column_that_rises_with_the_rows() -> Outcome {
    let folder = tempfile::tempdir()?;
    let rows = table(|_, _| 1.0);
    let mut lines = rows.lines();
    let mut text = lines.next().ok_or("no header")?.to_owned() + ",humidity_pct\n";
    for (k, line) in lines.enumerate() {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        let mu: f64 = cells[3].parse()?;
        cells[3] = format!("{:.7}", mu + 1e-5 * k as f64);
        let humidity = 40.0 + 0.7 * k as f64 + f64::from((k * 7) as u32 % 5);
        text += &format!("{},{humidity}\n", cells.join(","));
    }
    std::fs::write(folder.path().join("experiments.csv"), text)?;
    let found = report(folder.path(), MODEL)?;
    let class = found["steps"][0]["class"].as_array().ok_or("no step")?;
    assert!(
        class.contains(&"unknown:row".into()),
        "{}",
        found["sentence"]
    );
    Ok(())
}
