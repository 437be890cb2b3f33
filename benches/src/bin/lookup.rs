//! Time of one evaluation of a table, at random points, compared with the crate `interpn`'s
//! bilinear interpolation.
//!
//! `cargo run --release -p kufe-benches --bin lookup`

use std::fs::File;
use std::hint::black_box;
use std::io::BufReader;
use std::time::Instant;

use interpn::multilinear::rectilinear::MultilinearRectilinear;
use kufe_benches::{pressure_table, random_queries};
use kufe_lut::{Interpolator, Mode, Point, Quantity, Table};

const REPEATS: usize = 5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("### One evaluation of a table\n");
    println!("| nodes | method | ns |");
    println!("|---|---|---|");
    for size in [8, 16, 64] {
        let table = pressure_table(size)?;
        let queries = random_queries();
        let nodes = format!("{size} x {size}");
        for mode in Mode::ALL {
            let lookup = Interpolator::new(&table, Quantity::PMax, mode, None)?;
            let name = format!("kufe-lut {}", mode.name());
            report(&nodes, &name, &queries, |fz, k| {
                lookup.at(Point::at_rest(fz, k)).value
            });
        }
        let (fz, curvature) = (table.axes().fz(), table.axes().curvature());
        let values = table.values(Quantity::PMax).unwrap_or_default();
        let grids = [fz, curvature];
        let other = MultilinearRectilinear::<f64, 2>::new(&grids, &values)?;
        report(&nodes, "interpn bilinear", &queries, |fz, k| {
            other.interp_one([fz, k]).unwrap_or(f64::NAN)
        });
    }
    let file = File::open(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../assets/tables/front.lut"
    ))?;
    let table = Table::read(&mut BufReader::new(file))?;
    let nodes = format!(
        "{} x {}, reduced curvatures",
        table.axes().fz().len(),
        table.axes().curvature().len()
    );
    for mode in Mode::ALL {
        let lookup = Interpolator::new(&table, Quantity::PMax, mode, None)?;
        let name = format!("kufe-lut {}", mode.name());
        report(&nodes, &name, &random_queries(), |fz, k| {
            lookup.at(Point::at_rest(fz, k)).value
        });
    }
    Ok(())
}

/// Prints the best time of several passes over the queries, since other load on the machine only
/// adds time.
fn report(nodes: &str, name: &str, queries: &[(f64, f64)], at: impl Fn(f64, f64) -> f64) {
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
    println!("| {nodes} | {name} | {nanoseconds:.1} |");
}
