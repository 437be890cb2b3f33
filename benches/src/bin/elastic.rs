//! Elastic runners: iterations, unknowns and time of one mesh each, over shapes, tracks and mounts.
//!
//! ```sh
//! elastic                # 8 cells over half the patch
//! elastic 6              # another number
//! elastic --large        # a luge steel on its bridges on successively finer meshes: time, memory
//! ```

use std::sync::Arc;

use kufe_benches::{best_of, cpu_seconds, on_half_space, peak_bytes, run_again};
use kufe_contact::{
    ElasticRunner, Load, LoadedPlace, Mount, Options, Place, Problem, Runner, Tilt, solve,
};
use kufe_mesh::{BobRunner, LugeSteel, MeshError, Underside};

/// A runner of the gallery.
struct Row {
    name: &'static str,
    underside: Arc<dyn Underside>,
    top: f64,
    flank: Option<f64>,
    curvature: f64,
    /// Middle and length of the front place of its mount [m]; the other one is the mirror image.
    place: [f64; 2],
}

fn bob(
    name: &'static str,
    rocker_radius: f64,
    section_radius: f64,
    curvature: f64,
) -> Result<Row, MeshError> {
    let bob = BobRunner {
        rocker_radius,
        section_radius,
        width: f64::min(0.01, 2.0 * section_radius),
        ..BobRunner::default()
    };
    Ok(Row {
        name,
        underside: Arc::new(bob.swept()?),
        top: bob.height,
        flank: None,
        curvature,
        place: [0.25, 0.04],
    })
}

fn luge(name: &'static str, tilt: f64, curvature: f64) -> Result<Row, MeshError> {
    let luge = LugeSteel {
        tilt,
        ..LugeSteel::default()
    };
    Ok(Row {
        name,
        underside: Arc::new(luge.swept()?),
        top: luge.height,
        flank: Some(0.15),
        curvature,
        place: [0.15, 0.012],
    })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["--large"] => large(),
        ["--large", cells] => one(cells.parse()?),
        [cells] => gallery(cells.parse()?),
        _ => gallery(8),
    }
}

/// Every runner of the gallery on every mount.
fn gallery(cells: usize) -> Result<(), Box<dyn std::error::Error>> {
    let rows = [
        bob("bob, section 5 mm, rocker 30 m", 30.0, 0.005, 0.0)?,
        bob("bob, section 2 mm", 30.0, 0.002, 0.0)?,
        bob("bob, rocker 20 m", 20.0, 0.005, 0.0)?,
        bob("bob, rocker 45 m", 45.0, 0.005, 0.0)?,
        bob("bob, track 40 m", 30.0, 0.005, 1.0 / 40.0)?,
        bob("bob, track 20 m: its ends", 30.0, 0.005, 1.0 / 20.0)?,
        luge("luge, tilt 0.02", 0.02, 0.0)?,
        luge("luge, track 40 m", 0.02, 1.0 / 40.0)?,
    ];
    println!("### Elastic runners, 1 kN, {cells} cells over half the patch, residual 1e-9\n");
    println!("| runner | mount | iterations | unknowns | p_max | time | CPU |");
    println!("|---|---|---|---|---|---|---|");
    for row in &rows {
        for (mount, tilt) in [(0, "fixed"), (1, "fixed"), (2, "free")] {
            let (name, problem) = problem(row, mount, tilt == "free");
            line(&format!("{} | {name}", row.name), &problem, cells)?;
        }
    }
    println!(
        "\nPeak memory of all of them: {:.2} GB",
        peak_bytes() as f64 / 1e9
    );
    Ok(())
}

fn line(name: &str, problem: &Problem, cells: usize) -> Result<(), Box<dyn std::error::Error>> {
    let options = Options {
        cells: Some(cells),
        ..Options::default()
    };
    let before = cpu_seconds();
    let (seconds, solved) = best_of(1, || solve(problem, &options));
    let cpu = cpu_seconds() - before;
    let s = solved.map_err(|error| format!("{name}: {error}"))?;
    println!(
        "| {name} | {} | {} | {:.1} MPa | {seconds:.2} s | {cpu:.2} s |",
        s.iterations,
        s.dofs,
        1e-6 * s.p_max
    );
    Ok(())
}

/// A luge steel on its bridges on successively finer meshes, each in a separate process.
fn large() -> Result<(), Box<dyn std::error::Error>> {
    println!("### A luge steel on two bridges, 1 kN, residual 1e-9\n");
    println!("| cells over half the patch | unknowns | iterations | time | CPU | peak memory |");
    println!("|---|---|---|---|---|---|");
    for cells in ["4", "6", "8", "12"] {
        let words = run_again(&["--large", cells]);
        println!("| {cells} | {} |", words.join(" ").replace(';', " |"));
    }
    Ok(())
}

fn one(cells: usize) -> Result<(), Box<dyn std::error::Error>> {
    let (_, problem) = problem(&luge("luge", 0.02, 0.0)?, 1, false);
    let options = Options {
        cells: Some(cells),
        ..Options::default()
    };
    let before = cpu_seconds();
    let (seconds, solved) = best_of(1, || solve(&problem, &options));
    let (cpu, solution) = (cpu_seconds() - before, solved?);
    println!(
        "{}; {}; {seconds:.2} s; {cpu:.2} s; {:.2} GB",
        solution.dofs,
        solution.iterations,
        peak_bytes() as f64 / 1e9
    );
    Ok(())
}

fn problem(row: &Row, mount: usize, free: bool) -> (&'static str, Problem) {
    let [x, length] = row.place;
    let places = [-x, x].map(|x| Place { x, length });
    let loads = places.map(|place| LoadedPlace { place, share: 0.5 });
    let (name, mount) = match mount {
        0 => ("top", Mount::Top),
        1 => ("two places", Mount::Places(places.to_vec())),
        _ => ("two loads", Mount::Loads(loads.to_vec())),
    };
    let runner = Runner {
        underside: row.underside.clone(),
        elastic: Some(ElasticRunner {
            mount,
            flank: row.flank,
            ..ElasticRunner::fixed_at_top(210e9, 0.3, row.top)
        }),
    };
    let tilt = if free { Tilt::Free } else { Tilt::LEVEL };
    let problem = Problem {
        load: Load::central(1000.0, tilt),
        ..on_half_space(runner, row.curvature, 1000.0)
    };
    (name, problem)
}
