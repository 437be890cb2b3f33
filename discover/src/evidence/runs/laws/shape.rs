//! Shapes of laws: basis functions of a smooth curve, and the formulas that are tried for a column.

use std::borrow::Cow;

use kufe_sled::effects::Expression;

/// A function of one or two columns, by their indices.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// 1 everywhere.
    One,
    /// A cubic B-spline of a column: its centre and the distance of its knots.
    Bump(usize, f64, f64),
    /// The column.
    Line(usize),
    /// Its absolute value.
    Size(usize),
    /// Its absolute value over a scale, to a power.
    Power(usize, f64, f64),
    /// `exp(x / scale)`.
    Exponential(usize, f64),
    /// 1 above a value, 0 below.
    Step(usize, f64),
    /// `exp(-((x - middle) / width)^2)`.
    Hump(usize, f64, f64),
    /// The product of two columns.
    Product(usize, usize),
}

impl Shape {
    /// The value at a sample; `columns` returns each column's value.
    pub fn value(&self, columns: impl Fn(usize) -> f64) -> f64 {
        match *self {
            Shape::One => 1.0,
            Shape::Bump(x, middle, knots) => cubic((columns(x) - middle) / knots),
            Shape::Line(x) => columns(x),
            Shape::Size(x) => columns(x).abs(),
            Shape::Power(x, scale, power) => (columns(x).abs() / scale).powf(power),
            Shape::Exponential(x, scale) => (columns(x) / scale).exp(),
            Shape::Step(x, from) => f64::from(u8::from(columns(x) > from)),
            Shape::Hump(x, middle, width) => (-((columns(x) - middle) / width).powi(2)).exp(),
            Shape::Product(x, y) => columns(x) * columns(y),
        }
    }

    /// The formula as a model states it.
    pub fn text(&self, names: &[String]) -> String {
        let name = |x: &usize| Expression::quoted(&names[*x]);
        match self {
            Shape::One => "1".to_owned(),
            Shape::Bump(x, middle, knots) => format!("bump(({} - {middle}) / {knots})", name(x)),
            Shape::Line(x) => name(x),
            Shape::Size(x) => format!("abs({})", name(x)),
            Shape::Power(x, scale, power) => format!("(abs({}) / {scale})^{power}", name(x)),
            Shape::Exponential(x, scale) => format!("exp({} / ({scale}))", name(x)),
            Shape::Step(x, from) => format!("step({} - ({from}))", name(x)),
            Shape::Hump(x, middle, width) => {
                format!("exp(-(({} - ({middle})) / {width})^2)", name(x))
            }
            Shape::Product(x, y) => format!("{} * {}", name(x), name(y)),
        }
    }

    /// Number of parameters of the formula in addition to the amplitude: formulas are tried in this
    /// order.
    pub fn numbers(&self) -> usize {
        match self {
            Shape::One => 0,
            Shape::Line(_) | Shape::Size(_) => 1,
            Shape::Product(..) | Shape::Power(..) | Shape::Exponential(..) | Shape::Step(..) => 2,
            Shape::Hump(..) | Shape::Bump(..) => 3,
        }
    }

    /// The columns that it depends on.
    pub fn columns(&self) -> Vec<usize> {
        match *self {
            Shape::One => Vec::new(),
            Shape::Product(x, y) => vec![x, y],
            Shape::Line(x)
            | Shape::Size(x)
            | Shape::Step(x, _)
            | Shape::Exponential(x, _)
            | Shape::Bump(x, ..)
            | Shape::Power(x, ..)
            | Shape::Hump(x, ..) => vec![x],
        }
    }

    /// The columns whose units divide the amplitude's unit; the others are dimensionless.
    pub fn per(&self) -> Vec<usize> {
        match self {
            Shape::Line(x) | Shape::Size(x) => vec![*x],
            Shape::Product(x, y) => vec![*x, *y],
            _ => Vec::new(),
        }
    }
}

/// The cubic B-spline with knots at -2, -1, 0, 1, 2.
fn cubic(t: f64) -> f64 {
    let t = t.abs();
    match t {
        t if t < 1.0 => 2.0 / 3.0 - t * t * (1.0 - 0.5 * t),
        t if t < 2.0 => (2.0 - t).powi(3) / 6.0,
        _ => 0.0,
    }
}

/// The unit of an amplitude: the channel's unit divided by the columns' units.
pub fn unit(channel: &str, columns: &[&str]) -> String {
    let (mut above, mut below) = match channel.split_once('/') {
        Some((of, over)) => (vec![of], vec![over]),
        None => (vec![channel], Vec::new()),
    };
    let units: Vec<Cow<str>> = columns.iter().map(|name| unit_of(name)).collect();
    for unit in &units {
        match unit.split_once('/') {
            Some((of, over)) => {
                below.push(of);
                above.push(over);
            }
            None => below.push(unit),
        }
    }
    below.retain(|unit| match above.iter().position(|u| u == unit) {
        Some(same) => {
            above.remove(same);
            false
        }
        None => !unit.is_empty(),
    });
    above.retain(|unit| !unit.is_empty());
    let above = if above.is_empty() {
        "1".to_owned()
    } else {
        above.join(" ")
    };
    match below.as_slice() {
        [] if above == "1" => String::new(),
        [] => above,
        [one] => format!("{above}/{one}"),
        many => format!("{above}/({})", many.join(" ")),
    }
}

/// The unit of a column as a divisor; for a temperature the unit of its differences.
pub fn unit_of(name: &str) -> Cow<'static, str> {
    match kufe::plot::unit_of(name) {
        unit if unit == "deg C" => Cow::Borrowed("K"),
        unit => unit,
    }
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bumps_sum_to_one_between_their_knots() {
        for k in 0..50 {
            let x = f64::from(k) * 0.02;
            let sum: f64 = (-2..=3)
                .map(|j| Shape::Bump(0, f64::from(j), 1.0).value(|_| x))
                .sum();
            assert!((sum - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_formula_as_a_model_has_it_gives_the_same_value() {
        let names = ["v_mps".to_owned(), "runner (left)".to_owned()];
        let at = [-1.7, 0.6];
        for shape in [
            Shape::One,
            Shape::Line(0),
            Shape::Size(0),
            Shape::Power(0, 2.5, 1.5),
            Shape::Exponential(0, -3.0),
            Shape::Step(0, -2.0),
            Shape::Hump(0, -1.0, 0.5),
            Shape::Product(0, 1),
        ] {
            let formula = Expression::parse(&shape.text(&names)).expect("a formula");
            let places: Vec<usize> = formula
                .names()
                .iter()
                .map(|name| names.iter().position(|n| n == name).expect("a column"))
                .collect();
            let value = formula.evaluate(|k| at[places[k]]);
            assert!((value - shape.value(|k| at[k])).abs() < 1e-12, "{shape:?}");
        }
    }

    #[test]
    fn units_of_amplitudes_are_those_of_the_channel_over_the_columns() {
        assert_eq!(unit("", &["pitch_rate_radps"]), "s/rad");
        assert_eq!(unit("N", &["v_mps", "gamma_rad"]), "N s/(m rad)");
        assert_eq!(unit("N m", &[]), "N m");
        assert_eq!(unit("", &[]), "");
        assert_eq!(unit("", &["fz_n"]), "1/N");
        assert_eq!(unit("rad/s", &["v_mps"]), "rad/m");
        assert_eq!(unit("rad", &["t_s"]), "rad/s");
    }
}
