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
    /// Share asked for, where the family has sizes.
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
    /// Names that may be claimed without being false, beside the hidden effects' classes.
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
    /// Writes the data into `data` and the answer as `answer_file`; each file is renamed into
    /// place.
    pub fn write(
        &self,
        data: &std::path::Path,
        answer_file: &std::path::Path,
    ) -> Result<(), CaseError> {
        let failed = |path: &std::path::Path| {
            let path = path.display().to_string();
            move |source| CaseError::File { path, source }
        };
        std::fs::create_dir_all(data).map_err(failed(data))?;
        if let Some(parent) = answer_file.parent() {
            std::fs::create_dir_all(parent).map_err(failed(parent))?;
        }
        let json = serde_json::to_vec_pretty(&self.answer).expect("an answer is plain data");
        let files = self
            .files
            .iter()
            .map(|(name, bytes)| (data.join(name), bytes.as_slice()));
        for (path, bytes) in files.chain([(answer_file.to_path_buf(), json.as_slice())]) {
            let draft = path.with_extension("part");
            std::fs::write(&draft, bytes).map_err(failed(&draft))?;
            std::fs::rename(&draft, &path).map_err(failed(&path))?;
        }
        Ok(())
    }
}
