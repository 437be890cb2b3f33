//! A command's document and its series as a MAT-file.

use std::io::Write;

use kufe_lut::{MatValue, write_mat_file};
use serde::Serialize;

use crate::jobs::failure::Failure;

/// Writes every key of `document` and `more` as variables.
///
/// # Errors
/// Those of the writer.
pub fn write_document_mat(
    writer: &mut dyn Write,
    document: &impl Serialize,
    more: Vec<(String, MatValue)>,
) -> Result<(), Failure> {
    let document = serde_json::to_value(document).map_err(Failure::bad_input)?;
    let keys = document.as_object().into_iter().flatten();
    let mut variables: Vec<(String, MatValue)> = keys
        .map(|(key, value)| (key.clone(), MatValue::of_json(value)))
        .collect();
    variables.extend(more);
    write_mat_file(writer, env!("CARGO_PKG_VERSION"), variables).map_err(Failure::bad_input)
}
