//! Box plots of runs by driver, track and law.

use kufe_sled::{Angles, DrivingForce, RunEvaluation, RunValidation, by_track, distinct, quantile};

use crate::plot::{Axis, Figure, Layer, PALETTE, Panel, Point, extent};

/// Smallest number of values with quartiles; fewer values are drawn as points only.
const MIN_QUARTILES: usize = 5;
/// Largest number of values that are drawn as points next to their quartiles.
const MAX_POINTS: usize = 100;

/// Meaning of boxes, whiskers and dots.
const MEANING: &str = "boxes: quartiles, whiskers: 5 to 95 %, dots: runs";

/// A named distribution and the index of its colour.
struct Category {
    name: String,
    colour: usize,
    values: Vec<f64>,
}

/// A panel of boxes by category, or a note if all values are 0.
fn boxes(title: impl Into<String>, unit: &str, categories: &[Category]) -> Panel {
    if !has_values(categories) {
        let note = Layer::text((0.5, 0.5), "0 in every run", [0.0; 2], PALETTE[6]);
        let [x, y] = [[0.0, 1.0]; 2].map(Axis::blank);
        return Panel::new(x, y, vec![note]).titled(title);
    }
    let boxes = categories.iter().enumerate();
    let layers = boxes.flat_map(|(k, category)| one_box(k as f64 + 0.5, category));
    let values = categories.iter().flat_map(|category| &category.values);
    let [low, high] = extent(values.copied().chain([0.0]));
    let margin = 0.06 * (high - low);
    let bottom = if low < 0.0 { low - margin } else { 0.0 };
    let x = Axis::names("", categories.iter().map(|category| &*category.name));
    let y = Axis::new(unit).within([bottom, high + margin]);
    Panel::new(x, y, layers.collect()).titled(title)
}

fn has_values(categories: &[Category]) -> bool {
    let mut values = categories.iter().flat_map(|category| &category.values);
    values.any(|value| *value != 0.0)
}

/// Quartiles as a box, 5 to 95 % as whiskers, and up to [`MAX_POINTS`] values as points.
fn one_box(middle: f64, category: &Category) -> Vec<Layer> {
    let colour = PALETTE[category.colour];
    let mut sorted = category.values.clone();
    sorted.sort_by(f64::total_cmp);
    let points = |x: f64| sorted.iter().map(move |value| (x, *value));
    if sorted.len() < MIN_QUARTILES {
        return vec![Layer::dots(4.0, points(middle), colour)];
    }
    let [q5, q25, q50, q75, q95] =
        [0.05, 0.25, 0.5, 0.75, 0.95].map(|share| quantile(&sorted, share));
    let across = |half: f64, y: f64| -> [Point; 2] { [(middle - half, y), (middle + half, y)] };
    let [left, right] = [middle - 0.24, middle + 0.24];
    let corners = [(left, q25), (right, q25), (right, q75), (left, q75)];
    let outline = corners.into_iter().chain([corners[0]]);
    let whiskers =
        [(q75, q95), (q25, q5)].map(|(from, to)| [[(middle, from), (middle, to)], across(0.1, to)]);
    let mut layers = vec![
        Layer::area(corners, colour.alpha(0.35)),
        Layer::line(1.0, outline, colour),
        Layer::segments(1.0, whiskers.concat(), colour),
        Layer::segments(3.0, [across(0.24, q50)], colour),
    ];
    if sorted.len() <= MAX_POINTS {
        layers.push(Layer::dots(3.0, points(middle + 0.34), colour));
    }
    layers
}

/// A box for each group of runs, from the values of each of its runs.
fn grouped(
    runs: &[RunEvaluation],
    by: fn(&RunEvaluation) -> &String,
    values: &dyn Fn(&RunEvaluation) -> Vec<f64>,
) -> Vec<Category> {
    let groups = distinct(runs.iter().map(by)).into_iter().enumerate();
    let category = |(k, group): (usize, &String)| {
        let own = runs.iter().filter(|run| by(run) == group);
        Category {
            name: group.to_owned(),
            colour: k % 6,
            values: own.flat_map(values).collect(),
        }
    };
    groups.map(category).collect()
}

