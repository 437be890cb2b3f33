//! Candidates: one amplitude of one effect each.

/// One amplitude of one effect; `A` is its action on the data at hand.
#[derive(Clone)]
pub struct Candidate<A> {
    /// Name of the effect, as in `[effects.NAME]`.
    pub effect: String,
    /// Name of the amplitude.
    pub key: String,
    pub unit: String,
    pub low: f64,
    pub high: f64,
    /// Typical order of magnitude.
    pub typical: f64,
    /// Measurement that would distinguish it from its rivals.
    pub decides: String,
    pub act: A,
}

impl<A> Candidate<A> {
    /// Whether it is a dependence on a column outside the catalogue.
    pub fn is_column(&self) -> bool {
        self.effect.starts_with("unknown:")
    }

    /// Whether a size is within its bounds.
    pub fn admits(&self, size: f64) -> bool {
        (self.low..=self.high).contains(&size)
    }

    /// The same with another action.
    pub fn acting<B>(&self, act: B) -> Candidate<B> {
        Candidate {
            effect: self.effect.clone(),
            key: self.key.clone(),
            unit: self.unit.clone(),
            low: self.low,
            high: self.high,
            typical: self.typical,
            decides: self.decides.clone(),
            act,
        }
    }

    /// Name with the amplitude's key.
    pub fn label(&self) -> String {
        format!("{} ({})", self.effect, self.key)
    }
}
