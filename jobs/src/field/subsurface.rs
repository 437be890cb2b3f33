//! Stress on the line under the peak: figures, table and picture.

use std::io::Write;
use std::path::Path;

use kufe_contact::{CentreLine, Solution, UnderPeak};
use kufe_fem::von_mises;
use kufe_plot::{Error, PALETTE, PngRoot, png, tick_text};
use plotters::prelude::*;
use serde_json::{Value, json};

/// The key `subsurface` of result.json.
pub fn document(line: &CentreLine, solution: &Solution) -> Value {
    let under = solution.under_peak;
    let over = |under: UnderPeak| under.shear / solution.p_max;
    let relative =
        |under: UnderPeak| under.shear_error / under.shear + solution.p_max_error / solution.p_max;
    json!({
        "x_m": line.at[0],
        "y_m": line.at[1],
        "max_shear_pa": under.map(|u| u.shear),
        "max_shear_error_pa": under.map(|u| u.shear_error),
        "max_shear_mesh_pa": line.largest_shear().map(|l| l.value),
        "max_shear_depth_m": under.map(|u| u.depth),
        "max_shear_depth_error_m": under.map(|u| u.depth_error),
        "max_shear_over_p_max": under.map(over),
        "max_shear_over_p_max_error": under.map(|u| over(u) * relative(u)),
    })
}

/// One row a depth: normal stresses, maximum shear and von Mises stress.
pub fn write_csv(writer: &mut dyn Write, line: &CentreLine) -> std::io::Result<()> {
    writeln!(
        writer,
        "depth_m,sigma_xx_pa,sigma_yy_pa,sigma_zz_pa,max_shear_pa,von_mises_pa"
    )?;
    for ((depth, stress), shear) in line.depth.iter().zip(&line.stress).zip(line.shear()) {
        let [xx, yy, zz, ..] = stress;
        let mises = von_mises(*stress);
        writeln!(writer, "{depth:e},{xx:e},{yy:e},{zz:e},{shear:e},{mises:e}")?;
    }
    Ok(())
}

/// Depths are drawn down to this many times that of the largest shear.
const REACH: f64 = 6.0;

/// Maximum shear, von Mises and vertical stress against the depth.
///
/// # Errors
/// [`Error`] where the picture cannot be drawn or written.
pub fn write_png(path: &Path, line: &CentreLine) -> Result<(), Error> {
    png(path, 900, 700, &|root| draw(&root, line))
}

fn draw(root: &PngRoot, line: &CentreLine) -> Result<(), Error> {
    let last = line.depth.last().copied().unwrap_or(1.0);
    let reach = line
        .largest_shear()
        .map_or(last, |l| (REACH * l.depth).min(last));
    // Metres as millimetres, or micrometres for contacts as narrow as a hair.
    let (scale, unit) = if reach < 1e-3 {
        (1e6, "µm")
    } else {
        (1e3, "mm")
    };
    let curves = [
        ("maximum shear", line.shear()),
        (
            "von Mises",
            line.stress.iter().map(|&s| von_mises(s)).collect(),
        ),
        (
            "-sigma_zz",
            line.stress.iter().map(|s| -s[2]).collect::<Vec<f64>>(),
        ),
    ];
    let shown: Vec<usize> = (0..line.depth.len())
        .filter(|&k| line.depth[k] <= reach)
        .collect();
    let highest = curves
        .iter()
        .flat_map(|(_, values)| shown.iter().map(|&k| values[k] / 1e6))
        .fold(0.0, f64::max)
        .max(1e-6);
    let mut builder = ChartBuilder::on(root);
    builder
        .caption("stress under the peak pressure", ("sans-serif", 24))
        .margin(16)
        .margin_right(32)
        .x_label_area_size(56)
        .y_label_area_size(90);
    let (deepest, widest) = (scale * reach, 1.05 * highest);
    let mut chart = builder.build_cartesian_2d(0.0..deepest, 0.0..widest)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(RGBColor(225, 225, 230))
        .x_desc(format!("depth [{unit}]"))
        .y_desc("stress [MPa]")
        .x_label_formatter(&|x| tick_text(*x, deepest))
        .y_label_formatter(&|y| tick_text(*y, widest))
        .label_style(("sans-serif", 18))
        .axis_desc_style(("sans-serif", 20))
        .draw()?;
    for ((name, values), colour) in curves.iter().zip(PALETTE) {
        let points = shown
            .iter()
            .map(|&k| (scale * line.depth[k], values[k] / 1e6));
        chart
            .draw_series(LineSeries::new(points, colour.stroke_width(2)))?
            .label(*name)
            .legend(move |(x, y)| {
                PathElement::new(vec![(x, y), (x + 24, y)], colour.stroke_width(3))
            });
    }
    if let Some(largest) = line.largest_shear() {
        let at = (scale * largest.depth, largest.value / 1e6);
        let text = format!(
            "{:.2} MPa at {} {unit}",
            at.1,
            tick_text(at.0, 0.01 * deepest.max(1.0))
        );
        chart.draw_series([Circle::new(at, 5, PALETTE[0].filled())])?;
        chart.draw_series([Text::new(
            text,
            (at.0 + 0.02 * deepest, at.1 + 0.05 * widest),
            ("sans-serif", 18),
        )])?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.8))
        .border_style(RGBColor(200, 200, 205))
        .label_font(("sans-serif", 18))
        .draw()?;
    Ok(())
}
