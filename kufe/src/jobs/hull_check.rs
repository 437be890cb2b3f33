//! Whether a hull from a scanner can be pressed, and how it is to be read.

use std::fmt::Write as _;
use std::path::Path;

use kufe_contact::hertz;
use kufe_mesh::{
    Axis, Estimate, FittedUnderside, Hull, HullOptions, Orientation, Sampling, ScanFrame,
    load_hull, noise_of_hull, smaller_by, strips_of_hull, strips_warning,
};

use crate::jobs::failure::Failure;
use crate::results::{Angle, HullCheck, ResolvedLoad};

/// Relative error of the peak for which a hull is examined where none is requested.
const USUAL_SHARE: f64 = 0.05;
/// Relative error that the case of a hull without noise requests where none is requested.
const WITHOUT_NOISE: f64 = 0.01;
/// Plane-strain modulus of ice as cases have it by default, 9 GPa/(1 - 0.33^2) [Pa].
const ICE: f64 = 9.0e9 / (1.0 - 0.33 * 0.33);

/// An examined hull, and how a case reads it.
pub struct ExaminedHull {
    /// What was found.
    pub result: HullCheck,
    /// Whether the rotation into runner axes could be found.
    pub oriented: bool,
    /// Place of the load, along and across, where it is not over the file's origin [m].
    pub offset_m: [Option<f64>; 2],
    /// Relative error of the peak that the case requests.
    p_max: f64,
    /// How the file is to be read.
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
    let as_it_is = HullOptions {
        up: Some(Axis::Z),
        ..HullOptions::default()
    };
    let (hull, _) = load_hull(file, &as_it_is).map_err(Failure::bad_input)?;
    let Some(mut frame) = ScanFrame::of(&hull).map_err(Failure::bad_input)? else {
        return Err(not_rounded(file, &hull));
    };
    let (mut hull, mut report) = load_hull(file, &frame.options).map_err(Failure::bad_input)?;
    let noise = noise_of_hull(&hull).map_or(0.0, |noise| noise.found);
    let orientation = Orientation::of(&hull, noise).ok();
    frame.options.rotation = orientation.map_or([0.0; 3], |found| found.significant());
    if frame.options.rotation != [0.0; 3] {
        (hull, report) = load_hull(file, &frame.options).map_err(Failure::bad_input)?;
        if let Some(turned) = ScanFrame::of(&hull).map_err(Failure::bad_input)? {
            frame.rocker_radius = turned.rocker_radius;
            frame.section_radius = turned.section_radius;
        }
    }
    let Some(sampling) = Sampling::of(&hull, frame.section_radius) else {
        return Err(not_rounded(file, &hull));
    };
    let noise = noise_of(&sampling);
    let share = p_max.unwrap_or(USUAL_SHARE);
    let loads = FittedUnderside::new(&hull, noise.unwrap_or(0.0))
        .map_err(|error| error.to_string())
        .and_then(|underside| {
            let loads = forces.iter();
            let loads = loads.map(|&fz| resolved_load(&frame, &sampling, &underside, fz, share));
            loads.collect::<Result<Vec<_>, String>>()
        });
    let angle = |of: fn(Orientation) -> Option<Estimate>| {
        let Estimate { value, error } = orientation.and_then(of)?;
        Some(Angle { value, error })
    };
    let middle = middle_if_outside(hull.bounds());
    let keel = orientation.and_then(|found| found.middle[1]);
    let keel = keel.filter(Estimate::significant).map(|y| y.value);
    let [x, y] = [0, 1].map(|axis| middle.map(|middle| middle[axis]));
    let [length_m, width_m, height_m] = report.extent;
    let result = HullCheck {
        file: file.to_path_buf(),
        scale: frame.options.scale,
        up: frame.options.up.unwrap_or(Axis::Z).to_string(),
        forward: frame.options.forward.to_string(),
        yaw_rad: angle(|found| found.yaw),
        pitch_rad: angle(|found| found.pitch),
        roll_rad: angle(|found| found.roll),
        strips_m: strips_of_hull(&hull),
        length_m,
        width_m,
        height_m,
        rocker_radius_m: frame.rocker_radius,
        section_radius_m: frame.section_radius,
        vertices: hull.positions.len(),
        triangles: hull.triangles.len(),
        beyond_origin_m: middle,
        open_edges: report.open_edges,
        spacing_m: sampling.spacing,
        noise_m: noise.unwrap_or(0.0),
        unseen_noise_m: sampling.noise.map_or(0.0, |noise| noise.unseen),
        no_underside: loads.as_ref().err().cloned(),
        loads: loads.ok(),
        warnings: report.warnings.iter().map(ToString::to_string).collect(),
        written: None,
    };
    Ok(ExaminedHull {
        result,
        oriented: orientation.is_some(),
        p_max: p_max.unwrap_or(noise.map_or(WITHOUT_NOISE, |_| USUAL_SHARE)),
        options: frame.options,
        offset_m: [x, keel.or(y)],
    })
}

