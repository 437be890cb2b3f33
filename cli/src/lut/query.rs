//! `kufe lut query`: one contact, looked up.

use std::path::PathBuf;

use kufe::jobs::{Failure, table::read_table};
use kufe_lut::{
    Interpolated, Interpolator, MIN_SPEED, Mode, Quantity, Sample, Table, curvature_from_pitch,
};
use serde_json::{Map, Value, json};

use crate::output::global::Global;
use crate::output::say::{say, warn};

/// Arguments of `kufe lut query`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The table
    pub table: PathBuf,
    /// Normal force [N]
    #[arg(long, value_name = "NEWTONS", allow_negative_numbers = true)]
    pub fz_n: f64,
    /// Track curvature in the vertical plane [1/m], positive in a valley
    #[arg(long, value_name = "PER_METRE", allow_hyphen_values = true, conflicts_with_all = ["radius_m", "pitch_rate_radps"])]
    pub curvature_1pm: Option<f64>,
    /// Track radius in the vertical plane [m], positive in a valley, inf on a straight
    #[arg(
        long,
        value_name = "METRES",
        allow_hyphen_values = true,
        conflicts_with = "pitch_rate_radps"
    )]
    pub radius_m: Option<f64>,
    /// Pitch rate [rad/s], positive nose down, with --v-mps
    #[arg(
        long,
        value_name = "RAD_PER_S",
        allow_hyphen_values = true,
        requires = "v_mps"
    )]
    pub pitch_rate_radps: Option<f64>,
    /// Speed [m/s], with --pitch-rate-radps and where the table has that axis
    #[arg(long, value_name = "M_PER_S", allow_hyphen_values = true)]
    pub v_mps: Option<f64>,
    /// Ice temperature [degrees Celsius], where the table has that axis
    #[arg(long, value_name = "CELSIUS", allow_hyphen_values = true)]
    pub ice_c: Option<f64>,
    /// Radius of the rocker [m], where the table has that axis
    #[arg(long, value_name = "METRES")]
    pub rocker_radius_m: Option<f64>,
    /// How values between the nodes are found
    #[arg(long, value_enum, default_value = "smooth")]
    pub mode: ModeWord,
    /// Refuse a place outside the table instead of taking the nearest within
    #[arg(long)]
    pub strict: bool,
}

/// A mode on the command line.
#[derive(clap::ValueEnum, Clone, Copy, Debug)]
pub enum ModeWord {
    /// Smooth, without overshoot
    Smooth,
    /// Straight between the nodes, as Simulink's n-D lookup table
    Bilinear,
}

/// Looks every quantity up and prints it.
///
/// # Errors
/// [`Failure::Usage`] where the track is not given, [`Failure::BadInput`] for the table, and for a force that presses nothing.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let curvature = match (
        args.curvature_1pm,
        args.radius_m,
        args.pitch_rate_radps,
        args.v_mps,
    ) {
        (Some(curvature), ..) => curvature,
        (_, Some(radius), ..) => 1.0 / radius,
        (_, _, Some(pitch_rate), Some(v)) => {
            if v.abs() < MIN_SPEED && pitch_rate != 0.0 {
                warn(&format!(
                    "--v-mps {v}: below {MIN_SPEED} m/s a pitch rate tells nothing of the track, which is taken for ever straighter"
                ));
            }
            curvature_from_pitch(v, pitch_rate)
        }
        _ => {
            return Err(Failure::Usage(
                "which track? give --curvature-1pm, --radius-m, or --v-mps with --pitch-rate-radps"
                    .into(),
            ));
        }
    };
    for (name, value) in [("force", args.fz_n), ("curvature", curvature)] {
        if !value.is_finite() {
            return Err(Failure::BadInput(format!(
                "{name} {value}: expected a finite number"
            )));
        }
    }
    if args.fz_n <= 0.0 {
        return Err(Failure::BadInput(format!(
            "--fz-n {}: expected a force above 0 N: without one there is no contact",
            args.fz_n
        )));
    }
    let told =
        |error: kufe_lut::Error| Failure::BadInput(format!("{}: {error}", args.table.display()));
    let table = read_table(&args.table)?;
    let mode = match args.mode {
        ModeWord::Smooth => Mode::Smooth,
        ModeWord::Bilinear => Mode::Bilinear,
    };
    let further = [
        ("speed", "--v-mps", args.v_mps, table.axes().speed()),
        (
            "temperature of the ice",
            "--ice-c",
            args.ice_c,
            table.axes().ice_c(),
        ),
    ];
    for (name, option, value, axis) in further {
        if axis.is_some() && value.is_none_or(f64::is_nan) {
            return Err(Failure::Usage(format!(
                "which {name}? the table has that axis: give {option}"
            )));
        }
    }
    if args.strict {
        within(args, &table, curvature)?;
    }
    let [v, ice_c] = [args.v_mps, args.ice_c].map(|value| value.unwrap_or(f64::NAN));
    let mut answer = Map::new();
    let mut out_of_range = false;
    for &quantity in table.quantities() {
        let interpolator =
            Interpolator::new(&table, quantity, mode, args.rocker_radius_m).map_err(told)?;
        let Interpolated {
            value,
            out_of_range: outside,
        } = interpolator.at(Sample {
            fz: args.fz_n,
            curvature,
            speed: v,
            ice_c,
        });
        out_of_range |= outside;
        answer.insert(quantity.key().into(), json!(value));
        let error = relative_error(&table, quantity, mode).map_err(told)?;
        answer.insert(
            error_key(&table, quantity),
            json!(error.map(|e| (e * value).abs())),
        );
    }
    answer.insert("fz_n".into(), json!(args.fz_n));
    answer.insert("curvature_1pm".into(), json!(curvature));
    if table.axes().speed().is_some() {
        answer.insert("v_mps".into(), json!(v));
    }
    if table.axes().ice_c().is_some() {
        answer.insert("ice_c".into(), json!(ice_c));
    }
    answer.insert("mode".into(), json!(mode.name()));
    answer.insert("out_of_range".into(), json!(out_of_range));
    answer.insert("version".into(), json!(table.origin.version()));
    if global.json {
        say(&format!("{:#}\n", Value::Object(answer)));
    } else {
        say(&in_words(&answer, &table));
    }
    Ok(())
}

