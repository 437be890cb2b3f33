//! `friction.png` of a search: mu over one parameter, or the map over two, with the best runner.

use kufe::jobs::slide::Optimum;
use kufe::plot::{
    Error, Key, PALETTE, PngRoot, Swatch, colour_bar, curve, legend, tick_text, viridis,
};
use plotters::prelude::*;

/// Places along a parameter at which the curve is drawn.
const STEPS: usize = 200;
/// Colours of the map.
const BANDS: f64 = 20.0;

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

fn title(found: &Optimum) -> String {
    format!(
        "mu at {} m/s and {} C, least {:.3}e-3",
        found.point.v_mps,
        found.point.ice_c,
        1e3 * found.point.friction.mu.value
    )
}

fn line(root: &PngRoot, found: &Optimum) -> Result<(), Error> {
    let [from, to] = found.parameters[0].span.bounds();
    let places = (0..=STEPS).map(|k| from + (to - from) * k as f64 / STEPS as f64);
    let surface: Vec<(f64, f64)> = places.map(|x| (x, 1e3 * found.response.at(&[x]))).collect();
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
    let [blue, red, green] = [PALETTE[0], PALETTE[1], PALETTE[2]];
    let green = green.mix(0.18);
    let keys = [
        Key::new(Swatch::Dot(7), red, "best runner, solved"),
        Key::new(Swatch::Dot(4), red, "other runners solved"),
        Key::new(Swatch::Line, blue, "smooth curve through them"),
        Key::new(Swatch::Fill, green, "cannot be told from the best"),
    ];
    let area = root.margin(12, 0, 0, 0);
    let area = legend(&area.titled(&title(found), ("sans-serif", 22))?, &keys)?;
    let mut builder = ChartBuilder::on(&area);
    builder
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
    chart.draw_series([Rectangle::new(corners, green.filled())])?;
    curve(&chart, surface, blue.stroke_width(2))?;
    let bars = solved.iter().map(|(x, mu)| {
        let [below, at, above] = [-1.0, 0.0, 1.0].map(|side| 1e3 * (mu.value + side * mu.error));
        ErrorBar::new_vertical(*x, below, at, above, red.filled(), 10)
    });
    chart.draw_series(bars)?;
    let (x, mu) = (found.values[0], 1e3 * found.point.friction.mu.value);
    chart.draw_series([Circle::new((x, mu), 7, red.filled())])?;
    Ok(())
}

fn map(root: &PngRoot, found: &Optimum) -> Result<(), Error> {
    let [x0, x1] = found.parameters[0].span.bounds();
    let [y0, y1] = found.parameters[1].span.bounds();
    let [best, others] = [PALETTE[1], RGBColor(255, 105, 190)];
    let keys = [
        Key::new(Swatch::Dot(8), best, "best runner, solved"),
        Key::new(Swatch::Dot(4), others, "other runners solved"),
        Key::new(
            Swatch::Line,
            others,
            "bound of what cannot be told from the best",
        ),
    ];
    let area = root.margin(12, 0, 0, 0);
    let area = legend(&area.titled(&title(found), ("sans-serif", 22))?, &keys)?;
    let (area, bar) = area.split_horizontally(area.dim_in_pixel().0 - 130);
    let mut builder = ChartBuilder::on(&area);
    builder
        .margin(14)
        .margin_right(26)
        .x_label_area_size(50)
        .y_label_area_size(90);
    let mut chart = builder.build_cartesian_2d(x0..x1, y0..y1)?;
    let plane = chart.plotting_area().strip_coord_spec();
    let (width, height) = plane.dim_in_pixel();
    let share = |pixel: u32, count: u32| (f64::from(pixel) + 0.5) / f64::from(count);
    let places = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
    let values: Vec<f64> = places
        .map(|(column, row)| {
            let (right, down) = (share(column, width), share(row, height));
            let at = [x0 + right * (x1 - x0), y1 - down * (y1 - y0)];
            found.response.at(&at)
        })
        .collect();
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = values.iter().copied().fold(least * (1.0 + 1e-9), f64::max);
    let colour = |mu: f64| {
        let band = (BANDS * (mu - least) / (most - least)).floor();
        viridis(band / (BANDS - 1.0))
    };
    colour_bar(
        &bar.margin(14, 64, 0, 0),
        [1e3 * least, 1e3 * most],
        |mu| colour(1e-3 * mu),
        "coefficient of friction mu [1e-3]",
    )?;
    let most_alike = least * (1.0 + found.indistinct());
    let columns = width as usize;
    for (pixel, &mu) in values.iter().enumerate() {
        let at = ((pixel % columns) as i32, (pixel / columns) as i32);
        let alike =
            |other: Option<&f64>| other.is_none_or(|o| (*o <= most_alike) == (mu <= most_alike));
        let beside = (pixel + 1) % columns == 0 || alike(values.get(pixel + 1));
        let inside = beside && alike(values.get(pixel + columns));
        let colour = if inside { colour(mu) } else { others };
        plane.draw_pixel(at, &colour)?;
    }
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
    let dots = found.solved.iter();
    let dots = dots.map(|(values, _)| Circle::new((values[0], values[1]), 4, others.filled()));
    chart.draw_series(dots)?;
    let at = (found.values[0], found.values[1]);
    chart.draw_series([Circle::new(at, 8, best.filled())])?;
    Ok(())
}
