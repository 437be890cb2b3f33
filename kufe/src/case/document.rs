//! The document `case.toml`: one contact problem.

use std::collections::BTreeMap;
use std::path::PathBuf;

use kufe_contact::Options;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::case::{
    AccuracyTable, CaseError, IceTable, LoadTable, RunnerTable, SlidingTable, SolverTable,
    TrackTable,
};

/// File of an output folder with the groove of a sliding runner.
pub const GROOVE_FILE: &str = "groove.exr";

/// The document `case.toml`: one contact problem.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "case.toml")]
pub struct Case {
    /// The runner.
    pub runner: RunnerTable,
    /// The ice.
    pub ice: IceTable,
    /// The track under the runner; flat where the table is absent.
    #[serde(default)]
    pub track: TrackTable,
    /// The load.
    pub load: LoadTable,
    /// Steady sliding on yielding ice; the runner is at rest where the table is absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sliding: Option<SlidingTable>,
    /// The requested accuracy; one per cent of the peak pressure where the table is absent.
    #[serde(default)]
    pub accuracy: AccuracyTable,
    /// Options of the solver; matrix-free where the table is absent.
    #[serde(default, skip_serializing_if = "SolverTable::is_default")]
    pub solver: SolverTable,
    /// Effects that are switched on, by name ([`crate::case::effects`]); an absent one is off.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[schemars(schema_with = "crate::case::effects::schema")]
    pub effects: BTreeMap<String, toml::Table>,
}

impl Case {
    /// Reads and checks a case.
    ///
    /// # Errors
    /// [`CaseError`] with the line, the key, the value and what was expected.
    pub fn parse(text: &str) -> Result<Case, CaseError> {
        if let Some(error) = CaseError::not_a_table(text) {
            return Err(error);
        }
        let case: Case =
            toml::from_str(text).map_err(|error| CaseError::from_toml(text, &error))?;
        case.check().map_err(|error| error.locate(text))?;
        Ok(case)
    }

    /// [`Options::default`] with the accuracy and the form of the stiffness that the case requests.
    pub fn options(&self) -> Options {
        self.options_on(Options::default())
    }

    /// These options with the accuracy and the form of the stiffness that the case requests.
    pub(crate) fn options_on(&self, options: Options) -> Options {
        Options {
            p_max_tolerance: self.accuracy.p_max,
            stiffness: self.solver.stiffness.into(),
            ..options
        }
    }

    /// Keys and paths of the files that the case names: hull, mesh, section, ice surface, and the
    /// groove of a preceding runner.
    pub fn files(&self) -> Vec<(&'static str, PathBuf)> {
        let section = self.runner.section.as_ref();
        let profile = section.and_then(|s| s.profile.clone());
        let sliding = self.sliding.as_ref();
        let groove = sliding.and_then(|s| Some(s.previous.as_ref()?.join(GROOVE_FILE)));
        [
            ("runner.hull", self.runner.hull.clone()),
            ("runner.mesh", self.runner.mesh.clone()),
            ("runner.section.profile", profile),
            ("ice.surface", self.ice.surface.clone()),
            ("sliding.previous", groove),
        ]
        .into_iter()
        .filter_map(|(key, file)| Some((key, file?)))
        .collect()
    }

    /// The case as TOML, which [`Case::parse`] reads back.
    ///
    /// # Errors
    /// [`CaseError::Unwritable`] if the hull's path is not valid Unicode.
    pub fn to_toml(&self) -> Result<String, CaseError> {
        toml::to_string(self).map_err(|error| CaseError::Unwritable {
            reason: error.to_string(),
        })
    }
}
