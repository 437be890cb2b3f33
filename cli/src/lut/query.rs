//! `kufe lut query`: one contact, looked up.

use std::path::PathBuf;

use kufe_jobs::{Failure, table::read_table};
use kufe_lut::{Looked, Lookup, Mode, Quantity, Table, curvature_from_pitch};
use serde_json::{Map, Value, json};

use crate::output::global::Global;
use crate::output::say::say;

/// Arguments of `kufe lut query`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The table
    pub table: PathBuf,
    /// Normal force [N]
    #[arg(long, value_name = "NEWTONS", allow_negative_numbers = true)]
    pub fz: f64,
    /// Track curvature, positive in a valley [1/m]
    #[arg(long, value_name = "PER_METRE", allow_hyphen_values = true, conflicts_with_all = ["radius", "pitch_rate"])]
    pub curvature: Option<f64>,
    /// Track radius, positive in a valley, inf on a straight [m]
    #[arg(
        long,
        value_name = "METRES",
        allow_hyphen_values = true,
        conflicts_with = "pitch_rate"
    )]
    pub radius: Option<f64>,
    /// Pitch rate, positive nose down, with --v [rad/s]
    #[arg(
        long,
        value_name = "RAD_PER_S",
        allow_hyphen_values = true,
        requires = "v"
    )]
    pub pitch_rate: Option<f64>,
    /// Speed, with --pitch-rate [m/s]
    #[arg(
        long,
        value_name = "M_PER_S",
        allow_hyphen_values = true,
        requires = "pitch_rate"
    )]
    pub v: Option<f64>,
    /// Rocker radius, where the table has that axis [m]
    #[arg(long, value_name = "METRES")]
    pub rocker: Option<f64>,
    /// How values between the nodes are found
    #[arg(long, value_enum, default_value = "smooth")]
    pub mode: ModeWord,
}

/// A mode on the command line.
#[derive(clap::ValueEnum, Clone, Copy, Debug)]
pub enum ModeWord {
    /// C1 and monotone
    Smooth,
    /// As Simulink's n-D lookup table
    Bilinear,
}

/// Looks every quantity up and prints it.
///
/// # Errors
/// [`Failure::Usage`] where the track is not given, [`Failure::BadInput`] for the table.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let curvature = match (args.curvature, args.radius, args.pitch_rate, args.v) {
        (Some(curvature), ..) => curvature,
        (_, Some(radius), ..) => 1.0 / radius,
        (_, _, Some(pitch_rate), Some(v)) => curvature_from_pitch(v, pitch_rate),
        _ => {
            return Err(Failure::Usage(
                "which track? give --curvature, --radius, or --v with --pitch-rate".into(),
            ));
        }
    };
    let told =
        |error: kufe_lut::Error| Failure::BadInput(format!("{}: {error}", args.table.display()));
    let table = read_table(&args.table)?;
    let mode = match args.mode {
        ModeWord::Smooth => Mode::Smooth,
        ModeWord::Bilinear => Mode::Bilinear,
    };
    let mut answer = Map::new();
    let mut out_of_range = false;
    for quantity in Quantity::ALL {
        let lookup = Lookup::with_rocker(&table, quantity, mode, args.rocker).map_err(told)?;
        let Looked {
            value,
            out_of_range: outside,
        } = lookup.at(args.fz, curvature);
        out_of_range |= outside;
        answer.insert(quantity.key().into(), json!(value));
        if quantity == Quantity::PMax {
            let error = error_bound(&table, mode).map_err(told)?;
            answer.insert("p_max_error_pa".into(), json!(error * value));
        }
    }
    answer.insert("fz_n".into(), json!(args.fz));
    answer.insert("curvature_1pm".into(), json!(curvature));
    answer.insert("mode".into(), json!(mode.name()));
    answer.insert("out_of_range".into(), json!(out_of_range));
    answer.insert("version".into(), json!(table.version));
    if global.json {
        say(&format!("{:#}\n", Value::Object(answer)));
    } else {
        say(&format!("{}", in_words(&answer)));
    }
    Ok(())
}

/// Solver error and interpolation error, relative, added: the largest estimated and the largest measured.
fn error_bound(table: &Table, mode: Mode) -> Result<f64, kufe_lut::Error> {
    let measured = table.interpolation_error(Quantity::PMax, mode)?;
    Ok(table.solver_error() + measured.map_or(0.0, |measured| measured.max))
}

fn in_words(answer: &Map<String, Value>) -> String {
    let number = |key: &str| answer[key].as_f64().unwrap_or(f64::NAN);
    let mut text = format!(
        "peak pressure   {:.2} MPa (+- {:.2})\nmean pressure   {:.2} MPa\ncontact area    {:.4} mm2\n\
         length          {:.2} mm\nwidth           {:.4} mm\napproach        {:.3} um\n",
        1e-6 * number("p_max_pa"),
        1e-6 * number("p_max_error_pa"),
        1e-6 * number("p_mean_pa"),
        1e6 * number("area_m2"),
        1e3 * number("length_m"),
        1e3 * number("width_m"),
        1e6 * number("approach_m"),
    );
    if answer["out_of_range"] == json!(true) {
        text += "outside the table: clipped to its nearest value\n";
    }
    text
}
