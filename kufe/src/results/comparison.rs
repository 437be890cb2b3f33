//! `comparison.json`: two solved contacts.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::results::contact::ContactResult;
use crate::results::datum::Datum;
use crate::results::quantity::{PeakPressure, QUANTITIES, ResultQuantity};

/// `comparison.json`: two solved contacts, quantity by quantity and place by place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "comparison.json")]
pub struct Comparison {
    /// Folder of the first contact.
    pub first: String,
    /// Folder of the second.
    pub second: String,
    /// The quantities that both have.
    pub quantities: Vec<ComparedQuantity>,
    /// The difference of the pressure maps.
    pub map: MapDifference,
    /// Version of the program.
    pub version: String,
}

/// A quantity of two contacts, in SI units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ComparedQuantity {
    /// Its key in `result.json`.
    pub key: String,
    /// Value of the first contact.
    pub first: f64,
    /// Error of the first value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_error: Option<f64>,
    /// Value of the second contact.
    pub second: f64,
    /// Error of the second value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub second_error: Option<f64>,
    /// The second less the first.
    pub difference: f64,
    /// The sum of both errors.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub difference_error: Option<f64>,
    /// Whether the difference is larger than that sum.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exceeds_errors: Option<bool>,
}

/// The difference of two pressure maps, second less first, on the finer of both grids.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MapDifference {
    /// Size of a pixel along the runner [m].
    pub pixel_x_m: f64,
    /// Size of a pixel across the runner [m].
    pub pixel_y_m: f64,
    /// The difference that is largest in magnitude [Pa].
    pub largest_pa: f64,
    /// Its position along the runner [m].
    pub largest_x_m: f64,
    /// Its position across the runner [m].
    pub largest_y_m: f64,
    /// Root mean square over the pixels that carry load in either map [Pa].
    pub rms_pa: f64,
    /// Redistributed force [N]: half of the integral of the difference's magnitude less the
    /// magnitude of its integral.
    pub moved_n: f64,
}

/// Key of the quantity whose error has several parts.
const PEAK: &str = PeakPressure::DESCRIPTION.key;
/// Fraction of the larger value below which a difference is rounding.
const ROUNDING: f64 = 1e-12;

/// The quantities that both contacts have, the normal force first. The error of the peak pressure
/// is the sum of its parts.
///
/// # Errors
/// Those of a number that cannot be written as JSON.
pub fn compared_quantities(
    first: &ContactResult,
    second: &ContactResult,
) -> serde_json::Result<Vec<ComparedQuantity>> {
    let documents = [Datum::of(first)?, Datum::of(second)?];
    let peaks = [first, second].map(|result| result.p_max.error);
    let number = |k: usize, key: &str| documents[k].group()?.get(key)?.number();
    let row = |key: &str, error_key: &str| {
        let (first, second) = (number(0, key)?, number(1, key)?);
        let [first_error, second_error] = [0, 1].map(|k| match key {
            PEAK => Some(peaks[k]).filter(|error| error.is_finite()),
            _ => number(k, error_key),
        });
        let rounding = ROUNDING * first.abs().max(second.abs());
        let difference = match second - first {
            difference if difference.abs() > rounding => difference,
            _ => 0.0,
        };
        let difference_error = first_error.zip(second_error).map(|(a, b)| a + b);
        Some(ComparedQuantity {
            key: key.to_owned(),
            first,
            first_error,
            second,
            second_error,
            difference,
            difference_error,
            exceeds_errors: difference_error.map(|error| difference.abs() > error),
        })
    };
    let rows = QUANTITIES
        .iter()
        .filter_map(|quantity| row(quantity.key, quantity.error_key));
    Ok(row("fz_n", "").into_iter().chain(rows).collect())
}