/// The hull has no side that is rounded as a runner's underside is; long strips may be why.
fn not_rounded(file: &Path, hull: &Hull) -> Failure {
    let reason = strips_of_hull(hull).map_or_else(
        || {
            "no side of it is rounded along and across, as the underside of a runner is (rocker and section)"
                .to_owned()
        },
        strips_warning,
    );
    Failure::BadInput(format!("{}: {reason}", file.display()))
}

/// Noise of the vertices that is detected [m].
fn noise_of(sampling: &Sampling) -> Option<f64> {
    let found = sampling.noise.map(|noise| noise.found);
    found.filter(|found| *found > 0.0)
}

/// Whether the underside is fine enough for a force, and the noise and spacing that would be.
fn resolved_load(
    frame: &ScanFrame,
    sampling: &Sampling,
    underside: &FittedUnderside,
    fz: f64,
    share: f64,
) -> Result<ResolvedLoad, String> {
    let [a, b] = [frame.rocker_radius, frame.section_radius];
    let contact = hertz(a.max(b), a.min(b), ICE, fz).map_err(|error| error.to_string())?;
    let coarse = underside.coarse_for(contact.approach, share);
    let noise = noise_of(sampling);
    let smaller = coarse.map(|coarse| smaller_by(coarse.error / coarse.allowed, noise.is_some()));
    Ok(ResolvedLoad {
        fz_n: fz,
        approach_m: contact.approach,
        resolved: coarse.is_none(),
        error_m: underside.error_for(contact.approach),
        allowed_m: coarse.map(|coarse| coarse.allowed),
        noise_that_would_do_m: smaller.and_then(|smaller| Some(noise? / smaller)),
        spacing_that_would_do_m: smaller.map(|smaller| sampling.spacing / smaller),
    })
}

/// The middle of a hull, along and across, that is not over its origin [m].
fn middle_if_outside([low, high]: [[f64; 3]; 2]) -> Option<[f64; 2]> {
    let outside = (0..2).any(|axis| low[axis] >= 0.0 || high[axis] <= 0.0);
    outside.then(|| [0, 1].map(|axis| 0.5 * (low[axis] + high[axis])))
}

impl ExaminedHull {
    /// The axis opposite to [`forward`](HullCheck::forward), which the shape does not exclude.
    pub fn backward(&self) -> String {
        let forward = self.options.forward;
        let negative = !forward.negative;
        Axis {
            negative,
            ..forward
        }
        .to_string()
    }

    /// The case that reads the hull so, written to `path`: with ice, track and load to edit, of the
    /// `forces` [N] the one nearest to 1 kN.
    ///
    /// # Errors
    /// [`Failure::BadInput`] where the place of the hull cannot be found.
    pub fn case(&self, path: &Path, forces: &[f64]) -> Result<String, Failure> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let hull = match self.result.file.strip_prefix(folder) {
            Ok(inside) => inside.to_path_buf(),
            Err(_) => std::path::absolute(&self.result.file).map_err(|error| {
                Failure::BadInput(format!("{}: {error}", self.result.file.display()))
            })?,
        };
        let mut text = format!(
            "[runner]\nhull = {}\nscale = {}\nup = \"{}\"\nforward = \"{}\"   # or \"{}\": its shape does not tell\n",
            toml::Value::from(hull.display().to_string()),
            self.result.scale,
            self.result.up,
            self.result.forward,
            self.backward(),
        );
        let [roll, pitch, yaw] = self.options.rotation;
        for (key, angle) in [("yaw_rad", yaw), ("pitch_rad", pitch), ("roll_rad", roll)] {
            if angle != 0.0 {
                let _ = writeln!(text, "{key} = {angle:.6e}");
            }
        }
        if self.result.noise_m > 0.0 {
            let _ = writeln!(text, "noise_m = {:.2e}", self.result.noise_m);
        }
        text += "\n[ice]\nyoungs_modulus_pa = 9.0e9\npoissons_ratio = 0.33\nthickness_m = 0.05\n\n[track]\nradius_m = inf\n";
        let far = |fz: &f64| (fz - 1000.0).abs();
        let load = forces
            .iter()
            .copied()
            .min_by(|a, b| far(a).total_cmp(&far(b)));
        let _ = writeln!(text, "\n[load]\nfz_n = {:?}", load.unwrap_or(1000.0));
        let [x, y] = self.offset_m;
        if let Some(x) = x {
            let _ = writeln!(
                text,
                "offset_x_m = {x:.4}   # over the hull's middle: the file's origin lies outside it"
            );
        }
        if let Some(y) = y {
            let _ = writeln!(text, "offset_y_m = {y:.6}   # over the keel");
        }
        let _ = writeln!(text, "\n[accuracy]\np_max = {}", self.p_max);
        Ok(text)
    }
}
