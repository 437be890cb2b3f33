//! JSON values, taken apart with the place of what is wrong.

use serde_json::{Map, Value, json};

use crate::error::Error;
use crate::table::solved::{Method, Point};

pub(crate) fn wrong(place: &str, found: &str, expected: &str) -> Error {
    let mut found = found.to_string();
    if found.chars().count() > 120 {
        found = found.chars().take(120).chain("...".chars()).collect();
    }
    Error::Format {
        place: place.into(),
        found,
        expected: expected.into(),
    }
}

pub(crate) fn object<'a>(value: &'a Value, place: &str) -> Result<&'a Map<String, Value>, Error> {
    value
        .as_object()
        .ok_or_else(|| wrong(place, kind(value), "an object"))
}

pub(crate) fn list<'a>(value: &'a Value, place: &str) -> Result<&'a Vec<Value>, Error> {
    value
        .as_array()
        .ok_or_else(|| wrong(place, kind(value), "an array"))
}

pub(crate) fn get<'a>(
    map: &'a Map<String, Value>,
    key: &str,
    place: &str,
) -> Result<&'a Value, Error> {
    map.get(key)
        .ok_or_else(|| wrong(place, "nothing", &format!("the key {key}")))
}

pub(crate) fn text<'a>(map: &'a Map<String, Value>, key: &str) -> Result<&'a str, Error> {
    let value = get(map, key, "the file")?;
    value
        .as_str()
        .ok_or_else(|| wrong(key, kind(value), "a string"))
}

pub(crate) fn read_method(value: &Value, place: &str) -> Result<Method, Error> {
    let method = value.as_str().and_then(Method::named);
    method.ok_or_else(|| {
        let names = Method::ALL.map(Method::name).join(" or ");
        wrong(place, &value.to_string(), &names)
    })
}

pub(crate) fn number(value: &Value, place: &str) -> Result<f64, Error> {
    value
        .as_f64()
        .filter(|value| value.is_finite())
        .ok_or_else(|| wrong(place, &value.to_string(), "a finite number"))
}

pub(crate) fn known(map: &Map<String, Value>, keys: &[&str], place: &str) -> Result<(), Error> {
    match map.keys().find(|key| !keys.contains(&key.as_str())) {
        Some(key) => Err(wrong(
            place,
            &format!("the key {key}"),
            &format!("only {}", keys.join(", ")),
        )),
        None => Ok(()),
    }
}

fn kind(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "true or false",
        Value::Number(_) => "a number",
        Value::String(_) => "a string",
        Value::Array(_) => "an array",
        Value::Object(_) => "an object",
    }
}

pub(crate) fn point_json(point: &Point) -> Value {
    // Adding 0 turns -0 into 0: one straight, one name.
    let pairs = point
        .named()
        .map(|(key, value)| (key.into(), json!(value + 0.0)));
    Value::Object(pairs.collect())
}
