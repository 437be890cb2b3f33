//! Any document as a tree of data, for tables, pages and summaries of results.

use std::fmt;

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

/// Keys that a summary shows in full.
const SHOWN_IN_FULL: [&str; 3] = ["case", "warnings", "remarks"];
/// Keys that a summary omits: they concern files.
const OMITTED: [&str; 3] = ["version", "content_sha256", "files"];

/// A datum of a document: a single value, a list or a group.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Datum {
    /// No value: null in JSON.
    Absent(()),
    /// True or false.
    Flag(bool),
    /// An integer.
    Whole(i64),
    /// An integer above the range of [`Whole`](Self::Whole).
    Large(u64),
    /// Any other number.
    Number(f64),
    /// A string.
    Text(String),
    /// A list of data.
    List(Vec<Datum>),
    /// Data by key.
    Group(Data),
}

impl Default for Datum {
    fn default() -> Self {
        Datum::Group(Data::default())
    }
}

/// Data with their keys, in the order of the document.
pub type Data = IndexMap<String, Datum>;

impl Datum {
    /// The data of a document.
    ///
    /// # Errors
    /// Those of a document that cannot be written as JSON.
    pub fn of(document: &impl Serialize) -> serde_json::Result<Datum> {
        // The pretty form is also used for printing: one form halves the compiled code.
        serde_json::from_str(&serde_json::to_string_pretty(document)?)
    }

    /// The number; `None` for other data.
    pub fn number(&self) -> Option<f64> {
        match *self {
            Datum::Whole(number) => Some(number as f64),
            Datum::Large(number) => Some(number as f64),
            Datum::Number(number) => Some(number),
            _ => None,
        }
    }

    /// The string; `None` for other data.
    pub fn text(&self) -> Option<&str> {
        match self {
            Datum::Text(text) => Some(text),
            _ => None,
        }
    }

    /// The data of a list; empty for other data.
    pub fn list(&self) -> &[Datum] {
        match self {
            Datum::List(list) => list,
            _ => &[],
        }
    }

    /// The data by key; `None` if it is not a group.
    pub fn group(&self) -> Option<&Data> {
        match self {
            Datum::Group(data) => Some(data),
            _ => None,
        }
    }

    /// Whether it is neither a list nor a group.
    pub fn is_single(&self) -> bool {
        !matches!(self, Datum::List(_) | Datum::Group(_))
    }

    /// Whether it is a table: a list that contains groups.
    pub fn is_table(&self) -> bool {
        self.list().iter().any(|row| row.group().is_some())
    }

    /// Whether it contains nothing.
    pub fn is_empty(&self) -> bool {
        match self {
            Datum::Absent(()) => true,
            Datum::Text(text) => text.is_empty(),
            Datum::List(list) => list.is_empty(),
            Datum::Group(data) => data.is_empty(),
            _ => false,
        }
    }

    /// A value with the ends of its interval: a group of `value`, `low` and `high` alone.
    pub fn interval(&self) -> Option<[f64; 3]> {
        let data = self.group().filter(|data| data.len() == 3)?;
        let number = |key: &str| data.get(key)?.number();
        Some([number("value")?, number("low")?, number("high")?])
    }

    /// Removes the elastic constants of rigid runners, which have no effect, from every case in it.
    #[must_use]
    pub fn effective(self) -> Datum {
        match self {
            Datum::List(list) => Datum::List(list.into_iter().map(Datum::effective).collect()),
            Datum::Group(mut data) => {
                if data.get("elastic") == Some(&Datum::Flag(false)) {
                    data.retain(|key, _| {
                        !["youngs_modulus_pa", "poissons_ratio"].contains(&&**key)
                    });
                }
                let data = data.into_iter();
                Datum::Group(data.map(|(key, datum)| (key, datum.effective())).collect())
            }
            single => single,
        }
    }

    /// The main data of a document: single values, the lengths of long lists, and of groups the
    /// single values and the values with intervals; case, warnings and remarks in full.
    pub fn summary(self) -> Data {
        let entries = |count: usize| {
            let plural = if count == 1 { "entry" } else { "entries" };
            Datum::Text(format!("{count} {plural}"))
        };
        let Datum::Group(mut data) = self else {
            let rows = Datum::Whole(self.list().len() as i64);
            return Data::from([("rows".to_owned(), rows)]);
        };
        data.retain(|key, _| !OMITTED.contains(&&**key));
        for (_, datum) in data
            .iter_mut()
            .filter(|(key, _)| !SHOWN_IN_FULL.contains(&&***key))
        {
            let count = match datum {
                Datum::List(list) if list.len() > 3 || !list.iter().all(Datum::is_single) => {
                    list.len()
                }
                Datum::Group(main) => {
                    let count = main.len();
                    main.retain(|_, datum| match datum {
                        Datum::Group(data) => data.contains_key("value"),
                        other => other.is_single(),
                    });
                    if !main.is_empty() {
                        continue;
                    }
                    count
                }
                _ => continue,
            };
            *datum = entries(count);
        }
        data
    }
}

/// Single data as in a text table; others as JSON.
impl fmt::Display for Datum {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Datum::Absent(()) => Ok(()),
            Datum::Text(text) => f.write_str(text),
            other => f.write_str(&serde_json::to_string(other).unwrap_or_default()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_document_is_read_in_order_and_written_as_it_was() {
        let text = r#"{"z":1.5,"a":[1,-2,18446744073709551615],"n":null,"t":"x","of":{"y":true,"b":0.25}}"#;
        let data: Datum = serde_json::from_str(text).expect("data");
        assert_eq!(serde_json::to_string(&data).expect("JSON"), text);
        let keys: Vec<&String> = data.group().expect("a group").keys().collect();
        assert_eq!(keys, ["z", "a", "n", "t", "of"]);
    }

    #[test]
    fn constants_of_a_rigid_runner_are_removed_and_no_others() {
        let text =
            r#"[{"elastic":false,"poissons_ratio":0.3},{"elastic":true,"poissons_ratio":0.3}]"#;
        let data: Datum = serde_json::from_str(text).expect("data");
        assert_eq!(
            data.effective().to_string(),
            r#"[{"elastic":false},{"elastic":true,"poissons_ratio":0.3}]"#
        );
    }
}
