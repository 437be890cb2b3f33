//! A key whose value is a number or one word.

use std::fmt;

use serde::de::{Error, Unexpected, Visitor};

/// Reads a number, or `None` for the word.
pub(super) struct WordOrNumber {
    /// The word.
    pub word: &'static str,
    /// What the number is.
    pub number: &'static str,
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
