//! `kufe press` on runners that bend: a steel on its bridges, a runner without a fixed place, hexahedra of another program.

use std::fmt::Write as _;

use serde_json::Value;

use crate::kufe::{Bench, errors};
use crate::press::hull_check::normal;

pub fn result(bench: &Bench) -> Value {
    let text = std::fs::read_to_string(bench.path("out/result.json")).expect("result.json");
    serde_json::from_str(&text).expect("JSON")
}

pub fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().expect(key)
}

/// A short bobsled runner with `more` in its table.
pub fn case(more: &str, tilt: &str) -> String {
    format!(
        "[runner]\nshape = {{ kind = \"bob\", length_m = 0.3, rocker_radius_m = 8.0, section_radius_m = 0.004, width_m = 0.008, height_m = 0.012 }}\n\
         elastic = true\n{more}\n[ice]\nyoungs_modulus_pa = 9.0e9\npoissons_ratio = 0.33\nthickness_m = 0.02\n\
         [load]\nfz_n = 500.0\ntilt = \"{tilt}\"\n[accuracy]\np_max = 0.05\n"
    )
}

/// A body that bends away under its load has a lower peak the less of it is fixed.
#[test]
fn the_peak_falls_from_a_fixed_top_over_two_fixed_places_to_none() {
    let places = "{ x_m = -0.1, length_m = 0.02 }, { x_m = 0.1, length_m = 0.02 }";
    let held = format!("mount = {{ held = [{places}] }}");
    let carried = format!(
        "mount = {{ carries = [{}] }}",
        places.replace('}', ", share = 0.5 }")
    );
    let peaks =
        [("", "fixed"), (&held, "fixed"), (&carried, "free")].map(|(mount, tilt)| {
            let bench = Bench::new();
            bench.write("case.toml", case(mount, tilt));
            bench.succeeds(&["press", "case.toml"]);
            let result = result(&bench);
            assert!(
                (number(&result, "fz_n") / 500.0 - 1.0).abs() < 1e-6,
                "{mount}"
            );
            assert!(number(&result, "iterations") <= 50.0, "{mount}");
            // The mount carries the load.
            let mounts = result["mounts"].as_array().expect("mounts");
            let borne: f64 = mounts.iter().filter_map(|m| m["force_n"][2].as_f64()).sum();
            assert!((borne / 500.0 - 1.0).abs() < 1e-6, "{mount}: {mounts:?}");
            assert_eq!(mounts.len(), if mount.is_empty() { 1 } else { 2 });
            assert!(mounts.iter().all(
                |m| number(m, "von_mises_max_pa") <= number(&result, "runner_von_mises_max_pa")
            ));
            let file = std::fs::read(bench.path("out/runner.vtu")).expect("runner.vtu");
            let mesh = kufe_mesh::read_vtu(&file).expect("hexahedra");
            assert!(mesh.cells.len() > 1000, "{} cells", mesh.cells.len());
            number(&result, "p_max_pa")
        });
    println!("{peaks:?}");
    assert!(peaks[0] > peaks[1] && peaks[1] > peaks[2], "{peaks:?}");
}

