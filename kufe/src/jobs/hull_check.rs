//! Check of a scanned hull: its orientation, noise and sampling, and a case that reads it.

use std::path::Path;
use std::sync::Arc;

use kufe_contact::{Ice, Load, Problem, Runner, Tilt, hertz};
use kufe_mesh::{
    Axis, Estimate, FittedUnderside, Hull, HullOptions, HullReport, Orientation, PlacedScan,
    ScanFrame, Underside, keel_spacing, load_hull, smaller_by, strips_of_hull, strips_warning,
    unlike_runner,
};

use crate::case::{Case, CaseError, FittedHull};
use crate::jobs::failure::{Failure, Located};
use crate::jobs::press::hull_error::{bootstrap_scans, contact_on_hull, in_hole};
use crate::plot::quantity;
use crate::results::{HullCheck, ResolvedLoad, Sampling};

/// Default of the requested relative error of the peak on a hull with noise.
const DEFAULT_RTOL: f64 = 0.05;
/// Default of that on a hull without noise.
const RTOL_WITHOUT_NOISE: f64 = 0.01;
/// Young's modulus [Pa] and Poisson's ratio of ice as cases have them by default.
const ICE_MODULUS: f64 = 9.0e9;
const ICE_RATIO: f64 = 0.33;
/// Plane-strain modulus of the ice [Pa].
const ICE_PLANE_STRAIN: f64 = ICE_MODULUS / (1.0 - ICE_RATIO * ICE_RATIO);

/// An examined hull, and how a case reads it.
pub struct ExaminedHull {
    /// The result of the check.
    pub result: HullCheck,
    /// Names of pitch and roll where they cannot be determined from the shape.
    pub unknown_angles: Option<String>,
    /// Position of the load along and across [m]; `None` if it is over the file's origin.
    pub offset_m: [Option<f64>; 2],
    /// Relative error of the peak that the case requests.
    p_max: f64,
    /// Options with which a case reads the file.
    options: HullOptions,
}

/// Examines the hull in `file` under `forces` [N]; `p_max` is the requested relative error of the
/// peak.
///
/// # Errors
/// [`Failure::BadInput`] for a hull that cannot be read or has no rounded underside.
pub fn check_hull(
    file: &Path,
    forces: &[f64],
    p_max: Option<f64>,
) -> Result<ExaminedHull, Failure> {
    let (scan, mut report) = read_scan(file)?;
    let PlacedScan {
        hull,
        frame,
        noise,
        orientation,
    } = scan;
    let Some(spacing) = keel_spacing(&hull, frame.section_radius) else {
        return Err(not_rounded(file, &hull));
    };
    let p_max = p_max.unwrap_or(if noise.found > 0.0 {
        DEFAULT_RTOL
    } else {
        RTOL_WITHOUT_NOISE
    });
    let strips = strips_of_hull(&hull);
    let [vertices, triangles] = [hull.positions.len(), hull.triangles.len()];
    let bounds = hull.bounds();
    let middle = middle_if_outside(bounds);
    let keel = orientation.and_then(|found| found.middle[1]);
    let keel = keel.filter(Estimate::significant).map(|y| y.value);
    let [x, y] = [0, 1].map(|axis| middle.map(|middle| middle[axis]));
    let offset_m = [x, keel.or(y)];
    let place = offset_m.map(Option::unwrap_or_default);
    let (mut outliers, mut undetermined) = (None, Vec::new());
    let loads = FittedUnderside::new(&hull, noise.found)
        .map_err(|error| error.to_string())
        .and_then(|underside| {
            outliers = underside.quality().outliers_warning();
            let fitted = FittedHull::new(underside, hull, report.clone(), noise, strips);
            let scans = bootstrap_scans(&fitted);
            let known = |&fz: &f64| {
                let radii = [frame.rocker_radius, frame.section_radius];
                let (load, reason) =
                    known_peak(&fitted, scans.as_deref(), radii, place, fz, p_max, spacing)?;
                undetermined.extend(reason);
                Ok(load)
            };
            forces.iter().map(known).collect::<Result<Vec<_>, String>>()
        });
    report
        .warnings
        .extend(outliers.into_iter().chain(undetermined));
    let unknown = unknown_angles(orientation.as_ref());
    report.warnings.extend(unknown.as_ref().map(|angles| {
        format!(
            "the {angles} of the hull cannot be determined from its shape: correct the case where the hull is turned"
        )
    }));
    let [length_m, width_m, height_m] = report.extent;
    let result = HullCheck {
        file: file.to_path_buf(),
        scale: frame.options.scale,
        up: frame.options.up.unwrap_or(Axis::Z).to_string(),
        forward: frame.options.forward.to_string(),
        yaw_rad: orientation.and_then(|found| found.yaw),
        pitch_rad: orientation.and_then(|found| found.pitch),
        roll_rad: orientation.and_then(|found| found.roll),
        strips_m: strips,
        length_m,
        width_m,
        height_m,
        rocker_radius_m: frame.rocker_radius,
        section_radius_m: frame.section_radius,
        vertices,
        triangles,
        beyond_origin_m: middle,
        open_edges: report.open_edges,
        spacing_m: spacing,
        noise_m: noise.found,
        unseen_noise_m: noise.unseen,
        no_underside: loads.as_ref().err().cloned(),
        loads: loads.ok(),
        warnings: report.warnings.iter().map(ToString::to_string).collect(),
        written: None,
    };
    Ok(ExaminedHull {
        result,
        unknown_angles: unknown,
        p_max,
        options: frame.options,
        offset_m,
    })
}

