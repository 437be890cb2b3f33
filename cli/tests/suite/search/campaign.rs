//! `kufe discover campaign.toml`: files that belong together, and campaigns that are wrong.

use std::path::Path;
use std::process::{Command, Output};

use crate::search::friction_table::{MODEL, TABLE, discover};

type Outcome = Result<(), Box<dyn std::error::Error>>;

fn campaign(folder: &Path, text: &str, further: &[&str]) -> std::io::Result<Output> {
    std::fs::write(folder.join("campaign.toml"), text)?;
    Command::new(env!("CARGO_BIN_EXE_kufe"))
        .current_dir(folder)
        .args(["discover", "campaign.toml", "-o", "together"])
        .args(further)
        .output()
}

fn reported(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

const ONE: &str = "experiments = \"experiments.csv\"\nmodel = \"model.toml\"\n";

#[test]
fn a_campaign_of_one_table_is_that_table() -> Outcome {
    let folder = tempfile::tempdir()?;
    let at = folder.path();
    std::fs::write(at.join("experiments.csv"), TABLE)?;
    std::fs::write(at.join("model.toml"), MODEL)?;
    let output = campaign(at, ONE, &[])?;
    assert!(output.status.success(), "{}", reported(&output));
    let output = discover(at, "experiments.csv", &[])?;
    assert!(output.status.success(), "{}", reported(&output));
    for name in ["report.json", "report.html", "model.next.toml"] {
        let read = |folder: &str| std::fs::read(at.join(folder).join(name));
        assert!(read("together")? == read("out")?, "{name}");
    }
    assert!(!at.join("together/case.next.toml").exists());
    Ok(())
}

#[test]
fn wrong_campaigns_are_refused_with_file_place_and_what_was_expected() -> Outcome {
    let folder = tempfile::tempdir()?;
    let at = folder.path();
    std::fs::write(at.join("experiments.csv"), TABLE)?;
    std::fs::write(at.join("model.toml"), MODEL)?;
    std::fs::write(
        at.join("pressures.csv"),
        "case,fz_n,radius_m,p_max_pa,p_max_sd_pa\na.toml,1e3,inf,1e7,1e5\nb.toml,1e3,inf,1e7,1e5\n",
    )?;
    for (text, parts) in [
        ("", vec!["no data", "runs, experiments, pressures"]),
        (
            "experiments = \"experiments.csv\"",
            vec!["model is missing"],
        ),
        (
            "experiments = \"nowhere.csv\"\nmodel = \"model.toml\"",
            vec!["nowhere.csv", "not an existing file"],
        ),
        (
            "experiment = \"experiments.csv\"",
            vec!["line 1", "unknown field `experiment`"],
        ),
        (
            "experiments = \"experiments.csv\"\nmodel = 3",
            vec!["line 2", "model = 3"],
        ),
        (
            "runs = \"experiments.csv\"\nmodel = \"model.toml\"",
            vec!["experiments.csv", "run"],
        ),
        (
            "pressures = \"pressures.csv\"",
            vec!["pressures.csv", "a.toml, b.toml", "one case"],
        ),
        (
            "runs = \"model.toml\"\nmodel = \"model.toml\"",
            vec!["the same file as runs"],
        ),
    ] {
        let output = campaign(at, text, &[])?;
        assert_eq!(
            output.status.code(),
            Some(3),
            "{text}: {}",
            reported(&output)
        );
        for part in parts {
            assert!(
                reported(&output).contains(part),
                "{text}: no {part} in {}",
                reported(&output)
            );
        }
        assert!(!at.join("together").exists());
    }
    Ok(())
}

#[test]
fn a_model_with_a_campaign_and_a_table_without_one_are_wrong_usage() -> Outcome {
    let folder = tempfile::tempdir()?;
    let at = folder.path();
    std::fs::write(at.join("experiments.csv"), TABLE)?;
    std::fs::write(at.join("model.toml"), MODEL)?;
    let output = campaign(at, ONE, &["--model", "model.toml"])?;
    assert_eq!(output.status.code(), Some(2), "{}", reported(&output));
    assert!(reported(&output).contains("names its model itself"));
    let output = Command::new(env!("CARGO_BIN_EXE_kufe"))
        .current_dir(at)
        .args(["discover", "experiments.csv"])
        .output()?;
    assert_eq!(output.status.code(), Some(2), "{}", reported(&output));
    assert!(reported(&output).contains("--model is missing"));
    Ok(())
}