/// Relative loss increases (front, rear, air, total), one box per group of runs with equal `by`, as
/// driver or track.
pub fn energy_picture(
    title: &str,
    runs: &[RunEvaluation],
    by: fn(&RunEvaluation) -> &String,
) -> Figure {
    type Increase = fn(&RunEvaluation) -> f64;
    let panels: [(&str, Increase); 4] = [
        ("front runner", |run| run.increase_front),
        ("rear runner", |run| run.increase_rear),
        ("air", |run| run.increase_aero),
        ("total", |run| run.increase_total),
    ];
    let panels = panels.map(|(name, increase)| {
        let categories = grouped(runs, by, &|run| vec![100.0 * increase(run)]);
        boxes(name, "loss increase [%]", &categories)
    });
    Figure::new(1500.0, format!("{title} ({MEANING})")).row(400.0, panels)
}

/// Steering and slip angles by driver: their distributions, and the fractions of time above 2 and 4
/// degrees by run.
pub fn angle_picture(runs: &[RunEvaluation]) -> Figure {
    type Angle = fn(&DrivingForce) -> f64;
    type Shares = fn(&RunEvaluation) -> &Angles;
    let angles: [(&str, Angle, Shares); 4] = [
        ("steering", |f| f.delta_rad, |run| &run.steering),
        ("front slip", |f| f.alpha_f_rad, |run| &run.slip_front),
        ("rear slip", |f| f.alpha_r_rad, |run| &run.slip_rear),
        ("chassis slip", |f| f.beta_rad, |run| &run.chassis_slip),
    ];
    type Values<'a> = &'a dyn Fn(&RunEvaluation, Angle, Shares) -> Vec<f64>;
    let rows: [(&str, &str, Values); 3] = [
        ("", "angle [degrees]", &|run, angle, _| {
            run.series.iter().map(|f| angle(f).to_degrees()).collect()
        }),
        (" above 2°", "share of time [%]", &|run, _, shares| {
            vec![100.0 * shares(run).share_above_2deg]
        }),
        (" above 4°", "share of time [%]", &|run, _, shares| {
            vec![100.0 * shares(run).share_above_4deg]
        }),
    ];
    let mut figure = Figure::new(1600.0, format!("Angles by driver ({MEANING})"));
    for (above, unit, values) in rows {
        let panels = angles.map(|(name, angle, shares)| {
            let categories = grouped(runs, |run| &run.driver, &|run| values(run, angle, shares));
            let panel = boxes(format!("{name}{above}"), unit, &categories);
            (has_values(&categories), panel)
        });
        if panels.iter().any(|(is_known, _)| *is_known) {
            figure = figure.row(330.0, panels.map(|(_, panel)| panel));
        }
    }
    figure
}

/// Root mean square error of the lateral force by run, a box for each track and law.
pub fn rmse_picture(runs: &[RunValidation]) -> Figure {
    type Error = fn(&RunValidation) -> f64;
    let laws: [(&str, usize, Error); 2] = [
        ("friction model", 1, |run| run.rmse_n),
        ("Braghin's law, for comparison", 0, |run| run.rmse_braghin_n),
    ];
    let mut categories = Vec::new();
    for track in by_track(runs) {
        let own: Vec<_> = runs.iter().filter(|run| run.track == track.track).collect();
        categories.extend(laws.map(|(_, colour, error)| Category {
            name: track.track.clone(),
            colour,
            values: own.iter().map(|run| error(run)).collect(),
        }));
    }
    let mut panel = boxes("", "RMSE by run [N]", &categories);
    // Empty areas in the colours of the laws are the entries of the legend.
    let keys =
        laws.map(|(name, colour, _)| Layer::area([], PALETTE[colour].alpha(0.35)).named(name));
    panel.layers.splice(0..0, keys);
    let width = 220.0 * categories.len().max(4) as f64;
    Figure::new(width, format!("Lateral force: residuals ({MEANING})")).row(420.0, [panel])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quartiles_are_drawn_of_five_values_and_of_hundreds_but_not_of_two() {
        let layers = |count: u32| {
            let values = (0..count).map(f64::from).collect();
            let name = String::new();
            one_box(
                0.5,
                &Category {
                    name,
                    colour: 0,
                    values,
                },
            )
            .len()
        };
        assert_eq!([0, 1, 2, 4].map(layers), [1; 4]);
        assert_eq!([5, 100].map(layers), [5; 2]);
        assert_eq!([101, 1000].map(layers), [4; 2]);
    }

    #[test]
    fn a_panel_of_zeros_has_a_note() {
        let zeros = Category {
            name: "A1".to_owned(),
            colour: 0,
            values: vec![0.0; 9],
        };
        let panel = boxes("air", "loss increase [%]", &[zeros]);
        let note = Layer::text((0.5, 0.5), "0 in every run", [0.0; 2], PALETTE[6]);
        assert_eq!(panel.layers, [note]);
    }
}
