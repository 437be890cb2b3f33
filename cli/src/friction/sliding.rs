//! `kufe friction CASE --speed LIST --ice LIST`: the groove and the melt film's friction over speed and temperature.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use kufe_contact::Options;
use kufe_jobs::case_file::LoadedCase;
use kufe_jobs::slide::{FrictionPoint, friction_table};
use kufe_jobs::{Failure, case_json};
use kufe_plot::{Error, PALETTE, PngRoot, tick_text};
use plotters::prelude::*;
use serde_json::{Value, json};

use crate::output::apart::case_inputs;
use crate::output::global::Global;
use crate::output::say::say;
use crate::output::staging::Staging;
use crate::output::watched::watched;

/// What is asked.
pub struct Asked<'a> {
    /// The case.
    pub case: &'a Path,
    /// Speeds [m/s].
    pub speeds: &'a [f64],
    /// Temperatures of the ice [C].
    pub temperatures: &'a [f64],
    /// Folder for friction.csv, friction.json and friction.png; nothing is written where absent.
    pub out: Option<&'a PathBuf>,
}

/// Most points of a table, so that a slip of the hand does not run for days.
const MOST: usize = 10_000;

/// Solves, prints and writes.
///
/// # Errors
/// [`Failure::Usage`] for too long lists, else as [`friction_table`]; [`Failure::BadInput`] for an output that cannot be written.
pub fn run(asked: &Asked, global: &Global) -> Result<(), Failure> {
    let count = asked.speeds.len().saturating_mul(asked.temperatures.len());
    if count > MOST {
        let text = format!("{count} points: expected at most {MOST}");
        return Err(Failure::Usage(text));
    }
    let loaded = LoadedCase::read(asked.case)?;
    let staging = asked
        .out
        .map(|out| begin(asked, &loaded, out))
        .transpose()?;
    let options = Options::default();
    let points = watched(global, |watch| {
        friction_table(&loaded, asked.speeds, asked.temperatures, watch, &options)
    })?;
    let document = json!({
        "points": points.iter().map(row).collect::<Vec<Value>>(),
        "version": env!("CARGO_PKG_VERSION"),
        "case": case_json(&loaded.case),
    });
    if let Some(staging) = staging {
        staging.write("friction.json", |mut file| writeln!(file, "{document:#}"))?;
        staging.write("friction.csv", |file| write_csv(file, &points))?;
        kufe_plot::png(&staging.path("friction.png"), 900, 620, &|root| {
            draw(&root, &points, asked.temperatures)
        })
        .map_err(|error| staging.failure("friction.png", &error))?;
        staging.commit()?;
    }
    if global.json {
        say(&format!("{document:#}\n"));
    } else if !global.quiet {
        say(&table(&points));
    }
    Ok(())
}

/// The output folder, before anything is solved.
fn begin(asked: &Asked, loaded: &LoadedCase, out: &Path) -> Result<Staging, Failure> {
    let inputs = case_inputs(Some(asked.case), loaded)?;
    let names = ["friction.json", "friction.csv", "friction.png"];
    let staging = Staging::beside(&inputs, out, &names)?;
    staging.remove_on_interrupt();
    Ok(staging)
}

const HEADER: &str = "ice_c,v_mps,mu,mu_error,mu_ploughing,mu_ploughing_error,mu_viscous,mu_viscous_error,groove_depth_m,groove_depth_error_m,film_mean_m,hardness_pa";

fn values(point: &FrictionPoint) -> [f64; 12] {
    let friction = &point.friction;
    [
        point.ice_c,
        point.v_mps,
        friction.mu.value,
        friction.mu.error,
        friction.ploughing.value,
        friction.ploughing.error,
        friction.viscous.value,
        friction.viscous.error,
        point.groove_depth.value,
        point.groove_depth.error,
        point.film_mean,
        point.hardness,
    ]
}

fn row(point: &FrictionPoint) -> Value {
    let pairs = HEADER.split(',').zip(values(point));
    pairs
        .map(|(key, value)| (key.to_owned(), json!(value)))
        .collect::<serde_json::Map<_, _>>()
        .into()
}

fn write_csv(mut file: impl Write, points: &[FrictionPoint]) -> io::Result<()> {
    writeln!(file, "{HEADER}")?;
    for point in points {
        let cells = values(point).map(|value| value.to_string());
        writeln!(file, "{}", cells.join(","))?;
    }
    Ok(())
}

fn table(points: &[FrictionPoint]) -> String {
    let mut text = String::from(
        "ice [C]  speed [m/s]  mu [1e-3]       ploughing  film   groove [um]  film [um]\n",
    );
    for point in points {
        let friction = &point.friction;
        text += &format!(
            "{:7.1}  {:11.1}  {:6.3} +- {:5.3}  {:9.3}  {:5.3}  {:11.2}  {:9.3}\n",
            point.ice_c,
            point.v_mps,
            1e3 * friction.mu.value,
            1e3 * friction.mu.error,
            1e3 * friction.ploughing.value,
            1e3 * friction.viscous.value,
            1e6 * point.groove_depth.value,
            1e6 * point.film_mean,
        );
    }
    text
}

/// mu over speed, a line a temperature.
fn draw(root: &PngRoot, points: &[FrictionPoint], temperatures: &[f64]) -> Result<(), Error> {
    let fastest = points.iter().map(|p| p.v_mps).fold(0.0, f64::max);
    let most = points
        .iter()
        .map(|p| 1e3 * p.friction.mu.value)
        .fold(0.0, f64::max);
    let (widest, highest) = (1.05 * fastest, 1.1 * most);
    let mut builder = ChartBuilder::on(root);
    builder
        .caption("friction of groove and melt film", ("sans-serif", 22))
        .margin(14)
        .margin_right(26)
        .x_label_area_size(50)
        .y_label_area_size(66);
    let mut chart = builder.build_cartesian_2d(0.0..widest, 0.0..highest)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(RGBColor(225, 225, 230))
        .x_desc("speed [m/s]")
        .y_desc("coefficient of friction mu [1e-3]")
        .x_label_formatter(&|x| tick_text(*x, widest))
        .y_label_formatter(&|y| tick_text(*y, highest))
        .label_style(("sans-serif", 16))
        .axis_desc_style(("sans-serif", 18))
        .draw()?;
    for (k, &ice_c) in temperatures.iter().enumerate() {
        let colour = PALETTE[k % PALETTE.len()];
        let of_ice = points.iter().filter(|p| p.ice_c == ice_c);
        let mut line: Vec<(f64, f64)> = of_ice
            .map(|p| (p.v_mps, 1e3 * p.friction.mu.value))
            .collect();
        line.sort_by(|a, b| a.0.total_cmp(&b.0));
        chart.draw_series(line.iter().map(|&at| Circle::new(at, 4, colour.filled())))?;
        chart
            .draw_series(LineSeries::new(line, colour.stroke_width(2)))?
            .label(format!("ice of {ice_c} C"))
            .legend(move |(x, y)| {
                PathElement::new(vec![(x, y), (x + 24, y)], colour.stroke_width(3))
            });
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerRight)
        .background_style(WHITE.mix(0.8))
        .label_font(("sans-serif", 16))
        .draw()?;
    Ok(())
}
