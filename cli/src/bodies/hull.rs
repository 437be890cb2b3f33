//! `kufe hull`: parametric runners as hull files, and the examination of scanned ones.

use std::path::PathBuf;

use clap::Subcommand;
use kufe::jobs::Failure;
use kufe_mesh::{
    BobRunner, HullFormat, LugeSteel, MeshError, Rocker, Section, Swept, load_points, tessellate,
    tessellate_turning,
};
use serde::Serialize;

use crate::bodies::scan::{self, Check};
use crate::output::{OutputFiles, of_file};
use crate::terminal::Global;

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

/// Largest turn over one facet of a steel on its edge, whose radius is of the size of the contact
/// [rad].
const EDGE_TURN: f64 = 0.01;

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
    let (name, swept, out, points, turn) = match &args.kind {
        Kind::Bob(bob) => ("bob", bob.swept(), &bob.file, &bob.rocker_points, None),
        Kind::Luge(luge) => ("luge", luge.swept(), &luge.file, &none, Some(EDGE_TURN)),
        Kind::Check(check) => return scan::run(check, global),
    };
    let File {
        out: file,
        edge_length_m,
    } = out;
    let path = file.display();
    let refuse = |error: MeshError| Failure::BadInput(format!("kufe hull {name}: {error}"));
    let format = HullFormat::of(file).map_err(of_file(file))?;
    let swept = swept.map_err(refuse)?;
    let outputs = std::slice::from_ref(file);
    let files = OutputFiles::begin("hull", points.as_slice(), outputs, global.force)?;
    let hull = match turn {
        Some(turn) => tessellate_turning(&swept, *edge_length_m, turn),
        None => tessellate(&swept, *edge_length_m),
    };
    let hull = hull.map_err(refuse)?;
    files.write(file, |writer| format.write(&hull, writer))?;
    files.commit()?;
    let (vertices, triangles) = (hull.positions.len(), hull.triangles.len());
    let written = WrittenHull {
        file,
        vertices,
        triangles,
    };
    global.print(&written, || {
        format!("{path}: {vertices} vertices, {triangles} triangles\n")
    })
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
