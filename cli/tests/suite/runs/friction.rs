//! `kufe friction` and `kufe icehouse`.

use std::fmt::Write as _;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

type Outcome = Result<(), Box<dyn std::error::Error>>;

fn kufe(folder: &Path, arguments: &[&str]) -> std::io::Result<Output> {
    Command::new(env!("CARGO_BIN_EXE_kufe"))
        .current_dir(folder)
        .args(arguments)
        .output()
}

fn json(folder: &Path, arguments: &[&str]) -> Result<Value, Box<dyn std::error::Error>> {
    let output = kufe(folder, arguments)?;
    let reported = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{arguments:?}: {reported}");
    Ok(serde_json::from_slice(&output.stdout)?)
}

fn refused(folder: &Path, arguments: &[&str], code: i32, parts: &[&str]) -> Outcome {
    let output = kufe(folder, arguments)?;
    let reported = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(
        output.status.code(),
        Some(code),
        "{arguments:?}: {reported}"
    );
    for part in parts {
        assert!(
            reported.contains(part),
            "{arguments:?}: {part} not in {reported}"
        );
    }
    Ok(())
}

fn number(value: &Value, pointer: &str) -> f64 {
    value
        .pointer(pointer)
        .and_then(Value::as_f64)
        .unwrap_or(f64::NAN)
}

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

#[test]
fn a_table_that_cannot_be_read_has_one_message() -> Outcome {
    let bench = tempfile::tempdir()?;
    let cut = TABLE.trim_end().rsplit_once(',').expect("cells").0;
    let utf16: Vec<u8> = TABLE.encode_utf16().flat_map(u16::to_le_bytes).collect();
    for bytes in [cut.as_bytes(), &utf16] {
        std::fs::write(bench.path().join("cut.csv"), bytes)?;
        let output = kufe(bench.path(), &["friction", "fit", "cut.csv"])?;
        let reported = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(3), "{reported}");
        assert_eq!(reported.lines().count(), 1, "{reported}");
    }
    Ok(())
}

#[test]
fn a_fit_that_is_no_law_is_written_without_the_lines_of_a_model() -> Outcome {
    let folder = tempfile::tempdir()?;
    let out = folder.path().join("out");
    let mut table = "specimen,p_max_pa,p_max_sd_pa,mu,mu_sd\n".to_string();
    for k in 0..8 {
        let p = 8.0 + 2.0 * f64::from(k);
        let mu = 1e-3 * (8.0 - 0.05 * (p - 15.0).powi(2));
        writeln!(table, "s{k},{p}e6,0.1e6,{mu},0.0001")?;
    }
    std::fs::write(folder.path().join("concave.csv"), &table)?;
    let fit = ["friction", "fit", "concave.csv", "-o", "out"];
    let parts = ["concave.csv", "not a valid law of friction", "b = -0.05"];
    refused(folder.path(), &fit, 4, &parts)?;
    assert!(out.join("fit.json").exists() && out.join("mu.png").exists());
    assert!(!out.join("friction.toml").exists());
    let negative = table.replace(",0.00", ",-0.00");
    let negative = negative.replace(",-0.0001", ",0.0001");
    std::fs::write(folder.path().join("negative.csv"), negative)?;
    let fit = ["friction", "fit", "negative.csv", "-o", "other"];
    let parts = ["negative.csv", "row 2, column mu", "-0.00555", "above 0"];
    refused(folder.path(), &fit, 3, &parts)
}

/// A blunt paraboloid on thick ice: its pressure is within the range of the published law.
fn case(fz: f64) -> String {
    format!(
        "[runner]\nshape = {{ kind = \"paraboloid\", rocker_radius_m = 30.0, section_radius_m = 0.5 }}\n\
         [ice]\nyoungs_modulus_pa = 9.0e9\npoissons_ratio = 0.33\nthickness_m = \"half-space\"\n\
         [load]\nfz_n = {fz:.1}\ntilt = \"fixed\"\npitch_rad = 0.0\nroll_rad = 0.0\n"
    )
}

