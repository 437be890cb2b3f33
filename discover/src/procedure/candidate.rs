//! What could be missing: one amplitude of one effect.

/// One amplitude of one effect; `A` is how it acts on the data at hand.
#[derive(Clone)]
pub struct Candidate<A> {
    /// Name of the effect, as in `[effects.NAME]`.
    pub effect: String,
    /// Name of the amplitude.
    pub key: String,
    /// Its unit.
    pub unit: String,
    /// Smallest admissible value.
    pub low: f64,
    /// Largest admissible value.
    pub high: f64,
    /// Order of magnitude: a noticeable size.
    pub typical: f64,
    /// What would tell it from its rivals.
    pub decides: String,
    /// How it acts.
    pub act: A,
}

impl<A> Candidate<A> {
    /// Whether it is no effect but a dependence on a column outside the catalogue.
    pub fn is_column(&self) -> bool {
        self.effect.starts_with("unknown:")
    }

    /// Whether a size is within its bounds.
    pub fn admits(&self, size: f64) -> bool {
        (self.low..=self.high).contains(&size)
    }

    /// The same with another way to act.
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
