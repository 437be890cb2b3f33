//! `kufe export CASE --calculix`: the deck states what was solved, CalculiX reads it, and what it cannot state is refused.

use kufe_outside::program;

use serde_json::Value;

use crate::kufe::{Bench, errors};

/// A short luge steel on two bridges: a mesh that CalculiX solves in seconds.
const STEEL: &str = r#"[runner]
shape = { kind = "luge", length_m = 0.2, rocker_radius_m = 6.0, edge_radius_m = 2e-3, tilt_rad = 0.05, width_m = 0.012, height_m = 0.008 }
elastic = true
mount = { held = [{ x_m = -0.06, length_m = 0.012 }, { x_m = 0.06, length_m = 0.012 }] }
[ice]
youngs_modulus_pa = 9.0e9
poissons_ratio = 0.33
thickness_m = 0.01
[load]
fz_n = 400.0
tilt = "fixed"
"#;

/// The lines of a deck below each of its cards.
fn cards(deck: &str) -> Vec<(String, Vec<Vec<f64>>)> {
    let mut found: Vec<(String, Vec<Vec<f64>>)> = Vec::new();
    for line in deck.lines().filter(|line| !line.starts_with("**")) {
        if line.starts_with('*') {
            found.push((line.to_owned(), Vec::new()));
        } else if let Some((_, lines)) = found.last_mut() {
            lines.push(
                line.split(',')
                    .filter_map(|word| word.trim().parse().ok())
                    .collect(),
            );
        }
    }
    found
}

fn lines<'a>(cards: &'a [(String, Vec<Vec<f64>>)], name: &str) -> &'a [Vec<f64>] {
    let card = cards.iter().find(|(card, _)| card.contains(name));
    &card.unwrap_or_else(|| panic!("a card with {name}")).1
}

/// Total vertical force on a node set, as CalculiX prints it [N].
fn total(dat: &str, set: &str) -> f64 {
    let mut lines = dat
        .lines()
        .skip_while(|line| !(line.contains("total force") && line.contains(set)));
    let numbers = lines.nth(2).expect("the force below its heading");
    numbers
        .split_whitespace()
        .nth(2)
        .and_then(|word| word.parse().ok())
        .expect("a vertical force")
}

