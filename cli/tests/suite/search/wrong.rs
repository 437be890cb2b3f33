//! `kufe discover` with wrong experiments and wrong arguments.

use std::process::Output;

use crate::search::friction_table::{MODEL, TABLE, discover};

type Outcome = Result<(), Box<dyn std::error::Error>>;

fn refused(table: impl AsRef<[u8]>, parts: &[&str]) -> Outcome {
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("model.toml"), MODEL)?;
    std::fs::write(folder.path().join("experiments.csv"), table)?;
    let output = discover(folder.path(), "experiments.csv", &[])?;
    let reported = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(3), "{reported}");
    for part in parts {
        assert!(reported.contains(part), "{part} not in {reported}");
    }
    assert!(!folder.path().join("out/report.json").exists());
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
    refused(&ragged, &["experiments.csv", "row 6: found"])?;
    let twice = TABLE.replace("p_max_sd_pa", "mu");
    refused(&twice, &["experiments.csv", "`mu`", "twice"])?;
    let gap = TABLE
        .replace("mu_sd", "mu_sd,ice_c")
        .replace("0004\n", "0004,-5\n")
        .replace("0003\n", "0003,\n");
    refused(&gap, &["row 6", "ice_c", "\"\"", "a number"])
}

#[test]
fn rows_are_counted_as_lines_of_the_file_and_names_are_shown_on_one_line() -> Outcome {
    let blank = TABLE.replace("Beta 1", "\n\nBeta 1");
    let word = blank.replace("0.0046", "slow");
    refused(&word, &["row 7, column mu: found \"slow\""])?;
    let first = blank.replace("0.0042", "slow");
    for text in [
        first.replace('\n', "\r\n"),
        format!("\u{feff}{first}"),
        first,
    ] {
        refused(&text, &["row 6, column mu: found \"slow\""])?;
    }
    let copied = format!("{blank}\nDelta,7.7e6,0.4e6,0.0045,0.0004\n");
    refused(&copied, &["row 2", "row 12"])?;
    let broken = TABLE.replace("mu_sd", "\"mu\n\u{1b}[2J_sd\"");
    refused(&broken, &["mu_sd", r"mu\n\u{1b}[2J_sd"])
}

#[test]
fn text_in_another_encoding_is_named_as_such() -> Outcome {
    for mark in ["", "\u{feff}"] {
        let wide = format!("{mark}{TABLE}");
        let wide: Vec<u8> = wide.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let expected = "experiments.csv: text in UTF-16; expected UTF-8 with commas";
        refused(wide, &[expected])?;
    }
    refused(TABLE.replace(',', ";"), &["separated by semicolons"])
}

#[test]
fn missing_files_folders_and_unknown_effects_are_named() -> Outcome {
    let folder = tempfile::tempdir()?;
    let at = folder.path();
    let reported = |output: &Output| String::from_utf8_lossy(&output.stderr).into_owned();
    std::fs::write(at.join("experiments.csv"), TABLE)?;
    let output = discover(at, "experiments.csv", &[])?;
    assert_eq!(output.status.code(), Some(3));
    assert!(
        reported(&output).contains("model.toml"),
        "{}",
        reported(&output)
    );
    std::fs::write(at.join("model.toml"), MODEL)?;
    let output = discover(at, "nowhere.csv", &[])?;
    assert_eq!(output.status.code(), Some(3));
    assert!(
        reported(&output).contains("nowhere.csv"),
        "{}",
        reported(&output)
    );
    let output = discover(at, ".", &[])?;
    assert_eq!(output.status.code(), Some(3));
    for part in ["a folder", "such as ./experiments.csv"] {
        assert!(reported(&output).contains(part), "{}", reported(&output));
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
        assert_eq!(output.status.code(), Some(3), "{}", reported(&output));
        for part in parts {
            assert!(
                reported(&output).contains(part),
                "no {part} in {}",
                reported(&output)
            );
        }
    }
    Ok(())
}

#[test]
fn too_few_twins_are_wrong_usage() -> Outcome {
    let folder = tempfile::tempdir()?;
    let output = discover(folder.path(), "experiments.csv", &["--twins", "2"])?;
    assert_eq!(output.status.code(), Some(2));
    Ok(())
}
