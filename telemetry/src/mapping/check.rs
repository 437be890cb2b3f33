//! What can be said of a mapping before any of its files is read.

use crate::error::Error;
use crate::mapping::file::{ChannelSource, IndexValues, Mapping};
use crate::unit::{column_unit, conversion};

/// Largest number that a key of a mapping takes; far beyond any sensor's.
const LARGEST: f64 = 1e12;

/// Values that `runs.csv` takes: what they may be, as its reader has it.
pub(crate) const INDEX_RANGES: [(&str, f64, f64); 6] = [
    ("ice_c", -60.0, 5.0),
    ("air_c", -60.0, 50.0),
    ("air_pa", 50e3, 110e3),
    ("humidity_pct", 0.0, 100.0),
    ("distance_m", 0.0, 1e8),
    ("mass_kg", 1.0, 1e5),
];

/// Checks names, ranges and units.
///
/// # Errors
/// [`Error::Key`].
pub(crate) fn check(mapping: &Mapping, file: &str) -> Result<(), Error> {
    let wrong = |key: String, found: String, expected: &str| Error::Key {
        file: file.to_string(),
        key,
        found,
        expected: expected.to_string(),
    };
    let within = |key: String, value: Option<f64>, low: f64, high: f64| match value {
        Some(value) if !(low..=high).contains(&value) => Err(wrong(
            key,
            value.to_string(),
            &format!("a number from {low} to {high}"),
        )),
        _ => Ok(()),
    };
    within("rate_hz".into(), Some(mapping.rate_hz), 1.0, 1e4)?;
    let names = mapping
        .logger
        .keys()
        .cloned()
        .collect::<Vec<_>>()
        .join(", ");
    if mapping.logger.is_empty() {
        return Err(wrong(
            "logger".into(),
            "none".into(),
            "at least one table [logger.NAME]",
        ));
    }
    if mapping.channels.is_empty() {
        return Err(wrong(
            "channels".into(),
            "none".into(),
            "at least one column",
        ));
    }
    match &mapping.clock {
        None if mapping.logger.len() > 1 => {
            return Err(wrong(
                "clock".into(),
                "nothing".into(),
                &format!("the logger whose clock the runs keep, one of: {names}"),
            ));
        }
        Some(name) if !mapping.logger.contains_key(name) => {
            return Err(wrong(
                "clock".into(),
                name.clone(),
                &format!("one of: {names}"),
            ));
        }
        _ => {}
    }
    for (name, logger) in &mapping.logger {
        let key = |of: &str| format!("logger.{name}.{of}");
        plain_name(name).ok_or_else(|| wrong("logger".into(), name.clone(), PLAIN))?;
        within(key("rate_hz"), logger.rate_hz, 0.01, 1e6)?;
        within(key("delay_s"), logger.delay_s, -1e9, 1e9)?;
        within(key("largest_delay_s"), logger.largest_delay_s, 0.0, 1e5)?;
        if logger.rate_hz.is_some() && logger.time.is_some() {
            return Err(wrong(
                key("rate_hz"),
                "a rate beside a time channel".into(),
                "one of the two",
            ));
        }
        if logger
            .delimiter
            .is_some_and(|c| ![',', ';', '\t'].contains(&c))
        {
            let found = logger.delimiter.unwrap_or_default().to_string();
            return Err(wrong(
                key("delimiter"),
                found,
                "a comma, a semicolon or a tab",
            ));
        }
        if logger.decimal.is_some_and(|c| !['.', ','].contains(&c)) {
            let found = logger.decimal.unwrap_or_default().to_string();
            return Err(wrong(key("decimal"), found, "a point or a comma"));
        }
        if let Some(unit) = &logger.time_unit {
            conversion(unit, "s")
                .map_err(|reason| wrong(key("time_unit"), unit.clone(), &reason))?;
        }
        for (column, channel) in &logger.also {
            let at = format!("logger.{name}.also.{column}");
            check_channel(&at, column, channel, &names, mapping, &wrong)?;
            within(format!("{at}.delay_s"), channel.delay_s, -60.0, 60.0)?;
            if channel.logger.as_ref().is_some_and(|own| own != name) {
                let found = channel.logger.clone().unwrap_or_default();
                return Err(wrong(
                    format!("{at}.logger"),
                    found,
                    "nothing: it is this logger's",
                ));
            }
        }
    }
    for (column, channel) in &mapping.channels {
        let at = format!("channels.{column}");
        if column == "t_s" {
            return Err(wrong(
                at,
                "a time".into(),
                "logger.NAME.time: times are the loggers'",
            ));
        }
        check_channel(&at, column, channel, &names, mapping, &wrong)?;
        within(format!("{at}.delay_s"), channel.delay_s, -60.0, 60.0)?;
        if channel.logger.is_none() && mapping.logger.len() > 1 {
            return Err(wrong(
                format!("{at}.logger"),
                "nothing".into(),
                &format!("one of: {names}"),
            ));
        }
    }
    let index = |at: &str, values: &IndexValues| {
        for (name, low, high) in INDEX_RANGES {
            within(format!("{at}.{name}"), values.number(name), low, high)?;
        }
        for (place, value) in &values.ice_c_at {
            let key = format!("{at}.ice_c_at");
            place_of(place)
                .ok_or_else(|| wrong(key.clone(), place.clone(), "a place along the track in m"))?;
            let (_, low, high) = INDEX_RANGES[0];
            within(format!("{key}.{place}"), Some(*value), low, high)?;
        }
        Ok(())
    };
    index("index", &mapping.index)?;
    for run in &mapping.run {
        if mapping
            .run
            .iter()
            .filter(|other| other.name == run.name)
            .count()
            > 1
        {
            return Err(wrong(
                "run.name".into(),
                format!("{} twice", run.name),
                "each run once",
            ));
        }
        plain_name(&run.name).ok_or_else(|| wrong("run.name".into(), run.name.clone(), PLAIN))?;
        index(&format!("run {}: index", run.name), &run.index)?;
        let named = run.files.keys().chain(run.delay_s.keys());
        if let Some(unknown) = named
            .into_iter()
            .find(|name| !mapping.logger.contains_key(*name))
        {
            let key = format!("run {}: files or delay_s", run.name);
            return Err(wrong(key, unknown.clone(), &format!("one of: {names}")));
        }
        for (logger, delay) in &run.delay_s {
            within(
                format!("run {}: delay_s.{logger}", run.name),
                Some(*delay),
                -1e9,
                1e9,
            )?;
        }
    }
    Ok(())
}