#[test]
fn fit_reproduces_the_papers_figures_and_writes_a_models_table() -> Outcome {
    let folder = tempfile::tempdir()?;
    let at = folder.path();
    std::fs::write(at.join("t.csv"), TABLE)?;
    let fit = json(
        at,
        &[
            "friction",
            "fit",
            "t.csv",
            "--unweighted",
            "-o",
            "o",
            "--json",
        ],
    )?;
    for (pointer, expected, tolerance) in [
        ("/parameters/b/value", 0.0864, 5e-5),
        ("/parameters/c/value", 1.986, 5e-4),
        ("/parameters/d/value", 14.51, 5e-3),
    ] {
        let value = number(&fit, pointer);
        assert!((value - expected).abs() < tolerance, "{pointer}: {value}");
    }
    let text = std::fs::read_to_string(at.join("o/friction.toml"))?;
    let table: toml::Table = text.parse()?;
    let keys: kufe_sled::friction::LongitudinalKeys =
        table["friction"]["longitudinal"].clone().try_into()?;
    let law = keys.model()?;
    let least = number(&fit, "/least_friction/mu/value");
    let place = number(&fit, "/least_friction/p_pa/value");
    assert!((law.mu(place) - least).abs() < 1e-12);
    assert!(std::fs::metadata(at.join("o/mu.png"))?.len() > 5000);
    let weighted = json(at, &["friction", "fit", "t.csv", "-o", "w", "--json"])?;
    assert!(number(&weighted, "/p_value") > 0.05);
    Ok(())
}

#[test]
fn friction_of_a_case_is_the_law_at_the_pressure_of_hertz() -> Outcome {
    let folder = tempfile::tempdir()?;
    let at = folder.path();
    std::fs::write(at.join("case.toml"), case(200.0))?;
    let found = json(
        at,
        &[
            "friction",
            "case.toml",
            "--v-mps",
            "30",
            "--alpha-rad",
            "0.1",
            "--json",
        ],
    )?;
    let p = number(&found, "/p_max_pa");
    let mu = 1e-3 * (0.088 * (p * 1e-6).powi(2) - 2.01 * p * 1e-6 + 14.66);
    assert!(
        found["capped"] == false && (5e6..18e6).contains(&p),
        "{found}"
    );
    assert!((number(&found, "/mu") - mu).abs() < 1e-12);
    let fx = -mu * number(&found, "/fz_n") * 0.1f64.cos();
    assert!((number(&found, "/fx_n") - fx).abs() < 1e-9);
    assert!((number(&found, "/power_w") - 30.0 * fx).abs() < 1e-7);
    let hertz = kufe_contact::hertz(30.0, 0.5, 9.0e9 / (1.0 - 0.33 * 0.33), 200.0).unwrap();
    assert!((p / hertz.p_max - 1.0).abs() < 0.01, "{p} {}", hertz.p_max);
    Ok(())
}

#[test]
fn a_models_law_and_effects_apply_and_missing_conditions_are_named() -> Outcome {
    let folder = tempfile::tempdir()?;
    let at = folder.path();
    std::fs::write(at.join("case.toml"), case(200.0))?;
    let mut model = kufe_sled::Model::published();
    model.friction.longitudinal = kufe_sled::friction::LongitudinalKeys {
        mu: Some(0.005),
        ..Default::default()
    };
    let mut text = model.to_toml();
    for effect in ["temperature", "temperature-grip"] {
        write!(text, "\n[effects.{effect}]\nslope_per_k = -0.01\n")?;
    }
    std::fs::write(at.join("model.toml"), text)?;
    let base = [
        "friction",
        "case.toml",
        "--v-mps",
        "30",
        "--model",
        "model.toml",
    ];
    refused(at, &base, 2, &["temperature needs --ice-c"])?;
    let found = json(at, &[&base[..], &["--ice-c", "-9", "--json"]].concat())?;
    assert!(
        (number(&found, "/mu") - 0.005 * 1.04).abs() < 1e-12,
        "{found}"
    );
    assert_eq!(found["effects"], serde_json::json!(["temperature"]));
    assert_eq!(
        found["effects_not_concerned"],
        serde_json::json!(["temperature-grip"])
    );
    Ok(())
}

/// A glide without noise: v dv/ds = -g (mu cos k + sin k) - c v^2, closed form in s.
fn glide(mu: f64, climb: f64, mass: f64, cda: f64) -> String {
    let density = 94_700.0 / (287.05 * 275.15);
    let resistance = 9.81 * (mu * climb.cos() + climb.sin());
    let per_square = 0.5 * density * cda / mass;
    let speed = |s: f64| {
        let end = resistance / per_square;
        ((2.4f64.powi(2) + end) * (-2.0 * per_square * s).exp() - end).sqrt()
    };
    let mut text = String::from("t_s,v_mps,s_m\n");
    let (mut t, step) = (0.0, 0.02);
    for i in 0..1500 {
        let s = f64::from(i) * step;
        let _ = writeln!(text, "{t:.9},{:.9},{s:.4}", speed(s));
        t += step / speed(s + 0.5 * step);
    }
    text
}

