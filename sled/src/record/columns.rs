//! Columns of numbers by name.

use std::collections::BTreeMap;

use crate::error::Error;

/// Columns by name, all of one length.
pub type Columns = BTreeMap<String, Vec<f64>>;

/// Most numbers that a packed file of so many bytes may unpack to: 320 MB of them, or one for each byte.
///
/// A file of constants packs ten thousand numbers into a byte; a recording of sensors takes more than a byte for each.
pub fn most_values(bytes: u64) -> u64 {
    bytes.max(40_000_000)
}

/// Gathers named columns and refuses a name given twice.
pub(crate) fn collect(
    columns: impl Iterator<Item = (String, Vec<f64>)>,
    file: &str,
) -> Result<Columns, Error> {
    let mut gathered = Columns::new();
    for (name, values) in columns {
        if gathered.contains_key(&name) {
            return Err(Error::Column {
                file: file.to_string(),
                column: name,
                what: "given twice",
                expected: "each column once".to_string(),
            });
        }
        gathered.insert(name, values);
    }
    let lengths: Vec<usize> = gathered.values().map(Vec::len).collect();
    if lengths.windows(2).any(|pair| pair[0] != pair[1]) {
        let told: Vec<String> = gathered
            .iter()
            .map(|(name, values)| format!("{name} {}", values.len()))
            .collect();
        return Err(Error::file(
            file,
            format!("columns differ in length: {}", told.join(", ")),
        ));
    }
    Ok(gathered)
}