/// A place along the track [m] as it is written in a name.
pub(crate) fn place_of(text: &str) -> Option<f64> {
    text.parse().ok().filter(|s_m: &f64| s_m.abs() < 1e6)
}

const PLAIN: &str = "letters, digits, '-', '_' and '.', not beginning with a point";

/// A name that may be a file's.
pub(crate) fn plain_name(name: &str) -> Option<&str> {
    let plain = name
        .chars()
        .all(|c| c.is_alphanumeric() || "-_. ".contains(c));
    (plain && !name.is_empty() && !name.starts_with('.') && name.len() <= 120).then_some(name)
}

fn check_channel(
    at: &str,
    column: &str,
    channel: &ChannelSource,
    names: &str,
    mapping: &Mapping,
    wrong: &dyn Fn(String, String, &str) -> Error,
) -> Result<(), Error> {
    let own = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    if !column.chars().all(own) || !column.starts_with(|c: char| c.is_ascii_lowercase()) {
        return Err(wrong(
            at.into(),
            column.into(),
            "small letters, digits and '_'",
        ));
    }
    if let Some(name) = channel
        .logger
        .as_ref()
        .filter(|name| !mapping.logger.contains_key(*name))
    {
        return Err(wrong(
            format!("{at}.logger"),
            name.clone(),
            &format!("one of: {names}"),
        ));
    }
    if let Some(sign) = channel.sign.filter(|sign| sign.abs() != 1.0) {
        return Err(wrong(format!("{at}.sign"), sign.to_string(), "1 or -1"));
    }
    let numbers = [("scale", channel.scale), ("zero", channel.zero)];
    let places = channel
        .place_m
        .into_iter()
        .flatten()
        .map(|x| ("place_m", Some(x / 100.0 * LARGEST)));
    for (name, value) in numbers.into_iter().chain(places) {
        let zero = name == "scale" && value == Some(0.0);
        if value.is_some_and(|value| value.is_nan() || value.abs() > LARGEST || zero) {
            let found = value.unwrap_or_default().to_string();
            return Err(wrong(format!("{at}.{name}"), found, "a number of a sensor"));
        }
    }
    if let Some(unit) = &channel.unit {
        let target = column_unit(column);
        conversion(unit, target).map_err(|reason| {
            let expected = format!("a unit that converts to {target} ({reason})");
            wrong(format!("{at}.unit"), unit.clone(), &expected)
        })?;
    }
    Ok(())
}
