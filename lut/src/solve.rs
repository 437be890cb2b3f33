//! A point and the figures of the contact solved there: one JSON object with a key a coordinate and
//! a figure.

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
            // Adding 0 turns -0 into 0: one key for one point.
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
        let solve = deserializer.deserialize_map(SolveVisitor { figures: false })?;
        Ok(solve.point)
    }
}

/// Reads a solve, or a point without `figures`.
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
        let mut coordinates = Coordinates::default();
        let mut figures = Figures::at_rest([f64::NAN; 6]);
        while let Some(key) = map.next_key::<String>()? {
            let is = |known: &str| key == known;
            if coordinates.read(&key, &mut map)? {
                continue;
            }
            if !self.figures {
                return Err(A::Error::custom(format!("unknown key {key}")));
            }
            if let Some(quantity) = Quantity::ALL.into_iter().find(|q| is(q.key())) {
                let value = map.next_value()?;
                if let Some(expected) = quantity.expectation(value) {
                    let text = format!("{key} = {value}: expected {expected}");
                    return Err(A::Error::custom(text));
                }
                figures = figures.with(quantity, value);
            } else if let Some(quantity) = Quantity::ALL.into_iter().find(|q| is(q.error_key())) {
                let error: f64 = map.next_value()?;
                if let Some(expected) = Quantity::error_expectation(error) {
                    let text = format!("{key} = {error}: expected {expected}");
                    return Err(A::Error::custom(text));
                }
                figures = figures.with_error(quantity, error);
            } else if is("method") {
                figures.method = map.next_value()?;
            } else {
                return Err(A::Error::custom(format!("unknown key {key}")));
            }
        }
        let solve = Solve {
            point: coordinates.point()?,
            figures,
        };
        match figures.not_finite() {
            Some((key, _)) if self.figures => Err(A::Error::custom(format!("missing key {key}"))),
            _ => Ok(solve),
        }
    }
}

/// Coordinates read so far, by kind of axis.
#[derive(Default)]
struct Coordinates([Option<f64>; AxisKind::ALL.len()]);

impl Coordinates {
    /// Reads the value of a key where this is a coordinate's.
    fn read<'de, A: MapAccess<'de>>(&mut self, key: &str, map: &mut A) -> Result<bool, A::Error> {
        let kind = AxisKind::ALL.into_iter().find(|kind| kind.key() == key);
        if let Some(kind) = kind {
            self.0[kind as usize] = Some(map.next_value()?);
        }
        Ok(kind.is_some())
    }

    fn point<E: serde::de::Error>(&self) -> Result<Point, E> {
        for kind in [AxisKind::Fz, AxisKind::Curvature] {
            if self.0[kind as usize].is_none() {
                return Err(E::custom(format!("missing key {}", kind.key())));
            }
        }
        let given = AxisKind::ALL.into_iter().zip(self.0);
        Ok(
            given.fold(Point::default(), |point, (kind, value)| match value {
                Some(value) => point.with(kind, value),
                None => point,
            }),
        )
    }
}
