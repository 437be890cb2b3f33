//! Stress on the line under the peak: table and picture.

use std::io::Write;
use std::path::Path;

use crate::plot::{Error, Key, PALETTE, PngRoot, Swatch, curve, legend, png, tick_text};
use kufe_contact::CentreLine;
use kufe_fem::{maximum_shear, von_mises};
use plotters::prelude::*;

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
/// Depths at which a curve is drawn.
const DRAWN: u32 = 400;

/// Maximum shear, von Mises and vertical stress against the depth: dots at the middles of the cells, and between them what the stress is there by
/// [`CentreLine::stress_at`].
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
    type Of = fn([f64; 6]) -> f64;
    let curves: [(&str, Of); 3] = [
        ("maximum shear", maximum_shear),
        ("von Mises", von_mises),
        ("pressure downwards, -sigma_zz", |s| -s[2]),
    ];
    // The last cell that is drawn is the first beyond the reach.
    let cells = (line.depth.partition_point(|&depth| depth < reach) + 1).min(line.depth.len());
    let (first, last) = (line.depth[0], line.depth[cells - 1].min(reach));
    let depths: Vec<f64> = (0..=DRAWN)
        .map(|k| first + (last - first) * f64::from(k) / f64::from(DRAWN))
        .collect();
    let drawn: Vec<Vec<f64>> = curves
        .iter()
        .map(|(_, of)| {
            depths
                .iter()
                .map(|&d| 1e-6 * of(line.stress_at(d)))
                .collect()
        })
        .collect();
    let highest = drawn.iter().flatten().copied().fold(0.0, f64::max);
    let highest = highest.max(1e-6);
    let mut keys: Vec<Key> = curves
        .iter()
        .zip(PALETTE)
        .map(|((name, _), colour)| Key::new(Swatch::Line, colour, *name))
        .collect();
    keys.push(Key::new(Swatch::Dot(3), PALETTE[6], "middles of the cells"));
    let area = root.margin(12, 0, 0, 0);
    let area = area.titled("stress under the peak pressure", ("sans-serif", 24))?;
    let area = legend(&area, &keys)?;
    let mut builder = ChartBuilder::on(&area);
    builder
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
    for (((_, of), values), colour) in curves.iter().zip(drawn).zip(PALETTE) {
        let points = depths.iter().map(|d| scale * d).zip(values);
        curve(&chart, points, colour.stroke_width(2))?;
        let cells = line.depth.iter().zip(&line.stress);
        let cells = cells.take_while(|(depth, _)| **depth <= reach);
        let dots = cells.map(|(depth, &stress)| (scale * depth, 1e-6 * of(stress)));
        chart.draw_series(dots.map(|at| Circle::new(at, 3, colour.filled())))?;
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
    Ok(())
}
