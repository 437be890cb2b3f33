//! From where on relations between channels prove that one is not what its name says.

/// Thresholds of the relations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelationRules {
    /// By how much the disagreement must fall, a factor of e in the mean square that one relation leaves. In clean runs nothing
    /// that is tried lowers it by more than 0.4; at half, one run in eleven with little slip was said to be in degrees.
    pub least_gain: f64,
    /// A relation that shows a fault must hold once it is mended: less than this is left of its terms, as a mean square.
    pub holds: f64,
    /// A fault shows in a relation that leaves more than this, as a mean square; clean runs leave up to a tenth (`rigid_body`), of
    /// which gravity that a record's pitch rate does not carry can be lowered by a wrong sign.
    pub shows: f64,
    /// No relation may get worse by more than this when another is mended.
    pub worse: f64,
    /// Standard errors from what is right of a coefficient that is told to be wrong: by chance once in 10^9.
    pub least_t: f64,
    /// Share of the runs that must agree where all together prove it.
    pub agree: f64,
    /// Share of the runs' median answer that a single run must have to be told by its sign: a wrong sign leaves the size as it is.
    pub alike: f64,
    /// Least drag area over mass of a sled or car [m2/kg]; a bobsled has 7e-4, an accelerometer in g would show a tenth of that.
    pub least_drag: f64,
    /// What drives or brakes changes a_x by more than this [m/s2]: nothing is said of its air then.
    pub free: f64,
}

impl Default for RelationRules {
    fn default() -> Self {
        RelationRules {
            least_gain: 1.0,
            holds: 0.25,
            shows: 0.1,
            worse: 0.1,
            least_t: 6.0,
            agree: 0.8,
            alike: 0.5,
            least_drag: 2e-4,
            free: 1.0,
        }
    }
}