/// A block 40 mm x 4 mm x 6 mm with a round underside in Gmsh's format, `n` cells along each axis.
fn gmsh(n: [usize; 3]) -> String {
    let mut text = String::from("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n");
    let count = n.iter().map(|n| n + 1).product::<usize>();
    writeln!(text, "{count}").unwrap();
    let node = |i: usize, j: usize, k: usize| 1 + i + (n[0] + 1) * (j + (n[1] + 1) * k);
    for k in 0..=n[2] {
        for j in 0..=n[1] {
            for i in 0..=n[0] {
                // Closer together towards the middle, where it touches.
                let [x, y] = [(i, n[0], 0.02), (j, n[1], 0.002)].map(|(at, of, half)| {
                    let s = 2.0 * at as f64 / of as f64 - 1.0;
                    half * s * (0.2 + 0.8 * s * s)
                });
                let low = x * x / 4.0 + y * y / 0.02;
                let z = low + (0.006 - low) * (k as f64 / n[2] as f64).powi(2);
                writeln!(text, "{} {x:.12e} {y:.12e} {z:.12e}", node(i, j, k)).unwrap();
            }
        }
    }
    let cells = n.iter().product::<usize>();
    writeln!(text, "$EndNodes\n$Elements\n{cells}").unwrap();
    let mut number = 0;
    for k in 0..n[2] {
        for j in 0..n[1] {
            for i in 0..n[0] {
                number += 1;
                write!(text, "{number} 5 2 0 1").unwrap();
                for (di, dj, dk) in [
                    (0, 0, 0),
                    (1, 0, 0),
                    (1, 1, 0),
                    (0, 1, 0),
                    (0, 0, 1),
                    (1, 0, 1),
                    (1, 1, 1),
                    (0, 1, 1),
                ] {
                    write!(text, " {}", node(i + di, j + dj, k + dk)).unwrap();
                }
                text.push('\n');
            }
        }
    }
    text + "$EndElements\n"
}

/// The block is steel nearly as stiff as rigid, so that Hertz's paraboloid (2 m by 10 mm) is met but for its facets.
#[test]
fn hexahedra_from_elsewhere_bear_the_load_at_hertzs_peak() {
    let bench = Bench::new();
    bench.write("steel.msh", gmsh([24, 16, 6]));
    bench.write(
        "case.toml",
        "[runner]\nmesh = \"steel.msh\"\nelastic = true\n[ice]\nyoungs_modulus_pa = 9.0e9\npoissons_ratio = 0.33\n\
         thickness_m = \"half-space\"\n[load]\nfz_n = 50.0\ntilt = \"fixed\"\n[accuracy]\np_max = 0.03\n",
    );
    bench.succeeds(&["press", "case.toml"]);
    let result = result(&bench);
    assert!((number(&result, "fz_n") / 50.0 - 1.0).abs() < 1e-6);
    let both = (1.0 - 0.33f64.powi(2)) / 9.0e9 + (1.0 - 0.3f64.powi(2)) / 210e9;
    let hertz = kufe_contact::hertz(2.0, 0.01, 1.0 / both, 50.0)
        .unwrap()
        .p_max;
    let p_max = number(&result, "p_max_pa");
    println!("{p_max:.4e}, Hertz {hertz:.4e}");
    assert!((p_max / hertz - 1.0).abs() < 0.05, "{p_max} {hertz}");
    let file = std::fs::read(bench.path("out/runner.vtu")).expect("runner.vtu");
    let mesh = kufe_mesh::read_vtu(&file).expect("hexahedra");
    assert_eq!(mesh.cells.len(), 24 * 16 * 6);

    // A cell inside out is named.
    let text = gmsh([2, 2, 2]).replace("1 5 2 0 1 1 2", "1 5 2 0 1 2 1");
    bench.write("steel.msh", text);
    let output = bench.kufe(&["press", "case.toml", "-o", "again"]);
    let printed = errors(&output);
    assert_eq!(output.status.code(), Some(3), "{printed}");
    assert!(
        printed.contains("steel.msh") || printed.contains("runner.mesh"),
        "{printed}"
    );
}

/// Nodes from -`end` to `end`: even ones of `size` up to `even` from the middle, then each cell longer by a third.
fn line(size: f64, even: f64, end: f64) -> Vec<f64> {
    let mut half = vec![0.0];
    let mut step = size;
    while half[half.len() - 1] < end {
        let last = half[half.len() - 1];
        if last >= even {
            step *= 4.0 / 3.0;
        }
        half.push(last + step);
    }
    let below = half[1..].iter().rev().map(|x| -x);
    below.chain(half.iter().copied()).collect()
}

