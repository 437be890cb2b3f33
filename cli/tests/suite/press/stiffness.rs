//! `solver.stiffness` and `kufe export CASE --stiffness`: what SciPy reads is the stiffness.

use kufe_outside::python;
use std::path::Path;

use crate::kufe::{Bench, errors, refused};
use kufe::case::Case;
use kufe_contact::{Options, solve};
use kufe_fem::{Material, TensorOperator};
use serde_json::Value;

const CASE: &str = r#"[runner]
shape = { kind = "paraboloid", rocker_radius_m = 0.2, section_radius_m = 0.2 }
[ice]
youngs_modulus_pa = 9.0e9
poissons_ratio = 0.33
thickness_m = 0.002
[load]
fz_n = 100.0
tilt = "fixed"
"#;

/// Reads K, the fixed displacements and the values that Rust wrote: products, and rigid motions at the nodes.
const SCRIPT: &str = "import re, numpy as np, scipy.io\n\
    k = scipy.io.mmread('K.mtx').tocsc()\n\
    n = k.shape[0]\n\
    lines = [line for line in open('K.mtx') if line.startswith('%')]\n\
    fixed = [int(w) - 1 for line in lines if line.startswith('% ice fixed:') for w in line.split(':')[1].split()]\n\
    size = abs(k).max()\n\
    assert abs(k - k.T).max() == 0\n\
    u, ku = np.loadtxt('product.txt').T\n\
    assert abs(k @ u - ku).max() < 1e-12 * abs(ku).max()\n\
    x, y, z = (np.array([float(w) for line in lines if line.startswith('% ice ' + a + ':') for w in line.split(':')[1].split()]) for a in 'xyz')\n\
    z, y, x = (a.ravel() for a in np.meshgrid(z, y, x, indexing='ij'))\n\
    o, i = np.zeros(x.size), np.ones(x.size)\n\
    rigid = np.array([[i, o, o], [o, i, o], [o, o, i], [o, -z, y], [z, o, -x], [-y, x, o]]).reshape(6, n).T\n\
    rigid /= np.linalg.norm(rigid, axis=0)\n\
    assert np.linalg.matrix_rank(rigid) == 6\n\
    assert abs(k @ rigid).max() < 1e-9 * size, abs(k @ rigid).max() / size\n\
    near = np.linalg.eigvalsh(k.toarray())[:7]\n\
    assert abs(near[:6]).max() < 1e-6 * near[6], near\n\
    free = np.setdiff1d(np.arange(n), fixed)\n\
    assert 0 < len(fixed) < n\n\
    lowest = np.linalg.eigvalsh(k[free][:, free].toarray())[0]\n\
    assert lowest > 0, lowest\n\
    print(n, len(fixed))\n";

#[test]
fn scipy_reads_the_stiffness_symmetric_definite_where_fixed_and_with_six_rigid_motions() {
    let Some(interpreter) = python("scipy") else {
        return;
    };
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    let export = [
        "export",
        "case.toml",
        "--stiffness",
        "K.mtx",
        "--cells",
        "2",
    ];
    let printed = bench.succeeds(&[&export[..], &["--json"]].concat());
    let facts: Value = serde_json::from_str(&printed).expect("JSON");
    // The same solve here: its grid, and products without a matrix.
    let problem = Case::parse(CASE).unwrap().problem(Path::new(".")).unwrap();
    let options = Options {
        cells: Some(2),
        ..Options::default()
    };
    let grid = solve(&problem, &options).unwrap().volume.unwrap().grid;
    let ice = Material::new(9.0e9, 0.33).unwrap();
    let free = [[[false; 2]; 3]; 3];
    let operator = TensorOperator::new(&grid, ice, free);
    let u: Vec<f64> = (0..3 * grid.node_count())
        .map(|i| (0.37 * i as f64).sin())
        .collect();
    let mut ku = vec![0.0; u.len()];
    operator.apply(&u, &mut ku);
    let rows = u.iter().zip(&ku).map(|(u, ku)| format!("{u:e} {ku:e}\n"));
    bench.write("product.txt", rows.collect::<String>());
    let output = std::process::Command::new(interpreter)
        .args(["-c", SCRIPT])
        .current_dir(bench.folder.path())
        .output()
        .expect("the interpreter that KUFE_PYTHON names");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let counted = format!("{} {}", facts["displacements"], facts["held"]);
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), counted);
}

#[test]
fn the_result_states_the_form_that_was_used_and_both_give_the_same_pressure() {
    let bench = Bench::new();
    let mut peaks = Vec::new();
    for form in ["matrix-free", "assembled"] {
        bench.write(
            "case.toml",
            format!("{CASE}[accuracy]\np_max = 0.1\n[solver]\nstiffness = \"{form}\"\n"),
        );
        bench.succeeds(&["press", "case.toml", "-o", form]);
        let text = std::fs::read_to_string(bench.path(form).join("result.json")).unwrap();
        let result: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(result["stiffness"], form);
        peaks.push(result["p_max_pa"].as_f64().unwrap());
    }
    // The solver's residual is 1e-9.
    assert!((peaks[1] / peaks[0] - 1.0).abs() < 1e-7, "{peaks:?}");
    bench.write(
        "case.toml",
        format!("{CASE}[solver]\nstiffness = \"dense\"\n"),
    );
    let output = bench.kufe(&["press", "case.toml"]);
    let printed = errors(&output);
    assert_eq!(output.status.code(), Some(3), "{printed}");
    assert!(printed.contains("matrix-free"), "{printed}");
}

#[test]
fn an_export_needs_a_case_and_one_kind_of_file() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    for args in [
        &["export"][..],
        &["export", "case.toml"],
        &["export", "--stiffness", "K.mtx"],
        &["export", "case.toml", "--calculix", "a.inp", "-o", "b.inp"],
        &[
            "export",
            "case.toml",
            "--calculix",
            "a.inp",
            "--stiffness",
            "K.mtx",
        ],
    ] {
        assert_eq!(bench.kufe(args).status.code(), Some(2), "{args:?}");
    }
    let onto_itself = ["export", "case.toml", "--calculix", "case.toml"];
    refused(bench.folder.path(), &onto_itself, 3, &["case.toml"]);
    assert_eq!(bench.names(), ["case.toml"]);
}
