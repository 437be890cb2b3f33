//! `thickness_m`: a number or the word "half-space".

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::word_or_number::WordOrNumber;
use crate::case::check::range::Range;

/// How deep the ice is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Thickness {
    /// Ice without end, written `"half-space"`.
    HalfSpace,
    /// A layer on its bed [m].
    Layer(f64),
}

const WORD: &str = "half-space";

impl Serialize for Thickness {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Thickness::HalfSpace => serializer.serialize_str(WORD),
            Thickness::Layer(thickness) => serializer.serialize_f64(*thickness),
        }
    }
}

impl<'de> Deserialize<'de> for Thickness {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let read = deserializer.deserialize_any(WordOrNumber {
            word: WORD,
            number: "a thickness in metres",
        })?;
        Ok(read.map_or(Thickness::HalfSpace, Thickness::Layer))
    }
}

impl JsonSchema for Thickness {
    fn schema_name() -> Cow<'static, str> {
        "Thickness".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let range = Range::of("ice.thickness_m");
        json_schema!({
            "description": "Thickness on its bed [m], or ice without end.",
            "anyOf": [{ "type": "number", "minimum": range.low, "maximum": range.high }, { "const": WORD }],
        })
    }
}
