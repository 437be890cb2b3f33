//! `friction.png` of a search: mu over one parameter, or the map over two, with the best runner.

use kufe_jobs::slide::Optimum;
use kufe_plot::{Error, PALETTE, PngRoot, tick_text, viridis};
use plotters::prelude::*;

/// Places along a parameter at which the surface is drawn.
const STEPS: usize = 90;

/// Draws what was found over its one or two parameters.
///
/// # Errors
/// [`Error`] where the picture cannot be drawn.
pub fn draw(root: &PngRoot, found: &Optimum) -> Result<(), Error> {
    match found.parameters.len() {
        1 => line(root, found),
        _ => map(root, found),
    }
}

/// The `k`-th of places along parameter `axis`.
fn place(found: &Optimum, axis: usize, k: f64) -> f64 {
    let [low, high] = found.parameters[axis].span.bounds();
    low + (high - low) * k / STEPS as f64
}

fn title(found: &Optimum) -> String {
    format!(
        "mu at {} m/s and {} C, least {:.3}e-3",
        found.point.v_mps,
        found.point.ice_c,
        1e3 * found.point.friction.mu.value
    )
}

fn line(root: &PngRoot, found: &Optimum) -> Result<(), Error> {
    let surface: Vec<(f64, f64)> = (0..=STEPS)
        .map(|k| place(found, 0, k as f64))
        .map(|x| (x, 1e3 * found.response.at(&[x])))
        .collect();
    let solved = found
        .solved
        .iter()
        .map(|(values, point)| (values[0], point.friction.mu));
    let solved: Vec<_> = solved
        .chain([(found.values[0], found.point.friction.mu)])
        .collect();
    let reach = solved
        .iter()
        .flat_map(|(_, mu)| [mu.value - mu.error, mu.value + mu.error]);
    let (low, high) = reach.fold((f64::INFINITY, 0.0f64), |(a, b), mu| {
        (a.min(1e3 * mu), b.max(1e3 * mu))
    });
    let margin = 0.1 * (high - low);
    let [from, to] = found.parameters[0].span.bounds();
    let mut builder = ChartBuilder::on(root);
    builder
        .caption(title(found), ("sans-serif", 22))
        .margin(14)
        .margin_right(26)
        .x_label_area_size(50)
        .y_label_area_size(80);
    let mut chart = builder.build_cartesian_2d(from..to, low - margin..high + margin)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(RGBColor(225, 225, 230))
        .x_desc(&found.parameters[0].key)
        .y_desc("coefficient of friction mu [1e-3]")
        .x_label_formatter(&|x| tick_text(*x, to - from))
        .y_label_formatter(&|y| tick_text(*y, high - low))
        .label_style(("sans-serif", 16))
        .axis_desc_style(("sans-serif", 18))
        .draw()?;
    let [left, right] = found.flat()[0];
    let corners = [(left, low - margin), (right, high + margin)];
    let flat = Rectangle::new(corners, PALETTE[2].mix(0.18).filled());
    chart
        .draw_series([flat])?
        .label("cannot be told from the best")
        .legend(|(x, y)| {
            Rectangle::new([(x, y - 6), (x + 24, y + 6)], PALETTE[2].mix(0.3).filled())
        });
    chart
        .draw_series(LineSeries::new(surface, PALETTE[0].stroke_width(2)))?
        .label("smooth curve through the runners solved")
        .legend(|(x, y)| PathElement::new(vec![(x, y), (x + 24, y)], PALETTE[0].stroke_width(3)));
    let bars = solved.iter().map(|(x, mu)| {
        let [below, at, above] = [-1.0, 0.0, 1.0].map(|side| 1e3 * (mu.value + side * mu.error));
        ErrorBar::new_vertical(*x, below, at, above, PALETTE[1].filled(), 10)
    });
    chart.draw_series(bars)?;
    let (x, mu) = (found.values[0], 1e3 * found.point.friction.mu.value);
    chart
        .draw_series([Circle::new((x, mu), 7, PALETTE[1].filled())])?
        .label("best runner, solved")
        .legend(|(x, y)| Circle::new((x + 12, y), 6, PALETTE[1].filled()));
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerRight)
        .background_style(WHITE.mix(0.8))
        .label_font(("sans-serif", 16))
        .draw()?;
    Ok(())
}

fn map(root: &PngRoot, found: &Optimum) -> Result<(), Error> {
    let cell = |k: usize, l: usize| {
        let middle = [
            place(found, 0, k as f64 + 0.5),
            place(found, 1, l as f64 + 0.5),
        ];
        found.response.at(&middle)
    };
    let cells = || (0..STEPS).flat_map(|l| (0..STEPS).map(move |k| (k, l)));
    let (least, most) = cells()
        .map(|(k, l)| cell(k, l))
        .fold((f64::INFINITY, 0.0f64), |(a, b), mu| (a.min(mu), b.max(mu)));
    let [x0, x1] = found.parameters[0].span.bounds();
    let [y0, y1] = found.parameters[1].span.bounds();
    let mut builder = ChartBuilder::on(root);
    let scale = format!(
        "; colours {:.3} to {:.3}e-3, a band a twentieth",
        1e3 * least,
        1e3 * most
    );
    builder
        .caption(title(found) + &scale, ("sans-serif", 20))
        .margin(14)
        .margin_right(26)
        .x_label_area_size(50)
        .y_label_area_size(90);
    let mut chart = builder.build_cartesian_2d(x0..x1, y0..y1)?;
    let level = |mu: f64| (20.0 * (mu - least) / (most - least).max(f64::MIN_POSITIVE)).floor();
    chart.draw_series(cells().map(|(k, l)| {
        let corners = [
            (place(found, 0, k as f64), place(found, 1, l as f64)),
            (
                place(found, 0, k as f64 + 1.0),
                place(found, 1, l as f64 + 1.0),
            ),
        ];
        Rectangle::new(corners, viridis(level(cell(k, l)) / 19.0).filled())
    }))?;
    chart
        .configure_mesh()
        .disable_mesh()
        .x_desc(&found.parameters[0].key)
        .y_desc(&found.parameters[1].key)
        .x_label_formatter(&|x| tick_text(*x, x1 - x0))
        .y_label_formatter(&|y| tick_text(*y, y1 - y0))
        .label_style(("sans-serif", 16))
        .axis_desc_style(("sans-serif", 18))
        .draw()?;
    let dots = found
        .solved
        .iter()
        .map(|(values, _)| (values[0], values[1]));
    chart.draw_series(dots.map(|at| Circle::new(at, 3, WHITE.filled())))?;
    let most_alike = least * (1.0 + found.indistinct());
    let flat = cells().filter(|&(k, l)| cell(k, l) <= most_alike);
    let middles = flat.map(|(k, l)| {
        (
            place(found, 0, k as f64 + 0.5),
            place(found, 1, l as f64 + 0.5),
        )
    });
    chart
        .draw_series(middles.map(|at| Circle::new(at, 1, WHITE.filled())))?
        .label("cannot be told from the best (dots)")
        .legend(|(x, y)| Circle::new((x + 12, y), 2, WHITE.filled()));
    let best = (found.values[0], found.values[1]);
    chart
        .draw_series([Circle::new(best, 8, PALETTE[1].filled())])?
        .label("best runner, solved")
        .legend(|(x, y)| Circle::new((x + 12, y), 6, PALETTE[1].filled()));
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(RGBColor(120, 120, 130).mix(0.7))
        .label_font(("sans-serif", 16, &WHITE))
        .draw()?;
    Ok(())
}
