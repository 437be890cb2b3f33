//! Stress on the line under the peak: table and picture.

use std::io::Write;

use kufe_contact::CentreLine;
use kufe_fem::{maximum_shear, von_mises};

use crate::plot::{Axis, Figure, INK, Layer, PALETTE, Panel, tick_text};

/// Writes one row per depth: normal stresses, maximum shear and von Mises stress.
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

/// Ratio of the largest depth drawn to the depth of the largest shear.
const DEPTH_RATIO: f64 = 6.0;
/// Number of depths at which a curve is drawn.
const DEPTHS: u32 = 400;

/// Maximum shear, von Mises and vertical stress against the depth: dots at the middles of the
/// cells, and between them the stress by [`CentreLine::stress_at`].
pub fn subsurface_picture(line: &CentreLine) -> Figure {
    let last = line.depth.last().copied().unwrap_or(1.0);
    let reach = line
        .largest_shear()
        .map_or(last, |l| (DEPTH_RATIO * l.depth).min(last));
    // Millimetres, or micrometres for very narrow contacts.
    let (scale, unit) = if reach < 1e-3 {
        (1e6, "µm")
    } else {
        (1e3, "mm")
    };
    type Scalar = fn([f64; 6]) -> f64;
    let curves: [(&str, Scalar); 3] = [
        ("maximum shear", maximum_shear),
        ("von Mises", von_mises),
        ("pressure downwards, -sigma_zz", |s| -s[2]),
    ];
    // The last cell that is drawn is the first beyond the reach.
    let cells = (line.depth.partition_point(|&depth| depth < reach) + 1).min(line.depth.len());
    let (first, last) = (line.depth[0], line.depth[cells - 1].min(reach));
    let depths = || (0..=DEPTHS).map(|k| first + (last - first) * f64::from(k) / f64::from(DEPTHS));
    let mut layers = Vec::new();
    let mut highest = 1e-6f64;
    for ((name, scalar), colour) in curves.iter().zip(PALETTE) {
        let points: Vec<(f64, f64)> = depths()
            .map(|depth| (scale * depth, 1e-6 * scalar(line.stress_at(depth))))
            .collect();
        highest = points.iter().map(|point| point.1).fold(highest, f64::max);
        let cells = line.depth.iter().zip(&line.stress);
        let cells = cells.take_while(|(depth, _)| **depth <= reach);
        let dots = cells.map(|(depth, &stress)| (scale * depth, 1e-6 * scalar(stress)));
        layers.push(Layer::line(2.0, points, colour).named(*name));
        layers.push(Layer::dots(3.0, dots, colour));
    }
    layers.push(Layer::dots(3.0, [], PALETTE[6]).named("middles of the cells"));
    let deepest = scale * reach;
    if let Some(largest) = line.largest_shear() {
        let at = (scale * largest.depth, largest.value / 1e6);
        let depth = tick_text(at.0, 0.01 * deepest.max(1.0));
        let text = format!("{:.2} MPa at {depth} {unit}", at.1);
        layers.push(Layer::dots(5.0, [at], PALETTE[0]));
        layers.push(Layer::text(at, text, [1.0, 1.0], INK));
    }
    let x = Axis::new(format!("depth [{unit}]")).within([0.0, deepest]);
    let y = Axis::new("stress [MPa]").within([0.0, 1.05 * highest]);
    let title = "stress under the peak pressure";
    Figure::new(900.0, title).row(540.0, [Panel::new(x, y, layers)])
}