/// Refuses a place outside the table.
///
/// # Errors
/// [`Failure::BadInput`] with the input, its value and the table's range.
fn within(args: &Args, table: &Table, curvature: f64) -> Result<(), Failure> {
    let axes = table.axes();
    let ends = |axis: &[f64]| [axis[0], axis[axis.len() - 1]];
    let [low, high] = ends(axes.fz());
    let inputs = [
        ("fz_n", Some(args.fz_n), Some([low, high])),
        (
            "curvature_1pm",
            Some(curvature),
            Some(axes.curvature_range(args.fz_n.clamp(low, high))),
        ),
        ("v_mps", args.v_mps, axes.speed().map(ends)),
        ("ice_c", args.ice_c, axes.ice_c().map(ends)),
    ];
    for (name, value, range) in inputs {
        if let (Some(value), Some([low, high])) = (value, range)
            && !(low..=high).contains(&value)
        {
            return Err(Failure::BadInput(format!(
                "{}: {name} = {value}: outside the table, expected {low} to {high}",
                args.table.display()
            )));
        }
    }
    Ok(())
}

/// The key of a quantity's error, `p_max_error_pa` beside `p_max_pa`. Where the solver's own is not kept what is known is the error of
/// looking it up, which the key says.
fn error_key(table: &Table, quantity: Quantity) -> String {
    let key = quantity.key();
    let (name, unit) = match quantity.unit() {
        "1" => (key, String::new()),
        _ => key
            .rsplit_once('_')
            .map_or((key, String::new()), |(name, unit)| {
                (name, format!("_{unit}"))
            }),
    };
    match table.solver_error_of(quantity) {
        Some(_) => format!("{name}_error{unit}"),
        None => format!("{name}_interpolation_error{unit}"),
    }
}

/// The largest interpolation error measured, relative, and the solver's largest estimated one where it is kept; `None` where
/// none was measured.
fn relative_error(
    table: &Table,
    quantity: Quantity,
    mode: Mode,
) -> Result<Option<f64>, kufe_lut::Error> {
    let measured = table.interpolation_error(quantity, mode)?.map(|m| m.max);
    Ok(match table.solver_error_of(quantity) {
        Some(solver) => Some(solver + measured.unwrap_or(0.0)),
        None => measured,
    })
}

/// Name, scale, digits and unit of a quantity for reading.
fn shown(quantity: Quantity) -> (&'static str, f64, usize, &'static str) {
    match quantity {
        Quantity::PMax => ("peak pressure", 1e-6, 2, "MPa"),
        Quantity::PMean => ("mean pressure", 1e-6, 2, "MPa"),
        Quantity::Area => ("contact area", 1e6, 4, "mm2"),
        Quantity::Length => ("contact length", 1e3, 2, "mm"),
        Quantity::Width => ("contact width", 1e3, 4, "mm"),
        Quantity::Approach => ("approach", 1e6, 3, "µm"),
        Quantity::Mu => ("friction mu", 1e3, 4, "1e-3"),
        Quantity::MuPloughing => ("  of ploughing", 1e3, 4, "1e-3"),
        Quantity::MuViscous => ("  of the film", 1e3, 4, "1e-3"),
        Quantity::GrooveDepth => ("groove", 1e6, 2, "µm deep"),
        Quantity::FilmMean => ("film, mean", 1e6, 4, "µm"),
    }
}

fn in_words(answer: &Map<String, Value>, table: &Table) -> String {
    let mut text = String::new();
    for &quantity in table.quantities() {
        let (name, scale, digits, unit) = shown(quantity);
        let error = match answer[&error_key(table, quantity)].as_f64() {
            Some(error) => format!(" (+- {:.digits$})", scale * error),
            None => String::new(),
        };
        let value = scale * answer[quantity.key()].as_f64().unwrap_or(f64::NAN);
        text += &format!("{name:<15} {value:.digits$} {unit}{error}\n");
    }
    let kept = |q: &&Quantity| table.solver_error_of(**q).is_some();
    let (with, without): (Vec<&Quantity>, Vec<&Quantity>) =
        table.quantities().iter().partition(kept);
    let of: Vec<&str> = with.iter().map(|q| shown(**q).0.trim()).collect();
    text += &match without.is_empty() {
        true => "in brackets: interpolation and the solver's error\n".to_owned(),
        false => format!(
            "in brackets: interpolation, and the solver's error too for the {}\n",
            of.join(", ")
        ),
    };
    if answer["out_of_range"] == json!(true) {
        let fz = table.axes().fz();
        let at = answer["fz_n"].as_f64().unwrap_or(fz[0]);
        let [low, high] = table
            .axes()
            .curvature_range(at.clamp(fz[0], fz[fz.len() - 1]));
        text += &format!(
            "outside the table ({} to {} N; curvature {low:.4} to {high:.4} 1/m): clipped to its nearest value, whose errors these are\n",
            fz[0],
            fz[fz.len() - 1]
        );
    }
    text
}
