//! Estimates with intervals, and response surfaces for minimisation of an expensive function.

use nalgebra::{DMatrix, DVector};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::error::{Error, in_range};

/// Bounds of a parameter on a logarithmic scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    low: f64,
    high: f64,
}

impl Span {
    /// From `low` to `high`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a lower bound that is not positive, and for an upper bound that is
    /// not above it.
    pub fn new(low: f64, high: f64) -> Result<Self, Error> {
        in_range("lower bound", low, low > 0.0, "a positive number")?;
        let expected = "a number above the lower bound";
        in_range("upper bound", high, high > low, expected)?;
        Ok(Span { low, high })
    }

    /// The bounds.
    pub fn bounds(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// The value at `u`, -1 at the lower bound and 1 at the upper one.
    fn value(&self, u: f64) -> f64 {
        match u {
            -1.0 => self.low,
            1.0 => self.high,
            u => self.low * (self.high / self.low).powf(0.5 * (1.0 + u)),
        }
    }

    fn coordinate(&self, value: f64) -> f64 {
        2.0 * (value / self.low).ln() / (self.high / self.low).ln() - 1.0
    }
}

/// A response surface: a smooth approximation of values with scatter.
///
/// The logarithm of the response is a polynomial of degree 4 in the logarithms of the parameters,
/// fitted by least squares at Chebyshev points that include the bounds: 5 coefficients to 7 points
/// of one parameter, 15 coefficients to 25 points of two. A scatter of some thousandths between
/// meshes would mislead a search from point to point; the surface averages it, and the residual
/// measures it.
#[derive(Clone, Debug)]
pub struct Response {
    spans: Vec<Span>,
    coefficients: DVector<f64>,
    misfit: f64,
}

const DEGREE: i32 = 4;
/// Grid intervals of a parameter in a scan of the surface.
const SCAN: usize = 400;

impl Response {
    /// Points at which the response is to be evaluated; the first parameter varies fastest.
    ///
    /// # Panics
    /// Panics unless there are one or two spans.
    pub fn places(spans: &[Span]) -> Vec<Vec<f64>> {
        let chebyshev = |n: usize| {
            let at = |k: usize| -(std::f64::consts::PI * k as f64 / (n - 1) as f64).cos();
            (0..n).map(at).collect::<Vec<f64>>()
        };
        match spans {
            [span] => chebyshev(7).iter().map(|&u| vec![span.value(u)]).collect(),
            [first, second] => {
                let row = |v: f64| chebyshev(5).into_iter().map(move |u| (u, v));
                let pairs = chebyshev(5).into_iter().flat_map(row);
                let place = |(u, v)| vec![first.value(u), second.value(v)];
                pairs.map(place).collect()
            }
            _ => panic!("{} parameters, expected one or two", spans.len()),
        }
    }

    /// The surface through `values` at [`places`](Self::places).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a value that is not positive, [`Error::TooFew`] if the number of
    /// values is not that of the points.
    pub fn fit(spans: &[Span], values: &[f64]) -> Result<Self, Error> {
        let places = Self::places(spans);
        if places.len() != values.len() {
            let what = "values of a response";
            return Err(Error::too_few(what, values.len(), places.len()));
        }
        for &value in values {
            in_range("response", value, value > 0.0, "a positive number")?;
        }
        let row = |place: &Vec<f64>| terms(&scaled(spans, place));
        let rows: Vec<Vec<f64>> = places.iter().map(row).collect();
        let design = DMatrix::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j]);
        let logarithms = DVector::from_fn(values.len(), |i, _| values[i].ln());
        let solved = design.clone().svd(true, true).solve(&logarithms, 1e-12);
        let coefficients = solved.map_err(|_| Error::Undetermined {
            what: "response",
            ratio: 0.0,
        })?;
        let residual = (design * &coefficients - logarithms).norm_squared();
        let freedom = (values.len() - coefficients.len()) as f64;
        Ok(Response {
            spans: spans.to_vec(),
            coefficients,
            misfit: (residual / freedom).sqrt(),
        })
    }

    /// Relative scatter of the values about the surface: standard deviation of the logarithms'
    /// residuals.
    pub fn misfit(&self) -> f64 {
        self.misfit
    }

    /// The surface at a point.
    pub fn at(&self, place: &[f64]) -> f64 {
        self.logarithm(&scaled(&self.spans, place)).exp()
    }

    /// The minimum of the surface within the bounds.
    pub fn least(&self) -> Vec<f64> {
        let lowest = self.scan().min_by(|a, b| a.1.total_cmp(&b.1));
        let lowest = lowest.map_or_else(Vec::new, |(u, _)| u);
        let pairs = self.spans.iter().zip(lowest);
        pairs.map(|(span, u)| span.value(u)).collect()
    }

    /// Range of each parameter over all points at which the surface exceeds its minimum by at most
    /// the relative amount `share`.
    pub fn flat(&self, share: f64) -> Vec<[f64; 2]> {
        let values = self.scan().map(|(_, value)| value);
        let least = values.fold(f64::INFINITY, f64::min);
        let mut flat = vec![[f64::INFINITY, f64::NEG_INFINITY]; self.spans.len()];
        for (u, _) in self.scan().filter(|(_, v)| *v <= least + share.ln_1p()) {
            for (range, u) in flat.iter_mut().zip(u) {
                *range = [range[0].min(u), range[1].max(u)];
            }
        }
        let ranges = flat.iter().zip(&self.spans);
        let values = ranges.map(|(range, span)| range.map(|u| span.value(u)));
        values.collect()
    }

    /// Scaled points of an even grid with the logarithm of the surface.
    fn scan(&self) -> impl Iterator<Item = (Vec<f64>, f64)> + '_ {
        let u = |k: usize| 2.0 * k as f64 / SCAN as f64 - 1.0;
        let two = self.spans.len() == 2;
        (0..=if two { SCAN } else { 0 }).flat_map(move |l| {
            (0..=SCAN).map(move |k| {
                let place = if two { vec![u(k), u(l)] } else { vec![u(k)] };
                let value = self.logarithm(&place);
                (place, value)
            })
        })
    }

    fn logarithm(&self, u: &[f64]) -> f64 {
        let terms = terms(u);
        let products = terms.iter().zip(&self.coefficients).map(|(t, c)| t * c);
        products.sum()
    }
}

