//! Contact and linear solves: time, memory, unknowns and iterations, as Markdown tables.

use std::sync::Arc;
use std::time::Instant;

use kufe_benches::{ICE, best_of, measure_again, needle_block, on_half_space, peak_bytes};
use kufe_contact::{Options, Problem, Runner, Solution, hertz, solve};
use kufe_fem::{Body, Constraints, ElementKind, Factor, Material, assemble};
use kufe_mesh::{BobRunner, Paraboloid, Underside};
use kufe_tests::fem::cg;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words.as_slice() {
        ["hertz", tolerance, solves] => hertz_case(number(tolerance), number(solves) as usize),
        ["linear", cells] => linear_case(number(cells) as usize),
        ["direct", cells] => {
            direct_case(number(cells) as usize).unwrap_or_else(|error| panic!("{error}"));
        }
        ["runner", radius, dofs] => runner_case(number(radius), number(dofs)),
        _ => tables(),
    }
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn number(word: &str) -> f64 {
    word.parse()
        .unwrap_or_else(|_| panic!("{word}: expected a number"))
}

fn tables() {
    println!("### Runner of 30 m rocker and 5 mm section, 1 kN, rigid on a half-space\n");
    println!(
        "| requested accuracy | true error | solve | warm | whole process | peak memory | unknowns | iterations |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for tolerance in ["0.005", "0.001", "0.0003"] {
        // In turn processes that solve once and processes that solve six times.
        let rounds = [(); 5].map(|()| {
            let begun = Instant::now();
            let cold: [f64; 5] = measure_again(&["hertz", tolerance, "1"]);
            let whole = begun.elapsed().as_secs_f64();
            let [_, warm, ..]: [f64; 5] = measure_again(&["hertz", tolerance, "6"]);
            (whole, cold, warm)
        });
        let [solve, warm, whole] = [
            median(rounds.iter().map(|&(_, [_, seconds, ..], _)| seconds)),
            median(rounds.iter().map(|&(.., warm)| warm)),
            median(rounds.iter().map(|&(whole, ..)| whole)),
        ];
        let [error, _, memory, unknowns, iterations] = rounds[0].1;
        println!(
            "| {} % | {error:.3} % | {:.0} ms | {:.0} ms | {:.0} ms | {:.0} MB | {unknowns} | {iterations} |",
            100.0 * number(tolerance),
            1e3 * solve,
            1e3 * warm,
            1e3 * whole,
            memory / 1e6,
        );
    }
    println!(
        "\nMedians of five processes that solve once; warm: the later solves of processes that solve six times.\n"
    );
    println!("### One linear solve, residual 1e-8, aspect ratio over 100\n");
    println!("| unknowns | iterations | set-up | iterations' time | peak memory |");
    println!("|---|---|---|---|---|");
    for cells in ["24", "47", "70", "100", "150"] {
        let [unknowns, iterations, set_up, seconds, memory] = measure_again(&["linear", cells]);
        println!(
            "| {unknowns} | {iterations} | {set_up:.3} s | {seconds:.2} s | {:.2} GB |",
            memory / 1e9
        );
    }
    println!(
        "\n### Runner 1 m long with rounded ends, rocker 30 m, section 5 mm, 1 kN, about a million unknowns\n"
    );
    println!("| track radius | contact from end to end | p_max | iterations | unknowns | time |");
    println!("|---|---|---|---|---|---|");
    for radius in ["inf", "60", "32", "30", "29", "15"] {
        let [length, p_max, iterations, unknowns, seconds] =
            measure_again(&["runner", radius, "1000000"]);
        println!(
            "| {radius} m | {:.0} mm | {:.1} MPa | {iterations} | {unknowns} | {seconds:.2} s |",
            1e3 * length,
            p_max / 1e6
        );
    }
}

fn rigid(underside: impl Underside + 'static) -> Runner {
    Runner::rigid(Arc::new(underside))
}

fn solved(problem: &Problem, options: &Options) -> Solution {
    solve(problem, options).unwrap_or_else(|error| panic!("{error}"))
}

fn paraboloid(rocker: f64, section: f64) -> Paraboloid {
    Paraboloid::new(rocker, section).unwrap_or_else(|error| panic!("{error}"))
}

