//! Columns of numbers in MDF 4 logs; the channels are named like the columns.

use std::path::Path;

use falcon_mdf::Mf4File;

use crate::columns::{Columns, collect};
use crate::error::Error;

/// Reads every numeric channel; `t_s` is the time channel of the group that holds `v_mps` where no
/// channel has that name.
///
/// Channels recorded at another rate than `v_mps` are excluded: bring them to one rate before.
///
/// # Errors
/// [`Error::File`] where the file is no MDF 4 or a channel cannot be decoded.
pub fn read_mdf4(path: &Path) -> Result<Columns, Error> {
    let file = path.display().to_string();
    let failure = |error: falcon_mdf::Mf4Error| Error::file(&file, error);
    kufe_files::open_regular(path).map_err(|error| Error::file(&file, error))?;
    let log = Mf4File::open_buffered(path).map_err(failure)?;
    let lead = log
        .find_channel("v_mps")
        .ok_or_else(|| Error::MissingColumn {
            file: file.clone(),
            column: "v_mps".to_string(),
            found: log.channel_names().join(", "),
            needed_by: None,
        })?;
    let time = log.channel_timestamps(lead).map_err(failure)?;
    let mut columns: Vec<(String, Vec<f64>)> = Vec::new();
    for name in log.channel_names() {
        let Some(channel) = log.find_channel(name) else {
            continue;
        };
        if name != "t_s" && log.channel_timestamps(channel).map_err(failure)? != time {
            continue;
        }
        let signal = log.signal(channel).map_err(failure)?;
        if let Ok(values) = signal.values_f64() {
            columns.push((name.to_string(), values));
        }
    }
    if !columns.iter().any(|(name, _)| name == "t_s") {
        columns.push(("t_s".to_string(), time));
    }
    collect(columns.into_iter(), &file)
}
