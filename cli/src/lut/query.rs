//! `kufe lut query`: interpolates a table at one point.

use std::path::PathBuf;

use kufe::jobs::{Failure, Located, table::read_table};
use kufe::plot::{measured, short, shown_unit};
use kufe::results::{Description, LookupValue, TableLookup};
use kufe_lut::{Axes, AxisKind, MIN_SPEED, Mode, Outside, Point, curvature_from_pitch};

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
    #[arg(long, value_name = "METRES", allow_hyphen_values = true)]
    #[arg(conflicts_with = "pitch_rate_radps")]
    pub radius_m: Option<f64>,
    /// Pitch rate [rad/s], positive nose down, with --v-mps
    #[arg(long, value_name = "RAD_PER_S", allow_hyphen_values = true)]
    #[arg(requires = "v_mps")]
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
    /// Interpolation: smooth, without overshoot, or bilinear, linear between the nodes, as
    /// Simulink's n-D lookup table
    #[arg(long, value_parser = ["smooth", "bilinear"], default_value = "smooth")]
    pub mode: String,
    /// Fail if the point is outside the table
    #[arg(long)]
    pub strict: bool,
}

/// Interpolates every quantity and prints it.
///
/// # Errors
/// [`Failure::Usage`] if the track is not given, and for a force that is not finite;
/// [`Failure::BadInput`] for the table.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let usage = |text: &str| Err(Failure::Usage(text.into()));
    let (fz, v) = (args.fz_n, args.v_mps);
    let curvature = match (args.curvature_1pm, args.radius_m, args.pitch_rate_radps, v) {
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
            return usage(
                "the track is missing: give --curvature-1pm, --radius-m, or --v-mps with --pitch-rate-radps",
            );
        }
    };
    if !curvature.is_finite() {
        return usage(&format!(
            "track curvature of {curvature} 1/m: expected a finite one, and no radius of 0"
        ));
    }
    if !fz.is_finite() {
        return Err(Failure::option("fz-n", fz, "a finite force [N]"));
    }
    let table = read_table(&args.table)?;
    let at = Point {
        fz,
        curvature,
        rocker_radius: args.rocker_radius_m,
        speed: v,
        ice_c: args.ice_c,
    };
    let axes = table.axes();
    let of_track = args.pitch_rate_radps.and(v);
    for (kind, name, option, given, otherwise_used) in [
        (AxisKind::Speed, "speed", "--v-mps", v, of_track),
        (
            AxisKind::IceTemperature,
            "temperature of the ice",
            "--ice-c",
            args.ice_c,
            None,
        ),
    ] {
        let is_axis = axes.get(kind).is_some();
        if is_axis && given.is_none_or(f64::is_nan) {
            return usage(&format!(
                "the {name} is missing: the table has that axis; give {option}"
            ));
        }
        if !is_axis && given.is_some() && otherwise_used.is_none() {
            warn(&format!("{option} is not used: the table has no such axis"));
        }
    }
    let outside = outside(axes, &at);
    let is_refused = |kind| args.strict || axes.outside(kind) == Outside::Error;
    if let Some((kind, value, [low, high])) = outside.iter().find(|(kind, ..)| is_refused(*kind)) {
        let key = kind.key();
        let reason = format!("{key} = {value}: outside the table, expected {low} to {high}");
        return Err(Failure::in_file(&args.table, reason));
    }
    let mode = Mode::ALL.into_iter().find(|mode| mode.name() == args.mode);
    let mode = mode.expect("the parser admits modes alone");
    let found = TableLookup::new(&table, at, mode).in_file(&args.table)?;
    global.answer(&found, || text(&found, axes, &outside))
}

/// An input outside a table: its axis, its value and the range of the axis.
type OutOfRange = (AxisKind, f64, [f64; 2]);

/// The inputs that lie outside a table. The rocker radius is not included; the lookup itself checks
/// it.
fn outside(axes: &Axes, at: &Point) -> Vec<OutOfRange> {
    let outside = |kind| {
        let [min_fz, max_fz] = axes.range(AxisKind::Fz, at.fz)?;
        // The range of the curvature depends on the force.
        let [low, high] = axes.range(kind, at.fz.clamp(min_fz, max_fz))?;
        let value = at.get(kind).filter(|value| !(low..=high).contains(value))?;
        Some((kind, value, [low, high]))
    };
    let kinds = AxisKind::ALL.into_iter();
    let kinds = kinds.filter(|kind| *kind != AxisKind::RockerRadius);
    kinds.filter_map(outside).collect()
}

fn text(found: &TableLookup, axes: &Axes, outside: &[OutOfRange]) -> String {
    let mut text = String::new();
    for one in &found.values {
        let unit = shown_unit(one.quantity.key());
        let amount = measured(one.value, one.error.unwrap_or(0.0), &unit);
        text += &format!("{:<28} {amount}\n", Description::of(one.quantity).label);
    }
    let labels = |known: fn(&LookupValue) -> bool| {
        let values = found.values.iter().filter(|one| known(one));
        let labels = values.map(|one| Description::of(one.quantity).label);
        labels.collect::<Vec<_>>().join(", ")
    };
    for (errors, labels) in [
        (
            "errors of interpolation and solver",
            labels(|one| one.includes_solver),
        ),
        (
            "errors of interpolation alone, none of the solver is known",
            labels(|one| !one.includes_solver && one.error.is_some()),
        ),
        ("no error is known", labels(|one| one.error.is_none())),
    ] {
        if !labels.is_empty() {
            text += &format!("{errors}: {labels}\n");
        }
    }
    if found.out_of_range {
        let is_linear = |(kind, ..): &OutOfRange| axes.outside(*kind) == Outside::Linear;
        let what = if outside.iter().any(is_linear) {
            "the value at its edge or a straight continuation, as its axes state; the errors are those within"
        } else {
            "clipped to its nearest value, whose errors these are"
        };
        let place = outside.iter().map(|&(kind, value, [low, high])| {
            let [value, low, high] = [value, low, high].map(short);
            format!("{} = {value}, its range {low} to {high}", kind.key())
        });
        let place = place.collect::<Vec<_>>().join("; ");
        text += &format!("outside the table ({place}): {what}\n");
    }
    text
}
