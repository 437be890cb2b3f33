//! Effects that need what is stated nowhere are refused by name.

use crate::effects::Effects;

use crate::error::Error;

/// Refuses effects that need one of the `absent` columns; `file` is where they would stand.
///
/// # Errors
/// [`Error::Keys`] with the file, the effect and the column.
pub fn refuse_effects(effects: &Effects, absent: &[&str], file: &str) -> Result<(), Error> {
    let there: Vec<&str> = effects
        .active
        .iter()
        .flat_map(|effect| effect.columns())
        .filter(|column| !absent.contains(column))
        .collect();
    effects.check_columns(&there).map_err(|error| Error::Keys {
        file: file.to_string(),
        reason: error.to_string(),
    })
}
