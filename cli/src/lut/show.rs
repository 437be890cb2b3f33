//! `kufe lut show`: a table drawn.

use std::path::PathBuf;

use kufe_jobs::{Failure, table::read_table};
use kufe_lut::Quantity;

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
    /// p_max, p_mean, area, length, width or approach
    #[arg(long, default_value = "p_max")]
    pub quantity: String,
    /// Rocker radius, where the table has that axis [m]
    #[arg(long, value_name = "METRES")]
    pub rocker: Option<f64>,
}

/// Draws the table.
///
/// # Errors
/// [`Failure::Usage`] for an unknown quantity, [`Failure::BadInput`] for files.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let quantity = Quantity::from_name(&args.quantity).ok_or_else(|| {
        let names: Vec<&str> = Quantity::ALL.iter().map(|q| q.name()).collect();
        Failure::Usage(format!(
            "--quantity {}: expected one of {}",
            args.quantity,
            names.join(", ")
        ))
    })?;
    let table = read_table(&args.table)?;
    let out = args
        .out
        .clone()
        .unwrap_or_else(|| args.table.with_extension("png"));
    apart(
        std::slice::from_ref(&args.table),
        std::slice::from_ref(&out),
    )?;
    kufe_lut::draw(&table, quantity, args.rocker, &out)
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
