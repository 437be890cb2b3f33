//! Box plots over named categories.

use crate::plot::{Error, PALETTE, PngRoot, tick_text};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use kufe_sled::quantile;

/// Values of which quartiles are drawn; fewer are drawn by themselves.
const FEWEST: usize = 5;

/// What boxes, whiskers and dots are.
pub(super) const MEANING: &str = "boxes: quartiles, whiskers: 5 to 95 %, dots: runs";

/// A named distribution in its colour, a place of the palette.
pub(super) struct Category {
    pub name: String,
    pub colour: usize,
    pub spread: Spread,
}

/// Five quantiles of a distribution, and its points where they are few.
#[derive(Clone, Debug, Default)]
pub struct Spread {
    /// Quantiles 5 %, 25 %, 50 %, 75 %, 95 %.
    pub quantiles: [f64; 5],
    /// Every value, drawn as a point where there are at most a hundred.
    pub points: Vec<f64>,
}

impl Spread {
    /// From values in any order; all zero where there are none.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Spread {
        let mut sorted: Vec<f64> = values.into_iter().collect();
        sorted.sort_by(f64::total_cmp);
        if sorted.is_empty() {
            return Spread::default();
        }
        Spread {
            quantiles: [0.05, 0.25, 0.5, 0.75, 0.95].map(|share| quantile(&sorted, share)),
            points: if sorted.len() <= 100 {
                sorted
            } else {
                Vec::new()
            },
        }
    }

    /// Whether there are values, and too few of them for quartiles.
    fn is_few(&self) -> bool {
        (1..FEWEST).contains(&self.points.len())
    }

    fn reach(&self) -> (f64, f64) {
        let (mut low, mut high) = (self.quantiles[0], self.quantiles[4]);
        for point in &self.points {
            (low, high) = (low.min(*point), high.max(*point));
        }
        (low, high)
    }
}

/// One panel of boxes: categories along x, quartiles as a box, 5 to 95 % as whiskers, points beside; of fewer than
/// [`FEWEST`] values the points alone, and words in place of axes where every value is zero.
pub(super) fn draw_boxes(
    root: &PngRoot,
    title: &str,
    unit: &str,
    boxes: &[Category],
) -> Result<(), Error> {
    let Some((low, high)) = reach(boxes) else {
        let area = root.margin(12, 0, 0, 0).titled(title, ("sans-serif", 22))?;
        let (width, height) = area.dim_in_pixel();
        let style = ("sans-serif", 18).into_font().color(&PALETTE[6]);
        let style = style.pos(Pos::new(HPos::Center, VPos::Center));
        let middle = (width as i32 / 2, height as i32 / 2);
        return Ok(area.draw(&Text::new("0 in every run", middle, style))?);
    };
    let margin = 0.06 * (high - low);
    let count = boxes.len() as f64;
    let mut builder = ChartBuilder::on(root);
    if !title.is_empty() {
        builder.caption(title, ("sans-serif", 22));
    }
    let mut chart = builder
        .margin(12)
        .x_label_area_size(30)
        .y_label_area_size(64)
        .build_cartesian_2d(
            0.0..count,
            (low - if low < 0.0 { margin } else { 0.0 })..high + margin,
        )?;
    let names = |x: &f64| {
        let place = x.floor() as usize;
        match boxes.get(place) {
            Some(of) if (x - place as f64 - 0.5).abs() < 0.01 => of.name.clone(),
            _ => String::new(),
        }
    };
    chart
        .configure_mesh()
        .disable_x_mesh()
        .x_labels(2 * boxes.len() + 1)
        .x_label_formatter(&names)
        .y_label_formatter(&|y| tick_text(*y, high - low))
        .y_desc(unit)
        .label_style(("sans-serif", 17))
        .light_line_style(WHITE)
        .draw()?;
    for (place, Category { colour, spread, .. }) in boxes.iter().enumerate() {
        let colour = PALETTE[*colour];
        let [q5, q25, q50, q75, q95] = spread.quantiles;
        let middle = place as f64 + 0.5;
        let (left, right) = (middle - 0.24, middle + 0.24);
        if spread.is_few() {
            let own = |point: &f64| Circle::new((middle, *point), 4, colour.filled());
            chart.draw_series(spread.points.iter().map(own))?;
            continue;
        }
        let line = |points: Vec<(f64, f64)>, width: u32| {
            PathElement::new(points, colour.stroke_width(width))
        };
        chart.draw_series([Rectangle::new(
            [(left, q25), (right, q75)],
            colour.mix(0.35).filled(),
        )])?;
        chart.draw_series([
            line(
                vec![
                    (left, q25),
                    (right, q25),
                    (right, q75),
                    (left, q75),
                    (left, q25),
                ],
                1,
            ),
            line(vec![(left, q50), (right, q50)], 3),
            line(vec![(middle, q75), (middle, q95)], 1),
            line(vec![(middle, q25), (middle, q5)], 1),
            line(vec![(middle - 0.1, q95), (middle + 0.1, q95)], 1),
            line(vec![(middle - 0.1, q5), (middle + 0.1, q5)], 1),
        ])?;
        chart.draw_series(
            spread
                .points
                .iter()
                .map(|point| Circle::new((middle + 0.34, *point), 3, colour.filled())),
        )?;
    }
    Ok(())
}

/// The lowest and the highest value, with zero; nothing where there is no other.
pub(super) fn reach(boxes: &[Category]) -> Option<(f64, f64)> {
    let reach = boxes.iter().map(|of| of.spread.reach());
    let (low, high) = reach.fold((0.0_f64, 0.0_f64), |(low, high), (a, b)| {
        (low.min(a), high.max(b))
    });
    (high > low).then_some((low, high))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quartiles_are_drawn_of_five_values_and_of_hundreds_but_not_of_two() {
        let few = |count: u32| Spread::of((0..count).map(f64::from)).is_few();
        assert_eq!([0, 1, 2, 4].map(few), [false, true, true, true]);
        assert_eq!([5, 100, 101, 1000].map(few), [false; 4]);
    }
}