/// A runner of 75 GPa, 20 mm high, under a ball's side of 2 m: nodes `size` apart under the contact, those of its underside off by `noise` [m].
fn ball(size: f64, noise: f64, random: &mut u64) -> Vec<u8> {
    const HEIGHT: f64 = 0.02;
    let x = line(size, 0.009, 0.05);
    let levels: Vec<f64> = line(size, 0.003, HEIGHT)
        .into_iter()
        .filter(|z| *z >= 0.0)
        .collect();
    let levels: Vec<f64> = levels
        .iter()
        .map(|z| z / levels[levels.len() - 1])
        .collect();
    let heights: Vec<f64> = x
        .iter()
        .flat_map(|y| x.iter().map(move |x| (x * x + y * y) / 4.0))
        .map(|height| height + noise * normal(random))
        .collect();
    let mesh = kufe_mesh::mesh_over_heights(&x, &x, &heights, HEIGHT, &levels).expect("a mesh");
    let mut file = Vec::new();
    kufe_mesh::write_vtu(&mesh, &[], &[], &[], &mut file).expect("a file");
    file
}

/// Meshes under a load whose peak Hankel transforms know (15.774 MPa, `tests/data/layered.py`; by the height's change over the contact to
/// 0.04 %): noise that nobody stated is in the error that is reported, or the mesh is refused with the noise that would do. A clean mesh has none.
fn hold_their_noise(meshes: &[f64], noises: &[f64]) {
    const PEAK: f64 = 15.774_308e6;
    let mut random = 20_261_140;
    for &cells in meshes {
        let mut answered = Vec::new();
        for &noise in noises {
            let bench = Bench::new();
            bench.write("runner.vtu", ball(5.502e-3 / cells, noise, &mut random));
            bench.write(
                "case.toml",
                "[runner]\nmesh = \"runner.vtu\"\nelastic = true\nyoungs_modulus_pa = 75e9\n[ice]\nyoungs_modulus_pa = 9.0e9\n\
                 poissons_ratio = 0.33\nthickness_m = \"half-space\"\n[load]\nfz_n = 1000.0\ntilt = \"fixed\"\n[accuracy]\np_max = 0.03\n",
            );
            let output = bench.kufe(&["press", "case.toml"]);
            let printed = errors(&output);
            if output.status.code() == Some(3) {
                assert!(printed.contains("too coarse for its load"), "{printed}");
                assert!(
                    printed.contains("noise of") && printed.contains("would do"),
                    "{printed}"
                );
                continue;
            }
            // Short of the requested accuracy (4) the best answer has its error too; a clean mesh reaches it.
            let code = output.status.code();
            assert!(
                code == Some(0) || code == Some(4) && noise > 0.0,
                "{noise}: {printed}"
            );
            let result = result(&bench);
            let moved = result["p_max_noise_pa"].as_f64();
            let [off, reported] = [
                number(&result, "p_max_pa") / PEAK - 1.0,
                (number(&result, "p_max_error_pa") + moved.unwrap_or(0.0)) / PEAK,
            ];
            println!("{cells} cells, {noise:e} m: {off:.4} off, {reported:.4} reported");
            assert!(
                off.abs() < reported + 4e-4,
                "{cells} {noise}: {off} {reported}"
            );
            assert_eq!(moved.is_some(), noise > 0.0, "{noise}");
            assert_eq!(printed.contains("scatter by"), noise > 0.0, "{printed}");
            answered.push(noise);
        }
        // A third of the approach is too much, a fifteenth is not.
        let expected: Vec<f64> = noises.iter().copied().filter(|n| *n < 5e-6).collect();
        assert_eq!(answered, expected);
    }
}

#[test]
fn noise_that_nobody_stated_is_in_the_error() {
    hold_their_noise(&[3.0], &[0.0, 2e-7]);
}

#[test]
#[ignore = "slow study: .ci/slow"]
fn noise_that_nobody_stated_is_in_the_error_or_refused() {
    hold_their_noise(&[3.0, 4.5], &[0.0, 5e-8, 2e-7, 1e-6, 5e-6]);
}