/// The hull of a file in runner axes, with the radii measured there, and the report of its check.
fn read_scan(file: &Path) -> Result<(PlacedScan, HullReport), Failure> {
    let unrotated = HullOptions {
        up: Some(Axis::Z),
        ..HullOptions::default()
    };
    let (of_file, read) = load_hull(file, &unrotated)?;
    let Some(mut scan) = PlacedScan::of(&of_file)? else {
        return Err(not_rounded(file, &of_file));
    };
    let mut report = kufe_mesh::check_hull(&scan.hull)?;
    report.warnings.splice(0..0, read.removed);
    let frame = ScanFrame::of(&scan.hull)?;
    report
        .warnings
        .extend(unlike_runner(&scan.hull, frame.as_ref()));
    if let Some(frame) = frame {
        scan.frame.rocker_radius = frame.rocker_radius;
        scan.frame.section_radius = frame.section_radius;
    }
    Ok((scan, report))
}

/// The names of those of pitch and roll that are unknown.
fn unknown_angles(orientation: Option<&Orientation>) -> Option<String> {
    let pitch = orientation.and_then(|found| found.pitch);
    let roll = orientation.and_then(|found| found.roll);
    let angles = [("pitch", pitch), ("roll", roll)];
    let unknown = angles.iter().filter(|(_, angle)| angle.is_none());
    let names: Vec<&str> = unknown.map(|(name, _)| *name).collect();
    (!names.is_empty()).then(|| names.join(" and "))
}

/// The failure of a hull without a rounded side like a runner's underside; long strips of triangles
/// may be the reason.
fn not_rounded(file: &Path, hull: &Hull) -> Failure {
    let strips = strips_of_hull(hull).map(strips_warning);
    let reason = strips.or_else(|| unlike_runner(hull, None));
    Failure::in_file(file, reason.unwrap_or_default())
}

/// Error of the peak under the force `fz` [N] at an offset [m] along and across, as pressing the
/// hull would state it, and the noise and spacing that would lower it to `rtol` and to half; and the
/// reason why the vertices do not determine the contact, where they do not.
fn known_peak(
    hull: &FittedHull,
    scans: Option<&[Arc<dyn Underside>]>,
    [along, across]: [f64; 2],
    [offset_x, offset_y]: [f64; 2],
    fz: f64,
    rtol: f64,
    spacing: f64,
) -> Result<(ResolvedLoad, Option<String>), String> {
    let runner = Runner::rigid(hull.underside.clone());
    let ice = Ice::half_space(ICE_MODULUS, ICE_RATIO);
    let load = Load::Force {
        fz,
        offset_x,
        offset_y,
        tilt: Tilt::LEVEL,
    };
    let problem = Problem::new(runner, ice, load);
    let noise = hull.noise.found;
    let (approach, error_m, p_max_error, undetermined) =
        match contact_on_hull(&problem, hull, scans) {
            Some((found, p_max_error)) => {
                let error_m = hull.underside.error_within(found.patch);
                let hole = in_hole(hull, found.patch);
                (found.approach, error_m, p_max_error, hole)
            }
            None => {
                let contact = hertz(along.max(across), along.min(across), ICE_PLANE_STRAIN, fz);
                let approach = contact.map_err(|error| error.to_string())?.approach;
                let error_m = hull.underside.error_for(approach);
                let unknown = (noise > 0.0).then(|| {
                    "how far the noise moves the peak could not be estimated by boundary elements"
                        .into()
                });
                (approach, error_m, error_m / approach, unknown)
            }
        };
    let sampling_for = |factor: f64| {
        let smaller = smaller_by(factor, noise > 0.0);
        Sampling {
            noise_m: (noise > 0.0).then_some(noise / smaller),
            spacing_m: spacing / smaller,
        }
    };
    let is_fine = p_max_error <= rtol;
    let resolved = ResolvedLoad {
        fz_n: fz,
        approach_m: approach,
        resolved: is_fine && undetermined.is_none(),
        p_max_error,
        error_m,
        enough: (!is_fine).then(|| sampling_for(p_max_error / rtol)),
        halves: sampling_for(2.0),
    };
    let undetermined = undetermined.map(|reason| format!("{}: {reason}", quantity(fz, "N")));
    Ok((resolved, undetermined))
}

