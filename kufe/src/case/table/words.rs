//! Values that are a number or a word.

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::case::check::range::Range;

/// The largest pressure that the ice bears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hardness {
    /// Of the ice's temperature, written `"from-temperature"`.
    FromTemperature,
    /// A stated one [Pa].
    Stated(f64),
}

/// How deep the ice is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Thickness {
    /// Ice without end, written `"half-space"`.
    HalfSpace,
    /// A layer on its bed [m].
    Layer(f64),
}

/// Reads and writes `$name` as the word of its variant `$of_word` or the number of `$of_number`,
/// with the range of `$key`.
macro_rules! word_or_number {
    ($name:ident, $of_word:ident = $word:literal, $of_number:ident = $number:literal, $key:literal, $description:literal) => {
        impl Serialize for $name {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                match self {
                    $name::$of_word => serializer.serialize_str($word),
                    $name::$of_number(value) => serializer.serialize_f64(*value),
                }
            }
        }

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let read = deserializer.deserialize_any(WordOrNumber {
                    word: $word,
                    number: $number,
                })?;
                Ok(read.map_or($name::$of_word, $name::$of_number))
            }
        }

        impl JsonSchema for $name {
            fn schema_name() -> Cow<'static, str> {
                stringify!($name).into()
            }

            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                let range = Range::of($key);
                json_schema!({
                    "description": $description,
                    "anyOf": [
                        { "type": "number", "minimum": range.low, "maximum": range.high },
                        { "const": $word },
                    ],
                })
            }
        }
    };
}

word_or_number!(
    Hardness,
    FromTemperature = "from-temperature",
    Stated = "a pressure in pascals",
    "ice.hardness_pa",
    "Largest pressure that the ice bears [Pa], or that of its temperature."
);
word_or_number!(
    Thickness,
    HalfSpace = "half-space",
    Layer = "a thickness in metres",
    "ice.thickness_m",
    "Thickness on its bed [m], or ice without end."
);

/// Reads a number, or `None` for the word.
struct WordOrNumber {
    word: &'static str,
    /// What the number is.
    number: &'static str,
}

impl Visitor<'_> for WordOrNumber {
    type Value = Option<f64>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} or \"{}\"", self.number, self.word)
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Option<f64>, E> {
        Ok(Some(value))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Option<f64>, E> {
        Ok(Some(value as f64))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Option<f64>, E> {
        Ok(Some(value as f64))
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<Option<f64>, E> {
        if value == self.word {
            Ok(None)
        } else {
            Err(E::invalid_value(Unexpected::Str(value), &self))
        }
    }
}
