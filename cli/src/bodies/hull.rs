//! `kufe hull`: parametric runners as hull files, and checks of scanned hulls.

use std::path::PathBuf;

use clap::Subcommand;
use kufe::jobs::{ExaminedHull, Failure, Located, check_hull};
use kufe::plot::{measured, percent, quantity};
use kufe::results::{ResolvedLoad, Sampling};
use kufe_mesh::{
    BobRunner, Estimate, HullFormat, LugeSteel, MeshError, Rocker, Section, Swept, load_points,
    strips_warning, tessellate, tessellate_steel,
};
use serde::Serialize;

use crate::output::OutputFiles;
use crate::terminal::Global;
use crate::text::print_document;

/// Arguments of `kufe hull`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// What to make or to examine
    #[command(subcommand)]
    kind: Kind,
}

#[derive(Subcommand, Debug)]
enum Kind {
    /// A bobsled runner: a round section swept along a rocker, with rounded ends
    Bob(Bob),
    /// A luge steel on its rounded edge
    Luge(Luge),
    /// Examine a hull from a scanner: unit, axes, spacing, noise, and which loads it resolves
    Check(Check),
}

#[derive(clap::Args, Debug)]
struct Bob {
    /// Length [m]
    #[arg(long, value_name = "METRES", default_value_t = BobRunner::default().length)]
    length_m: f64,
    /// Radius of the rocker [m], or inf
    #[arg(long, value_name = "METRES", default_value_t = BobRunner::default().rocker_radius)]
    rocker_radius_m: f64,
    /// Rocker of several radii instead: a CSV file with the columns x_m and z_m, x increasing
    #[arg(long, value_name = "CSV", conflicts_with = "rocker_radius_m")]
    rocker_points: Option<PathBuf>,
    /// Radius of the section [m]
    #[arg(long, value_name = "METRES", default_value_t = BobRunner::default().section_radius)]
    section_radius_m: f64,
    /// Width [m]
    #[arg(long, value_name = "METRES", default_value_t = BobRunner::default().width)]
    width_m: f64,
    /// Height [m]
    #[arg(long, value_name = "METRES", default_value_t = BobRunner::default().height)]
    height_m: f64,
    #[command(flatten)]
    file: File,
}

#[derive(clap::Args, Debug)]
struct Luge {
    /// Length [m]
    #[arg(long, value_name = "METRES", default_value_t = LugeSteel::default().length)]
    length_m: f64,
    /// Radius of the rocker [m], or inf
    #[arg(long, value_name = "METRES", default_value_t = LugeSteel::default().rocker_radius)]
    rocker_radius_m: f64,
    /// Radius of the edge [m]
    #[arg(long, value_name = "METRES", default_value_t = LugeSteel::default().edge_radius)]
    edge_radius_m: f64,
    /// Tilt of the steel's flat underside [rad]
    #[arg(long, value_name = "RAD", default_value_t = LugeSteel::default().tilt)]
    tilt_rad: f64,
    /// Width [m]
    #[arg(long, value_name = "METRES", default_value_t = LugeSteel::default().width)]
    width_m: f64,
    /// Height [m]
    #[arg(long, value_name = "METRES", default_value_t = LugeSteel::default().height)]
    height_m: f64,
    #[command(flatten)]
    file: File,
}

#[derive(clap::Args, Debug)]
struct File {
    /// Hull to write: .obj, .glb or .stl, in metres
    #[arg(long, short, value_name = "FILE")]
    out: PathBuf,
    /// Length of the triangles' edges on the underside [m]
    #[arg(long, value_name = "METRES", default_value_t = 0.0005)]
    edge_length_m: f64,
}

/// A hull that was written.
#[derive(Serialize)]
struct WrittenHull<'a> {
    file: &'a PathBuf,
    vertices: usize,
    triangles: usize,
}

