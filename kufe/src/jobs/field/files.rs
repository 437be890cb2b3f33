//! The files of a solved case.

use std::fmt::Display;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;

use kufe_contact::{PressureMap, Solution, pressure_maps};
use kufe_lut::MatValue;
use kufe_mesh::HullFormat;
use serde::Serialize;

use crate::jobs::document_mat::write_document_mat;
use crate::jobs::failure::{Failure, Located};
use crate::jobs::field::groove::write_sliding;
use crate::jobs::field::maps::map_picture;
use crate::jobs::field::placed_hull::placed_hull;
use crate::jobs::field::stress_picture::stress_picture;
use crate::jobs::field::{exr, subsurface, vtk};
use crate::jobs::press::SolvedContact;
use crate::plot::{Figure, quantity};
use crate::results::ContactResult;

/// Whether a name is a plain file name: without a folder, and not hidden.
pub fn is_plain(name: &str) -> bool {
    let refused = |c: char| c.is_control() || "/\\:".contains(c);
    !(name.is_empty() || name.starts_with('.') || name.contains(refused))
}

/// Files of a result in a temporary folder; the caller moves them to their final folder.
pub struct NewFiles {
    /// The temporary folder.
    pub hidden: PathBuf,
    /// The final folder, which messages name.
    pub named: PathBuf,
}

impl NewFiles {
    /// Writes the file `name` with a function that takes the file.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with the path if the file cannot be written, its name is not plain,
    /// or it was written before.
    pub fn write<E: Display>(
        &self,
        name: &str,
        write: impl FnOnce(&File) -> Result<(), E>,
    ) -> Result<(), Failure> {
        let path = self.named.join(name);
        if !is_plain(name) {
            return Err("it is not the plain name of a file").writable(&path);
        }
        let file = File::create_new(self.hidden.join(name));
        let exists = |error: &io::Error| error.kind() == io::ErrorKind::AlreadyExists;
        if file.as_ref().is_err_and(exists) {
            return Err("another file of this result has the same name").writable(&path);
        }
        let file = file.writable(&path)?;
        write(&file).writable(&path)?;
        file.sync_all().writable(&path)
    }

    /// Writes a file of these bytes or this text.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn bytes(&self, name: &str, bytes: impl AsRef<[u8]>) -> Result<(), Failure> {
        self.write(name, |mut file| file.write_all(bytes.as_ref()))
    }

    /// Writes a picture.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn picture(&self, name: &str, figure: &Figure) -> Result<(), Failure> {
        self.bytes(name, figure.png())
    }

    /// Writes a result as indented JSON.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn json(&self, name: &str, result: &impl Serialize) -> Result<(), Failure> {
        self.bytes(name, pretty(result)?)
    }
}

/// A result as indented JSON.
///
/// # Errors
/// [`Failure::BadInput`] for a result that cannot be written as JSON.
pub fn pretty(result: &impl Serialize) -> Result<String, Failure> {
    Ok(serde_json::to_string_pretty(result)? + "\n")
}

/// The picture's title.
fn title(solution: &Solution) -> String {
    format!(
        "p_max {} ({} on this mesh)   Fz {}   contact {} x {}",
        quantity(solution.p_max, "Pa"),
        quantity(solution.p_max_mesh, "Pa"),
        quantity(solution.fz, "N"),
        quantity(solution.length, "m"),
        quantity(solution.width, "m"),
    )
}

/// Writes the files of a solved case, and returns the document.
///
/// - Always: result.json, pressure.exr, pressure.png, contact.vtp.
/// - Volume solution of the ice: field.vtu. Shape with ends: hull.glb.
/// - Elastic runner: runner.vtu, stress.png.
/// - Sliding runner: groove.exr, groove.png, film.csv.
/// - Centre line: subsurface.csv, subsurface.png, and maximum shear stress in the VTU files.
/// - `mat`: result.mat.
///
/// # Errors
/// [`Failure::BadInput`] with the file that cannot be written.
pub fn write_contact(
    output: &NewFiles,
    pressed: &SolvedContact,
    mat: bool,
) -> Result<ContactResult, Failure> {
    let (p_max_map, stress_max) = fields(output, pressed)?;
    let mut result = pressed.result();
    result.p_max_map_pa = Some(p_max_map);
    result.stress_max_pa = stress_max;
    if let Some(line) = &pressed.line {
        output.write("subsurface.csv", |mut file| {
            subsurface::write_csv(&mut file, line)
        })?;
        output.picture("subsurface.png", &subsurface::subsurface_picture(line))?;
    }
    if mat {
        output.write("result.mat", |mut file| {
            write_mat(&mut BufWriter::new(&mut file), &result, &pressed.solution)
        })?;
    }
    output.json("result.json", &result)?;
    Ok(result)
}

