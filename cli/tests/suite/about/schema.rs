//! The schemas against the files that are shipped, by a validator that is not ours.

use std::path::{Path, PathBuf};
use std::process::Command;

use kufe::case::Case;
use kufe::jobs::{TABLE_EXAMPLE, case_file::EXAMPLE};
use kufe_sled::MODEL_EXAMPLE;
use kufe_sled::Model;
use kufe_telemetry::{MAPPING_EXAMPLE, Mapping};

use crate::kufe::{Bench, CASE};

const VALIDATE: &str = "
import json, sys, tomllib, jsonschema
for line in sys.stdin:
    schema, file = line.rstrip('\\n').split('\\t')
    validator = jsonschema.Draft7Validator(json.load(open(schema)))
    validator.check_schema(validator.schema)
    errors = [error.message for error in validator.iter_errors(tomllib.load(open(file, 'rb')))]
    print(file, '\\t', '; '.join(errors))
";

/// The validator's verdict on each pair of schema and file; `None` without a validator.
fn validate(pairs: &[(PathBuf, PathBuf)]) -> Option<Vec<String>> {
    let python = kufe_outside::python("jsonschema")?;
    let folder = tempfile::tempdir().expect("a folder");
    let list = folder.path().join("list");
    let text: String = pairs
        .iter()
        .map(|(schema, file)| format!("{}\t{}\n", schema.display(), file.display()))
        .collect();
    std::fs::write(&list, text).expect("a list");
    let output = Command::new(&python)
        .args(["-c", VALIDATE])
        .stdin(std::fs::File::open(&list).expect("a list"))
        .output()
        .expect("Python");
    let reported = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{reported}");
    let lines = String::from_utf8(output.stdout).expect("text");
    Some(
        lines
            .lines()
            .map(|line| line.split_once('\t').expect("a tab").1.trim().to_owned())
            .collect(),
    )
}

/// The schemas in a folder, and where each of them is.
fn schemas(bench: &Bench) -> impl Fn(&str) -> PathBuf {
    let place = |kind: &str| format!("{kind}.schema.json");
    for kind in ["case", "table", "model", "mapping"] {
        bench.succeeds(&["schema", kind, "-q", "-o", &place(kind)]);
    }
    move |kind: &str| bench.path(&place(kind))
}

/// Results fit their schemas, each quantity with its description.
#[test]
fn results_have_schemas() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    let experiments = (0..24).map(|k| {
        let mu = 0.0035 + 1e-5 * f64::from(37 * k % 61);
        format!("S{k},{}e4,5e5,{mu:.6},0.0003\n", 700 + 40 * k)
    });
    let head = "specimen,p_max_pa,p_max_sd_pa,mu,mu_sd\n";
    bench.write(
        "experiments.csv",
        head.to_owned() + &experiments.collect::<String>(),
    );
    for (document, words, file) in [
        ("result", "press case.toml", "out/result.json"),
        (
            "series",
            "press case.toml -o series --fz-n 800,1000 --radius-m inf,60",
            "series/table.json",
        ),
        ("mesh", "mesh case.toml -o mesh", "mesh/quality.json"),
        (
            "truth",
            "simulate --sample-data sample",
            "sample/truth.json",
        ),
        (
            "check",
            "runs check sample/runs.csv -o check",
            "check/check.json",
        ),
        (
            "finding",
            "discover experiments.csv --model sample/model.toml -o finding",
            "finding/report.json",
        ),
    ] {
        bench.succeeds(&["schema", document, "-q", "-o", "schema.json", "--force"]);
        let schema = std::fs::read_to_string(bench.path("schema.json")).expect("a schema");
        let described = schema.contains("\"peak pressure [Pa]\"");
        assert_eq!(
            described,
            ["result", "series"].contains(&document),
            "{schema}"
        );
        let words: Vec<&str> = words.split(' ').chain(["-q"]).collect();
        bench.succeeds(&words);
        let Some(python) = kufe_outside::python("jsonschema") else {
            return;
        };
        let script = format!(
            "import json, jsonschema\n\
            schema, result = [json.load(open(name)) for name in ('schema.json', '{file}')]\n\
            jsonschema.Draft7Validator.check_schema(schema)\n\
            jsonschema.Draft7Validator(schema).validate(result)\n"
        );
        let output = Command::new(python)
            .args(["-c", &script])
            .current_dir(bench.folder.path())
            .output()
            .expect("Python");
        assert!(
            output.status.success(),
            "{document}: {}",
            String::from_utf8_lossy(&output.stderr)
        );
    }
}

