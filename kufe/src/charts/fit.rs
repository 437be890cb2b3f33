//! Lateral force over slip angle for ranges of the normal force, measured and fitted.

use std::path::Path;

use crate::plot::{Key, PALETTE, Swatch, curve, legend, tick_text};
use kufe_sled::friction::{LateralSample, MagicFormula};
use plotters::prelude::*;

use crate::plot::Error;
use kufe_sled::quantile;

/// Points drawn a panel at most; more would only hide each other.
const MOST_POINTS: usize = 6000;

/// Three panels, a third of the samples each by their normal force, with the fitted law at each third's mean load.
///
/// # Errors
/// [`Error`].
pub fn fit_picture(
    path: &Path,
    runner: &str,
    samples: &[LateralSample],
    law: &MagicFormula,
) -> Result<(), Error> {
    let mut loads: Vec<f64> = samples.iter().map(|sample| sample.fz).collect();
    loads.sort_by(f64::total_cmp);
    let cuts = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0].map(|share| quantile(&loads, share));
    let mut slips: Vec<f64> = samples
        .iter()
        .map(|sample| sample.alpha.to_degrees().abs())
        .collect();
    slips.sort_by(f64::total_cmp);
    // The rarest slips would make everything else a line.
    let reach = 1.15 * quantile(&slips, 0.9995).max(0.2);
    crate::plot::png(path, 1500, 560, &|root| {
        for (panel, area) in root.split_evenly((1, 3)).into_iter().enumerate() {
            let (low, high) = (cuts[panel], cuts[panel + 1]);
            let inside = |fz: f64| fz >= low && (fz < high || panel == 2);
            let here: Vec<&LateralSample> =
                samples.iter().filter(|sample| inside(sample.fz)).collect();
            let mean = here.iter().map(|sample| sample.fz).sum::<f64>() / here.len().max(1) as f64;
            let most = here
                .iter()
                .filter(|sample| sample.alpha.to_degrees().abs() <= reach)
                .map(|sample| sample.fy.abs())
                .fold(law.force(reach.to_radians(), mean), f64::max)
                * 1.05;
            let title = format!(
                "{runner} runner, {:.1} to {:.1} kN",
                low * 1e-3,
                high * 1e-3
            );
            let keys = [
                Key::new(Swatch::Dot(4), PALETTE[5], "measured"),
                Key::new(
                    Swatch::Line,
                    PALETTE[1],
                    format!("fit at {:.1} kN", mean * 1e-3),
                ),
            ];
            let area = area.margin(10, 0, 0, 0);
            let area = legend(&area.titled(&title, ("sans-serif", 22))?, &keys)?;
            let mut chart = ChartBuilder::on(&area)
                .margin(12)
                .x_label_area_size(46)
                .y_label_area_size(70)
                .build_cartesian_2d(-reach..reach, -most..most)?;
            chart
                .configure_mesh()
                .x_desc("slip angle [degrees]")
                .y_desc("lateral force [N]")
                .x_label_formatter(&|x| tick_text(*x, 2.0 * reach))
                .y_label_formatter(&|y| tick_text(*y, 2.0 * most))
                .label_style(("sans-serif", 16))
                .light_line_style(WHITE)
                .draw()?;
            let every = here.len().div_ceil(MOST_POINTS).max(1);
            let shown = here.iter().step_by(every);
            let points = shown.map(|sample| (sample.alpha.to_degrees(), sample.fy));
            chart.draw_series(
                points
                    .filter(|(degrees, _)| degrees.abs() <= reach)
                    .map(|point| Circle::new(point, 1, PALETTE[5].mix(0.5).filled())),
            )?;
            let law = (-200..=200).map(|i| {
                let degrees = reach * f64::from(i) / 200.0;
                (degrees, law.force(degrees.to_radians(), mean))
            });
            curve(&chart, law, PALETTE[1].stroke_width(3))?;
        }
        Ok(())
    })?;
    Ok(())
}
