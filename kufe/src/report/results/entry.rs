//! One figure of a document: its name, and how it is written.

use std::borrow::Cow;

use crate::plot::escape;
use crate::report::results::amount::Scale;
use crate::report::results::label::{error_keys, name_of, unit_of};
use crate::results::{Data, Datum};

/// Most values of a list that are shown at once.
const MOST_VALUES: usize = 8;

/// A figure, which may be part of others.
#[derive(Clone)]
pub struct Entry<'a> {
    /// Its name, after the names of what it is part of.
    pub name: String,
    /// Its own key.
    pub key: &'a str,
    /// A number, a word, a flag, an interval or a list of such.
    pub value: &'a Datum,
    /// Its error, where the document states one.
    pub error: Option<f64>,
}

/// The figures of a group, and those of the groups in it after their names; tables and empty
/// figures are omitted.
pub fn entries(figures: &Data) -> Vec<Entry<'_>> {
    let mut all = Vec::new();
    collect(&mut all, "", figures);
    all
}

fn collect<'a>(all: &mut Vec<Entry<'a>>, of: &str, figures: &'a Data) {
    let errors: Vec<(&str, String)> = figures
        .iter()
        .filter(|(_, value)| is_number(value))
        .flat_map(|(key, _)| error_keys(key).map(|error| (key, error)))
        .filter(|(_, error)| figures.get(error).and_then(Datum::number).is_some())
        .collect();
    for (key, value) in figures.iter() {
        let name = format!("{of}{}", name_of(key));
        match value {
            Datum::Group(inner) if value.interval().is_none() => {
                collect(all, &format!("{name}: "), inner);
            }
            _ if value.is_empty() || value.is_table() => {}
            _ if errors.iter().any(|(_, error)| error == key) => {}
            _ => {
                let error = errors.iter().find(|(of, _)| *of == key);
                let error = error.and_then(|(_, error)| figures.get(error)?.number());
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

/// Whether a figure is a number, with or without an interval.
fn is_number(figure: &Datum) -> bool {
    figure.number().is_some() || figure.interval().is_some()
}

impl Entry<'_> {
    /// The size of its largest number; 0 where there is none.
    pub fn largest(&self) -> f64 {
        let size = |value: &Datum| value.number().map_or(0.0, f64::abs);
        match (self.value.interval(), self.value) {
            (Some(numbers), _) => numbers.iter().fold(0.0, |most, x| x.abs().max(most)),
            (None, Datum::List(values)) => values.iter().map(size).fold(0.0, f64::max),
            (None, value) => size(value),
        }
    }

    /// Whether it is a number, with or without an interval.
    pub fn is_number(&self) -> bool {
        is_number(self.value)
    }

    /// The unit that its key ends in.
    pub fn unit(&self) -> Cow<'static, str> {
        unit_of(self.key)
    }

    /// The figure in the unit that suits it, as HTML.
    pub fn shown(&self) -> String {
        self.in_unit(&Scale::of(&self.unit(), self.largest()))
    }

    /// The figure with the unit of this scale, as HTML.
    pub fn in_unit(&self, scale: &Scale) -> String {
        let number = self.number(scale);
        let has_numbers = self.is_number() || self.value.list().iter().any(is_number);
        if !has_numbers || scale.unit.is_empty() {
            return number;
        }
        let unit = escape(&scale.unit);
        // A power of ten is a factor.
        match (unit.starts_with("10"), number.contains(' ')) {
            (false, _) => format!("{number} {unit}"),
            (true, false) => format!("{number} · {unit}"),
            (true, true) => format!("({number}) · {unit}"),
        }
    }

    /// The figure without its unit, as HTML.
    pub fn number(&self, scale: &Scale) -> String {
        if let Some([value, low, high]) = self.value.interval() {
            let [value, low, high] = [value, low, high].map(|x| scale.number(x));
            return if low == high {
                value
            } else {
                format!("{value} ({low} to {high})")
            };
        }
        let single = |value: &Datum| match value {
            Datum::Flag(true) => "yes".to_owned(),
            Datum::Flag(false) => "no".to_owned(),
            // A text of such a column is itself the name of a column or key.
            Datum::Text(text) if ["column", "key"].contains(&self.key) => escape(&name_of(text)),
            other => match other.number() {
                // Counts and seeds that are longer than a number's digits are shown in full.
                Some(number)
                    if matches!(other, Datum::Number(_))
                        || number.abs() < 1e7
                        || scale.times != 1.0 =>
                {
                    scale.number(number)
                }
                _ => escape(&other.to_string()),
            },
        };
        let Datum::List(values) = self.value else {
            let Some(error) = self.error else {
                return single(self.value);
            };
            let exceeded = |value: &f64| error.is_finite() && value.abs() < error;
            let value = match self.value.number().filter(exceeded) {
                Some(value) => scale.uncertain(value, error),
                None => single(self.value),
            };
            return format!("{value} ± {}", scale.error(error));
        };
        let all = values.iter().map(single).collect::<Vec<_>>().join(", ");
        match values.len() {
            ..=MOST_VALUES => all,
            count => format!(
                "<details class=\"values\"><summary>{count} values</summary>{all}</details>"
            ),
        }
    }
}
