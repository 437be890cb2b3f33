//! What one solved case is written to.

use std::io::BufWriter;

use kufe::case::Case;
use kufe::jobs::field::{
    contact_vtp, map_picture, stress_picture, subsurface, volume_vtu, write_exr,
};
use kufe::jobs::{Failure, SolvedContact};
use kufe::results::ContactResult;
use kufe_contact::{PressureMap, pressure_maps};
use kufe_mesh::HullFormat;

use crate::bodies::placed_hull::placed_hull;
use crate::output::staging::Staging;
use crate::press::args::Args;
use crate::press::{mat, sliding, summary};

/// The files that a solved case may be written to.
pub const NAMES: [&str; 14] = [
    "result.json",
    "pressure.exr",
    "pressure.png",
    "field.vtu",
    "contact.vtp",
    "result.mat",
    "hull.glb",
    "runner.vtu",
    "stress.png",
    "groove.exr",
    "groove.png",
    "film.csv",
    "subsurface.csv",
    "subsurface.png",
];

/// Those that this case is surely written to, and what is asked of it.
pub fn surely(case: &Case, args: &Args) -> Vec<&'static str> {
    let of = |wanted: bool, names: &'static [&'static str]| match wanted {
        true => names.to_vec(),
        false => Vec::new(),
    };
    [
        of(true, &NAMES[..5]),
        of(args.mat, &["result.mat"]),
        of(case.runner.elastic, &["runner.vtu", "stress.png"]),
        of(
            case.sliding.is_some(),
            &["groove.exr", "groove.png", "film.csv"],
        ),
        of(args.subsurface, &["subsurface.csv", "subsurface.png"]),
    ]
    .concat()
}

/// Writes result.json, pressure.exr, pressure.png, field.vtu, contact.vtp, hull.glb where the shape has ends, and runner.vtu and stress.png where the runner deforms; where it
/// slides groove.exr, groove.png and film.csv; with a centre line subsurface.csv and subsurface.png, and the maximum shear stress in the VTU files;
/// with `mat` result.mat. Returns the document and its text.
///
/// # Errors
/// [`Failure::BadInput`] with the file that cannot be written.
pub fn write(
    staging: &Staging,
    pressed: &SolvedContact,
    mat: bool,
) -> Result<(ContactResult, String), Failure> {
    let (p_max_map, stress_max) = fields(staging, pressed)?;
    let mut result = pressed.result();
    result.p_max_map_pa = Some(p_max_map);
    result.stress_max_pa = Some(stress_max);
    if let Some(line) = &pressed.line {
        staging.write("subsurface.csv", |mut file| {
            subsurface::write_csv(&mut file, line)
        })?;
        subsurface::write_png(&staging.path("subsurface.png"), line)
            .map_err(|error| staging.failure("subsurface.png", &error))?;
    }
    if mat {
        staging.write("result.mat", |mut file| {
            mat::write(&mut BufWriter::new(&mut file), &result, &pressed.solution)
        })?;
    }
    let text = staging.result("result.json", &result)?;
    Ok((result, text))
}

/// Writes maps, fields and the surfaces, side by side; returns the largest pressure of the map and the largest compressive stress of the
/// field [Pa].
fn fields(staging: &Staging, pressed: &SolvedContact) -> Result<(f64, f64), Failure> {
    let bodies = || rayon::join(|| volumes(staging, pressed), || surfaces(staging, pressed));
    let (maps, (volumes, surfaces)) = rayon::join(|| maps(staging, pressed), bodies);
    surfaces?;
    Ok((maps?, volumes?))
}

/// Writes what is a picture of the contact plane; returns the largest pressure [Pa].
fn maps(staging: &Staging, pressed: &SolvedContact) -> Result<f64, Failure> {
    let solution = &pressed.solution;
    let parts = pressure_maps(solution);
    let whole = (parts.len() > 1).then(|| PressureMap::of(solution));
    let map = whole.as_ref().unwrap_or(&parts[0]);
    let largest = map.pressure.iter().copied().fold(0.0, f64::max);
    let numbers = || {
        staging.write("pressure.exr", |mut file| {
            let curvature = pressed.problem.track_curvature;
            let figures = [
                ("fz_n", solution.fz),
                ("p_max_pa", solution.p_max),
                ("p_max_error_pa", solution.p_max_error),
                ("p_max_mesh_pa", solution.p_max_mesh),
                ("p_max_map_pa", largest),
            ];
            write_exr::write(&mut file, map, curvature, &figures)
        })
    };
    let picture = || {
        let title = summary::title(solution);
        map_picture::write(&staging.path("pressure.png"), &parts, &title)
            .map_err(|error| staging.failure("pressure.png", &error))
    };
    let (numbers, picture) = rayon::join(numbers, picture);
    numbers.and(picture)?;
    if let Some(slid) = &pressed.sliding {
        sliding::write(staging, pressed, map, slid)?;
    }
    Ok(largest)
}

/// Writes the hexahedra of ice and runner; returns the largest compressive stress across the ice's surface [Pa].
fn volumes(staging: &Staging, pressed: &SolvedContact) -> Result<f64, Failure> {
    let shear = pressed.line.is_some();
    let solution = &pressed.solution;
    let mut stress_max = 0.0;
    staging.write("field.vtu", |mut file| {
        let groove = pressed.sliding.as_ref().map(|slid| &slid.groove.depth[..]);
        stress_max = volume_vtu::write_ice(&mut file, solution, groove, shear)?;
        Ok::<_, Failure>(())
    })?;
    if let (Some(field), Some(elastic)) = (&solution.runner_volume, &pressed.problem.runner.elastic)
    {
        staging.write("runner.vtu", |mut file| {
            volume_vtu::write_runner(&mut file, field, elastic, solution.symmetry, shear)
        })?;
    }
    Ok(stress_max)
}

/// Writes the patch, the sections of a runner that deforms, and the hull where it stands.
fn surfaces(staging: &Staging, pressed: &SolvedContact) -> Result<(), Failure> {
    let solution = &pressed.solution;
    staging.write("contact.vtp", |mut file| {
        contact_vtp::write(&mut file, &solution.surface, solution.fz)
    })?;
    if let (Some(field), Some(loads)) = (&solution.runner_volume, &pressed.runner) {
        let path = staging.path("stress.png");
        stress_picture::write(&path, field, loads, solution.symmetry)
            .map_err(|error| staging.failure("stress.png", &error))?;
    }
    if let Some(hull) = placed_hull(&pressed.problem, solution) {
        staging.write("hull.glb", |file| HullFormat::Gltf.write(&hull, file))?;
    }
    Ok(())
}
