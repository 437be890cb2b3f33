//! `kufe lut show`: a table drawn.

use std::path::PathBuf;

use kufe_jobs::{Failure, table::read_table};
use kufe_lut::{Quantity, Slice};

use crate::output::apart::apart;
use crate::output::global::Global;
use crate::output::say::say;

/// Arguments of `kufe lut show`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The table
    pub table: PathBuf,
    /// Where the picture goes [default: the table's name with .png]
    #[arg(long, short, value_name = "PNG")]
    pub out: Option<PathBuf>,
    /// p_max, p_mean, area, length, width, approach; of a runner that slides also mu, mu_ploughing, mu_viscous, groove_depth,
    /// film_mean [default: p_max, or mu of a runner that slides]
    #[arg(long)]
    pub quantity: Option<String>,
    /// Rocker radius, where the table has that axis [m]
    #[arg(long, value_name = "METRES")]
    pub rocker: Option<f64>,
    /// Speed, where the table has that axis [m/s] [default: the middle one]
    #[arg(long, value_name = "M_PER_S")]
    pub v: Option<f64>,
    /// Temperature of the ice, where the table has that axis [C] [default: the middle one]
    #[arg(long, value_name = "CELSIUS", allow_hyphen_values = true)]
    pub ice: Option<f64>,
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
    apart(
        std::slice::from_ref(&args.table),
        std::slice::from_ref(&out),
    )?;
    let slice = Slice {
        rocker_radius: args.rocker,
        speed: args.v,
        ice_c: args.ice,
    };
    kufe_lut::draw(&table, quantity, slice, &out)
        .map_err(|error| Failure::BadInput(format!("{}: {error}", args.table.display())))?;
    if global.json {
        let written = out.display().to_string();
        say(&format!(
            "{}\n",
            serde_json::json!({ "written": [written] })
        ));
    } else if !global.quiet {
        say(&format!("wrote {}\n", out.display()));
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
