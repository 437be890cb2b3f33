//! `kufe hull check`: whether a hull from a scanner can be pressed, and how it is to be read.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use kufe::jobs::Failure;
use kufe_contact::hertz;
use kufe_mesh::{
    Axis, Coarse, Estimate, FittedUnderside, Hull, HullOptions, HullReport, HullWarning,
    Orientation, Sampling, ScanFrame, load_hull, noise_of_hull, smaller_by, strips_of_hull,
};
use serde_json::{Value, json};

use crate::output::file::OutputFiles;
use crate::output::global::Global;
use crate::output::say::say;

/// Arguments of `kufe hull check`.
#[derive(clap::Args, Debug)]
pub struct Check {
    /// The hull: .obj, .gltf, .glb, .stl or .3mf
    file: PathBuf,
    /// Normal force [N], one or several: what it is judged for
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_values_t = [250.0, 500.0, 1000.0, 2000.0, 4000.0])]
    fz_n: Vec<f64>,
    /// Relative error of the peak pressure that it is judged for, and that the case requests [default: 0.05, and 0.01 in the case of a
    /// hull without noise]
    #[arg(long, value_name = "SHARE")]
    p_max: Option<f64>,
    /// Write the case that reads it so
    #[arg(long, short, value_name = "CASE.toml")]
    out: Option<PathBuf>,
}

/// Relative error of the peak that a hull is judged for where none is requested.
const JUDGED: f64 = 0.05;

/// Plane-strain modulus of ice as cases have it by default, 9 GPa/(1 - 0.33^2) [Pa].
const ICE: f64 = 9.0e9 / (1.0 - 0.33 * 0.33);

/// One load, and whether the hull is fine enough for it.
struct Judged {
    fz: f64,
    approach: f64,
    /// Estimated error of the surface where it touches [m].
    error: f64,
    coarse: Option<Coarse>,
}

struct Found {
    standing: ScanFrame,
    /// How the scan is turned, where its underside could be fitted.
    orientation: Option<Orientation>,
    /// Length of its triangles where they are long strips [m].
    strips: Option<f64>,
    report: HullReport,
    vertices: usize,
    triangles: usize,
    sampling: Sampling,
    /// Where the load goes, along and across, where the file's origin lies beyond the hull [m].
    beyond: Option<[f64; 2]>,
    /// Loads, or why no smooth underside could be fitted.
    judged: Result<Vec<Judged>, String>,
}

/// Looks at the hull, says what it is like, and writes the case.
///
/// # Errors
/// [`Failure::BadInput`] for a hull that cannot be read or has no rounded underside, a force that is not positive, and a case that exists
/// or cannot be written.
pub fn run(check: &Check, global: &Global) -> Result<(), Failure> {
    if let Some(fz) = check.fz_n.iter().find(|fz| !(**fz > 0.0 && fz.is_finite())) {
        let text = format!("--fz-n {fz}: expected positive forces [N]");
        return Err(Failure::Usage(text));
    }
    if let Some(share) = check.p_max.filter(|share| !(1e-4..=0.5).contains(share)) {
        let text = format!("--p-max {share}: expected a relative error from 1e-4 to 0.5");
        return Err(Failure::Usage(text));
    }
    let inputs = std::slice::from_ref(&check.file);
    let files = OutputFiles::begin("hull check", inputs, check.out.as_slice(), global.force)?;
    let found = look(check)?;
    if let Some(out) = &check.out {
        let text = case(check, out, &found)?;
        files.write(out, |writer| writer.write_all(text.as_bytes()))?;
    }
    files.commit()?;
    if global.json {
        say(&format!("{:#}\n", document(check, &found)));
    } else if !global.quiet {
        say(&text(check, &found));
    }
    Ok(())
}

/// No side was found that is rounded as a runner's underside is; long strips may be why.
fn not_rounded(file: &Path, hull: &Hull) -> Failure {
    let reason = strips_of_hull(hull).map_or_else(
        || {
            "no side of it is rounded along and across, as the underside of a runner is (rocker and section)"
                .to_owned()
        },
        |length| HullWarning::Strips { length }.to_string(),
    );
    Failure::BadInput(format!("{}: {reason}", file.display()))
}

