//! `kufe lut query`: a table interpolated at one contact.

use std::path::PathBuf;

use kufe::jobs::{Failure, table::read_table};
use kufe::results::{Description, TableLookup};
use kufe_lut::{AxisKind, MIN_SPEED, Mode, Outside, Sample, Table, curvature_from_pitch};

use crate::terminal::{Global, warn};

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
    /// Refuse a place outside the table along any axis
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

/// Interpolates every quantity and prints it.
///
/// # Errors
/// [`Failure::Usage`] where the track is not given, [`Failure::BadInput`] for the table, and for a
/// force that presses nothing.
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
                    "--v-mps {v}: below {MIN_SPEED} m/s a pitch rate does not determine the track, which is taken as ever straighter"
                ));
            }
            curvature_from_pitch(v, pitch_rate)
        }
        _ => {
            return Err(Failure::Usage(
                "the track is missing: give --curvature-1pm, --radius-m, or --v-mps with --pitch-rate-radps"
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
                "the {name} is missing: the table has that axis; give {option}"
            )));
        }
    }
    within(args, &table, curvature)?;
    let at = Sample {
        fz: args.fz_n,
        curvature,
        speed: args.v_mps.unwrap_or(f64::NAN),
        ice_c: args.ice_c.unwrap_or(f64::NAN),
    };
    let found = TableLookup::new(&table, at, mode, args.rocker_radius_m)
        .map_err(|error| Failure::BadInput(format!("{}: {error}", args.table.display())))?;
    global.answer(&found, || text(&found, &table))
}

/// Refuses a place outside an axis whose rule is an error; with `--strict` outside any.
///
/// # Errors
/// [`Failure::BadInput`] with the input, its value and the table's range.
fn within(args: &Args, table: &Table, curvature: f64) -> Result<(), Failure> {
    let axes = table.axes();
    let ends = |axis: &[f64]| [axis[0], axis[axis.len() - 1]];
    let [low, high] = ends(axes.fz());
    let curvatures = axes.curvature_range(args.fz_n.clamp(low, high));
    let inputs = [
        (AxisKind::Fz, Some(args.fz_n), Some([low, high])),
        (AxisKind::Curvature, Some(curvature), Some(curvatures)),
        (AxisKind::Speed, args.v_mps, axes.speed().map(ends)),
        (AxisKind::IceTemperature, args.ice_c, axes.ice_c().map(ends)),
    ];
    for (kind, value, range) in inputs {
        if let (Some(value), Some([low, high])) = (value, range)
            && (args.strict || axes.outside(kind) == Outside::Error)
            && !(low..=high).contains(&value)
        {
            return Err(Failure::BadInput(format!(
                "{}: {} = {value}: outside the table, expected {low} to {high}",
                args.table.display(),
                kind.key()
            )));
        }
    }
    Ok(())
}

fn text(found: &TableLookup, table: &Table) -> String {
    let mut text = String::new();
    let (mut with, mut without) = (Vec::new(), false);
    for one in &found.values {
        let shown = Description::of(one.quantity);
        let error = one
            .error
            .map(|error| format!(" (+- {})", shown.number(error)));
        text += &format!(
            "{:<28} {}{}\n",
            shown.label,
            shown.amount(one.value),
            error.unwrap_or_default()
        );
        if one.includes_solver {
            with.push(shown.label);
        } else {
            without = true;
        }
    }
    text += &if without {
        format!(
            "in brackets: interpolation, and the solver's error too for the {}\n",
            with.join(", ")
        )
    } else {
        "in brackets: interpolation and the solver's error\n".to_owned()
    };
    if found.out_of_range {
        let axes = table.axes();
        let [low, high] = [axes.fz()[0], axes.fz()[axes.fz().len() - 1]];
        let [from, to] = axes.curvature_range(found.fz_n.clamp(low, high));
        let is_linear = |kind: &AxisKind| axes.outside(*kind) == Outside::Linear;
        let what = if AxisKind::ALL.iter().any(is_linear) {
            "held at its edge or continued straight, as its axes say; the errors are those within"
        } else {
            "clipped to its nearest value, whose errors these are"
        };
        text += &format!(
            "outside the table ({low} to {high} N; curvature {from:.4} to {to:.4} 1/m): {what}\n"
        );
    }
    text
}
