//! A channel that is not what its name says, proved or suspected.

use serde::Serialize;

/// What is wrong with a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FaultKind {
    /// Values in another unit.
    Unit,
    /// Values with the other sign.
    Sign,
    /// Two channels under one another's names.
    Swapped,
    /// A specific force from which gravity was taken.
    Gravity,
    /// One value throughout.
    Constant,
    /// A channel that is slower than its rows: each value stands for many of them.
    Held,
    /// Time in another unit.
    Clock,
    /// Distance in another unit, or of another place.
    Distance,
}

/// Evidence that a channel of a run is not what its name says, and what mends it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fault {
    /// The run.
    pub run: String,
    /// Its file.
    pub file: String,
    /// The channels, one but for swapped ones.
    pub columns: Vec<String>,
    /// What is wrong.
    pub kind: FaultKind,
    /// Whether the evidence is a proof. A fault that is not proved is advice: no command refuses the run.
    pub proven: bool,
    /// What the values seem to be.
    pub looks_like: String,
    /// The statistic, and what it is in good runs.
    pub evidence: String,
    /// What to write in the mapping.
    pub mend: String,
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (several, looks) = match self.columns.len() {
            1 => ("", "looks"),
            _ => ("s", "look"),
        };
        write!(
            f,
            "{}: column{several} {} {looks} like {} ({}); in a mapping: {}",
            self.file,
            self.columns.join(", "),
            self.looks_like,
            self.evidence,
            self.mend
        )
    }
}
