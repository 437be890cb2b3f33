//! `kufe hull`: parametric runners as hull files, and a look at scanned ones.

use std::path::PathBuf;

use clap::Subcommand;
use kufe::jobs::Failure;
use kufe_mesh::{
    BobRunner, HullFormat, LugeSteel, MeshError, Rocker, Swept, load_points, tessellate,
    tessellate_turning,
};
use serde_json::json;

use crate::bodies::scan::{self, Check};
use crate::output::file::OutputFiles;
use crate::output::global::Global;
use crate::output::say::say;

/// Arguments of `kufe hull`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// What to make, or to look at
    #[command(subcommand)]
    kind: Kind,
}

#[derive(Subcommand, Debug)]
enum Kind {
    /// A bobsled runner: a round section swept along a rocker, with rounded ends
    Bob(Bob),
    /// A luge steel on its rounded edge
    Luge(Luge),
    /// Say whether a hull from a scanner can be pressed: unit, axes, spacing, noise, and which loads it resolves
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

/// Largest turn over one facet of a steel on its edge, whose radius is of the size of the contact [rad].
const EDGE_TURN: f64 = 0.01;

/// Writes the hull, or looks at one.
///
/// # Errors
/// [`Failure::BadInput`] for dimensions that do not fit and a file that cannot be written.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let (name, swept, file, turn) = match &args.kind {
        Kind::Bob(bob) => ("bob", bob.swept(bob.rocker()?), &bob.file, None),
        Kind::Luge(luge) => ("luge", luge.swept(), &luge.file, Some(EDGE_TURN)),
        Kind::Check(check) => return scan::run(check, global),
    };
    let path = file.out.display();
    let told = |error: MeshError| Failure::BadInput(format!("kufe hull {name}: {error}"));
    let format =
        HullFormat::of(&file.out).map_err(|error| Failure::BadInput(format!("{path}: {error}")))?;
    let swept = swept.map_err(told)?;
    let inputs = match &args.kind {
        Kind::Bob(bob) => bob.rocker_points.as_slice(),
        _ => &[],
    };
    let outputs = std::slice::from_ref(&file.out);
    let files = OutputFiles::begin("hull", inputs, outputs, global.force)?;
    let hull = match turn {
        Some(turn) => tessellate_turning(&swept, file.edge_length_m, turn),
        None => tessellate(&swept, file.edge_length_m),
    };
    let hull = hull.map_err(told)?;
    files.write(&file.out, |writer| format.write(&hull, writer))?;
    files.commit()?;
    let (vertices, triangles) = (hull.positions.len(), hull.triangles.len());
    if global.json {
        let document = json!({ "file": file.out, "vertices": vertices, "triangles": triangles });
        say(&format!("{document:#}\n"));
    } else if !global.quiet {
        say(&format!(
            "{path}: {vertices} vertices, {triangles} triangles\n"
        ));
    }
    Ok(())
}

impl Bob {
    /// The measured rocker, where one is given.
    fn rocker(&self) -> Result<Option<Vec<[f64; 2]>>, Failure> {
        let read = |path: &PathBuf| load_points(path, ["x_m", "z_m"]).map_err(Failure::bad_input);
        self.rocker_points.as_ref().map(read).transpose()
    }

    fn swept(&self, rocker: Option<Vec<[f64; 2]>>) -> Result<Swept, MeshError> {
        let bob = BobRunner {
            length: self.length_m,
            rocker_radius: self.rocker_radius_m,
            section_radius: self.section_radius_m,
            width: self.width_m,
            height: self.height_m,
            ..BobRunner::default()
        };
        match rocker {
            Some(points) => bob.swept_along(Rocker::points(&points)?),
            None => bob.swept(),
        }
    }
}

impl Luge {
    fn swept(&self) -> Result<Swept, MeshError> {
        LugeSteel {
            length: self.length_m,
            rocker_radius: self.rocker_radius_m,
            edge_radius: self.edge_radius_m,
            tilt: self.tilt_rad,
            width: self.width_m,
            height: self.height_m,
            ..LugeSteel::default()
        }
        .swept()
    }
}
