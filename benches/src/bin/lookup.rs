//! Time of one evaluation of a table, at random points, beside the crate `interpn`'s bilinear interpolation.
//!
//! `cargo run --release -p kufe-benches --bin lookup`

use std::hint::black_box;
use std::time::Instant;

use interpn::multilinear::rectilinear::MultilinearRectilinear;
use kufe_lut::{Axes, Lookup, Mode, Quantity, Solved, Table};

const QUERIES: usize = 1 << 20;
const REPEATS: usize = 5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("nodes      method                 ns an evaluation");
    for size in [8, 16, 64] {
        let table = table(size)?;
        let queries = queries();
        for mode in Mode::ALL {
            let lookup = Lookup::new(&table, Quantity::PMax, mode)?;
            let name = format!("kufe-lut {}", mode.name());
            report(size, &name, &queries, |fz, k| lookup.at(fz, k).value);
        }
        let (fz, curvature) = (table.axes().fz(), table.axes().curvature());
        let values: Vec<f64> = table.nodes().iter().map(|node| node.p_max).collect();
        let grids = [fz, curvature];
        let other = MultilinearRectilinear::<f64, 2>::new(&grids, &values)?;
        report(size, "interpn bilinear", &queries, |fz, k| {
            other.interp_one([fz, k]).unwrap_or(f64::NAN)
        });
    }
    Ok(())
}

/// Best of a few passes over the queries: other load on the machine only ever adds.
fn report(size: usize, name: &str, queries: &[(f64, f64)], at: impl Fn(f64, f64) -> f64) {
    let mut best = f64::INFINITY;
    for _ in 0..REPEATS {
        let started = Instant::now();
        let mut sum = 0.0;
        for &(fz, curvature) in queries {
            sum += at(black_box(fz), black_box(curvature));
        }
        black_box(sum);
        best = best.min(started.elapsed().as_secs_f64());
    }
    let nanoseconds = 1e9 * best / queries.len() as f64;
    println!("{size:>3} x {size:<3}  {name:<20}  {nanoseconds:8.1}");
}

fn queries() -> Vec<(f64, f64)> {
    let mut state = 1u64;
    let mut random = || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    (0..QUERIES)
        .map(|_| (200.0 + 7800.0 * random(), -0.02 + 0.048 * random()))
        .collect()
}

/// Unevenly spaced breakpoints; pressures that follow the load's power law.
fn table(size: usize) -> Result<Table, kufe_lut::Error> {
    let t = |i: usize| i as f64 / (size - 1) as f64;
    let fz = (0..size).map(|i| 200.0 * 40f64.powf(t(i))).collect();
    let curvature = (0..size).map(|j| -0.02 + 0.048 * t(j).sqrt()).collect();
    let axes = Axes::new(fz, curvature, None)?;
    let nodes = axes.points().into_iter().map(|point| {
        let p_max = 1.4e8 * (point.fz / 1e3).cbrt() * (1.0 - 30.0 * point.curvature).powf(0.6);
        Solved {
            p_max,
            p_max_error: 0.0,
            p_mean: p_max / 1.5,
            area: 1e-5,
            length: 0.05,
            width: 3e-4,
            approach: 1e-5,
        }
    });
    let nodes = nodes.collect();
    Table::new(axes, nodes, Vec::new())
}