/// Every TOML file below the repository's own folders that states a case, a table or a model.
fn shipped() -> Vec<(&'static str, PathBuf)> {
    fn walk(folder: &Path, found: &mut Vec<(&'static str, PathBuf)>) {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            let name = path
                .file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned();
            if path.is_dir()
                && !["target", "out"].contains(&name.as_str())
                && !name.starts_with('.')
            {
                walk(&path, found);
            } else if name.ends_with(".toml") {
                let text = std::fs::read_to_string(&path).expect("text");
                let starts = |word: &str| text.lines().any(|line| line.starts_with(word));
                if starts("[runner]") && starts("[ice]") {
                    found.push(("case", path));
                } else if starts("[axes]") {
                    found.push(("table", path));
                } else if starts("[sled]") {
                    found.push(("model", path));
                } else if starts("[logger.") {
                    found.push(("mapping", path));
                }
            }
        }
    }
    let mut found = Vec::new();
    walk(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join(".."),
        &mut found,
    );
    found
}

#[test]
fn every_shipped_file_is_valid_by_its_schema() {
    let bench = Bench::new();
    let schema = schemas(&bench);
    let files = shipped();
    for kind in ["case", "table", "model", "mapping"] {
        assert!(
            files.iter().any(|(found, _)| *found == kind),
            "no {kind} is shipped"
        );
    }
    let pairs: Vec<_> = files
        .iter()
        .map(|(kind, file)| (schema(kind), file.clone()))
        .collect();
    let Some(reported) = validate(&pairs) else {
        return;
    };
    for ((_, file), errors) in files.iter().zip(reported) {
        assert!(errors.is_empty(), "{}: {errors}", file.display());
    }
}

#[test]
fn a_misspelt_key_and_a_wrong_value_are_refused() {
    let bench = Bench::new();
    let schema = schemas(&bench);
    let model = format!("{MODEL_EXAMPLE}\n[effects.temperature-grip]\nslope_per_k = -0.01\n");
    let wrong = [
        ("case", EXAMPLE.replace("fz_n", "fz_kn"), "fz_kn"),
        (
            "case",
            EXAMPLE.replace("kind = \"bob\"", "kind = \"ski\""),
            "ski",
        ),
        (
            "case",
            EXAMPLE.replace("thickness_m = 0.05", "thickness_m = \"deep\""),
            "deep",
        ),
        (
            "case",
            format!("{EXAMPLE}\n[effects.hardnes]\npressure_pa = 1e7\n"),
            "hardnes",
        ),
        (
            "table",
            TABLE_EXAMPLE.replace("checks = 8", "chekcs = 8"),
            "chekcs",
        ),
        (
            "model",
            MODEL_EXAMPLE.replace("mass_kg", "mass_lb"),
            "mass_lb",
        ),
        (
            "model",
            model.replace("temperature-grip", "temperature-grib"),
            "slope_per_k",
        ),
        (
            "model",
            model.replace("slope_per_k", "slope_per_c"),
            "slope_per_c",
        ),
        (
            "mapping",
            MAPPING_EXAMPLE.replace("sign = -1", "sing = -1"),
            "sing",
        ),
        (
            "mapping",
            MAPPING_EXAMPLE.replace("rate_hz = 100.0", "rate_hz = 0.1"),
            "0.1",
        ),
    ];
    let mut pairs = Vec::new();
    for (n, (kind, text, _)) in wrong.iter().enumerate() {
        let name = format!("{n}.toml");
        bench.write(&name, text);
        pairs.push((schema(kind), bench.path(&name)));
    }
    bench.write("right.toml", &model);
    pairs.push((schema("model"), bench.path("right.toml")));
    let Some(reported) = validate(&pairs) else {
        return;
    };
    for ((kind, _, found), errors) in wrong.iter().zip(&reported) {
        assert!(errors.contains(found), "{kind}, {found}: {errors:?}");
    }
    assert_eq!(reported.last().map(String::as_str), Some(""));
}

#[test]
fn files_to_start_from_are_what_the_readers_take() {
    assert_eq!(
        Model::from_toml(MODEL_EXAMPLE, "model.toml").expect("a model"),
        Model::published()
    );
    Case::parse(EXAMPLE).expect("a case");
    Mapping::parse(MAPPING_EXAMPLE, "mapping.toml").expect("a mapping");
    let bench = Bench::new();
    for kind in ["case", "table", "model", "mapping"] {
        bench.succeeds(&["init", "--kind", kind, "-q"]);
        let text = std::fs::read_to_string(bench.path(&format!("{kind}.toml"))).expect("text");
        assert!(text.starts_with(&format!("#:schema ./{kind}.schema.json\n")));
        assert!(bench.path(&format!("{kind}.schema.json")).exists());
    }
    kufe::jobs::table::TableSpec::read(&bench.path("table.toml")).expect("a table file");
    kufe::jobs::case_file::LoadedCase::read(&bench.path("case.toml")).expect("a case");
}
