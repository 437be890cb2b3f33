//! One figure of a document: its name and its format.

use std::borrow::Cow;

use crate::plot::{Scale, escape, shown_unit};
use crate::results::Datum;
use crate::results::label::{error_keys, name_of};

/// Largest number of values of a list that are shown unfolded.
const MAX_VALUES: usize = 8;

/// HTML of a number with the unit of this scale.
pub fn with_unit(scale: &Scale, number: &str) -> String {
    let unit = escape(&scale.unit);
    Scale { unit, ..*scale }.with_unit(number)
}

/// A figure of a document.
#[derive(Clone)]
pub struct Entry<'a> {
    /// Name, preceded by the names of the groups that contain it.
    pub name: String,
    /// Key without those of its groups.
    pub key: &'a str,
    /// A number, text, flag or interval, or a list of these.
    pub value: &'a Datum,
    /// Error, if the document states one.
    pub error: Option<f64>,
}

/// The figures of a group and of its subgroups. Tables and empty figures are omitted.
pub fn entries<'a>(figures: impl IntoIterator<Item = (&'a String, &'a Datum)>) -> Vec<Entry<'a>> {
    let mut all = Vec::new();
    collect(&mut all, "", &figures.into_iter().collect::<Vec<_>>());
    all
}

fn collect<'a>(all: &mut Vec<Entry<'a>>, prefix: &str, figures: &[(&'a String, &'a Datum)]) {
    let number_of = |key: &String| {
        let found = figures.iter().find(|(known, _)| *known == key);
        found.and_then(|(_, value)| value.number())
    };
    // The key of a number's error, where the document states one.
    let error_of = |(key, value): &(&String, &Datum)| {
        let keys = error_keys(key).into_iter().filter(|_| is_number(value));
        keys.into_iter().find(|error| number_of(error).is_some())
    };
    let errors: Vec<String> = figures.iter().filter_map(error_of).collect();
    for figure in figures {
        let (key, value) = *figure;
        let name = format!("{prefix}{}", name_of(key));
        match value {
            Datum::Group(inner) if value.interval().is_none() => {
                collect(all, &format!("{name}: "), &inner.iter().collect::<Vec<_>>());
            }
            _ if value.is_empty() || value.is_table() || errors.contains(key) => {}
            _ => all.push(Entry {
                name,
                key,
                value,
                error: error_of(figure).and_then(|error| number_of(&error)),
            }),
        }
    }
}

/// Whether a figure is a number, with or without an interval.
fn is_number(figure: &Datum) -> bool {
    figure.number().is_some() || figure.interval().is_some()
}

impl Entry<'_> {
    /// The numbers of a value, an interval or a list.
    fn numbers(&self) -> Vec<f64> {
        let values = self.value.list().iter().chain([self.value]);
        let interval = self.value.interval().map(|interval| interval.to_vec());
        interval.unwrap_or_else(|| values.filter_map(Datum::number).collect())
    }

    /// Largest magnitude of its numbers; 0 without numbers.
    pub fn largest(&self) -> f64 {
        self.numbers()
            .into_iter()
            .fold(0.0, |max, x| x.abs().max(max))
    }

    /// Whether it is a number, with or without an interval.
    pub fn is_number(&self) -> bool {
        is_number(self.value)
    }

    /// Display unit of its key.
    pub fn unit(&self) -> Cow<'static, str> {
        shown_unit(self.key)
    }

    /// The figure in the display unit that suits its size, as HTML.
    pub fn shown(&self) -> String {
        self.in_unit(&Scale::of(&self.unit(), self.largest()))
    }

    /// The figure with the unit of this scale, as HTML.
    pub fn in_unit(&self, scale: &Scale) -> String {
        let number = self.number(scale);
        if self.numbers().is_empty() {
            return number;
        }
        with_unit(scale, &number)
    }

    /// The figure without its unit, as HTML.
    pub fn number(&self, scale: &Scale) -> String {
        if let Some(interval) = self.value.interval() {
            let [value, low, high] = interval.map(|x| scale.number(x));
            return if low == high {
                value
            } else {
                format!("{value} ({low} to {high})")
            };
        }
        if let Datum::List(values) = self.value {
            let all: Vec<String> = values
                .iter()
                .map(|value| self.single(value, scale))
                .collect();
            let (count, all) = (all.len(), all.join(", "));
            return match count {
                ..=MAX_VALUES => all,
                _ => format!(
                    "<details class=\"values\"><summary>{count} values</summary>{all}</details>"
                ),
            };
        }
        match (self.value.number(), self.error) {
            (Some(value), Some(error)) => scale.with_error(value, error),
            _ => self.single(self.value, scale),
        }
    }

    fn single(&self, value: &Datum, scale: &Scale) -> String {
        match value {
            Datum::Flag(true) => "yes".to_owned(),
            Datum::Flag(false) => "no".to_owned(),
            // A text of such a column is itself the name of a column or key.
            Datum::Text(text) if ["column", "key"].contains(&self.key) => escape(&name_of(text)),
            Datum::Number(number) => scale.number(*number),
            // Large counts and seeds are shown in full.
            other => match other.number() {
                Some(number) if number.abs() < 1e7 || scale.times != 1.0 => scale.number(number),
                _ => escape(&other.to_string()),
            },
        }
    }
}
