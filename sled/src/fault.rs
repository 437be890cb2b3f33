//! A channel whose values contradict its name, proved or suspected.

use serde::Serialize;

/// What is wrong with a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FaultKind {
    /// Values in another unit.
    Unit,
    /// Values with the other sign.
    Sign,
    /// Two channels under one another's names.
    Swapped,
    /// Both vectors of a sensor box that is turned.
    Rotation,
    /// A specific force from which gravity was taken.
    Gravity,
    /// One value throughout.
    Constant,
    /// A channel that is slower than its rows: each value is repeated over many of them.
    Held,
    /// Time in another unit.
    Clock,
    /// Distance in another unit, or of another place.
    Distance,
}

/// Evidence that the values of a channel contradict its name, and the remedy.
#[derive(Clone, Debug, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Fault {
    /// The run.
    pub run: String,
    /// Its file.
    pub file: String,
    /// The channels, one but for swapped ones and those of a box.
    pub columns: Vec<String>,
    /// What is wrong.
    pub kind: FaultKind,
    /// Whether the evidence is a proof. A fault that is not proved is advice: no command refuses
    /// the run.
    pub proven: bool,
    /// What the values seem to be.
    pub looks_like: String,
    /// The statistic, and what it is in good runs.
    pub evidence: String,
    /// What to write in the mapping.
    pub mend: String,
}

impl Fault {
    /// The same, proved or suspected only.
    pub(crate) fn proven_if(self, proven: bool) -> Fault {
        Fault { proven, ..self }
    }
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Fault {
            file,
            looks_like,
            evidence,
            mend,
            ..
        } = self;
        let columns = match &self.columns[..] {
            [one] => format!("column {one} resembles"),
            several => format!("columns {} resemble", several.join(", ")),
        };
        write!(
            f,
            "{file}: {columns} {looks_like} ({evidence}); in a mapping: {mend}"
        )
    }
}
