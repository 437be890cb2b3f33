//! `kufe mesh`: hexahedra that other programs read.

use kufe_outside::python;
use serde_json::Value;

use crate::kufe::{Bench, CASE, errors, names};

#[test]
fn ice_and_runner_are_written_without_an_inverted_cell() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    let printed = bench.succeeds(&["mesh", "case.toml", "--json"]);
    let quality: Value = serde_json::from_str(&printed).expect("JSON");
    assert_eq!(
        names(&bench.path("out")),
        ["ice.vtu", "quality.json", "runner.vtu"]
    );
    for body in ["ice", "runner"] {
        let figure = |key: &str| quality[body][key].as_f64().expect(key);
        assert_eq!(figure("inverted"), 0.0, "{body}");
        assert!(
            figure("min_scaled_jacobian") > 0.0 && figure("cells") > 100.0,
            "{body}"
        );
    }
    // A quarter of the runner (two mirror planes): its volume is below its box and above the box of its upper half.
    let volume = quality["runner"]["volume_m3"].as_f64().expect("a volume");
    let boxed = 0.5 * 0.005 * 0.030;
    assert!(
        volume > 0.5 * boxed && volume < boxed,
        "{volume} of {boxed}"
    );
}

#[test]
fn the_meshes_of_a_hull_are_written_too() {
    let bench = Bench::new();
    bench.succeeds(&["hull", "bob", "-o", "bob.obj", "--edge-length-m", "0.002"]);
    let text: String = CASE
        .lines()
        .map(|line| {
            if line.starts_with("shape") {
                "hull = \"bob.obj\"\n".to_string()
            } else {
                format!("{line}\n")
            }
        })
        .collect();
    bench.write("case.toml", text);
    let printed = bench.succeeds(&["mesh", "case.toml", "--json"]);
    let quality: Value = serde_json::from_str(&printed).expect("JSON");
    assert_eq!(quality["runner"]["inverted"], 0);
}

/// What `kufe mesh` writes is half a runner or a quarter, as coarse as its columns are far from the patch: given back as a runner's own
/// mesh it is refused, and so is one in millimetres that is read in metres.
#[test]
fn meshes_that_are_no_runner_for_their_load_are_refused_with_one_reason() {
    let bench = Bench::new();
    let refused = |case: &str, reasons: [&str; 2]| {
        bench.write("own.toml", case);
        let output = bench.kufe(&["press", "own.toml", "-o", "own"]);
        let reported = errors(&output);
        assert!(matches!(output.status.code(), Some(3 | 4)), "{reported}");
        assert!(
            reasons.iter().all(|reason| reported.contains(reason)),
            "{reported}"
        );
        assert!(!bench.path("own/result.json").exists());
    };
    let case = CASE.replace("[ice]", "elastic = true\n[ice]");
    bench.write("case.toml", &case);
    bench.succeeds(&["mesh", "case.toml"]);
    let shape = case
        .lines()
        .find(|line| line.starts_with("shape"))
        .expect("a shape");
    let own = case.replace(shape, "mesh = \"out/runner.vtu\"");
    refused(
        &own,
        ["runs along the rim", "half a runner is mirrored first"],
    );
    let level = own.replace("[accuracy]", "tilt = \"fixed\"\n[accuracy]");
    refused(
        &level,
        ["runs along the rim", "half a runner is mirrored first"],
    );
    let metres = own.replace("out/runner.vtu\"", "out/runner.vtu\"\nscale = 1000.0");
    refused(&metres, ["runs along the rim", "set scale = 0.001"]);
}

#[test]
fn a_paraboloid_has_ice_alone() {
    let bench = Bench::new();
    let shape =
        "shape = { kind = \"paraboloid\", rocker_radius_m = 30.0, section_radius_m = 0.005 }\n";
    let text: String = CASE
        .lines()
        .map(|line| {
            if line.starts_with("shape") {
                shape.to_string()
            } else {
                format!("{line}\n")
            }
        })
        .collect();
    bench.write("case.toml", text);
    bench.succeeds(&["mesh", "case.toml"]);
    assert_eq!(names(&bench.path("out")), ["ice.vtu", "quality.json"]);
}

#[test]
fn pyvista_and_meshio_read_meshes_and_fields() {
    let Some(interpreter) = python("pyvista, meshio") else {
        return;
    };
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    bench.succeeds(&["mesh", "case.toml", "-o", ".", "--force"]);
    bench.succeeds(&["press", "case.toml", "-o", ".", "--force"]);
    let script = "import numpy as np, pyvista, meshio, json\n\
        r = json.load(open('result.json'))\n\
        for name in ['ice.vtu', 'runner.vtu', 'field.vtu']:\n\
        \x20   g, m = pyvista.read(name), meshio.read(name)\n\
        \x20   assert g.n_cells == len(m.cells_dict['hexahedron']) > 0, name\n\
        \x20   assert np.allclose(g.points, m.points)\n\
        \x20   assert (g.compute_cell_sizes()['Volume'] > 0).all(), name\n\
        f = pyvista.read('field.vtu')\n\
        assert {'displacement_m', 'stress_pa', 'von_mises_pa'} <= set(f.point_data)\n\
        s = f['stress_pa'].reshape(-1, 3, 3)\n\
        assert np.allclose(s, s.transpose(0, 2, 1))\n\
        d = s - np.trace(s, axis1=1, axis2=2)[:, None, None] * np.eye(3) / 3\n\
        assert np.allclose(f['von_mises_pa'], np.sqrt(1.5 * (d * d).sum((1, 2))))\n\
        c = pyvista.read('contact.vtp')\n\
        assert r['symmetry'] == [True, True] and c.n_cells > 0\n\
        top = {tuple(p[:2]): k for k, p in enumerate(f.points) if p[2] == 0}\n\
        quarter = [k for k, p in enumerate(c.points) if p[0] >= 0 and p[1] >= 0]\n\
        at = [top[tuple(c.points[k][:2])] for k in quarter]\n\
        assert np.array_equal(c['gap_m'][quarter], f['gap_m'][at])\n\
        faces = c.regular_faces\n\
        rim = np.unique(faces[(c['contact_pressure_pa'][faces] == 0).any(1)])\n\
        same = c['contact_pressure_pa'][quarter] == f['contact_pressure_pa'][at]\n\
        assert set(np.array(quarter)[~same]) <= set(rim), 'inside the rim'\n\
        assert np.allclose(c['uz_m'][quarter], f['displacement_m'][at, 2])\n\
        below = f.points[:, 2] < 0\n\
        assert (f['contact_pressure_pa'][below] == 0).all() and np.isnan(f['gap_m'][below]).all()\n\
        assert np.allclose(c.bounds[:4:2], -np.array(c.bounds[1:4:2]))\n\
        whole = c.point_data_to_cell_data().compute_cell_sizes()\n\
        force = (whole['contact_pressure_pa'] * whole['Area']).sum()\n\
        assert abs(force / r['fz_n'] - 1) < 1e-3, force\n\
        assert (c['gap_m'][c['contact_pressure_pa'] > 0] < 1e-9).all()\n\
        print(-s[:, 2, 2].min() / r['p_max_pa'])\n";
    let output = std::process::Command::new(interpreter)
        .args(["-c", script])
        .current_dir(bench.folder.path())
        .output()
        .expect("the interpreter that KUFE_PYTHON names");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    // The stress under the peak is the pressure; nodal stresses of trilinear cells see it to a few per cent.
    let ratio: f64 = String::from_utf8_lossy(&output.stdout)
        .trim()
        .parse()
        .expect("a number");
    assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
}
