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
    /// Two channels with exchanged names.
    Swapped,
    /// Acceleration and rotation rate of a turned sensor box.
    Rotation,
    /// A specific force from which gravity was subtracted.
    Gravity,
    /// One value throughout.
    Constant,
    /// A channel that is slower than its rows: each value is repeated over many of them.
    Held,
    /// Time in another unit.
    Clock,
    /// Distance in another unit, or from another origin.
    Distance,
}

/// Evidence that the values of a channel contradict its name, and the remedy.
#[derive(Clone, Debug, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Fault {
    /// The run.
    pub run: String,
    /// Its file.
    pub file: String,
    /// The channels: several if swapped or of a sensor box, else one.
    pub columns: Vec<String>,
    /// What is wrong.
    pub kind: FaultKind,
    /// Whether the evidence is a proof. A fault without proof is only reported: no command refuses
    /// the run.
    pub proven: bool,
    /// What the values appear to be.
    pub looks_like: String,
    /// The statistic with its value in good runs.
    pub evidence: String,
    /// The correction to write in the mapping.
    pub mend: String,
}

impl Fault {
    /// Sets whether the evidence is a proof.
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
