//! A point and the figures of the contact solved there, as a JSON object with one key per
//! coordinate and figure.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error as _, MapAccess, Visitor};
use serde::ser::{Serialize, SerializeMap, Serializer};

use crate::axes::{AxisKind, Point};
use crate::quantity::{Figures, Quantity};

/// A point and the figures of the contact solved there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solve {
    /// The point.
    pub point: Point,
    /// The figures.
    pub figures: Figures,
}

impl Serialize for Point {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for (key, value) in self.named() {
            // Adding 0 turns -0 into 0, so that equal points have equal text.
            map.serialize_entry(key, &(value + 0.0))?;
        }
        map.end()
    }
}

impl Serialize for Solve {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for (key, value) in self.point.named() {
            map.serialize_entry(key, &(value + 0.0))?;
        }
        for quantity in Quantity::ALL {
            if let Some(value) = self.figures.get(quantity) {
                map.serialize_entry(quantity.key(), &value)?;
            }
            if let Some(error) = self.figures.error(quantity) {
                map.serialize_entry(quantity.error_key(), &error)?;
            }
        }
        if !self.figures.method.is_default() {
            map.serialize_entry("method", &self.figures.method)?;
        }
        map.end()
    }
}

impl<'de> Deserialize<'de> for Solve {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(SolveVisitor { figures: true })
    }
}

impl<'de> Deserialize<'de> for Point {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let read = deserializer.deserialize_map(SolveVisitor { figures: false });
        read.map(|solve| solve.point)
    }
}

/// Reads a solve, or only a point if `figures` is false.
struct SolveVisitor {
    figures: bool,
}

impl<'de> Visitor<'de> for SolveVisitor {
    type Value = Solve;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let figures = if self.figures { " and figures" } else { "" };
        write!(f, "an object with the coordinates{figures} of a point")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Solve, A::Error> {
        let refused = |text: String| Err(A::Error::custom(text));
        let mut coordinates: [Option<f64>; AxisKind::ALL.len()] = Default::default();
        let mut figures = Figures::at_rest([f64::NAN; 6]);
        while let Some(key) = map.next_key::<String>()? {
            let mut kinds = AxisKind::ALL.into_iter();
            if let Some(kind) = kinds.find(|kind| kind.key() == key) {
                coordinates[kind as usize] = Some(map.next_value()?);
            } else if !self.figures {
                return refused(format!("unknown key {key}"));
            } else if key == "method" {
                figures.method = map.next_value()?;
            } else if let Some((quantity, is_error)) = Quantity::from_key(&key) {
                let value = map.next_value()?;
                let expected = if is_error {
                    figures = figures.with_error(quantity, value);
                    Quantity::error_expectation(value)
                } else {
                    figures = figures.with(quantity, value);
                    quantity.expectation(value)
                };
                if let Some(expected) = expected {
                    return refused(format!("{key} = {value}: expected {expected}"));
                }
            } else {
                return refused(format!("unknown key {key}"));
            }
        }
        let mut point = Point::default();
        for (kind, value) in AxisKind::ALL.into_iter().zip(coordinates) {
            match value {
                Some(value) => point = point.with(kind, value),
                None if kind > AxisKind::Curvature => {}
                None => return refused(format!("missing key {}", kind.key())),
            }
        }
        match figures.not_finite() {
            Some((key, _)) if self.figures => refused(format!("missing key {key}")),
            _ => Ok(Solve { point, figures }),
        }
    }
}
