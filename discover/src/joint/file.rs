//! `campaign.toml`: the data files of a campaign and their model.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::error::{Error, Result};
use crate::input::table::Table;

/// Largest campaign file [bytes].
const MAX_BYTES: u64 = 1 << 20;

/// The files of a campaign; paths are relative to its folder.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CampaignFile {
    /// A `runs.csv`.
    pub runs: Option<PathBuf>,
    /// An `experiments.csv`.
    pub experiments: Option<PathBuf>,
    /// A `pressures.csv`.
    pub pressures: Option<PathBuf>,
    /// The `model.toml` of runs and experiments.
    pub model: Option<PathBuf>,
}

impl CampaignFile {
    /// Reads and checks it.
    ///
    /// # Errors
    /// [`Error::File`] for an invalid file, without data, without a model, or naming a file twice
    /// or one that does not exist.
    pub fn read(path: &Path) -> Result<Self> {
        let refused = |reason: &str| Error::file(path, reason.trim());
        let text = kufe_files::text_of_regular(path, MAX_BYTES);
        let text = text.map_err(|error| refused(&error.to_string()))?;
        let mut campaign: Self = toml::from_str(&text).map_err(|error: toml::de::Error| {
            refused(&kufe_files::broken_at(&text, error.span(), error.message()))
        })?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut seen: Vec<(&str, PathBuf)> = Vec::new();
        for (key, file) in [
            ("runs", &mut campaign.runs),
            ("experiments", &mut campaign.experiments),
            ("pressures", &mut campaign.pressures),
            ("model", &mut campaign.model),
        ] {
            let Some(file) = file else { continue };
            *file = folder.join(&*file);
            let shown = file.display();
            if !file.is_file() {
                return Err(refused(&format!(
                    "{key}: {shown} is not an existing file; paths are relative to the campaign's folder"
                )));
            }
            if let Some((other, _)) = seen.iter().find(|(_, f)| f == file) {
                let reason = format!("{key} = {shown}: the same file as {other}");
                return Err(refused(&reason));
            }
            seen.push((key, file.clone()));
        }
        let of_model = campaign.runs.is_some() || campaign.experiments.is_some();
        match (&campaign.model, of_model, &campaign.pressures) {
            (_, false, None) => Err(refused(
                "no data; expected one or more of runs, experiments, pressures",
            )),
            (None, true, _) => Err(refused(
                "model is missing; expected the model.toml that runs and experiments are compared with",
            )),
            (Some(_), false, _) => Err(refused(
                "model is given without runs or experiments; pressures are compared with their own case",
            )),
            _ => Ok(campaign),
        }
    }

    /// Every file that the campaign names.
    pub fn inputs(&self) -> Vec<PathBuf> {
        [&self.runs, &self.experiments, &self.pressures, &self.model]
            .into_iter()
            .flatten()
            .cloned()
            .collect()
    }
}

/// The one case that all rows of a `pressures.csv` name.
///
/// # Errors
/// [`Error::File`] if they name several; those of the table.
pub fn case_of(pressures: &Path) -> Result<PathBuf> {
    let table = Table::read(pressures)?;
    let mut cases = table.texts("case")?;
    cases.sort_unstable();
    cases.dedup();
    match cases.as_slice() {
        [case] => Ok(pressures.parent().unwrap_or(Path::new("")).join(case)),
        several => Err(Error::file(
            pressures,
            format!(
                "column case: found {}; expected one case in all rows of a campaign, the one to improve",
                several.join(", ")
            ),
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<CampaignFile, String> {
        let folder = tempfile::tempdir().expect("a folder");
        for name in ["runs.csv", "experiments.csv", "pressures.csv", "model.toml"] {
            std::fs::write(folder.path().join(name), "").expect("a file");
        }
        let path = folder.path().join("campaign.toml");
        std::fs::write(&path, text).expect("a file");
        CampaignFile::read(&path).map_err(|error| error.to_string())
    }

    #[test]
    fn paths_are_relative_to_the_campaign_file() {
        let campaign = read("runs = \"runs.csv\"\nmodel = \"model.toml\"\n").expect("a campaign");
        assert!(
            campaign
                .runs
                .is_some_and(|p| p.ends_with("runs.csv") && p.is_absolute())
        );
        assert_eq!(campaign.experiments, None);
        assert!(read("pressures = \"pressures.csv\"").is_ok());
    }

    #[test]
    fn errors_of_invalid_campaigns_state_the_expected_content() {
        for (text, expected) in [
            ("", "no data"),
            ("model = \"model.toml\"", "no data"),
            ("runs = \"runs.csv\"", "model is missing"),
            (
                "runs = \"away.csv\"\nmodel = \"model.toml\"",
                "away.csv is not an existing file",
            ),
            (
                "runs = \"runs.csv\"\nmodel = \"runs.csv\"",
                "the same file as runs",
            ),
            (
                "pressures = \"pressures.csv\"\nmodel = \"model.toml\"",
                "without runs",
            ),
            ("run = \"runs.csv\"", "unknown field `run`"),
            ("runs = 3", "line 1"),
            ("runs = ", "line 1"),
        ] {
            let refused = read(text).expect_err(text);
            assert!(
                refused.contains(expected) && refused.contains("campaign.toml"),
                "{text}: {refused}"
            );
        }
    }
}
