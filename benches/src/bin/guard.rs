//! Four small deterministic workloads on one thread; `benches/guard` counts their instructions.
//!
//! ```sh
//! guard contact   # one contact on one small mesh
//! guard lookup    # a table evaluated at a hundred thousand points
//! guard linear    # a linear solve's two kernels, ten times
//! guard telemetry # a run of the sample data simulated, recorded, prepared and evaluated
//! ```

use std::path::Path;

use kufe::case::Case;
use kufe_benches::{needle_block, table_of};
use kufe_contact::{Options, solve};
use kufe_lut::{Interpolator, Mode, Point, Quantity};
use kufe_sled::sample_data::{drive_sample, sample_plan};
use kufe_sled::{Model, PrepareOptions, Vehicle, evaluate, prepare_all};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let word = std::env::args().nth(1).unwrap_or_default();
    match word.as_str() {
        "contact" => contact(),
        "lookup" => lookup(),
        "linear" => linear(),
        "telemetry" => telemetry(),
        _ => {
            println!("usage: guard contact | lookup | linear | telemetry");
            Ok(())
        }
    }
}

fn contact() -> Result<(), Box<dyn std::error::Error>> {
    let case = Case::parse(
        "[runner]\nshape = { kind = \"paraboloid\", rocker_radius_m = 30.0, section_radius_m = 0.005 }\n\
         [ice]\nyoungs_modulus_pa = 9e9\npoissons_ratio = 0.33\nthickness_m = \"half-space\"\n\
         [load]\nfz_n = 1000.0\n",
    )?;
    let options = Options {
        cells: Some(6),
        ..Options::default()
    };
    println!("{}", solve(&case.problem(Path::new("."))?, &options)?.p_max);
    Ok(())
}

fn lookup() -> Result<(), Box<dyn std::error::Error>> {
    let fz: Vec<f64> = (0..16).map(|i| 200.0 * 1.28f64.powi(i)).collect();
    let curvature: Vec<f64> = (0..16).map(|j| 0.001 * f64::from(j * j)).collect();
    let table = table_of(fz, curvature, |fz, curvature| {
        1e7 * fz.cbrt() * (1.0 - 2.0 * curvature)
    })?;
    for mode in Mode::ALL {
        let p_max = Interpolator::new(&table, Quantity::PMax, mode, None)?;
        let sum: f64 = (0..100_000)
            .map(|i| {
                let i = f64::from(i);
                let sample = Point::at_rest(200.0 + (i * 7.31) % 7000.0, (i * 3.7e-4) % 0.2);
                p_max.at(sample).value
            })
            .sum();
        println!("{sum}");
    }
    Ok(())
}

fn linear() -> Result<(), Box<dyn std::error::Error>> {
    let block = needle_block(20);
    let nodes = block.operator.node_count();
    let mut u: Vec<f64> = (0..3 * nodes).map(|i| (0.37 * i as f64).sin()).collect();
    let mut out = vec![0.0; 3 * nodes];
    let mut modal = vec![0.0; block.preconditioner.mode_count()];
    for _ in 0..10 {
        block.operator.apply(&u, &mut out);
        block.preconditioner.apply(&out, &mut u, &mut modal);
    }
    println!("{}", u.iter().map(|u| u * u).sum::<f64>());
    Ok(())
}

fn telemetry() -> Result<(), Box<dyn std::error::Error>> {
    let model = Model::published();
    let vehicle = Vehicle::new(&model)?;
    let runs = drive_sample(&sample_plan(1)[..1], &model)?;
    let prepared = prepare_all(
        &runs,
        &vehicle,
        model.noise.as_ref(),
        &PrepareOptions::default(),
    )?;
    for run in evaluate(&prepared, &vehicle) {
        println!("{} {}", run.run, run.series.len());
    }
    Ok(())
}
