//! `hardness_pa`: a number or the words "from-temperature".

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::word_or_number::WordOrNumber;
use crate::case::check::range::Range;

/// The largest pressure that the ice bears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hardness {
    /// Of the ice's temperature, written `"from-temperature"`.
    FromTemperature,
    /// A stated one [Pa].
    Stated(f64),
}

const WORD: &str = "from-temperature";

impl Serialize for Hardness {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Hardness::FromTemperature => serializer.serialize_str(WORD),
            Hardness::Stated(pressure) => serializer.serialize_f64(*pressure),
        }
    }
}

impl<'de> Deserialize<'de> for Hardness {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let read = deserializer.deserialize_any(WordOrNumber {
            word: WORD,
            number: "a pressure in pascals",
        })?;
        Ok(read.map_or(Hardness::FromTemperature, Hardness::Stated))
    }
}

impl JsonSchema for Hardness {
    fn schema_name() -> Cow<'static, str> {
        "Hardness".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let range = Range::of("ice.hardness_pa");
        json_schema!({
            "description": "Largest pressure that the ice bears [Pa], or that of its temperature.",
            "anyOf": [{ "type": "number", "minimum": range.low, "maximum": range.high }, { "const": WORD }],
        })
    }
}