fn look(check: &Check) -> Result<Found, Failure> {
    let (path, forces) = (&check.file, &check.fz_n);
    let share = check.p_max.unwrap_or(JUDGED);
    let as_it_is = HullOptions {
        up: Some(Axis::Z),
        ..HullOptions::default()
    };
    let (hull, _) = load_hull(path, &as_it_is).map_err(Failure::bad_input)?;
    let Some(mut standing) = ScanFrame::of(&hull).map_err(Failure::bad_input)? else {
        return Err(not_rounded(path, &hull));
    };
    let (mut hull, mut report) = load_hull(path, &standing.options).map_err(Failure::bad_input)?;
    let noise = noise_of_hull(&hull).map_or(0.0, |noise| noise.found);
    let orientation = Orientation::of(&hull, noise).ok();
    standing.options.rotation = orientation.map_or([0.0; 3], |found| found.significant());
    if standing.options.rotation != [0.0; 3] {
        (hull, report) = load_hull(path, &standing.options).map_err(Failure::bad_input)?;
        if let Some(turned) = ScanFrame::of(&hull).map_err(Failure::bad_input)? {
            standing.rocker_radius = turned.rocker_radius;
            standing.section_radius = turned.section_radius;
        }
    }
    let Some(sampling) = Sampling::of(&hull, standing.section_radius) else {
        return Err(not_rounded(path, &hull));
    };
    let noise = stated(&sampling).unwrap_or(0.0);
    let judge = |underside: FittedUnderside| {
        let judged = forces.iter().map(|&fz| {
            let [a, b] = [standing.rocker_radius, standing.section_radius];
            let contact = hertz(a.max(b), a.min(b), ICE, fz).map_err(|error| error.to_string())?;
            Ok(Judged {
                fz,
                approach: contact.approach,
                error: underside.error_for(contact.approach),
                coarse: underside.coarse_for(contact.approach, share),
            })
        });
        judged.collect::<Result<Vec<Judged>, String>>()
    };
    Ok(Found {
        vertices: hull.positions.len(),
        triangles: hull.triangles.len(),
        judged: FittedUnderside::new(&hull, noise)
            .map_err(|error| error.to_string())
            .and_then(judge),
        beyond: middle_if_beyond(hull.bounds()),
        strips: strips_of_hull(&hull),
        standing,
        orientation,
        report,
        sampling,
    })
}

/// The middle of a hull, along and across, that does not reach over or under its origin [m].
fn middle_if_beyond([low, high]: [[f64; 3]; 2]) -> Option<[f64; 2]> {
    let beyond = (0..2).any(|axis| low[axis] >= 0.0 || high[axis] <= 0.0);
    beyond.then(|| [0, 1].map(|axis| 0.5 * (low[axis] + high[axis])))
}

/// The load of the case: of those requested the one nearest to 1 kN [N].
fn load(check: &Check) -> f64 {
    let far = |fz: &f64| (fz - 1000.0).abs();
    let nearest = check.fz_n.iter().copied();
    nearest
        .min_by(|a, b| far(a).total_cmp(&far(b)))
        .unwrap_or(1000.0)
}

