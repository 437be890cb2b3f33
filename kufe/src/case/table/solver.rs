//! How a case is solved.

use kufe_contact::StiffnessForm;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the equations are solved.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SolverTable {
    /// The form of the stiffness that is multiplied with.
    #[serde(default)]
    pub stiffness: StiffnessWord,
}

impl SolverTable {
    /// Whether the table has nothing but defaults.
    pub(crate) fn is_default(&self) -> bool {
        *self == SolverTable::default()
    }
}

/// The form of the stiffness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum StiffnessWord {
    /// Applied cell by cell, without being stored.
    #[default]
    MatrixFree,
    /// Assembled into a sparse matrix a body, in at most 4 GB.
    Assembled,
}

impl From<StiffnessWord> for StiffnessForm {
    fn from(word: StiffnessWord) -> Self {
        match word {
            StiffnessWord::MatrixFree => StiffnessForm::MatrixFree,
            StiffnessWord::Assembled => StiffnessForm::Assembled,
        }
    }
}
