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
fn too_few_twins_are_wrong_usage() -> Outcome {
    let folder = tempfile::tempdir()?;
    let output = discover(folder.path(), "experiments.csv", &["--twins", "2"])?;
    assert_eq!(output.status.code(), Some(2));
    Ok(())
}