/// Prints true error [%], time of the solve or median time of the later ones [s], memory [bytes],
/// unknowns and iterations.
fn hertz_case(tolerance: f64, solves: usize) {
    let problem = on_half_space(rigid(paraboloid(30.0, 0.005)), 0.0, 1000.0);
    let options = Options {
        p_max_tolerance: tolerance,
        ..Options::default()
    };
    let timed = || best_of(1, || solved(&problem, &options));
    let (first, s) = timed();
    let later: Vec<f64> = (1..solves).map(|_| timed().0).collect();
    let seconds = if later.is_empty() {
        first
    } else {
        median(later.into_iter())
    };
    let exact = hertz(30.0, 0.005, ICE.0 / (1.0 - ICE.1 * ICE.1), 1000.0)
        .expect("numbers of a contact")
        .p_max;
    let error = 100.0 * (s.p_max / exact - 1.0).abs();
    println!(
        "{error} {seconds} {} {} {}",
        peak_bytes(),
        s.dofs,
        s.iterations
    );
}

/// Solves a quarter of a needle-shaped patch under Hertz pressure on a graded grid of `cells`^3
/// cells. Prints unknowns, iterations, set-up time [s], solution time [s] and memory [bytes].
fn linear_case(cells: usize) {
    let (set_up, block) = best_of(1, || needle_block(cells));
    let load = block.load();
    let mut modal = vec![0.0; block.preconditioner.mode_count()];
    let mut u = vec![0.0; load.len()];
    let options = cg::Options {
        stop: cg::Stop::Energy(1e-8),
        ..cg::Options::default()
    };
    let (seconds, history) = best_of(1, || {
        cg::solve(
            |v, out| block.operator.apply(v, out),
            |r, out| block.preconditioner.apply(r, out, &mut modal),
            &load,
            &mut u,
            &mut cg::Workspace::default(),
            &options,
        )
        .unwrap_or_else(|error| panic!("{error:?}"))
    });
    println!(
        "{} {} {set_up} {seconds} {}",
        block.operator.free_dofs(),
        history.iterations,
        peak_bytes()
    );
}

/// Solves the equations of [`linear_case`] by faer's sparse Cholesky. Prints unknowns, times of
/// assembly, factorisation and solution [s], and memory [bytes].
fn direct_case(cells: usize) -> Result<(), kufe_fem::Error> {
    let block = needle_block(cells);
    let nodes = block.grid.node_count();
    let load = block.load();
    let body = Body::uniform(
        block.grid.hex_mesh(),
        Material::new(ICE.0, ICE.1)?,
        ElementKind::Hex8,
    )?;
    let mut fixed = Constraints::new(nodes);
    let faces = block.grid.shape().map(|n| n - 1);
    for node in 0..nodes {
        let [nx, ny, _] = block.grid.shape();
        let place = [node % nx, node / nx % ny, node / (nx * ny)];
        for c in 0..3 {
            let on = |axis: usize| {
                let [low, high] = block.operator.fixed[c][axis];
                (low && place[axis] == 0) || (high && place[axis] == faces[axis])
            };
            if (0..3).any(on) {
                fixed.prescribe(node, c, 0.0)?;
            }
        }
    }
    let map = fixed.dof_map();
    let (assembling, stiffness) = best_of(1, || assemble(&body));
    let points = body.mesh().points.clone();
    let (factorising, factor) = best_of(1, || Factor::of_body(&stiffness, &map, &points));
    let factor = factor?;
    let by_node: Vec<f64> = (0..3 * nodes)
        .map(|i| load[i % 3 * nodes + i / 3])
        .collect();
    let mut u = map.restrict(&by_node);
    let (solving, ()) = best_of(1, || factor.solve(&mut u));
    println!(
        "{} {assembling} {factorising} {solving} {}",
        factor.dofs(),
        peak_bytes()
    );
    Ok(())
}

/// Solves the runner with about `dofs` unknowns. Prints contact length [m], peak pressure [Pa],
/// iterations, unknowns and time [s].
fn runner_case(radius: f64, dofs: f64) {
    let bob = BobRunner::default()
        .swept()
        .unwrap_or_else(|error| panic!("{error}"));
    let problem = on_half_space(rigid(bob), 1.0 / radius, 1000.0);
    let at = |cells: usize| Options {
        cells: Some(cells),
        ..Options::default()
    };
    let trial = solved(&problem, &at(6));
    let cells = (6.0 * (dofs / trial.dofs as f64).cbrt()).round() as usize;
    let (seconds, s) = best_of(2, || solved(&problem, &at(cells)));
    println!(
        "{} {} {} {} {seconds}",
        s.length, s.p_max, s.iterations, s.dofs
    );
}
