//! What came of a case.

use serde::{Deserialize, Serialize};

/// One step of a report.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Claim {
    /// Name.
    pub effect: String,
    /// The class, the name included.
    pub class: Vec<String>,
    /// Explainable gap closed: value, low, high.
    pub closed: Option<[f64; 3]>,
}

/// What came of one hidden effect.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Found {
    /// Hidden effect.
    pub effect: String,
    /// Share of the noise's variance that it has.
    #[serde(default)]
    pub share: Option<f64>,
    /// Named itself.
    pub exact: bool,
    /// Named, or in the class of a named one.
    pub in_class: bool,
    /// Reported as an error of the installation, within its tolerance or outside it.
    #[serde(default)]
    pub installed: bool,
    /// Size of that class.
    pub class_size: Option<usize>,
    /// Explainable gap closed by that step: value, low, high.
    pub closed: Option<[f64; 3]>,
    /// Whether the parameter's interval holds the truth, where it could be compared.
    pub parameter_inside: Option<bool>,
    /// Overlap of the reported with the true stretches (intersection over union).
    pub overlap: Option<f64>,
}

/// What came of one case.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Outcome {
    /// Case.
    pub id: String,
    /// Family.
    pub family: String,
    /// Requested share.
    pub share: Option<f64>,
    /// Seed.
    pub seed: u64,
    /// Why there is no report, if there is none.
    pub failure: Option<String>,
    /// Verdict.
    pub verdict: String,
    /// Claims in the report's order.
    pub claims: Vec<Claim>,
    /// A claim where nothing was hidden, or of something that is neither hidden nor tolerated.
    pub false_claim: bool,
    /// A single name, not of a class, that is not hidden.
    pub wrong_firm: bool,
    /// A single name where the data cannot carry one.
    pub overconfident: bool,
    /// Hidden effects.
    pub found: Vec<Found>,
    /// Base parameters in `model.next.toml`.
    pub base: Vec<BaseFound>,
    /// Time of the finder's run.
    pub seconds: f64,
    /// Processor time of the finder's run, where it can be read.
    #[serde(default)]
    pub cpu_seconds: Option<f64>,
    /// Whether the report states that the model is adequate; `None` if it states nothing.
    #[serde(default)]
    pub adequate: Option<bool>,
    /// Models on fresh runs, where the case has such.
    #[serde(default)]
    pub fresh: Option<Fresh>,
}

/// Models on fresh runs.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Fresh {
    /// As given.
    pub given: Vec<OnRun>,
    /// The base refitted by the generator, installation errors ignored.
    pub refitted: Vec<OnRun>,
    /// As the finder wrote it; nothing where it wrote none or one that cannot be used.
    pub written: Vec<OnRun>,
}

/// A model on one fresh run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OnRun {
    /// Root mean squares of what the balances leave: along [N], side [N], yaw [N m].
    pub force: [f64; 3],
    /// Root mean squares of the replay's differences: time [s], speed [m/s].
    pub replay: [f64; 2],
}

/// A base parameter as it was found.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct BaseFound {
    /// Its dotted key.
    pub key: String,
    /// Relative error.
    pub error: f64,
    /// Whether its interval holds the truth; nothing where none is reported.
    pub inside: Option<bool>,
}
