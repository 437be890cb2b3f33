//! A channel's values in its column's unit.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use crate::error::Error;
use crate::mapping::ChannelSource;
use crate::source::Channel;
use crate::unit::{Conversion, column_unit, conversion};

/// Conversions that were asked for, each once.
#[derive(Debug, Default)]
pub(crate) struct Conversions(Mutex<BTreeMap<(String, String), Result<Conversion, String>>>);

impl Conversions {
    /// As [`conversion`].
    pub fn of(&self, unit: &str, target: &str) -> Result<Conversion, String> {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let key = (unit.to_string(), target.to_string());
        known
            .entry(key)
            .or_insert_with(|| conversion(unit, target))
            .clone()
    }
}

/// How a channel becomes a column.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Recipe {
    pub unit: String,
    pub unit_from: &'static str,
    pub factor: f64,
    pub offset: f64,
}

/// `sign * unit(scale * (value - zero))` as one factor and one offset.
///
/// # Errors
/// [`Error::Channel`] where neither mapping nor file state a unit that converts.
pub(crate) fn recipe(
    column: &str,
    source: &ChannelSource,
    channel: &Channel,
    units: &Conversions,
    file: &str,
) -> Result<Recipe, Error> {
    let target = column_unit(column);
    let (unit, unit_from) = match (&source.unit, &channel.unit) {
        (Some(unit), _) => (unit.clone(), "mapping"),
        (None, Some(unit)) => (unit.clone(), "file"),
        // A pure number needs no unit.
        (None, None) if target == "1" => (String::new(), "mapping"),
        (None, None) => {
            return Err(Error::Channel {
                file: file.to_string(),
                channel: source.from.clone(),
                found: "no unit".to_string(),
                expected: format!(
                    "channels.{column}.unit in the mapping, a unit that converts to {target}"
                ),
            });
        }
    };
    let unit_of = units.of(&unit, target).map_err(|reason| Error::Channel {
        file: file.to_string(),
        channel: source.from.clone(),
        found: format!("unit {unit:?}"),
        expected: format!("a unit that converts to {target} ({reason}); channels.{column}.unit in the mapping stands before it"),
    })?;
    let sign = source.sign.unwrap_or(1.0);
    let scale = source.scale.unwrap_or(1.0);
    let zero = source.zero.unwrap_or(0.0);
    let factor = sign * unit_of.factor * scale;
    Ok(Recipe {
        unit,
        unit_from,
        factor,
        // Not -0, which an offset of no unit would give.
        offset: 0.0 + sign * unit_of.offset - factor * zero,
    })
}
