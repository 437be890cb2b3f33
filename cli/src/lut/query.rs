//! `kufe lut query`: one contact, looked up.

use std::path::PathBuf;

use kufe_jobs::{Failure, table::read_table};
use kufe_lut::{Looked, Lookup, MIN_SPEED, Mode, Quantity, Table, curvature_from_pitch};
use serde_json::{Map, Value, json};

use crate::output::global::Global;
use crate::output::say::say;
use crate::output::watched::warn;

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
        (_, _, Some(pitch_rate), Some(v)) => {
            if v.abs() < MIN_SPEED && pitch_rate != 0.0 {
                warn(&format!(
                    "--v {v}: below {MIN_SPEED} m/s a pitch rate tells nothing of the track, which is taken for ever straighter"
                ));
            }
            curvature_from_pitch(v, pitch_rate)
        }
        _ => {
            return Err(Failure::Usage(
                "which track? give --curvature, --radius, or --v with --pitch-rate".into(),
            ));
        }
    };
    for (name, value) in [("force", args.fz), ("curvature", curvature)] {
        if !value.is_finite() {
            return Err(Failure::Usage(format!(
                "{name} {value}: expected a finite number"
            )));
        }
    }
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
        let error = relative_error(&table, quantity, mode).map_err(told)?;
        answer.insert(error_key(quantity), json!(error.map(|e| (e * value).abs())));
    }
    answer.insert("fz_n".into(), json!(args.fz));
    answer.insert("curvature_1pm".into(), json!(curvature));
    answer.insert("mode".into(), json!(mode.name()));
    answer.insert("out_of_range".into(), json!(out_of_range));
    answer.insert("version".into(), json!(table.version));
    if global.json {
        say(&format!("{:#}\n", Value::Object(answer)));
    } else {
        say(&in_words(&answer));
    }
    Ok(())
}

/// The key of a quantity's error, `p_max_error_pa` beside `p_max_pa`. What is known of the others is the error of looking them
/// up, which the key says.
fn error_key(quantity: Quantity) -> String {
    let key = quantity.key();
    let (name, unit) = key.rsplit_once('_').unwrap_or((key, ""));
    match quantity {
        Quantity::PMax => format!("{name}_error_{unit}"),
        _ => format!("{name}_interpolation_error_{unit}"),
    }
}

/// The largest interpolation error measured, relative, and for the peak pressure the solver's largest estimated one; `None` where
/// none was measured.
fn relative_error(
    table: &Table,
    quantity: Quantity,
    mode: Mode,
) -> Result<Option<f64>, kufe_lut::Error> {
    let measured = table.interpolation_error(quantity, mode)?;
    Ok(match quantity {
        Quantity::PMax => Some(table.solver_error() + measured.map_or(0.0, |m| m.max)),
        _ => measured.map(|m| m.max),
    })
}

fn in_words(answer: &Map<String, Value>) -> String {
    let number = |key: &str| answer[key].as_f64().unwrap_or(f64::NAN);
    let row = |name: &str, quantity: Quantity, scale: f64, digits: usize, unit: &str| {
        let error = match answer[&error_key(quantity)].as_f64() {
            Some(error) => format!(" (+- {:.digits$})", scale * error),
            None => String::new(),
        };
        let value = scale * number(quantity.key());
        format!("{name:<15} {value:.digits$} {unit}{error}\n")
    };
    let mut text = [
        row("peak pressure", Quantity::PMax, 1e-6, 2, "MPa"),
        row("mean pressure", Quantity::PMean, 1e-6, 2, "MPa"),
        row("contact area", Quantity::Area, 1e6, 4, "mm2"),
        row("length", Quantity::Length, 1e3, 2, "mm"),
        row("width", Quantity::Width, 1e3, 4, "mm"),
        row("approach", Quantity::Approach, 1e6, 3, "um"),
    ]
    .concat();
    text += "in brackets: interpolation, and the solver's error too for the peak pressure\n";
    if answer["out_of_range"] == json!(true) {
        text += "outside the table: clipped to its nearest value\n";
    }
    text
}
