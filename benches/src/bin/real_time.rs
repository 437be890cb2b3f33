//! Speed of the driving simulation relative to real time, and of evaluations of a fitted hull.

use std::hint::black_box;

use kufe_benches::best_of;
use kufe_mesh::{BobRunner, FittedUnderside, Underside, tessellate};
use kufe_sled::sample_data::sample_track;
use kufe_sled::{Driver, Model, SimulateOptions, TrackShape, Vehicle, simulate};

fn main() {
    println!("### One core against the clock\n");
    println!("| work | rate |");
    println!("|---|---|");
    let vehicle = Vehicle::new(&Model::published()).unwrap_or_else(|error| panic!("{error}"));
    let shape = TrackShape::new(&sample_track("east"));
    let options = SimulateOptions {
        rate_hz: 100.0,
        ..SimulateOptions::default()
    };
    let (seconds, run) = best_of(10, || {
        simulate(&vehicle, &shape, &Driver::of_skill(0.6), &options)
    });
    let run = run.unwrap_or_else(|error| panic!("{error}"));
    let simulated = run.instants.last().map_or(0.0, |last| last.state.t_s);
    println!(
        "| driving simulation, steps of 1 ms | {:.0} times real time |",
        simulated / seconds
    );

    let runner = BobRunner::default()
        .swept()
        .unwrap_or_else(|error| panic!("{error}"));
    let hull = tessellate(&runner, 2e-3).unwrap_or_else(|error| panic!("{error}"));
    let fitted = FittedUnderside::new(&hull, 0.0).unwrap_or_else(|error| panic!("{error}"));
    const HEIGHTS: u32 = 200_000;
    let (seconds, _) = best_of(5, || {
        (0..HEIGHTS)
            .map(|i| fitted.height(black_box(1e-6 * f64::from(i % 1000)), 1e-9 * f64::from(i)))
            .sum::<f64>()
    });
    println!(
        "| height of a fitted hull | {:.0} ns each |",
        1e9 * seconds / f64::from(HEIGHTS)
    );
}
