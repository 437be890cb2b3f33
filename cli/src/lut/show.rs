//! `kufe lut show`: draws a table.

use std::path::PathBuf;

use kufe::charts::table_picture;
use kufe::jobs::runs::{RunSelection, run_inputs};
use kufe::jobs::{Failure, Located, table::read_table};
use kufe_lut::{Point, Quantity};
use kufe_sled::table_samples;
use serde::Serialize;

use crate::output::OutputFiles;
use crate::terminal::Global;
use crate::text::print_document;

/// Arguments of `kufe lut show`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The table
    pub table: PathBuf,
    /// File of the picture [default: the table's name with .png]
    #[arg(long, short, value_name = "PNG")]
    pub out: Option<PathBuf>,
    /// Quantity to draw: p_max, p_mean, area, length, width, approach; for a sliding runner also
    /// mu, mu_ploughing, mu_viscous, mu_boundary, groove_depth, film_mean [default: p_max, or mu
    /// for a sliding runner]
    #[arg(long, value_parser = quantity)]
    pub quantity: Option<Quantity>,
    /// Radius of the rocker [m], where the table has that axis
    #[arg(long, value_name = "METRES")]
    pub rocker_radius_m: Option<f64>,
    /// Speed [m/s], where the table has that axis [default: the middle one, the upper of two]
    #[arg(long, value_name = "M_PER_S")]
    pub v_mps: Option<f64>,
    /// Ice temperature [degrees Celsius], where the table has that axis [default: the middle one,
    /// the upper of two]
    #[arg(long, value_name = "CELSIUS", allow_hyphen_values = true)]
    pub ice_c: Option<f64>,
    /// Draw the samples of these runs on the table, and count those outside; needs --model
    #[arg(long, value_name = "RUNS.csv", requires = "model")]
    pub runs: Option<PathBuf>,
    /// Model of the sled and its friction, with --runs: mass and axles determine the load of each
    /// runner
    #[arg(long, short, value_name = "MODEL.toml", requires = "runs")]
    pub model: Option<PathBuf>,
    /// With --runs: the runner of which samples are drawn [default: both]
    #[arg(long, value_parser = ["front", "rear"], requires = "runs")]
    pub runner: Option<String>,
}

impl Args {
    /// The points on the table of the samples of the runs; none without `--runs`.
    fn samples(&self, global: &Global) -> Result<Vec<Point>, Failure> {
        let (Some(runs), Some(model)) = (&self.runs, &self.model) else {
            return Ok(Vec::new());
        };
        let selection = RunSelection::all(runs.clone(), model.clone());
        let loaded = global.watched(|watch| selection.load(watch, |_| true))?;
        let [front, rear] = table_samples(loaded.prepared.iter().flat_map(|run| &run.states));
        Ok(match self.runner.as_deref() {
            Some("front") => front,
            Some(_) => rear,
            None => [front, rear].concat(),
        })
    }
}

/// Output of the command.
#[derive(Serialize)]
struct Drawn<'a> {
    written: [&'a PathBuf; 1],
    /// Number of samples of the runs.
    samples: usize,
    /// Number of samples outside the table.
    outside: usize,
}

/// Draws the table.
///
/// # Errors
/// [`Failure::BadInput`] for files.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let table = read_table(&args.table)?;
    let quantity = args.quantity.unwrap_or(table.judged());
    let out = args.out.clone();
    let out = out.unwrap_or_else(|| args.table.with_extension("png"));
    let mut inputs = vec![args.table.clone()];
    inputs.extend(args.runs.iter().flat_map(|index| run_inputs(index)));
    inputs.extend(args.model.clone());
    let outputs = std::slice::from_ref(&out);
    let files = OutputFiles::begin("lut show", &inputs, outputs, global.force)?;
    let samples = args.samples(global)?;
    let slice = Point {
        rocker_radius: args.rocker_radius_m,
        speed: args.v_mps,
        ice_c: args.ice_c,
        ..Point::default()
    };
    let picture = table_picture(&table, quantity, slice, &samples);
    let mut picture = picture.in_file(&args.table)?;
    if let Some(runner) = &args.runner {
        picture.figure.title = format!("{runner} runner: {}", picture.figure.title);
    }
    files.bytes(&out, &picture.figure.png())?;
    files.commit()?;
    let drawn = Drawn {
        written: [&out],
        samples: samples.len(),
        outside: picture.outside,
    };
    print_document(&drawn, global)
}

fn quantity(name: &str) -> Result<Quantity, String> {
    Quantity::from_name(name).ok_or_else(|| {
        let names = Quantity::ALL.map(|quantity| quantity.name()).join(", ");
        format!("expected one of {names}")
    })
}
