//! Cost as a function of size: time and memory for numbers of unknowns, points of a table, runs and
//! candidates, with fitted exponents.
//!
//! ```sh
//! growth docs/performance   # prints the table and draws growth.svg there
//! ```
//!
//! Every size is measured in a separate process. Exponents are least-squares slopes of the
//! logarithms.

use std::path::Path;
use std::sync::Arc;

use kufe_benches::{
    ICE, Line, best_of, growth_figure, growth_panel, measure_again, needle_block, on_half_space,
    peak_bytes,
};
use kufe_contact::{Foundation, Ice, Load, Options, Problem, Runner, solve};
use kufe_discover::{Gram, Prior, Scores};
use kufe_mesh::{BobRunner, Paraboloid, Waviness};
use kufe_sled::sample_data::{drive_sample, sample_plan};
use kufe_sled::{Model, PrepareOptions, Vehicle, evaluate, prepare_all};
use kufe_tests::fem::cg;
use nalgebra::DMatrix;
use rayon::prelude::*;

/// Series: name, unit of size, work, and sizes.
const SERIES: [(&str, &str, &str, &[&str]); 5] = [
    (
        "linear",
        "unknowns",
        "linear solve, residual 1e-8",
        &["14", "22", "32", "47", "70"],
    ),
    (
        "points",
        "points",
        "contacts of a sweep, 0.5 % each",
        &["4", "8", "16", "32", "64"],
    ),
    (
        "waves",
        "touching nodes",
        "a contact on waves of ice",
        &["25", "50", "100", "200", "400"],
    ),
    (
        "runs",
        "runs",
        "runs of 60 s x 500 Hz evaluated",
        &["4", "8", "16", "32", "64"],
    ),
    (
        "candidates",
        "candidates",
        "candidates scored on 20 runs",
        &["32", "64", "128", "256", "512"],
    ),
];

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words.as_slice() {
        [what, size] => {
            let size = size
                .parse()
                .unwrap_or_else(|_| panic!("{size}: expected a number"));
            let [count, seconds] = match *what {
                "linear" => linear(size),
                "points" => points(size),
                "waves" => waves(size),
                "runs" => runs(size),
                "candidates" => candidates(size),
                _ => panic!("{what}: expected linear, points, waves, runs or candidates"),
            };
            println!("{count} {seconds} {}", peak_bytes());
        }
        [folder] => tables(Some(Path::new(folder))),
        _ => tables(None),
    }
}

fn tables(folder: Option<&Path>) {
    println!("### Cost against size\n");
    println!(
        "| work | sizes | time at the largest | grows as | memory at the largest | grows as |"
    );
    println!("|---|---|---|---|---|---|");
    let (mut times, mut memories) = (Vec::new(), Vec::new());
    for (name, counted, work, sizes) in SERIES {
        let measured: Vec<[f64; 3]> = sizes
            .iter()
            .map(|size| measure_again(&[name, size]))
            .collect();
        let pairs =
            |value: usize| -> Vec<[f64; 2]> { measured.iter().map(|m| [m[0], m[value]]).collect() };
        let (time, memory) = (pairs(1), pairs(2));
        let last = measured[measured.len() - 1];
        println!(
            "| {work} | {:.0} to {:.0} {counted} | {:.3} s | size^{:.2} | {:.0} MB | size^{:.2} |",
            measured[0][0],
            last[0],
            last[1],
            exponent(&time),
            last[2] / 1e6,
            exponent(&memory),
        );
        times.push(Line {
            name: format!("{counted}: {work}"),
            points: time,
        });
        let points = memory.iter().map(|m| [m[0], m[1] / 1e6]).collect();
        memories.push(Line {
            name: counted.to_string(),
            points,
        });
    }
    println!("\nMemory is the whole process's, some 5 MB of it before any work.");
    if let Some(folder) = folder {
        let figure = growth_figure([
            growth_panel("Time", "time [s]", times),
            growth_panel("Memory", "peak memory [MB]", memories),
        ]);
        std::fs::write(folder.join("growth.svg"), figure.svg())
            .unwrap_or_else(|error| panic!("{error}"));
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        println!("\n![Time and memory over size]({name}/growth.svg)");
    }
}

/// Least-squares slope of the logarithms.
fn exponent(points: &[[f64; 2]]) -> f64 {
    let logs: Vec<[f64; 2]> = points.iter().map(|p| p.map(f64::ln)).collect();
    let n = logs.len() as f64;
    let mean = [0, 1].map(|i| logs.iter().map(|l| l[i]).sum::<f64>() / n);
    let cross: f64 = logs
        .iter()
        .map(|l| (l[0] - mean[0]) * (l[1] - mean[1]))
        .sum();
    let square: f64 = logs.iter().map(|l| (l[0] - mean[0]).powi(2)).sum();
    cross / square
}