/// The middle of a hull along and across [m] if its origin lies outside its bounds.
fn middle_if_outside([low, high]: [[f64; 3]; 2]) -> Option<[f64; 2]> {
    let outside = (0..2).any(|axis| low[axis] >= 0.0 || high[axis] <= 0.0);
    outside.then(|| [0, 1].map(|axis| 0.5 * (low[axis] + high[axis])))
}

impl ExaminedHull {
    /// The axis opposite to [`forward`](HullCheck::forward), which the shape cannot exclude.
    pub fn backward(&self) -> String {
        let mut axis = self.options.forward;
        axis.negative = !axis.negative;
        axis.to_string()
    }

    /// Normal force of the case [N]: the examined force nearest to 1 kN, or 1 kN.
    pub fn force(&self) -> f64 {
        let forces = self.result.loads.iter().flatten().map(|load| load.fz_n);
        let far = |fz: &f64| (fz - 1000.0).abs();
        let nearest = forces.min_by(|a, b| far(a).total_cmp(&far(b)));
        nearest.unwrap_or(1000.0)
    }

    /// Text of a case that reads the hull, for a file `path`, with ice, track and load to edit.
    ///
    /// # Errors
    /// [`Failure::BadInput`] if the place of the hull cannot be found, or is out of a case's range.
    pub fn case(&self, path: &Path) -> Result<String, Failure> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let hull = match self.result.file.strip_prefix(folder) {
            Ok(inside) => inside.to_path_buf(),
            Err(_) => std::path::absolute(&self.result.file).in_file(&self.result.file)?,
        };
        let [roll, pitch, yaw] = self.options.rotation;
        let angles = [("yaw_rad", yaw), ("pitch_rad", pitch), ("roll_rad", roll)];
        let angles = angles.iter().filter(|(_, angle)| *angle != 0.0);
        let angles: String = angles
            .map(|(key, angle)| format!("{key} = {angle:.6e}\n"))
            .collect();
        let noise = match self.result.noise_m {
            0.0 => String::new(),
            noise => format!("noise_m = {noise:.2e}\n"),
        };
        let [x, y] = self.offset_m;
        let why = "over the hull's middle: the file's origin lies outside it";
        let x = x.map_or(String::new(), |x| {
            format!("offset_x_m = {x:.4}   # {why}\n")
        });
        let y = y.map_or(String::new(), |y| {
            format!("offset_y_m = {y:.6}   # over the keel\n")
        });
        let text = format!(
            "[runner]
hull = {}
scale = {}
up = \"{}\"
forward = \"{}\"   # or \"{}\": the shape cannot tell
{angles}{noise}
[ice]
youngs_modulus_pa = 9.0e9
poissons_ratio = 0.33
thickness_m = 0.05

[track]
radius_m = inf

[load]
fz_n = {:?}
{x}{y}
[accuracy]
p_max = {}
",
            toml::Value::from(hull.display().to_string()),
            self.result.scale,
            self.result.up,
            self.result.forward,
            self.backward(),
            self.force(),
            self.p_max,
        );
        let refused = |error: CaseError| {
            let reason = format!(
                "no case can read it: {error}; move a hull that is far from its file's origin there"
            );
            Failure::in_file(&self.result.file, reason)
        };
        Case::parse(&text).map_err(refused)?;
        Ok(text)
    }
}