fn scaled(spans: &[Span], place: &[f64]) -> Vec<f64> {
    let pairs = spans.iter().zip(place);
    pairs.map(|(span, &value)| span.coordinate(value)).collect()
}

/// Monomials of one or two scaled parameters up to the total degree.
fn terms(u: &[f64]) -> Vec<f64> {
    match *u {
        [u] => (0..=DEGREE).map(|k| u.powi(k)).collect(),
        [u, v] => (0..=DEGREE)
            .flat_map(|l| (0..=DEGREE - l).map(move |k| u.powi(k) * v.powi(l)))
            .collect(),
        _ => Vec::new(),
    }
}

/// An estimate with its confidence interval.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Estimate {
    /// Best value.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

impl Estimate {
    /// The interval `value` +- `half`.
    pub(crate) fn about(value: f64, half: f64) -> Self {
        Estimate {
            value,
            low: value - half,
            high: value + half,
        }
    }

    /// Whether the interval covers `value`.
    pub fn covers(&self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }
}

/// Two-sided quantile of Student's t.
pub(crate) fn student_quantile(confidence: f64, freedom: usize) -> f64 {
    match StudentsT::new(0.0, 1.0, freedom.max(1) as f64) {
        Ok(distribution) => distribution.inverse_cdf(0.5 + 0.5 * confidence),
        Err(_) => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// exp(k (ln x/x0)^2) is within a share s of its least value for |ln x/x0| up to sqrt(ln(1 +
    /// s)/k).
    #[test]
    fn a_valley_has_its_bottom_and_its_width() -> Result<(), Error> {
        let spans = [Span::new(15.0, 60.0)?];
        let valley = |place: &[f64]| 3e-3 * (0.2 * (place[0] / 25.0).ln().powi(2)).exp();
        let values: Vec<f64> = Response::places(&spans).iter().map(|p| valley(p)).collect();
        let response = Response::fit(&spans, &values)?;
        let step = (60.0f64 / 15.0).ln() / SCAN as f64;
        assert!((response.least()[0] / 25.0).ln().abs() <= step);
        assert!(response.misfit() < 1e-12);
        let half = ((0.01f64).ln_1p() / 0.2).sqrt();
        for (found, exact) in response.flat(0.01)[0].iter().zip([-half, half]) {
            assert!(((found / 25.0).ln() - exact).abs() < 1.5 * step, "{found}");
        }
        assert!((response.at(&[40.0]) / valley(&[40.0]) - 1.0).abs() < 1e-12);
        Ok(())
    }

    #[test]
    fn a_slope_is_lowest_on_its_bound_and_scatter_is_told() -> Result<(), Error> {
        let spans = [Span::new(15.0, 60.0)?, Span::new(0.003, 0.008)?];
        let places = Response::places(&spans);
        let scatter = |k: usize| 1.0 + 3e-3 * if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let slope = |(k, p): (usize, &Vec<f64>)| {
            let valley = (p[0] / 30.0).ln().powi(2) + 0.1 * (p[0] / 30.0).ln() * p[1].ln();
            scatter(k) * 1e-3 * valley.exp() * p[1].powf(-0.3)
        };
        let values: Vec<f64> = places.iter().enumerate().map(slope).collect();
        let response = Response::fit(&spans, &values)?;
        let [rocker, section] = response.least()[..] else {
            panic!("two parameters");
        };
        assert_eq!(section, 0.008);
        let exact = 30.0 * (-0.05 * (0.008f64).ln()).exp();
        assert!((rocker / exact).ln().abs() < 0.02, "{rocker} {exact}");
        assert!((2e-3..5e-3).contains(&response.misfit()));
        Ok(())
    }

    #[test]
    fn bounds_and_values_that_cannot_be_are_refused() {
        for (low, high) in [
            (0.0, 1.0),
            (2.0, 1.0),
            (1.0, f64::NAN),
            (1.0, f64::INFINITY),
        ] {
            assert!(Span::new(low, high).is_err(), "{low} {high}");
        }
        let spans = [Span {
            low: 1.0,
            high: 2.0,
        }];
        assert!(Response::fit(&spans, &[1.0; 6]).is_err());
        assert!(Response::fit(&spans, &[-1.0; 7]).is_err());
    }
}