/// Writes the hull, or examines one.
///
/// # Errors
/// [`Failure::BadInput`] for dimensions that do not fit and a file that cannot be written.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let none = None;
    let (name, swept, out, points) = match &args.kind {
        Kind::Bob(bob) => ("bob", bob.swept(), &bob.file, &bob.rocker_points),
        Kind::Luge(luge) => ("luge", luge.swept(), &luge.file, &none),
        Kind::Check(check) => return examine(check, global),
    };
    let File {
        out: file,
        edge_length_m,
    } = out;
    let refuse = |error: MeshError| Failure::BadInput(format!("kufe hull {name}: {error}"));
    let format = HullFormat::of_output(file).in_file(file)?;
    let swept = swept.map_err(refuse)?;
    let outputs = std::slice::from_ref(file);
    let files = OutputFiles::begin("hull", points.as_slice(), outputs, global.force)?;
    let hull = match args.kind {
        Kind::Luge(_) => tessellate_steel(&swept, *edge_length_m),
        _ => tessellate(&swept, *edge_length_m),
    };
    let hull = hull.map_err(refuse)?;
    files.write(file, |writer| format.write(&hull, writer))?;
    files.commit()?;
    let written = WrittenHull {
        file,
        vertices: hull.positions.len(),
        triangles: hull.triangles.len(),
    };
    print_document(&written, global)
}

impl Bob {
    fn swept(&self) -> Result<Swept, MeshError> {
        let section = Section::arc(self.section_radius_m, self.width_m)?;
        let rocker = match &self.rocker_points {
            Some(path) => Rocker::points(&load_points(path, ["x_m", "z_m"])?)?,
            None => Rocker::arc(self.rocker_radius_m)?,
        };
        Swept::with_rounded_ends(rocker, section, self.length_m, self.height_m)
    }
}

impl Luge {
    fn swept(&self) -> Result<Swept, MeshError> {
        let section = Section::edge(self.edge_radius_m, self.tilt_rad, self.width_m)?;
        let rocker = Rocker::arc(self.rocker_radius_m)?;
        Swept::with_rounded_ends(rocker, section, self.length_m, self.height_m)
    }
}

#[derive(clap::Args, Debug)]
struct Check {
    /// The hull: .obj, .gltf, .glb, .stl or .3mf
    file: PathBuf,
    /// Normal force [N], one or several, for which it is examined
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_values_t = [250.0, 500.0, 1000.0, 2000.0, 4000.0])]
    fz_n: Vec<f64>,
    /// Relative error of the peak pressure for which it is examined, and that the case requests
    /// [default: 0.05, or 0.01 for a hull without noise]
    #[arg(long, value_name = "SHARE")]
    p_max: Option<f64>,
    /// Write a case that reads the hull with these options
    #[arg(long, short, value_name = "CASE.toml")]
    out: Option<PathBuf>,
}

/// Examines the hull, prints its properties, and writes the case.
///
/// # Errors
/// [`Failure::BadInput`] for a hull that cannot be read or has no rounded underside, one that cannot
/// be fitted where a case is requested, and a case that exists or cannot be written;
/// [`Failure::Usage`] for a force that is not positive.
fn examine(check: &Check, global: &Global) -> Result<(), Failure> {
    if let Some(fz) = check.fz_n.iter().find(|fz| !(**fz > 0.0 && fz.is_finite())) {
        return Err(Failure::option("fz-n", fz, "positive forces [N]"));
    }
    if let Some(share) = check.p_max.filter(|share| !(1e-4..=0.5).contains(share)) {
        let expected = "a relative error from 1e-4 to 0.5";
        return Err(Failure::option("p-max", share, expected));
    }
    let inputs = std::slice::from_ref(&check.file);
    let files = OutputFiles::begin("hull check", inputs, check.out.as_slice(), global.force)?;
    let mut found = check_hull(&check.file, &check.fz_n, check.p_max)?;
    if let Some(out) = &check.out {
        if let Some(error) = &found.result.no_underside {
            let reason =
                format!("no smooth underside could be fitted, and no case is written: {error}");
            return Err(Failure::in_file(&check.file, reason));
        }
        let text = found.case(out)?;
        files.bytes(out, text.as_bytes())?;
    }
    files.commit()?;
    found.result.written.clone_from(&check.out);
    global.print(&found.result, || text(&found))
}

