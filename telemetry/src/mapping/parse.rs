//! A mapping from its text.

use crate::error::Error;
use crate::mapping::check::check;
use crate::mapping::file::Mapping;

impl Mapping {
    /// Reads a mapping and checks what can be checked without its files.
    ///
    /// # Errors
    /// [`Error::File`] with the line where it is no TOML or a key is unknown; [`Error::Key`].
    pub fn parse(text: &str, file: &str) -> Result<Mapping, Error> {
        let mapping: Mapping = toml::from_str(text)
            .map_err(|error| Error::file(file, error.to_string().trim_end().replace('\n', " ")))?;
        check(&mapping, file)?;
        Ok(mapping)
    }
}
