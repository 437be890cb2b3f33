//! The set of formulas tried for a column, and their refinement.

use crate::evidence::runs::laws::formulas::shape::Shape;

/// B-splines of a column whose values are `sorted`.
pub fn splines(column: usize, sorted: &[f64], count: usize) -> Vec<Shape> {
    let [low, high] = [0.01, 0.99].map(|share| quantile(sorted, share));
    let knots = (high - low) / (count - 3) as f64;
    (0..count)
        .map(|k| Shape::Bump(column, low + (k as f64 - 1.0) * knots, knots))
        .collect()
}

/// Lines, powers, exponentials, steps and humps of a column whose values are `sorted`.
pub fn formulas(column: usize, sorted: &[f64]) -> Vec<Shape> {
    let [low, high] = [0.01, 0.99].map(|share| quantile(sorted, share));
    let span = high - low;
    let scale = rounded(low.abs().max(high.abs()), 2);
    let signs = low < 0.0 && high > 0.0;
    let mut shapes = vec![Shape::Line(column)];
    if signs {
        shapes.push(Shape::Size(column));
    }
    for power in [0.5, 1.5, 2.0, 3.0] {
        shapes.push(Shape::Power(column, scale, power));
    }
    for share in [0.25, 0.5, 1.0] {
        for sign in [1.0, -1.0] {
            shapes.push(Shape::Exponential(column, rounded(sign * share * span, 2)));
        }
    }
    for k in 1..12 {
        let at = low + span * f64::from(k) / 12.0;
        shapes.push(Shape::Step(column, rounded(at, 4)));
        for share in [0.08, 0.2] {
            shapes.push(Shape::Hump(
                column,
                rounded(at, 4),
                rounded(share * span, 3),
            ));
        }
    }
    shapes
}

/// Formulas of the same kind with neighbouring parameters; empty if the formula has none.
pub fn around(shape: &Shape, span: f64, share: f64) -> Vec<Shape> {
    let moves = [-1.0, -0.5, 0.0, 0.5, 1.0];
    let factors = moves.map(|m: f64| (3.0 * share * m).exp());
    let places = moves.map(|m| share * span * m);
    match *shape {
        Shape::Power(x, scale, power) => factors
            .map(|f| Shape::Power(x, scale, rounded(power * f, 3)))
            .to_vec(),
        Shape::Exponential(x, scale) => factors
            .map(|f| Shape::Exponential(x, rounded(scale * f, 3)))
            .to_vec(),
        Shape::Step(x, from) => places
            .map(|by| Shape::Step(x, rounded(from + by, 4)))
            .to_vec(),
        Shape::Hump(x, middle, width) => places
            .iter()
            .flat_map(|by| {
                factors.map(|f| Shape::Hump(x, rounded(middle + by, 4), rounded(width * f, 3)))
            })
            .collect(),
        _ => Vec::new(),
    }
}

/// A quantile of sorted values.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let last = sorted.len().saturating_sub(1);
    sorted
        .get((share * last as f64).round() as usize)
        .copied()
        .unwrap_or(0.0)
}

/// A number rounded to `digits` significant digits.
pub fn rounded(x: f64, digits: i32) -> f64 {
    if x == 0.0 || !x.is_finite() {
        return 0.0;
    }
    let text = format!("{x:.*e}", (digits - 1).max(0) as usize);
    text.parse().unwrap_or(x)
}