#[test]
#[ignore = "slow study: .ci/slow"]
fn the_deck_of_a_steel_on_bridges_has_the_mesh_that_was_solved_and_its_forces_in_calculix() {
    let bench = Bench::new();
    bench.write("case.toml", STEEL);
    let printed = bench.succeeds(&[
        "export",
        "case.toml",
        "--calculix",
        "deck.inp",
        "--cells",
        "2",
        "--json",
    ]);
    let facts: Value = serde_json::from_str(&printed).expect("JSON");
    let text = std::fs::read_to_string(bench.path("deck.inp")).expect("a deck");
    let deck = cards(&text);
    let nodes = lines(&deck, "*NODE, NSET=ALL");
    for (index, node) in nodes.iter().enumerate() {
        assert_eq!((node.len(), node[0]), (4, index as f64 + 1.0));
    }
    // Every node belongs to a hexahedron; each node has three unknowns, less the fixed ones.
    let mut used = vec![false; nodes.len()];
    let cells = [lines(&deck, "ELSET=ICE"), lines(&deck, "ELSET=RUNNER")].concat();
    for cell in &cells {
        assert_eq!(cell.len(), 9);
        cell[1..]
            .iter()
            .for_each(|&node| used[node as usize - 1] = true);
    }
    assert!(used.iter().all(|&used| used) && text.contains("TYPE=C3D8I, ELSET=RUNNER"));
    let dofs = facts["dofs"].as_f64().expect("dofs");
    assert!(
        dofs < 3.0 * nodes.len() as f64 && dofs > 2.0 * nodes.len() as f64,
        "{dofs}"
    );
    // The runner is fixed at its top over the bridge; the other one is its mirror image.
    let top = nodes.iter().map(|node| node[3]).fold(f64::MIN, f64::max);
    for fixed in lines(&deck, "NSET=MOUNT") {
        let node = &nodes[fixed[0] as usize - 1];
        assert!(
            (node[3] - top).abs() < 1e-6 && (54.0 - 1e-6..=66.0 + 1e-6).contains(&node[1]),
            "{node:?}"
        );
    }
    let pressures = text.lines().filter(|line| {
        let words: Vec<&str> = line.trim_start_matches("** ").split(", ").collect();
        words.len() == 2 && words.iter().all(|word| word.parse::<f64>().is_ok())
    });
    assert!(pressures.count() > 5);

    let Some(mut ccx) = program("ccx") else {
        return;
    };
    // The force on each of the mount's nodes and the steel's stress at the nodes, too.
    let more = text.replace(
        "*NODE FILE\n",
        "*NODE PRINT, NSET=MOUNT\nRF\n*EL FILE\nS\n*NODE FILE\n",
    );
    assert_ne!(more, text);
    std::fs::write(bench.path("deck.inp"), more).expect("the deck");
    let ccx = ccx
        .arg("deck")
        .current_dir(bench.folder.path())
        .env("OMP_NUM_THREADS", "1")
        .output()
        .expect("ccx");
    let printed = String::from_utf8_lossy(&ccx.stdout);
    assert!(
        ccx.status.success() && !printed.contains("*ERROR"),
        "{printed}"
    );
    let dat = std::fs::read_to_string(bench.path("deck.dat")).expect("CalculiX's forces");
    // Half of it is on either side of the mirror plane. On so coarse a mesh the runners' elements differ by a few per cent.
    let force = -2.0 * total(&dat, "MOUNT");
    println!("{force} N in CalculiX, {} N here", facts["fz_n"]);
    assert!((force / 400.0 - 1.0).abs() < 0.08, "{force}");
    assert!((total(&dat, "MOUNT") / total(&dat, "BED") + 1.0).abs() < 1e-3);

    // The load of one bridge: force, and moment about its middle, in N and N mm; the other one is its mirror image.
    let mount = &facts["mounts"][1];
    let triple = |key: &str| -> [f64; 3] {
        let read = serde_json::from_value(mount[key].clone());
        read.expect("three numbers")
    };
    let at = triple("at_m").map(|x| 1e3 * x);
    let (mut force, mut moment) = ([0.0; 3], 0.0);
    for (node, [fx, fy, fz]) in reactions(&dat) {
        let place = &nodes[node - 1];
        let [x, z] = [place[1] - at[0], place[3] - at[2]];
        for (sum, f) in force.iter_mut().zip([fx, fy, fz]) {
            *sum -= f;
        }
        moment -= z * fx - x * fz;
    }
    let (own, own_moment) = (triple("force_n"), 1e3 * triple("moment_nm")[1]);
    println!("{force:?} N and {moment} N mm in CalculiX, {own:?} and {own_moment} here");
    assert!((own[2] - 200.0).abs() < 1e-4, "{own:?}");
    assert!((force[2] / own[2] - 1.0).abs() < 0.08, "{force:?}");
    // Over the force, which the two were not pressed to alike, they agree far closer.
    let lever = moment / force[2] / (own_moment / own[2]);
    assert!((lever - 1.0).abs() < 0.02, "{moment} {own_moment}");
    // The largest stress of the steel, from its nodes in CalculiX.
    let frd = std::fs::read_to_string(bench.path("deck.frd")).expect("CalculiX's fields");
    let steel: std::collections::BTreeSet<usize> = lines(&deck, "ELSET=RUNNER")
        .iter()
        .flat_map(|cell| cell[1..].iter().map(|&node| node as usize))
        .collect();
    let stresses = stresses(&frd)
        .into_iter()
        .filter(|(node, _)| steel.contains(node));
    let (node, largest) = stresses
        .map(|(node, [xx, yy, zz, xy, yz, zx])| {
            (node, kufe_fem::von_mises([xx, yy, zz, yz, zx, xy]))
        })
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .expect("stresses");
    let own = 1e-6 * facts["runner_von_mises_max_pa"].as_f64().expect("a stress");
    let place = &nodes[node - 1][1..];
    println!(
        "{largest} MPa at {place:?} mm in CalculiX, {own} at {} m here",
        facts["runner_von_mises_at_m"]
    );
    assert!((largest / own - 1.0).abs() < 0.1, "{largest} {own}");
}

