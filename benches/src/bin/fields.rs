//! Fields for the comparison with other programs, whose scripts stand in `benches/peers`.
//!
//! ```sh
//! fields one 0.001        # one Hertz contact at an accuracy: p_max [Pa] and seconds
//! fields all 0.005        # 64 Hertz contacts: the largest true error and seconds
//! fields shape wavy out/  # a gap that is no paraboloid: its figures, and its pressures as CSV
//! ```

use std::f64::consts::TAU;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use kufe_benches::ICE;
use kufe_contact::case::Case;
use kufe_contact::{Options, Problem, Solution, hertz, solve};
use kufe_mesh::Underside;
use rayon::prelude::*;

const SECTION: f64 = 0.005;
/// Cells over half the patch where a whole map is compared.
const MAP_CELLS: usize = 20;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words.as_slice() {
        ["one", tolerance] => one(tolerance.parse()?),
        ["all", tolerance] => all(tolerance.parse()?),
        ["shape", name, folder] => shape(name, Path::new(folder)),
        _ => {
            // Nothing by itself: benches/peers/compare.py asks.
            println!("usage: fields one TOLERANCE | all TOLERANCE | shape NAME FOLDER");
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
    hertz(rocker, SECTION, e / (1.0 - nu * nu), fz).p_max
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

/// Eight loads from 250 to 4000 N by eight effective radii from 15 to 250 m, each in geometric progression.
fn all(tolerance: f64) -> Result<(), Box<dyn std::error::Error>> {
    let spread = |from: f64, to: f64, i: usize| from * (to / from).powf(i as f64 / 7.0);
    let begun = Instant::now();
    let points: Vec<(f64, f64)> = (0..64)
        .map(|n| (spread(15.0, 250.0, n / 8), spread(250.0, 4000.0, n % 8)))
        .collect();
    let errors: Vec<f64> = points
        .par_iter()
        .map(|&(rocker, fz)| {
            let s = problem(rocker, fz).and_then(|p| Ok(solve(&p, &options(tolerance))?));
            s.map(|s| (s.p_max / exact(rocker, fz) - 1.0).abs())
                .map_err(|error| format!("{rocker} m, {fz} N: {error}"))
        })
        .collect::<Result<_, String>>()?;
    let worst = errors.iter().copied().fold(0.0, f64::max);
    println!("{worst} {}", begun.elapsed().as_secs_f64());
    Ok(())
}

/// The height of a shape of the comparison; peers/shapes.py states the same formulas.
///
/// Every shape is smooth to its slope, so that pressures are finite: a crease would have a peak without a value.
#[derive(Clone, Copy, Debug)]
struct Gap {
    name: &'static str,
    height: fn(f64, f64) -> f64,
}

fn across(y: f64) -> f64 {
    y * y / (2.0 * SECTION)
}

/// Ends that turn up in a radius of 1 m beyond 80 mm.
fn ends(x: f64) -> f64 {
    0.5 * (x.abs() - 0.08).max(0.0).powi(2)
}

const SHAPES: [Gap; 4] = [
    Gap {
        name: "conformal",
        height: |x, y| across(y) + ends(x),
    },
    Gap {
        name: "two-ended",
        height: |x, y| across(y) + ends(x) - x * x / (2.0 * 30.0),
    },
    Gap {
        name: "wavy",
        height: |x, y| across(y) + x * x / (2.0 * 30.0) + 4e-6 * (1.0 - (TAU * x / 0.02).cos()),
    },
    Gap {
        name: "worn",
        height: |x, y| across((y.abs() - 5e-5).max(0.0)) + x * x / (2.0 * 30.0),
    },
];

impl Underside for Gap {
    fn height(&self, x: f64, y: f64) -> f64 {
        (self.height)(x, y)
    }

    fn extent(&self) -> [f64; 4] {
        [
            f64::NEG_INFINITY,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::INFINITY,
        ]
    }

    fn mirror_symmetric(&self) -> [bool; 2] {
        [true; 2]
    }
}

fn shape(name: &str, folder: &Path) -> Result<(), Box<dyn std::error::Error>> {
    let gap = SHAPES
        .into_iter()
        .find(|gap| gap.name == name)
        .ok_or_else(|| format!("{name}: the shapes are {:?}", SHAPES.map(|gap| gap.name)))?;
    let mut problem = problem(30.0, 1000.0)?;
    problem.runner.underside = Arc::new(gap);
    let begun = Instant::now();
    let s = solve(&problem, &options(0.003))?;
    let seconds = begun.elapsed().as_secs_f64();
    // The peak is extrapolated over meshes; a map is what one mesh says, so it gets a fine one.
    let map = Options {
        cells: Some(MAP_CELLS),
        ..Options::default()
    };
    write_pressures(&folder.join(format!("{name}.csv")), &solve(&problem, &map)?)?;
    println!(
        "{} {} {seconds} {} {}",
        s.p_max, s.p_max_error, s.length, s.width
    );
    Ok(())
}

/// First row: 0 and the x; then a y and its pressures, a row each.
fn write_pressures(path: &Path, s: &Solution) -> std::io::Result<()> {
    let mut file = BufWriter::new(std::fs::File::create(path)?);
    let row = |first: f64, values: &[f64]| {
        let words: Vec<String> = std::iter::once(&first)
            .chain(values)
            .map(|v| format!("{v:e}"))
            .collect();
        words.join(",")
    };
    writeln!(file, "{}", row(0.0, &s.surface.x))?;
    for (y, pressures) in s
        .surface
        .y
        .iter()
        .zip(s.surface.pressure.chunks_exact(s.surface.x.len()))
    {
        writeln!(file, "{}", row(*y, pressures))?;
    }
    file.flush()
}