/// A quarter of a needle-shaped patch, solved to 1e-8.
fn linear(cells: usize) -> [f64; 2] {
    let block = needle_block(cells);
    let load = block.load();
    let mut modal = vec![0.0; block.preconditioner.mode_count()];
    let mut u = vec![0.0; load.len()];
    let mut workspace = cg::Workspace::default();
    let options = cg::Options {
        stop: cg::Stop::Energy(1e-8),
        ..cg::Options::default()
    };
    let (seconds, _) = best_of(2, || {
        u.fill(0.0);
        cg::solve(
            |v, out| block.operator.apply(v, out),
            |r, out| block.preconditioner.apply(r, out, &mut modal),
            &load,
            &mut u,
            &mut workspace,
            &options,
        )
        .unwrap_or_else(|error| panic!("{error:?}"))
    });
    [block.operator.free_dofs() as f64, seconds]
}

/// Hertz contacts of loads and rocker radii in geometric progression, on all cores.
fn points(count: usize) -> [f64; 2] {
    let problem = |i: usize| {
        let t = i as f64 / 63.0;
        let hull = Paraboloid::new(15.0 * 16f64.powf((7.0 * t).fract()), 0.005)
            .unwrap_or_else(|error| panic!("{error}"));
        on_half_space(Runner::rigid(Arc::new(hull)), 0.0, 250.0 * 16f64.powf(t))
    };
    let options = Options {
        p_max_tolerance: 0.005,
        ..Options::default()
    };
    let (seconds, _) = best_of(2, || {
        (0..count)
            .into_par_iter()
            // All sizes cover the same range of loads.
            .map(|i| solve(&problem(i * 64 / count), &options).map(|s| s.p_max))
            .collect::<Result<Vec<f64>, _>>()
            .unwrap_or_else(|error| panic!("{error}"))
    });
    [count as f64, seconds]
}

/// A runner of 1 m along `count` waves of ice on a rigid bed, each touched by 16 cells.
///
/// A tiny tilt, so that no mirror plane halves the number of touching nodes.
fn waves(count: usize) -> [f64; 2] {
    let problem = || -> Result<Problem, Box<dyn std::error::Error>> {
        let length = 0.95 / count as f64;
        let hull = BobRunner::default();
        let ice = Ice {
            foundation: Foundation::RigidBed { thickness: 5e-4 },
            ..Ice::half_space(ICE.0, ICE.1)
        };
        let load = Load::Approach {
            approach: 1e-5,
            pitch: 1e-9,
            roll: 1e-9,
        };
        Ok(Problem {
            track_curvature: 1.0 / hull.rocker_radius,
            ice_surface: Some(Arc::new(Waviness::new(2.5e-3 * length, length)?)),
            ..Problem::new(Runner::rigid(Arc::new(hull.swept()?)), ice, load)
        })
    };
    let problem = problem().unwrap_or_else(|error| panic!("{error}"));
    let options = Options {
        cells: Some(8),
        ..Options::default()
    };
    let (seconds, solution) = best_of(1, || {
        solve(&problem, &options).unwrap_or_else(|error| panic!("{error}"))
    });
    let touching = solution.history.last().map_or(0, |last| last.contact_nodes);
    [touching as f64, seconds]
}

/// Preparation and evaluation of runs of the sample data, from their recordings in memory.
fn runs(count: usize) -> [f64; 2] {
    let model = Model::published();
    let vehicle = Vehicle::new(&model).unwrap_or_else(|error| panic!("{error}"));
    let plan: Vec<_> = sample_plan(1).into_iter().cycle().take(count).collect();
    let runs = drive_sample(&plan, &model).unwrap_or_else(|error| panic!("{error}"));
    let (seconds, _) = best_of(3, || {
        let options = PrepareOptions::default();
        let prepared = prepare_all(&runs, &vehicle, model.noise.as_ref(), &options)
            .unwrap_or_else(|error| panic!("{error}"));
        evaluate(&prepared, &vehicle).len()
    });
    [count as f64, seconds]
}

/// Candidates scored against a residual: products of all columns run by run, then the score of each.
fn candidates(count: usize) -> [f64; 2] {
    const RUNS: usize = 20;
    const SAMPLES: usize = 1000;
    const LEVELS: usize = 1;
    const BASE: usize = 3;
    let width = LEVELS + BASE + count + 1;
    let columns: Vec<DMatrix<f64>> = (0..RUNS)
        .map(|run| {
            DMatrix::from_fn(SAMPLES, width, |i, j| match j {
                0 => 1.0,
                _ => ((i * (j + 1)) as f64 * 0.37 + run as f64).sin(),
            })
        })
        .collect();
    let windows = DMatrix::zeros(0, width);
    let (seconds, _) = best_of(3, || {
        let grams: Vec<Gram> = columns
            .par_iter()
            .map(|columns| Gram::new(&columns.tr_mul(columns), LEVELS, &windows, &[]))
            .collect();
        Scores::new(&grams, &Prior::none(BASE)).total_information(0)
    });
    [count as f64, seconds]
}
