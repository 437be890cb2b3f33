//! Files that are whole or absent, that replace nothing that is not theirs, and that end.
//!
//! A process that dies while it writes, or a disk that fills up, leaves the former file at the
//! path, and no other. What a command writes is apart from what it reads ([`outputs_apart`]). A
//! link is written through; a device, a pipe or a folder is never replaced. Reading takes regular
//! files alone, up to a length ([`read_regular`]).
//!
//! ```
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("result.txt");
//! kufe_files::write_whole(&path, |writer| writer.write_all(b"whole"))?;
//! assert_eq!(kufe_files::read_regular(&path, 100)?, b"whole");
//! assert!(kufe_files::outputs_apart(&[&path], &[&path]).is_err());
//! # Ok::<(), std::io::Error>(())
//! ```

mod apart;
mod leftovers;
mod names;
mod place;
mod read;
mod whole;

pub use apart::{leads_out, outputs_apart, resolved, same_file};
pub use leftovers::{TemporaryFolder, clear_temporaries};
pub use names::{TABLE_TEXT, column_names, line_of_row, shown_name};
pub use read::{broken_at, open_regular, read_regular, sha256, sha256_of_file, text_of_regular};
pub use whole::{TEMPORARY, write_whole};
