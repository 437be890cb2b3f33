//! One figure of a document: what it is called, and how it is written.

use std::borrow::Cow;

use serde_json::{Map, Value};

use crate::report::page::escape;
use crate::report::results::amount::Scale;
use crate::report::results::label::{error_keys, name_of, unit_of};

/// Most values of a list that are shown without being asked for.
const MOST_VALUES: usize = 8;

/// A figure, which may stand within others.
#[derive(Clone)]
pub struct Entry<'a> {
    /// What it is called, with what it is part of before it.
    pub name: String,
    /// Its own key.
    pub key: &'a str,
    /// A number, a word, a flag, an interval or a list of such.
    pub value: &'a Value,
    /// Its error, where one stands beside it.
    pub error: Option<f64>,
}

/// The figures of an object, those of what it holds after their names; tables within it and what is empty are left out.
pub fn entries(fields: &Map<String, Value>) -> Vec<Entry<'_>> {
    let mut all = Vec::new();
    collect(&mut all, "", fields);
    all
}

fn collect<'a>(all: &mut Vec<Entry<'a>>, of: &str, fields: &'a Map<String, Value>) {
    let errors: Vec<(&str, String)> = fields
        .iter()
        .filter(|(_, value)| value.is_number() || interval(value).is_some())
        .flat_map(|(key, _)| error_keys(key).map(|error| (key.as_str(), error)))
        .filter(|(_, error)| fields.get(error).is_some_and(Value::is_number))
        .collect();
    for (key, value) in fields {
        let name = format!("{of}{}", name_of(key));
        match value {
            Value::Object(inner) if interval(value).is_none() => {
                collect(all, &format!("{name}: "), inner);
            }
            _ if is_empty(value) || is_table(value) => {}
            _ if errors.iter().any(|(_, error)| error == key) => {}
            _ => {
                let error = errors.iter().find(|(of, _)| of == key);
                let error = error.and_then(|(_, error)| fields[error].as_f64());
                all.push(Entry {
                    name,
                    key,
                    value,
                    error,
                });
            }
        }
    }
}

/// Whether a value says nothing.
pub fn is_empty(value: &Value) -> bool {
    match value {
        Value::Null => true,
        Value::String(text) => text.is_empty(),
        Value::Array(values) => values.is_empty(),
        Value::Object(fields) => fields.is_empty(),
        _ => false,
    }
}

/// Whether a value is rows of a table.
pub fn is_table(value: &Value) -> bool {
    let rows = value.as_array();
    rows.is_some_and(|rows| rows.iter().any(Value::is_object))
}

/// A value with the ends of its interval.
fn interval(value: &Value) -> Option<[f64; 3]> {
    let fields = value.as_object().filter(|fields| fields.len() == 3)?;
    let number = |key: &str| fields.get(key)?.as_f64();
    Some([number("value")?, number("low")?, number("high")?])
}

impl Entry<'_> {
    /// The size of its largest number; 0 where it holds none.
    pub fn largest(&self) -> f64 {
        let size = |value: &Value| value.as_f64().map_or(0.0, f64::abs);
        match (interval(self.value), self.value) {
            (Some(numbers), _) => numbers.iter().fold(0.0, |most, x| x.abs().max(most)),
            (None, Value::Array(values)) => values.iter().map(size).fold(0.0, f64::max),
            (None, value) => size(value),
        }
    }

    /// Whether it is a number, with or without an interval.
    pub fn is_number(&self) -> bool {
        self.value.is_number() || interval(self.value).is_some()
    }

    /// The unit that its key ends in.
    pub fn unit(&self) -> Cow<'static, str> {
        unit_of(self.key)
    }

    /// The figure with the unit of this scale, as HTML.
    pub fn in_unit(&self, scale: &Scale) -> String {
        let numbers = match self.value {
            Value::Array(values) => values.iter().any(Value::is_number),
            _ => self.is_number(),
        };
        let number = self.number(scale);
        match (numbers, &*scale.unit) {
            (false, _) | (_, "") => number,
            // A power of ten is a factor.
            (_, power) if power.starts_with("10") && number.contains(' ') => {
                format!("({number}) · {}", escape(power))
            }
            (_, power) if power.starts_with("10") => format!("{number} · {}", escape(power)),
            (_, unit) => format!("{number} {}", escape(unit)),
        }
    }

    /// The figure without its unit, as HTML.
    pub fn number(&self, scale: &Scale) -> String {
        if let Some([value, low, high]) = interval(self.value) {
            let [value, low, high] = [value, low, high].map(|x| scale.number(x));
            return match low == high {
                true => value,
                false => format!("{value} ({low} to {high})"),
            };
        }
        let error = self.error.map(|error| format!(" ± {}", scale.error(error)));
        let single = |value: &Value| match value {
            Value::Bool(truth) => if *truth { "yes" } else { "no" }.to_owned(),
            // Counts and seeds that are longer than a number's digits stay whole.
            Value::Number(count)
                if count.as_f64().is_some_and(|x| x.abs() >= 1e7)
                    && scale.times == 1.0
                    && !count.is_f64() =>
            {
                count.to_string()
            }
            Value::Number(number) => scale.number(number.as_f64().unwrap_or(f64::NAN)),
            // What stands in a column of names is a column or a key itself.
            Value::String(text) if ["column", "key"].contains(&self.key) => escape(&name_of(text)),
            Value::String(text) => escape(text),
            other => escape(&other.to_string()),
        };
        match self.value {
            Value::Array(values) => {
                let all = values.iter().map(single).collect::<Vec<_>>().join(", ");
                match values.len() {
                    ..=MOST_VALUES => all,
                    count => format!(
                        "<details class=\"values\"><summary>{count} values</summary>{all}</details>"
                    ),
                }
            }
            value => single(value) + &error.unwrap_or_default(),
        }
    }
}
