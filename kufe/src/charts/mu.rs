//! Picture of mu over the peak pressure: points with both errors, fit, band and cap.

use crate::plot::{Error, Key, PALETTE, PngRoot, Swatch, curve, legend, tick_text};
use plotters::prelude::*;

use kufe_sled::friction::Experiment;
use kufe_sled::friction::MuFit;
use kufe_sled::friction::{PressureLaw, ZetaActsOn};

/// Draws the coefficient of friction over the peak pressure.
///
/// `fit` gives the confidence band, `law` the capped curve that a simulation uses.
///
/// # Errors
/// [`Error::Draw`].
pub fn draw_mu_over_pressure(
    root: &PngRoot,
    experiments: &[Experiment],
    fit: &MuFit,
    law: &PressureLaw,
) -> Result<(), Error> {
    let ends = |e: &Experiment| {
        let (p, p_sd) = (e.p_max_pa * 1e-6, e.p_max_sd_pa * 1e-6);
        (p - p_sd, p + p_sd)
    };
    let low = experiments
        .iter()
        .map(|e| ends(e).0)
        .fold(f64::INFINITY, f64::min);
    let high = experiments.iter().map(|e| ends(e).1).fold(0.0, f64::max);
    let margin = 0.08 * (high - low);
    let (low, high) = ((low - margin).max(0.0), high + margin);
    let top = experiments
        .iter()
        .map(|e| 1e3 * (e.mu + e.mu_sd))
        .fold(1e3 * law.mu_cap, f64::max);
    let [red, blue, grey] = [PALETTE[1], PALETTE[0], PALETTE[6]];
    let formula = format!(
        "{:.4} p² − {:.3} p + {:.2}{}",
        fit.b,
        fit.c,
        fit.d,
        asperities(law)
    );
    let band = format!("{:.0} % band of the fit", 100.0 * fit.confidence);
    let keys = [
        Key::new(Swatch::Dot(4), red, "specimens, one standard deviation"),
        Key::new(Swatch::Line, blue, formula),
        Key::new(Swatch::Fill, blue.mix(0.15), band),
        Key::new(Swatch::Dashes, grey, "cap"),
    ];
    let area = root.margin(12, 0, 0, 0);
    let area = area.titled("Friction over peak contact pressure", ("sans-serif", 20))?;
    let mut chart = ChartBuilder::on(&legend(&area, &keys)?)
        .margin(14)
        .x_label_area_size(48)
        .y_label_area_size(58)
        .build_cartesian_2d(low..high, 0.0..1.08 * top)?;
    chart
        .configure_mesh()
        .x_desc("peak pressure p_max [MPa]")
        .y_desc("coefficient of friction mu [1e-3]")
        .light_line_style(WHITE)
        .bold_line_style(RGBColor(225, 225, 225))
        .label_style(("sans-serif", 15))
        .x_label_formatter(&|p| tick_text(*p, high - low))
        .y_label_formatter(&|mu| tick_text(*mu, top))
        .draw()?;
    let grid: Vec<f64> = (0..=200)
        .map(|i| low + (high - low) * i as f64 / 200.0)
        .collect();
    let band: Vec<(f64, f64)> = grid
        .iter()
        .map(|&p| (p, 1e3 * fit.band(p * 1e6).low))
        .chain(
            grid.iter()
                .rev()
                .map(|&p| (p, 1e3 * fit.band(p * 1e6).high)),
        )
        .map(|(p, mu)| (p, mu.clamp(0.0, 1.08 * top)))
        .collect();
    chart.draw_series([Polygon::new(band, blue.mix(0.15))])?;
    let law_at = grid.iter().map(|&p| (p, 1e3 * law.mu(p * 1e6)));
    curve(&chart, law_at, blue.stroke_width(2))?;
    let cap = [(low, 1e3 * law.mu_cap), (high, 1e3 * law.mu_cap)];
    chart.draw_series(DashedLineSeries::new(cap, 6, 5, grey.stroke_width(1)))?;
    for e in experiments {
        let (p, mu, sd) = (e.p_max_pa * 1e-6, 1e3 * e.mu, 1e3 * e.mu_sd);
        let (left, right) = ends(e);
        let bar = |from, to| PathElement::new([from, to], red.stroke_width(1));
        chart.draw_series([
            bar((p, (mu - sd).max(0.0)), (p, mu + sd)),
            bar((left, mu), (right, mu)),
        ])?;
    }
    chart.draw_series(
        experiments
            .iter()
            .map(|e| Circle::new((e.p_max_pa * 1e-6, 1e3 * e.mu), 4, red.filled())),
    )?;
    if experiments.len() <= 24 {
        chart.draw_series(experiments.iter().map(|e| {
            // Above a point that lies above the curve, below one below; leftwards near the right edge.
            let down = e.mu < law.mu(e.p_max_pa);
            let left = e.p_max_pa * 1e-6 > low + 0.85 * (high - low);
            let width = 7 * e.specimen.chars().count() as i32;
            let offset = (
                if left { -7 - width } else { 7 },
                if down { 6 } else { -18 },
            );
            EmptyElement::at((e.p_max_pa * 1e-6, 1e3 * e.mu))
                + Text::new(e.specimen.clone(), offset, ("sans-serif", 13).into_font())
        }))?;
    }
    Ok(())
}

fn asperities(law: &PressureLaw) -> String {
    match (law.zeta == 1.0, law.zeta_acts_on) {
        (true, _) => String::new(),
        (false, ZetaActsOn::Mu) => format!(", times zeta = {}", law.zeta),
        (false, ZetaActsOn::Pressure) => format!(", p times zeta = {}", law.zeta),
    }
}
