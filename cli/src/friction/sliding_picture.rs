//! `friction.png`: mu of each runner over speed, over temperature, or runner by runner.

use kufe::plot::{Axis, Figure, Layer, PALETTE, Panel, Point, extent};
use kufe::results::FrictionRow;

/// What the points of a line differ by.
#[derive(Clone, Copy, PartialEq)]
enum Over {
    Speed,
    Temperature,
    Runner,
}

/// Mu of the points of each runner over speed where there are several, else over temperature, else
/// runner by runner.
pub fn sliding_picture(runners: &[Vec<FrictionRow>]) -> Figure {
    let points = || runners.iter().flatten();
    let differ =
        |of: fn(&FrictionRow) -> f64| points().any(|p| Some(of(p)) != points().next().map(of));
    let over = match (differ(|p| p.v_mps), differ(|p| p.ice_c)) {
        (true, _) => Over::Speed,
        (_, true) => Over::Temperature,
        _ => Over::Runner,
    };
    let lines = lines(runners, over);
    let places = || lines.iter().flat_map(|(_, line)| line);
    let [least, most] = extent(places().flat_map(|[_, mu, error]| [mu - error, mu + error]));
    let [left, right] = extent(places().map(|at| at[0]).chain([0.0]));
    let x = match over {
        Over::Speed => Axis::new("speed [m/s]").within([0.0, 1.05 * right]),
        Over::Temperature => Axis::new("temperature of the ice [C]").within([1.05 * left, 0.0]),
        Over::Runner => {
            let first = runners.iter().filter_map(|points| points.first());
            Axis::names("runner", first.map(|point| &*point.case))
        }
    };
    // Runner by runner the differences matter, else the size.
    let room = 0.2 * (most - least);
    let y = match over {
        Over::Runner => [least - room, most + room],
        _ => [0.0, 1.1 * most],
    };
    let mut layers = Vec::new();
    for ((name, line), colour) in lines.iter().zip(PALETTE.iter().cycle()) {
        let point = |[x, mu, _]: &[f64; 3]| -> Point { (*x, *mu) };
        let errors = line
            .iter()
            .map(|[x, mu, error]| [(*x, mu - error), (*x, mu + error)]);
        layers.push(Layer::segments(1.0, errors, *colour));
        if over != Over::Runner {
            layers.push(Layer::line(2.0, line.iter().map(point), *colour).named(name));
        }
        layers.push(Layer::dots(4.0, line.iter().map(point), *colour));
    }
    let y = Axis::new("coefficient of friction mu [1e-3]").within(y);
    let title = "friction of groove and melt film";
    Figure::new(900.0, title).row(460.0, [Panel::new(x, y, layers)])
}

/// A line: its name, and place, mu and error of its points [1e-3].
type Line = (String, Vec<[f64; 3]>);

/// A line for each runner, and over speed for each of its temperatures.
fn lines(runners: &[Vec<FrictionRow>], over: Over) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    for (k, points) in runners.iter().enumerate() {
        for point in points {
            let name = match (over, runners.len()) {
                (Over::Speed, 1) => format!("ice of {} C", point.ice_c),
                (Over::Speed, _) => format!("{}, {} C", point.case, point.ice_c),
                _ => point.case.clone(),
            };
            let place = match over {
                Over::Speed => point.v_mps,
                Over::Temperature => point.ice_c,
                Over::Runner => 0.5 + k as f64,
            };
            let mu = point.friction.mu;
            let at = [place, 1e3 * mu.value, 1e3 * mu.error];
            match lines.iter_mut().find(|line| line.0 == name) {
                Some((_, line)) => line.push(at),
                None => lines.push((name, vec![at])),
            }
        }
    }
    for (_, line) in &mut lines {
        line.sort_by(|a, b| a[0].total_cmp(&b[0]));
    }
    lines
}
