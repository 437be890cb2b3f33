//! The solver on a graphics processor beside this one, in one run: for whoever has such a processor.
//!
//! `cargo run --release -p kufe-benches --features gpu --bin gpu`

use std::sync::Arc;

use kufe_benches::{best_of, needle_block, on_half_space};
use kufe_contact::{Options, Runner, solve};
use kufe_fem::gpu::{self, Device, DeviceCg, Solver};
use kufe_fem::{Error, cg};
use kufe_mesh::Paraboloid;

fn main() {
    let device = match Device::open() {
        Ok(device) => Arc::new(device),
        Err(error) => return println!("{error}"),
    };
    let software = match device.is_software() {
        true => {
            " (software on the main processor: its times say nothing about a graphics processor)"
        }
        false => "",
    };
    println!("{}{software}", device.name());
    println!("{} threads beside it\n", rayon::current_num_threads());
    linear(&device).unwrap_or_else(|error| panic!("{error}"));
    contact(&device);
}

/// Iterations and whole linear solves.
fn linear(device: &Device) -> Result<(), Error> {
    println!("### One linear solve, residual 1e-10, aspect ratio over 100\n");
    println!(
        "| unknowns | iteration: processor | device | ratio | solve: processor, iterations | device, iterations | ratio | solutions apart (energy) |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    // Software takes minutes for the larger ones.
    let sizes = if device.is_software() { 1 } else { 4 };
    for cells in [24, 47, 70, 100].into_iter().take(sizes) {
        let block = needle_block(cells);
        let load = block.load();
        let mut modal = vec![0.0; block.preconditioner.mode_count()];
        let mut expected = vec![0.0; load.len()];
        let (host, history) = best_of(3, || {
            expected.fill(0.0);
            cg::solve(
                |v, out| block.operator.apply(v, out),
                |r, out| block.preconditioner.apply(r, out, &mut modal),
                &load,
                &mut expected,
                &mut cg::Workspace::default(),
                &cg::Options::default(),
            )
            .unwrap_or_else(|error| panic!("{error}"))
        });
        let per_iteration = host / history.iterations as f64;

        let mut kernels = DeviceCg::new(device, &block.operator, &block.preconditioner)?;
        kernels.start(&load, 0.0);
        kernels.progress()?;
        const COUNT: usize = 20;
        let (seconds, progress) = best_of(3, || {
            kernels.iterate(COUNT);
            kernels.progress()
        });
        progress?;
        let on_device = seconds / COUNT as f64;
        drop(kernels);

        let mut solver = Solver::new(device, &block.operator, &block.preconditioner)?;
        let mut found = vec![0.0; load.len()];
        let (seconds, refined) = best_of(3, || {
            found.fill(0.0);
            solver.solve(&load, &mut found, &gpu::Options::default())
        });
        let energy = |v: &[f64]| -> f64 {
            let mut kv = vec![0.0; v.len()];
            block.operator.apply(v, &mut kv);
            v.iter().zip(&kv).map(|(v, kv)| v * kv).sum::<f64>().sqrt()
        };
        let difference: Vec<f64> = found.iter().zip(&expected).map(|(f, e)| f - e).collect();
        println!(
            "| {} | {:.2} ms | {:.2} ms | {:.2} | {:.1} ms, {} | {:.1} ms, {} | {:.2} | {:.1e} |",
            block.operator.free_dofs(),
            1e3 * per_iteration,
            1e3 * on_device,
            per_iteration / on_device,
            1e3 * host,
            history.iterations,
            1e3 * seconds,
            refined?.iterations,
            host / seconds,
            energy(&difference) / energy(&expected)
        );
    }
    Ok(())
}

/// Whole contacts, meshes refined until the accuracy asked is reached.
fn contact(device: &Arc<Device>) {
    println!("\n### Rocker 30 m, section 5 mm, 1 kN, rigid on a half-space\n");
    println!("| accuracy asked | unknowns | processor | device | ratio | peaks apart |");
    println!("|---|---|---|---|---|---|");
    let hull = Paraboloid::new(30.0, 0.005).unwrap_or_else(|error| panic!("{error}"));
    let problem = on_half_space(Runner::rigid(Arc::new(hull)), 0.0, 1000.0);
    let accuracies = if device.is_software() { 1 } else { 3 };
    for tolerance in [0.005, 0.001, 0.0003].into_iter().take(accuracies) {
        let run = |device: Option<Arc<Device>>| {
            let options = Options {
                p_max_tolerance: tolerance,
                device,
                ..Options::default()
            };
            best_of(3, || {
                solve(&problem, &options).unwrap_or_else(|error| panic!("{error}"))
            })
        };
        let (host, expected) = run(None);
        let (on_device, found) = run(Some(device.clone()));
        println!(
            "| {} % | {} | {:.0} ms | {:.0} ms | {:.2} | {:.1e} |",
            100.0 * tolerance,
            found.dofs,
            1e3 * host,
            1e3 * on_device,
            host / on_device,
            (found.p_max / expected.p_max - 1.0).abs()
        );
    }
}