fn text(examined: &ExaminedHull) -> String {
    let found = &examined.result;
    let metres = |value| quantity(value, "m");
    let [length, width, height] = [found.length_m, found.width_m, found.height_m].map(metres);
    let [rocker, section] = [found.rocker_radius_m, found.section_radius_m].map(metres);
    let (file, vertices, triangles) = (found.file.display(), found.vertices, found.triangles);
    let (scale, up, forward, backward) =
        (found.scale, &found.up, &found.forward, examined.backward());
    let mut lines = vec![
        format!("{file}: {vertices} vertices, {triangles} triangles"),
        format!("scale {scale}, up {up}, forward {forward} or {backward}: its shape does not tell"),
        format!("{length} x {width} x {height}; rocker radius {rocker}, section radius {section}"),
    ];
    let shown = |angle: Option<Estimate>| {
        angle.map_or("not shown by its shape".into(), |angle| {
            let [value, error] = [angle.value, angle.error].map(f64::to_degrees);
            measured(value, error, "deg")
        })
    };
    let [yaw, pitch, roll] = [found.yaw_rad, found.pitch_rad, found.roll_rad].map(shown);
    lines.push(format!(
        "into runner axes by yaw {yaw}, pitch {pitch}, roll {roll}"
    ));
    lines.extend(found.strips_m.map(strips_warning));
    let noise = match (found.noise_m, found.unseen_noise_m) {
        (0.0, 0.0) => "none".to_owned(),
        (0.0, unseen) => format!("none; less than {} would not show", metres(unseen)),
        (noise, _) => metres(noise),
    };
    let spacing = metres(found.spacing_m);
    lines.push(format!(
        "near the keel: triangles of {spacing}, noise {noise}"
    ));
    if let (Some(_), [Some(x), Some(y)]) = (found.beyond_origin_m, examined.offset_m) {
        lines.push(format!(
            "the file's origin lies outside the hull; its middle: load.offset_x_m = {x:.4}, load.offset_y_m = {y:.4}"
        ));
    }
    lines.extend(found.warnings.iter().map(ToString::to_string));
    let error = found.no_underside.as_ref();
    lines.extend(error.map(|error| format!("no smooth underside could be fitted: {error}")));
    let unknown = examined.unknown_angles.as_deref();
    let verdicts = found
        .loads
        .iter()
        .flatten()
        .map(|load| verdict(load, unknown));
    lines.extend(verdicts);
    let written = found.written.as_ref();
    let written = written.map_or(String::new(), |out| {
        format!("wrote {} for {} N\n", out.display(), examined.force())
    });
    lines.join("\n  ") + "\n" + &written
}

/// The accuracy of the peak under a load; `unknown` are the angles that the shape does not
/// determine.
fn verdict(load: &ResolvedLoad, unknown: Option<&str>) -> String {
    let (fz, known) = (quantity(load.fz_n, "N"), percent(load.p_max_error));
    let surface = measured(load.approach_m, load.error_m, "m");
    let verdict = match unknown {
        _ if load.enough.is_some() => "too coarse".to_owned(),
        _ if !load.resolved => "not determined by its vertices".to_owned(),
        None => "fine enough".to_owned(),
        Some(angles) => format!("but for its unknown {angles}"),
    };
    let by = |sampling: &Sampling| {
        let noise = sampling.noise_m;
        let noise = noise.map_or(String::new(), |n| {
            format!("noise of {} or ", quantity(n, "m"))
        });
        format!("{noise}triangles of {}", quantity(sampling.spacing_m, "m"))
    };
    let enough = load.enough.as_ref();
    let enough = enough.map_or(String::new(), |enough| format!("; {} would do", by(enough)));
    let halves = by(&load.halves);
    format!(
        "{fz}: {verdict}: the peak is known to {known}, the approach is {surface} by the surface{enough}; half of \
         that error with {halves}"
    )
}