/// Writes maps, fields and surfaces in parallel; returns the largest pressure of the map and the
/// largest compressive stress of the field [Pa].
fn fields(output: &NewFiles, pressed: &SolvedContact) -> Result<(f64, Option<f64>), Failure> {
    let bodies = || rayon::join(|| volumes(output, pressed), || surfaces(output, pressed));
    let (maps, (volumes, surfaces)) = rayon::join(|| maps(output, pressed), bodies);
    surfaces?;
    Ok((maps?, volumes?))
}

/// Writes the maps of the contact plane; returns the largest pressure [Pa].
fn maps(output: &NewFiles, pressed: &SolvedContact) -> Result<f64, Failure> {
    let solution = &pressed.solution;
    let parts = pressure_maps(solution);
    let whole = (parts.len() > 1).then(|| PressureMap::of(solution));
    let map = whole.as_ref().unwrap_or(&parts[0]);
    let largest = map.pressure.iter().copied().fold(0.0, f64::max);
    let numbers = || {
        let figures = [
            ("fz_n", solution.fz),
            ("p_max_pa", solution.p_max),
            ("p_max_error_pa", pressed.peak().error),
            ("p_max_mesh_pa", solution.p_max_mesh),
            ("p_max_map_pa", largest),
        ];
        let curvature = pressed.problem.track_curvature;
        output.write("pressure.exr", |mut file| {
            exr::write_map(&mut file, map, curvature, &figures)
        })
    };
    let picture = || output.picture("pressure.png", &map_picture(&parts, &title(solution)));
    let (numbers, picture) = rayon::join(numbers, picture);
    numbers.and(picture)?;
    if let Some(slid) = &pressed.sliding {
        write_sliding(output, pressed, map, slid)?;
    }
    Ok(largest)
}

/// Writes the fields in the volumes of ice and runner, where these were solved; returns the largest
/// compressive stress -sigma_zz in the ice [Pa].
fn volumes(output: &NewFiles, pressed: &SolvedContact) -> Result<Option<f64>, Failure> {
    let shear = pressed.line.is_some();
    let solution = &pressed.solution;
    let Some(volume) = &solution.volume else {
        return Ok(None);
    };
    let mut stress_max = 0.0;
    let groove = pressed.sliding.as_ref().map(|slid| &slid.groove.depth[..]);
    output.write("field.vtu", |mut file| {
        stress_max = vtk::write_ice(&mut file, (volume, solution), groove, shear)?;
        Ok::<_, Failure>(())
    })?;
    let elastic = &pressed.problem.runner.elastic;
    if let (Some(field), Some(elastic)) = (&solution.runner_volume, elastic) {
        output.write("runner.vtu", |mut file| {
            vtk::write_runner(&mut file, field, elastic, solution.symmetry, shear)
        })?;
    }
    Ok(Some(stress_max))
}

/// Writes the patch, the sections of a runner that deforms, and the hull after approach and tilt.
fn surfaces(output: &NewFiles, pressed: &SolvedContact) -> Result<(), Failure> {
    let solution = &pressed.solution;
    output.write("contact.vtp", |mut file| {
        vtk::write_contact(&mut file, &solution.surface, solution.fz)
    })?;
    if let (Some(field), Some(loads)) = (&solution.runner_volume, &pressed.runner) {
        let picture = stress_picture(field, loads, solution.symmetry);
        output.picture("stress.png", &picture)?;
    }
    match placed_hull(&pressed.problem, solution) {
        Some(hull) => output.write("hull.glb", |file| HullFormat::Gltf.write(&hull, file)),
        None => Ok(()),
    }
}

/// Writes every key of result.json as a variable, and the map of pressure.exr: `x_m` and `y_m`, the
/// pixels' centres, and `pressure_pa`, `map_gap_m` and `map_uz_m`, with rows along y and columns
/// along x as `surf(x_m, y_m, pressure_pa)` takes them.
///
/// # Errors
/// Those of the writer.
fn write_mat(
    writer: &mut dyn Write,
    result: &ContactResult,
    solution: &Solution,
) -> Result<(), Failure> {
    let map = PressureMap::of(solution);
    let centres = |start: f64, step: f64, count: usize| {
        MatValue::row((0..count).map(|i| start + i as f64 * step).collect())
    };
    let over_plane = |values: &[f64]| {
        let by_column = (0..map.nx).flat_map(|i| (0..map.ny).map(move |j| (i, j)));
        let values = by_column.map(|(i, j)| values[j * map.nx + i]).collect();
        MatValue::Numbers(vec![map.ny, map.nx], values)
    };
    let fields = [
        ("x_m", centres(map.x0, map.dx, map.nx)),
        ("y_m", centres(map.y0, map.dy, map.ny)),
        ("pressure_pa", over_plane(&map.pressure)),
        ("map_gap_m", over_plane(&map.gap)),
        ("map_uz_m", over_plane(&map.uz)),
    ];
    let fields = fields.map(|(name, value)| (name.to_owned(), value));
    write_document_mat(writer, result, fields.into())
}
