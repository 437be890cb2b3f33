//! `kufe lut show`: a table drawn.

use std::path::PathBuf;

use kufe::charts::{Slice, table_picture};
use kufe::jobs::runs::RunSelection;
use kufe::jobs::{Failure, table::read_table};
use kufe_lut::{Quantity, Sample};
use kufe_sled::table_samples;

use crate::output::file::OutputFiles;
use crate::output::global::Global;
use crate::output::say::say;
use crate::output::watched::watched;

/// Arguments of `kufe lut show`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The table
    pub table: PathBuf,
    /// Where the picture goes [default: the table's name with .png]
    #[arg(long, short, value_name = "PNG")]
    pub out: Option<PathBuf>,
    /// What is drawn: p_max, p_mean, area, length, width, approach; of a runner that slides also mu, mu_ploughing, mu_viscous, mu_boundary, groove_depth,
    /// film_mean [default: p_max, or mu of a runner that slides]
    #[arg(long)]
    pub quantity: Option<String>,
    /// Radius of the rocker [m], where the table has that axis
    #[arg(long, value_name = "METRES")]
    pub rocker_radius_m: Option<f64>,
    /// Speed [m/s], where the table has that axis [default: the middle one, the upper of two]
    #[arg(long, value_name = "M_PER_S")]
    pub v_mps: Option<f64>,
    /// Ice temperature [degrees Celsius], where the table has that axis [default: the middle one, the upper of two]
    #[arg(long, value_name = "CELSIUS", allow_hyphen_values = true)]
    pub ice_c: Option<f64>,
    /// Shows where the samples of these runs lie on the table, and counts those outside; needs --model
    #[arg(long, value_name = "RUNS.csv", requires = "model")]
    pub runs: Option<PathBuf>,
    /// Model of the sled and its friction, with --runs: mass and axles say what each runner bears
    #[arg(long, short, value_name = "MODEL.toml", requires = "runs")]
    pub model: Option<PathBuf>,
    /// With --runs: the runner that the table is of [default: both]
    #[arg(long, value_enum, requires = "runs")]
    pub runner: Option<Runner>,
}

/// A runner of the sled.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq)]
pub enum Runner {
    /// Those in front
    Front,
    /// Those at the rear
    Rear,
}

impl Args {
    /// What the runs asked for would ask the table; nothing where none are.
    fn samples(&self, global: &Global) -> Result<Vec<Sample>, Failure> {
        let (Some(runs), Some(model)) = (&self.runs, &self.model) else {
            return Ok(Vec::new());
        };
        let selection = RunSelection::all(runs.clone(), model.clone());
        let loaded = watched(global, |watch| selection.load(watch, |_| true))?;
        let [front, rear] = table_samples(loaded.prepared.iter().flat_map(|run| &run.states));
        Ok(match self.runner {
            Some(Runner::Front) => front,
            Some(Runner::Rear) => rear,
            None => [front, rear].concat(),
        })
    }
}

/// Draws the table.
///
/// # Errors
/// [`Failure::Usage`] for an unknown quantity, [`Failure::BadInput`] for files.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let asked = args.quantity.as_deref().map(named).transpose()?;
    let table = read_table(&args.table)?;
    let quantity = asked.unwrap_or(table.judged());
    let out = args
        .out
        .clone()
        .unwrap_or_else(|| args.table.with_extension("png"));
    let inputs = [&Some(args.table.clone()), &args.runs, &args.model];
    let inputs: Vec<PathBuf> = inputs.into_iter().flatten().cloned().collect();
    let outputs = std::slice::from_ref(&out);
    let files = OutputFiles::begin("lut show", &inputs, outputs, global.force)?;
    let samples = args.samples(global)?;
    let slice = Slice {
        rocker_radius: args.rocker_radius_m,
        speed: args.v_mps,
        ice_c: args.ice_c,
    };
    let picture = table_picture(&table, quantity, slice, &samples)
        .map_err(|error| Failure::BadInput(format!("{}: {error}", args.table.display())))?;
    let outside = picture.outside;
    files.write(&out, |writer| writer.write_all(&picture.figure.png()))?;
    files.commit()?;
    if global.json {
        let written = out.display().to_string();
        say(&format!(
            "{}\n",
            serde_json::json!({ "written": [written], "samples": samples.len(), "outside": outside })
        ));
    } else if !global.quiet {
        let mut text = format!("wrote {}\n", out.display());
        if !samples.is_empty() {
            text += &format!(
                "{outside} of {} samples lie outside the table\n",
                samples.len()
            );
        }
        say(&text);
    }
    Ok(())
}

fn named(name: &str) -> Result<Quantity, Failure> {
    Quantity::from_name(name).ok_or_else(|| {
        let names: Vec<&str> = Quantity::ALL.iter().map(|q| q.name()).collect();
        let names = names.join(", ");
        Failure::Usage(format!("--quantity {name}: expected one of {names}"))
    })
}
