//! The record of a case within a result, and records as rows of a CSV file.

use std::fmt;
use std::io::Write;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Serialize};

use crate::case::Case;
use crate::results::datum::Datum;

/// A case, key by key.
///
/// JSON has neither infinity nor NaN: the words `inf`, `-inf` and `nan` replace them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct CaseRecord(#[schemars(schema_with = "any_object")] Datum);

/// Schema of any object: the schema of a case would refuse the words for infinity.
fn any_object(_: &mut SchemaGenerator) -> Schema {
    schemars::json_schema!({ "type": "object" })
}

impl CaseRecord {
    /// The record of a case; empty where a path in it is not valid Unicode.
    pub fn of(case: &Case) -> Self {
        let table = toml::Table::try_from(case).unwrap_or_default();
        let mut table = toml::Value::Table(table);
        write_infinity(&mut table);
        CaseRecord(Datum::of(&table).unwrap_or_default())
    }

    /// A number of the case, by its path.
    pub fn number(&self, path: &[&str]) -> Option<f64> {
        let inner = |datum: &'_ Datum, key: &&str| datum.group()?.get(*key).cloned();
        path.iter()
            .try_fold(self.0.clone(), |datum, key| inner(&datum, key))?
            .number()
    }

    /// The record without the elastic constants of a rigid runner, which have no effect.
    #[must_use]
    pub fn effective(self) -> Self {
        CaseRecord(self.0.effective())
    }
}

/// The case as JSON.
impl fmt::Display for CaseRecord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

fn write_infinity(value: &mut toml::Value) {
    match value {
        toml::Value::Float(number) if !number.is_finite() => {
            let word = number.to_string().to_lowercase();
            *value = toml::Value::String(word);
        }
        toml::Value::Table(table) => table
            .iter_mut()
            .for_each(|(_, value)| write_infinity(value)),
        toml::Value::Array(values) => values.iter_mut().for_each(write_infinity),
        _ => {}
    }
}

/// Writes documents of single values as CSV: their keys are the columns.
///
/// The longest document names the columns; the cells of missing keys are empty.
///
/// # Errors
/// Those of the writer, and of a document that contains lists or objects.
pub fn write_csv<T: Serialize>(writer: impl Write, rows: &[T]) -> std::io::Result<()> {
    let mut records = Vec::new();
    for row in rows {
        match Datum::of(row)? {
            Datum::Group(cells) if cells.values().all(Datum::is_single) => {
                records.push(cells);
            }
            other => {
                let text = format!("{other}: expected an object of single values");
                return Err(std::io::Error::other(text));
            }
        }
    }
    let Some(longest) = records.iter().max_by_key(|cells| cells.len()) else {
        return Ok(());
    };
    let mut csv = csv::Writer::from_writer(writer);
    csv.write_record(longest.keys())?;
    for cells in &records {
        let text = |column| cells.get(column).map_or(String::new(), Datum::to_string);
        csv.write_record(longest.keys().map(text))?;
    }
    csv.flush()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jobs::case_file::LoadedCase;

    #[test]
    fn a_case_record_reads_back_from_json_and_spells_infinity() {
        let case = LoadedCase::example().expect("a case").case;
        let record = CaseRecord::of(&case);
        let text = serde_json::to_string(&record).expect("JSON");
        assert!(text.contains("\"radius_m\":\"inf\""), "{text}");
        assert_eq!(
            serde_json::from_str::<CaseRecord>(&text).expect("a case"),
            record
        );
        assert!(
            text.contains("youngs_modulus_pa\":210000000000.0"),
            "{text}"
        );
        let shown = serde_json::to_string(&record.effective()).expect("JSON");
        assert!(!shown.contains("210000000000.0"), "{shown}");
    }

    #[test]
    fn the_longest_record_names_the_columns() {
        #[derive(Serialize)]
        struct Row {
            step: usize,
            #[serde(skip_serializing_if = "Option::is_none")]
            mu: Option<f64>,
            error: Option<&'static str>,
        }
        let row = |step, mu, error| Row { step, mu, error };
        let mut text = Vec::new();
        let rows = [row(1, None, Some("short, of it")), row(2, Some(4e-3), None)];
        write_csv(&mut text, &rows).expect("CSV");
        let expected = "step,mu,error\n1,,\"short, of it\"\n2,0.004,\n";
        assert_eq!(String::from_utf8(text).expect("text"), expected);
    }
}
