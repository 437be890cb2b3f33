//! What a table holds at a point.

/// One of the tabulated figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// Peak pressure [Pa].
    PMax,
    /// Force over contact area [Pa].
    PMean,
    /// Contact area [m2].
    Area,
    /// Extent of the contact along the runner [m].
    Length,
    /// Extent of the contact across the runner [m].
    Width,
    /// Rigid approach [m].
    Approach,
}

impl Quantity {
    /// All quantities, in the order files list them.
    pub const ALL: [Quantity; 6] = [
        Quantity::PMax,
        Quantity::PMean,
        Quantity::Area,
        Quantity::Length,
        Quantity::Width,
        Quantity::Approach,
    ];

    /// Name without a unit, as `.lut` files spell it.
    pub fn name(self) -> &'static str {
        match self {
            Quantity::PMax => "p_max",
            Quantity::PMean => "p_mean",
            Quantity::Area => "area",
            Quantity::Length => "length",
            Quantity::Width => "width",
            Quantity::Approach => "approach",
        }
    }

    /// Key with its unit, as CSV columns and `result.json` spell it.
    pub fn key(self) -> &'static str {
        match self {
            Quantity::PMax => "p_max_pa",
            Quantity::PMean => "p_mean_pa",
            Quantity::Area => "area_m2",
            Quantity::Length => "length_m",
            Quantity::Width => "width_m",
            Quantity::Approach => "approach_m",
        }
    }

    /// Unit.
    pub fn unit(self) -> &'static str {
        match self {
            Quantity::PMax | Quantity::PMean => "Pa",
            Quantity::Area => "m2",
            Quantity::Length | Quantity::Width | Quantity::Approach => "m",
        }
    }

    /// The quantity of this [`name`](Self::name).
    pub fn from_name(name: &str) -> Option<Quantity> {
        Quantity::ALL.into_iter().find(|q| q.name() == name)
    }
}
