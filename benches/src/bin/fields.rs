//! Hertz contacts for the comparison with other programs, with the scripts of `benches/peers`.
//!
//! ```sh
//! fields one 0.001        # one Hertz contact at an accuracy: p_max [Pa] and seconds
//! fields all 0.005        # 64 Hertz contacts: the largest true error and seconds
//! fields anchored 0.005   # 64 contacts by boundary elements, verified by finite elements at corners and middle, as in a table
//! fields plane one        # by boundary elements alone: true error and seconds
//! fields plane all
//! ```

use std::path::Path;
use std::time::Instant;

use kufe::case::Case;
use kufe_benches::ICE;
use kufe_contact::{Options, Problem, VerifiedBem, boundary_elements, hertz, solve};
use kufe_lut::each;
use rayon::prelude::*;

const SECTION: f64 = 0.005;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words.as_slice() {
        ["one", tolerance] => one(tolerance.parse()?),
        ["all", tolerance] => {
            let tolerance = tolerance.parse()?;
            all(&|problem| Ok(solve(problem, &options(tolerance))?.p_max))
        }
        ["anchored", tolerance] => anchored(tolerance.parse()?),
        ["plane", "one"] => plane(),
        ["plane", "all"] => all(&|problem| Ok(boundary_elements(problem)?.p_max)),
        _ => {
            // Called by benches/peers/compare.py.
            println!(
                "usage: fields one TOLERANCE | all TOLERANCE | anchored TOLERANCE | plane one | plane all"
            );
            Ok(())
        }
    }
}

/// A paraboloid of `rocker` [m] and 5 mm on a half-space under `fz` [N].
fn problem(rocker: f64, fz: f64) -> Result<Problem, Box<dyn std::error::Error>> {
    let (e, nu) = ICE;
    let text = format!(
        "[runner]\nshape = {{ kind = \"paraboloid\", rocker_radius_m = {rocker:?}, section_radius_m = {SECTION:?} }}\n\
         [ice]\nyoungs_modulus_pa = {e:?}\npoissons_ratio = {nu:?}\nthickness_m = \"half-space\"\n\
         [load]\nfz_n = {fz:?}\n"
    );
    Ok(Case::parse(&text)?.problem(Path::new("."))?)
}

fn options(tolerance: f64) -> Options {
    Options {
        p_max_tolerance: tolerance,
        ..Options::default()
    }
}

fn exact(rocker: f64, fz: f64) -> f64 {
    let (e, nu) = ICE;
    hertz(rocker, SECTION, e / (1.0 - nu * nu), fz)
        .expect("numbers of a contact")
        .p_max
}

fn one(tolerance: f64) -> Result<(), Box<dyn std::error::Error>> {
    let problem = problem(30.0, 1000.0)?;
    let begun = Instant::now();
    let s = solve(&problem, &options(tolerance))?;
    println!(
        "{} {} {}",
        s.p_max,
        begun.elapsed().as_secs_f64(),
        (s.p_max / exact(30.0, 1000.0) - 1.0).abs()
    );
    Ok(())
}

fn plane() -> Result<(), Box<dyn std::error::Error>> {
    let problem = problem(30.0, 1000.0)?;
    let begun = Instant::now();
    let solution = boundary_elements(&problem)?;
    let seconds = begun.elapsed().as_secs_f64();
    let error = (solution.p_max / exact(30.0, 1000.0) - 1.0).abs();
    println!("{error} {seconds}");
    Ok(())
}

/// A solver for the peak pressure [Pa].
type PeakOf<'a> = &'a (dyn Fn(&Problem) -> Result<f64, Box<dyn std::error::Error>> + Sync);

/// Rocker radii [m] and loads [N] of 64 contacts: eight loads from 250 to 4000 N by eight effective
/// radii from 15 to 250 m, each in geometric progression.
fn points() -> Vec<(f64, f64)> {
    let spread = |from: f64, to: f64, i: usize| from * (to / from).powf(i as f64 / 7.0);
    let point = |n: usize| (spread(15.0, 250.0, n / 8), spread(250.0, 4000.0, n % 8));
    (0..64).map(point).collect()
}

fn all(p_max: PeakOf) -> Result<(), Box<dyn std::error::Error>> {
    let begun = Instant::now();
    let points = points();
    let errors: Vec<f64> = points
        .par_iter()
        .map(|&(rocker, fz)| {
            let found = problem(rocker, fz).and_then(|problem| p_max(&problem));
            found
                .map(|found| (found / exact(rocker, fz) - 1.0).abs())
                .map_err(|error| format!("{rocker} m, {fz} N: {error}"))
        })
        .collect::<Result<_, String>>()?;
    let worst = errors.iter().copied().fold(0.0, f64::max);
    println!("{worst} {}", begun.elapsed().as_secs_f64());
    Ok(())
}

/// Solves the 64 contacts by boundary elements where finite elements at their corners and middle
/// verify them, else by finite elements.
fn anchored(tolerance: f64) -> Result<(), Box<dyn std::error::Error>> {
    let begun = Instant::now();
    let points = points();
    let problems = points.iter().map(|&(rocker, fz)| problem(rocker, fz));
    let problems = problems.collect::<Result<Vec<_>, _>>()?;
    let corners = [0, 7, 56, 63, 36];
    let solutions = each(&corners, |&n| solve(&problems[n], &options(tolerance)));
    let solutions = solutions.into_iter().collect::<Result<Vec<_>, _>>()?;
    let pairs: Vec<_> = corners
        .iter()
        .zip(solutions)
        .map(|(&n, s)| (problems[n].clone(), s))
        .collect();
    let anchored = VerifiedBem::at(&pairs, tolerance).ok_or("the two methods part at an anchor")?;
    let peaks = each(&problems, |problem| match anchored.answer(problem) {
        Some(found) => Ok(found.p_max),
        None => solve(problem, &options(tolerance)).map(|solution| solution.p_max),
    });
    let mut worst = 0.0f64;
    for (peak, &(rocker, fz)) in peaks.into_iter().zip(&points) {
        worst = worst.max((peak? / exact(rocker, fz) - 1.0).abs());
    }
    println!("{worst} {}", begun.elapsed().as_secs_f64());
    Ok(())
}