#[test]
fn ice_house_leads_from_glides_to_a_fit() -> Outcome {
    let folder = tempfile::tempdir()?;
    let at = folder.path();
    let mut index = String::from(
        "run,file,specimen,direction,mass_kg,cda_m2,air_c,air_pa,p_max_pa,p_max_sd_pa\n",
    );
    let slope = 0.1f64.to_radians();
    let specimens = [
        (7.7, 4.5e-3),
        (9.6, 3.3e-3),
        (11.4, 2.9e-3),
        (13.6, 3.9e-3),
        (14.5, 4.2e-3),
    ];
    for (i, (p, mu)) in specimens.iter().enumerate() {
        for (direction, climb) in [("uphill", slope), ("downhill", -slope)] {
            let name = format!("{i}{direction}");
            std::fs::write(
                at.join(format!("{name}.csv")),
                glide(*mu, climb, 100.0, 0.25),
            )?;
            writeln!(
                index,
                "{name},{name}.csv,S{i},{direction},100,0.25,2,94700,{p}e6,0.5e6"
            )?;
        }
    }
    std::fs::write(at.join("glides.csv"), &index)?;
    let found = json(at, &["icehouse", "glides.csv", "-o", "o", "--json"])?;
    for (i, (_, mu)) in specimens.iter().enumerate() {
        let value = number(&found, &format!("/specimens/{i}/mu/value"));
        assert!((value / mu - 1.0).abs() < 2e-4, "{value} {mu}");
    }
    assert!((number(&found, "/slope_rad/value") / slope - 1.0).abs() < 2e-4);
    assert!(at.join("o/energy_001_0uphill.png").exists());
    let table = std::fs::read_to_string(at.join("o/experiments.csv"))?;
    let experiments = kufe_sled::friction::read_experiments("experiments.csv", table.as_bytes())?;
    assert_eq!(experiments.len(), 5);
    json(
        at,
        &["friction", "fit", "o/experiments.csv", "-o", "f", "--json"],
    )?;
    Ok(())
}

#[test]
fn bad_input_is_named_and_leaves_nothing_behind() -> Outcome {
    let folder = tempfile::tempdir()?;
    let at = folder.path();
    std::fs::write(at.join("t.csv"), TABLE.replace("13.6e6", "13.6"))?;
    refused(
        at,
        &["friction", "fit", "t.csv", "-o", "o"],
        3,
        &["t.csv", "row 4", "p_max_pa", "13.6", "Pa"],
    )?;
    refused(
        at,
        &["friction", "fit", "none.csv"],
        3,
        &["none.csv", "cannot be read"],
    )?;
    std::fs::write(at.join("t.csv"), TABLE.replace("mu_sd", "mu_se"))?;
    refused(
        at,
        &["friction", "fit", "t.csv"],
        3,
        &["t.csv", "mu_sd", "missing", "mu_se"],
    )?;
    refused(
        at,
        &["friction", "fit", "t.csv", "--confidence", "95"],
        2,
        &["--confidence 95"],
    )?;
    std::fs::write(at.join("case.toml"), case(200.0))?;
    refused(at, &["friction", "case.toml"], 2, &["--v-mps"])?;
    refused(
        at,
        &["friction", "case.toml", "--v-mps", "-3"],
        2,
        &["--v-mps -3", "0 to 100"],
    )?;
    let degrees = ["friction", "case.toml", "--v-mps", "3", "--alpha-rad", "4"];
    refused(at, &degrees, 2, &["--alpha-rad 4", "rad"])?;
    let header = "run,file,specimen,direction,mass_kg,cda_m2,air_c,air_pa\n";
    let row = "1,gone.csv,A,uphill,100,0.25,2,94700\n";
    std::fs::write(at.join("glides.csv"), format!("{header}{row}"))?;
    let house = ["icehouse", "glides.csv"];
    refused(
        at,
        &house,
        3,
        &["glides.csv, run 1", "gone.csv", "cannot be read"],
    )?;
    std::fs::write(at.join("gone.csv"), glide(4e-3, 0.0, 100.0, 0.25))?;
    refused(at, &house, 3, &["glides.csv", "pairs", ": 0, expected"])?;
    std::fs::write(at.join("gone.csv"), "t_s,v_mps\n0,1\n0.1,1\n0.2,1\n")?;
    refused(at, &house, 3, &["gone.csv", ": 3, expected", "30"])?;
    assert!(!at.join("out").exists() && !at.join("o").exists());
    Ok(())
}
