//! The answer to a case, kept where the finder never looks.

use serde::{Deserialize, Serialize};

/// One hidden effect, as an answer.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Hides {
    /// Name, as in reports.
    pub effect: String,
    /// Names that these data cannot tell from it.
    pub class: Vec<String>,
    /// Its parameter's key in `[effects.NAME]`.
    pub key: String,
    /// Its parameter.
    pub size: f64,
    /// The parameter's unit.
    pub unit: String,
    /// Variance it adds to the residual after a refit of base and, in other worlds, installation,
    /// over the noise's variance; 0 where not measured, or without noise.
    pub share: f64,
    /// Stretches of track where it acts: track, from [m], to [m].
    pub places: Vec<(String, f64, f64)>,
}

/// The answer to a case.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Answer {
    /// Family, for example `lateral` or `null`.
    pub family: String,
    /// Case within the family.
    pub name: String,
    /// Requested share, where the family has sizes.
    pub wanted_share: Option<f64>,
    /// Seed.
    pub seed: u64,
    /// The data file that the finder is given.
    pub data: String,
    /// The model file that the finder is given beside it; none beside a campaign, which names its
    /// own.
    pub model: Option<String>,
    /// What is hidden; empty for a null.
    pub hides: Vec<Hides>,
    /// Further names that may be reported without being wrong, in addition to the hidden effects' classes.
    pub tolerated: Vec<String>,
    /// True where a single firm name would say more than the data can.
    pub too_little_to_name: bool,
    /// True values of base parameters, by their dotted keys in the model file.
    pub base: Vec<(String, f64)>,
}

/// A case ready to be written.
#[derive(Debug)]
pub struct Case {
    /// Files of the data folder.
    pub files: Vec<(String, Vec<u8>)>,
    /// Its answer.
    pub answer: Answer,
    /// Data that only the scorer sees, where written models are compared on such: fresh runs, and
    /// `refitted.toml`, the refitted base.
    pub fresh: Vec<(String, Vec<u8>)>,
}

/// What can go wrong with a case.
#[derive(Debug, thiserror::Error)]
pub enum CaseError {
    /// The name is not a case.
    #[error("no case is called {0:?}; `blind list` names them all")]
    Unknown(String),
    /// A file cannot be written.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: String,
        /// Why.
        source: std::io::Error,
    },
    /// A pressure map cannot be encoded.
    #[error("pressure map {name}: {source}")]
    Map {
        /// The map.
        name: String,
        /// Why.
        source: exr::error::Error,
    },
    /// The contact solver stopped short.
    #[error(
        "contact solution stopped after {iterations} iterations at a relative change of {change:.1e}"
    )]
    Contact {
        /// Iterations made.
        iterations: usize,
        /// Last relative change of the pressure.
        change: f64,
    },
}

impl Case {
    /// Writes the data into `data`, the answer as `answer_file`, and fresh data into a folder
    /// `NAME-fresh` next to it; each file is renamed into place.
    pub fn write(
        &self,
        data: &std::path::Path,
        answer_file: &std::path::Path,
    ) -> Result<(), CaseError> {
        let failed = |path: &std::path::Path| {
            let path = path.display().to_string();
            move |source| CaseError::File { path, source }
        };
        let fresh = fresh_folder(answer_file);
        let has_fresh = !self.fresh.is_empty();
        let folders = [
            Some(data),
            answer_file.parent(),
            has_fresh.then_some(fresh.as_path()),
        ];
        for folder in folders.into_iter().flatten() {
            std::fs::create_dir_all(folder).map_err(failed(folder))?;
        }
        let json = serde_json::to_vec_pretty(&self.answer).expect("an answer is plain data");
        let of = |folder: &std::path::Path, files: &[(String, Vec<u8>)]| {
            let path = |(name, bytes): &(String, Vec<u8>)| (folder.join(name), bytes.clone());
            files.iter().map(path).collect::<Vec<_>>()
        };
        let answer = [(answer_file.to_path_buf(), json)];
        let files = of(data, &self.files)
            .into_iter()
            .chain(of(&fresh, &self.fresh));
        for (path, bytes) in files.chain(answer) {
            let draft = path.with_extension("part");
            std::fs::write(&draft, bytes).map_err(failed(&draft))?;
            std::fs::rename(&draft, &path).map_err(failed(&path))?;
        }
        Ok(())
    }
}

/// Folder of the fresh data next to an answer: `NAME-fresh` of `NAME.json`.
pub fn fresh_folder(answer_file: &std::path::Path) -> std::path::PathBuf {
    let stem = answer_file.file_stem().unwrap_or_default();
    let mut name = stem.to_os_string();
    name.push("-fresh");
    answer_file.with_file_name(name)
}
