//! Picture of one gliding run: energies over distance with the fitted line.

use crate::plot::{Error, Key, PALETTE, PngRoot, Swatch, curve, legend};
use plotters::prelude::*;

use kufe_sled::friction::IceHouse;
use kufe_sled::friction::{GRAVITY, GlideRun};

/// Draws kinetic, potential and air energy of one run, their sum, and the line whose slope is the ice's friction.
///
/// Energies are counted from the start of the glide; the sum falls by what the ice takes. The middle section is shaded.
///
/// # Errors
/// [`Error::Draw`].
pub fn draw_glide(root: &PngRoot, house: &IceHouse, run: &GlideRun) -> Result<(), Error> {
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
    let shade = RGBColor(232, 232, 236);
    let series = [
        ("kinetic", &kinetic, PALETTE[2]),
        ("potential", &potential, PALETTE[3]),
        ("given to the air", &run.aero, PALETTE[4]),
        ("sum of the three", &sum, PALETTE[0]),
    ];
    let mut keys: Vec<Key> = series
        .iter()
        .map(|(name, _, colour)| Key::new(Swatch::Line, *colour, *name))
        .collect();
    keys.push(Key::new(Swatch::Line, PALETTE[1], "line fitted to the sum"));
    keys.push(Key::new(
        Swatch::Fill,
        shade,
        "section that it is fitted to",
    ));
    let area = root.margin(12, 0, 0, 0);
    let area = legend(&area.titled(&caption, ("sans-serif", 18))?, &keys)?;
    let mut chart = ChartBuilder::on(&area)
        .margin(14)
        .x_label_area_size(46)
        .y_label_area_size(66)
        .build_cartesian_2d(0.0..length, low..high)?;
    let (first, last) = (run.s[run.section.start], run.s[run.section.end - 1]);
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
    for (_, values, colour) in series {
        let points = run.s.iter().copied().zip(values.iter().copied());
        curve(&chart, points, colour)?;
    }
    let fit = |s: f64| (s, run.line.at(s) - start + climb * s);
    curve(&chart, [fit(first), fit(last)], PALETTE[1].stroke_width(2))
}