/// An open scan of a runner of 8 mm width, of a 0.5 mm grid: ragged rims, holes, one of which cuts the
/// rim, and 2 µm of noise.
fn ragged_scan() -> String {
    const HALF: f64 = 0.004;
    let (along, across) = (600, 17);
    let holes = [
        [0.08, 0.001, 0.0015],
        [-0.06, -0.0035, 0.002],
        [0.03, 0.004, 0.001],
    ];
    let mut random = 20_261_141;
    let mut obj = String::new();
    let mut scanned = Vec::new();
    for i in 0..=along {
        for j in 0..across {
            let x = 0.3 * (f64::from(i) / f64::from(along) - 0.5);
            let y = HALF * (2.0 * f64::from(j) / f64::from(across - 1) - 1.0);
            let z = x * x / 60.0 + 0.006 - (36e-6 - y * y).sqrt() + 2e-6 * normal(&mut random);
            obj += &format!("v {x} {y} {z}\n");
            // One grid line, here and there, at the sides; up to 3 mm at the ends.
            let rim = HALF - if (i / 7) % 3 == 0 { 0.0004 } else { 0.0 };
            let end = 0.15 - 0.001 * f64::from(j % 4);
            let hole = |[at, side, radius]: &[f64; 3]| (x - at).hypot(y - side) < *radius;
            scanned.push(y.abs() <= rim && x.abs() <= end && !holes.iter().any(hole));
        }
    }
    for i in 0..along {
        for j in 1..across {
            let [a, b] = [i * across + j, (i + 1) * across + j].map(|k| k as usize);
            let corners = [a, a + 1, b + 1, b];
            if corners.iter().all(|&corner| scanned[corner - 1]) {
                obj += &format!("f {a} {} {} {b}\n", a + 1, b + 1);
            }
        }
    }
    obj
}

/// On two places of its top a runner bends, as its width lets it: the body that fills the scan has
/// that of the shape, whatever is missing at its rims.
#[test]
fn a_ragged_scan_with_holes_bends_as_its_shape() {
    let bench = Bench::new();
    bench.write("scan.obj", ragged_scan());
    let pressed = |runner: &str, accuracy: f64| {
        let case = format!(
            "[runner]\n{runner}\nelastic = true\nmount = {{ held = [{{ x_m = -0.12, length_m = 0.02 }}, {{ x_m = 0.12, length_m = 0.02 }}] }}\n\
             [ice]\nyoungs_modulus_pa = 9.0e9\npoissons_ratio = 0.33\nthickness_m = 0.05\n[load]\nfz_n = 1000.0\ntilt = \"fixed\"\n\
             [accuracy]\np_max = {accuracy}\n"
        );
        bench.write("case.toml", case);
        bench.succeeds(&["press", "case.toml", "--force"]);
        result(&bench)
    };
    let shape = pressed(
        "shape = { kind = \"bob\", length_m = 0.3, rocker_radius_m = 30.0, section_radius_m = 0.006, width_m = 0.008, height_m = 0.010 }",
        0.01,
    );
    let scan = pressed("hull = \"scan.obj\"\nheight_m = 0.010", 0.1);
    let stated: f64 = ["p_max_error_pa", "p_max_noise_pa", "p_max_hull_pa"]
        .map(|key| scan[key].as_f64().unwrap_or(0.0))
        .iter()
        .sum();
    let [found, truth] = [&scan, &shape].map(|result| number(result, "p_max_pa"));
    println!("{found:e} +- {stated:e}, of the shape {truth:e}");
    assert!(stated < 0.1 * truth, "{stated}");
    assert!((found - truth).abs() <= stated + number(&shape, "p_max_error_pa"));
    // The bending, of which the approach consists, within what noise leaves of the width.
    let [bent, expected] = [&scan, &shape].map(|result| number(result, "approach_m"));
    assert!((bent / expected - 1.0).abs() < 0.03, "{bent} {expected}");
}
