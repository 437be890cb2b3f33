//! What a result was made from, as one number: no result is taken for another's.

use kufe_contact::NUMERICS;
use kufe_files::read_regular;
use kufe_lut::sha256;

use crate::jobs::case_file::LoadedCase;
use crate::jobs::failure::Failure;

/// A file counts towards a case up to this size [bytes].
const LARGEST: u64 = 1 << 31;

impl LoadedCase {
    /// SHA-256, hexadecimal, of the content of every file that the case reads beside its own, whatever the files are called and
    /// whenever they were written, and of the version of the numerics.
    ///
    /// # Errors
    /// [`Failure::BadInput`] where a file cannot be read.
    pub fn content(&self) -> Result<String, Failure> {
        let mut digests = format!("numerics {NUMERICS}");
        for (key, file) in self.files()? {
            let bytes = read_regular(&file, LARGEST).map_err(|error| {
                let (case, file) = (&self.name, file.display());
                Failure::BadInput(format!("{case}: {key}: {file}: cannot be read: {error}"))
            })?;
            digests += "\n";
            digests += &sha256(&bytes);
        }
        Ok(sha256(digests.as_bytes()))
    }
}
