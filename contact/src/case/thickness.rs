//! `thickness_m`: a number or the word "half-space".

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// How deep the ice is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Thickness {
    /// Ice without end, written `"half-space"`.
    HalfSpace,
    /// A layer on a rigid bed [m].
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
        deserializer.deserialize_any(ThicknessVisitor)
    }
}

impl JsonSchema for Thickness {
    fn schema_name() -> Cow<'static, str> {
        "Thickness".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "Thickness on a rigid bed [m], or ice without end.",
            "anyOf": [{ "type": "number" }, { "const": WORD }],
        })
    }
}

struct ThicknessVisitor;

impl Visitor<'_> for ThicknessVisitor {
    type Value = Thickness;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a thickness in metres or \"{WORD}\"")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Thickness, E> {
        Ok(Thickness::Layer(value))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Thickness, E> {
        Ok(Thickness::Layer(value as f64))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Thickness, E> {
        Ok(Thickness::Layer(value as f64))
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<Thickness, E> {
        if value == WORD {
            Ok(Thickness::HalfSpace)
        } else {
            Err(E::invalid_value(Unexpected::Str(value), &self))
        }
    }
}