/// Forces on nodes from CalculiX's table of them [N].
fn reactions(dat: &str) -> Vec<(usize, [f64; 3])> {
    let table = dat
        .lines()
        .skip_while(|line| {
            !line
                .trim_start()
                .starts_with("forces (fx,fy,fz) for set MOUNT")
        })
        .skip(2);
    let row = |line: &str| {
        let numbers: Option<Vec<f64>> = line.split_whitespace().map(|w| w.parse().ok()).collect();
        match numbers?.as_slice() {
            &[node, x, y, z] => Some((node as usize, [x, y, z])),
            _ => None,
        }
    };
    table.map_while(row).collect()
}

/// Stresses (xx, yy, zz, xy, yz, zx) at nodes, from the block STRESS of CalculiX's fields: 12 columns a number [MPa].
fn stresses(frd: &str) -> Vec<(usize, [f64; 6])> {
    let block = frd
        .lines()
        .skip_while(|line| !line.starts_with(" -4  STRESS"));
    let rows = block
        .take_while(|line| !line.starts_with(" -3"))
        .filter(|line| line.starts_with(" -1"));
    let row = |line: &str| {
        let node = line.get(3..13)?.trim().parse().ok()?;
        let number = |k: usize| line.get(13 + 12 * k..25 + 12 * k)?.trim().parse().ok();
        let mut stress = [0.0; 6];
        for (k, value) in stress.iter_mut().enumerate() {
            *value = number(k)?;
        }
        Some((node, stress))
    };
    rows.filter_map(row).collect()
}

#[test]
fn what_a_deck_cannot_state_is_refused() {
    let bench = Bench::new();
    let refusals = [
        ("elastic = true\n", "", "runner.elastic: expected true"),
        (
            "held = [{ x_m = -0.06, length_m = 0.012 }, { x_m = 0.06, length_m = 0.012 }]",
            "carries = [{ x_m = -0.06, length_m = 0.012, share = 0.5 }, { x_m = 0.06, length_m = 0.012, share = 0.5 }]",
            "runner.mount: expected held places",
        ),
        (
            "tilt = \"fixed\"",
            "tilt = \"free\"",
            "load.tilt: expected \"fixed\"",
        ),
        (
            "thickness_m = 0.01",
            "thickness_m = \"half-space\"",
            "ice.thickness_m: expected a layer",
        ),
        (
            "thickness_m = 0.01",
            "thickness_m = 0.01\nhardness_pa = 30e6",
            "ice.hardness_pa",
        ),
    ];
    for (there, instead, expected) in refusals {
        let case = STEEL.replace(there, instead);
        let case = if expected.contains("held places") {
            case.replace("tilt = \"fixed\"", "tilt = \"free\"")
        } else if expected.contains("expected true") {
            case.lines()
                .filter(|line| !line.starts_with("mount"))
                .map(|line| format!("{line}\n"))
                .collect()
        } else {
            case
        };
        assert_ne!(case, STEEL);
        bench.write("case.toml", case);
        let output = bench.kufe(&[
            "export",
            "case.toml",
            "--calculix",
            "deck.inp",
            "--cells",
            "2",
        ]);
        let printed = errors(&output);
        assert_eq!(output.status.code(), Some(3), "{printed}");
        assert!(printed.contains(expected), "{expected}: {printed}");
        assert_eq!(bench.names(), ["case.toml"]);
    }
    let output = bench.kufe(&[
        "export",
        "case.toml",
        "--calculix",
        "deck.inp",
        "--cells",
        "1",
    ]);
    assert_eq!(output.status.code(), Some(2));
}
