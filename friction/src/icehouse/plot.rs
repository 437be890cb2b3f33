//! Picture of one gliding run: energies over distance with the fitted line.

use plotters::prelude::*;

use crate::icehouse::glide_run::{GRAVITY, GlideRun};
use crate::icehouse::specimens::IceHouse;

/// Draws kinetic, potential and air energy of one run, their sum, and the line whose slope is the ice's friction.
///
/// Energies are counted from the start of the glide; the sum falls by what the ice takes. The middle section is shaded.
///
/// # Errors
/// [`kufe_plot::Error::Draw`].
pub fn draw_glide<B: DrawingBackend>(
    root: &DrawingArea<B, plotters::coord::Shift>,
    house: &IceHouse,
    run: &GlideRun,
) -> Result<(), kufe_plot::Error>
where
    B::ErrorType: 'static,
{
    let potential = house.potential(run);
    let start = run.line.at(0.0);
    let kinetic: Vec<f64> = run.kinetic.iter().map(|e| e - start).collect();
    let sum: Vec<f64> = (0..run.s.len())
        .map(|i| kinetic[i] + potential[i] + run.aero[i])
        .collect();
    let length = run.s.iter().copied().fold(0.0, f64::max);
    let all = || {
        kinetic
            .iter()
            .chain(&potential)
            .chain(&run.aero)
            .chain(&sum)
    };
    let low = all().copied().fold(f64::INFINITY, f64::min);
    let high = all().copied().fold(f64::NEG_INFINITY, f64::max);
    let margin = 0.06 * (high - low);
    let (low, high) = (low - margin, high + margin);
    let weight = run.entry.mass_kg * GRAVITY;
    let climb = potential.last().copied().unwrap_or(0.0) / run.s.last().copied().unwrap_or(1.0);
    let friction = -(run.line.slope + climb);
    let caption = format!(
        "{}, run {} ({}): friction {:.2} N, mu {:.2}e-3",
        run.entry.specimen,
        run.entry.run,
        run.entry.direction,
        friction,
        1e3 * friction / (weight * house.slope_rad.value.cos()),
    );
    let mut chart = ChartBuilder::on(root)
        .caption(caption, ("sans-serif", 18))
        .margin(14)
        .x_label_area_size(46)
        .y_label_area_size(66)
        .build_cartesian_2d(0.0..length, low..high)?;
    let (first, last) = (run.s[run.section.start], run.s[run.section.end - 1]);
    let shade = RGBColor(240, 240, 240);
    chart.draw_series(std::iter::once(Rectangle::new(
        [(first, low), (last, high)],
        shade.filled(),
    )))?;
    chart
        .configure_mesh()
        .x_desc("distance s [m]")
        .y_desc("energy against the start [J]")
        .light_line_style(TRANSPARENT)
        .bold_line_style(RGBColor(218, 218, 218))
        .label_style(("sans-serif", 15))
        .x_label_formatter(&|s| format!("{s:.0}"))
        .y_label_formatter(&|e| format!("{e:.0}"))
        .draw()?;
    let palette = kufe_plot::PALETTE;
    let series = [
        ("kinetic", &kinetic, palette[2]),
        ("potential", &potential, palette[3]),
        ("given to the air", &run.aero, palette[4]),
        ("sum", &sum, palette[5]),
    ];
    for (name, values, colour) in series {
        chart
            .draw_series(LineSeries::new(
                run.s.iter().copied().zip(values.iter().copied()),
                colour.stroke_width(1),
            ))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], colour.stroke_width(2)));
    }
    let fit = |s: f64| (s, run.line.at(s) - start + climb * s);
    let red = palette[1];
    chart
        .draw_series(LineSeries::new(
            [fit(first), fit(last)],
            red.stroke_width(2),
        ))?
        .label("fitted line, middle section")
        .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], red.stroke_width(2)));
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerLeft)
        .background_style(WHITE.mix(0.85))
        .border_style(RGBColor(200, 200, 200))
        .label_font(("sans-serif", 14))
        .margin(12)
        .draw()?;
    Ok(())
}