/// Degrees with as many digits as the uncertainty has.
fn degrees(angle: Estimate) -> String {
    let [value, error] = [angle.value, angle.error].map(f64::to_degrees);
    let digits = (1.0 - error.log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{value:.digits$} +- {error:.digits$} degrees")
}

/// Where the load goes, along and across: over the middle of a hull that lies beyond its origin, and over the keel where that does not pass it [m].
fn offset(found: &Found) -> [Option<f64>; 2] {
    let middle = found.orientation.and_then(|found| found.middle[1]);
    let keel = middle.filter(|y| y.significant()).map(|y| y.value);
    let [x, y] = [0, 1].map(|axis| found.beyond.map(|beyond| beyond[axis]));
    [x, keel.or(y)]
}

/// Noise of the vertices that shows [m].
fn stated(sampling: &Sampling) -> Option<f64> {
    let found = sampling.noise.map(|noise| noise.found);
    found.filter(|found| *found > 0.0)
}

/// Noise that would not show [m].
fn unseen(sampling: &Sampling) -> f64 {
    sampling.noise.map_or(0.0, |noise| noise.unseen)
}

/// Noise at this spacing, and spacing at this noise, with which a load would do [m].
fn would_do(coarse: &Coarse, sampling: &Sampling) -> (Option<f64>, f64) {
    let noise = stated(sampling);
    let smaller = smaller_by(coarse.error / coarse.allowed, noise.is_some());
    (
        noise.map(|noise| noise / smaller),
        sampling.spacing / smaller,
    )
}

fn backward(forward: Axis) -> Axis {
    Axis {
        negative: !forward.negative,
        ..forward
    }
}

/// The case that reads the hull so, with ice, track and load to edit.
fn case(check: &Check, out: &Path, found: &Found) -> Result<String, Failure> {
    let file = &check.file;
    let folder = out.parent().unwrap_or(Path::new(""));
    let hull = match file.strip_prefix(folder) {
        Ok(inside) => inside.to_path_buf(),
        Err(_) => std::path::absolute(file)
            .map_err(|error| Failure::BadInput(format!("{}: {error}", file.display())))?,
    };
    let options = &found.standing.options;
    let mut text = format!(
        "[runner]\nhull = {}\nscale = {}\nup = \"{}\"\nforward = \"{}\"   # or \"{}\": its shape does not tell\n",
        json!(hull.display().to_string()),
        options.scale,
        options.up.unwrap_or(Axis::Z),
        options.forward,
        backward(options.forward),
    );
    let [roll, pitch, yaw] = options.rotation;
    for (key, angle) in [("yaw_rad", yaw), ("pitch_rad", pitch), ("roll_rad", roll)] {
        if angle != 0.0 {
            let _ = writeln!(text, "{key} = {angle:.6e}");
        }
    }
    let noise = stated(&found.sampling);
    if let Some(noise) = noise {
        let _ = writeln!(text, "noise_m = {noise:.2e}");
    }
    text += "\n[ice]\nyoungs_modulus_pa = 9.0e9\npoissons_ratio = 0.33\nthickness_m = 0.05\n\n[track]\nradius_m = inf\n";
    let _ = writeln!(text, "\n[load]\nfz_n = {:?}", load(check));
    let [x, y] = offset(found);
    if let Some(x) = x {
        let _ = writeln!(
            text,
            "offset_x_m = {x:.4}   # over the hull's middle: the file's origin lies beyond it"
        );
    }
    if let Some(y) = y {
        let _ = writeln!(text, "offset_y_m = {y:.6}   # over the keel");
    }
    let p_max = check.p_max.unwrap_or(noise.map_or(0.01, |_| JUDGED));
    let _ = writeln!(text, "\n[accuracy]\np_max = {p_max}");
    Ok(text)
}

fn document(check: &Check, found: &Found) -> Value {
    let options = &found.standing.options;
    let [length, width, height] = found.report.extent;
    let loads = found.judged.as_ref().map(|judged| {
        let one = |j: &Judged| {
            json!({
                "fz_n": j.fz, "approach_m": j.approach, "resolved": j.coarse.is_none(),
                "error_m": j.error, "allowed_m": j.coarse.map(|c| c.allowed),
                "noise_that_would_do_m": j.coarse.map(|c| would_do(&c, &found.sampling).0),
                "spacing_that_would_do_m": j.coarse.map(|c| would_do(&c, &found.sampling).1),
            })
        };
        judged.iter().map(one).collect::<Vec<Value>>()
    });
    let estimate = |of: fn(Orientation) -> Option<Estimate>| {
        let estimate = found.orientation.and_then(of);
        estimate.map(|found| json!({ "value": found.value, "error": found.error }))
    };
    json!({
        "file": check.file,
        "scale": options.scale,
        "up": options.up.unwrap_or(Axis::Z).to_string(),
        "forward": options.forward.to_string(),
        "yaw_rad": estimate(|o| o.yaw), "pitch_rad": estimate(|o| o.pitch), "roll_rad": estimate(|o| o.roll),
        "strips_m": found.strips,
        "length_m": length, "width_m": width, "height_m": height,
        "rocker_radius_m": found.standing.rocker_radius,
        "section_radius_m": found.standing.section_radius,
        "vertices": found.vertices, "triangles": found.triangles,
        "beyond_origin_m": found.beyond,
        "open_edges": found.report.open_edges,
        "spacing_m": found.sampling.spacing,
        "noise_m": stated(&found.sampling).unwrap_or(0.0),
        "unseen_noise_m": unseen(&found.sampling),
        "loads": loads.as_ref().ok(),
        "no_underside": loads.as_ref().err(),
        "warnings": found.report.warnings.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "written": check.out,
    })
}

fn text(check: &Check, found: &Found) -> String {
    let options = &found.standing.options;
    let [length, width, height] = found.report.extent.map(|m| 1e3 * m);
    let mut text = format!(
        "{}: {} vertices, {} triangles\n\
         \x20 scale {}, up {}, forward {} or {}: its shape does not tell\n",
        check.file.display(),
        found.vertices,
        found.triangles,
        options.scale,
        options.up.unwrap_or(Axis::Z),
        options.forward,
        backward(options.forward),
    );
    let _ = writeln!(
        text,
        "  {length:.1} x {width:.2} x {height:.2} mm; rocker radius {:.2} m, section radius {:.3} mm",
        found.standing.rocker_radius,
        1e3 * found.standing.section_radius
    );
    if let Some(orientation) = &found.orientation {
        text += "  into runner axes by";
        for (name, angle) in [
            ("yaw", orientation.yaw),
            ("pitch", orientation.pitch),
            ("roll", orientation.roll),
        ] {
            let comma = if name == "yaw" { "" } else { "," };
            let said = angle.map_or("not shown by its shape".to_owned(), degrees);
            let _ = write!(text, "{comma} {name} {said}");
        }
        text += "\n";
    }
    if let Some(length) = found.strips {
        let _ = writeln!(text, "  {}", HullWarning::Strips { length });
    }
    let _ = writeln!(
        text,
        "  near the keel: triangles of {:.3} mm, noise {}",
        1e3 * found.sampling.spacing,
        match (stated(&found.sampling), unseen(&found.sampling)) {
            (Some(noise), _) => format!("{:.3} µm", 1e6 * noise),
            (None, 0.0) => "none".to_owned(),
            (None, unseen) => format!("none; less than {:.3} µm would not show", 1e6 * unseen),
        }
    );
    if let Some([x, y]) = found.beyond {
        let y = offset(found)[1].unwrap_or(y);
        let _ = writeln!(
            text,
            "  the file's origin lies beyond the hull; its middle: load.offset_x_m = {x:.4}, load.offset_y_m = {y:.4}"
        );
    }
    for warning in &found.report.warnings {
        let _ = writeln!(text, "  {warning}");
    }
    match &found.judged {
        Err(error) => {
            let _ = writeln!(text, "  no smooth underside could be fitted: {error}");
        }
        Ok(judged) => {
            for one in judged {
                let _ = writeln!(text, "  {}", verdict(one, &found.sampling));
            }
        }
    }
    if let Some(out) = &check.out {
        let _ = writeln!(text, "wrote {}", out.display());
    }
    text
}

fn verdict(judged: &Judged, sampling: &Sampling) -> String {
    let [fz, approach] = [judged.fz, 1e6 * judged.approach];
    match &judged.coarse {
        None => format!(
            "{fz} N: fine enough (approach {approach:.1} µm, the surface is known to {:.2} µm)",
            1e6 * judged.error
        ),
        Some(coarse) => {
            let (noise, spacing) = would_do(coarse, sampling);
            let noise = noise.map_or(String::new(), |n| format!("noise of {:.2} µm or ", 1e6 * n));
            format!(
                "{fz} N: too coarse (approach {approach:.1} µm): the fit is known to {:.2} µm where {:.2} are needed; {noise}triangles of \
                 {:.3} mm would do",
                1e6 * coarse.error,
                1e6 * coarse.allowed,
                1e3 * spacing
            )
        }
    }
}
