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
    /// Coefficient of friction of a runner that slides.
    Mu,
    /// Part of it that ploughs the groove.
    MuPloughing,
    /// Part of it that shears the melt film.
    MuViscous,
    /// Depth of the groove that a sliding runner leaves [m].
    GrooveDepth,
    /// Thickness of the melt film averaged over the patch [m].
    FilmMean,
}

impl Quantity {
    /// Its name in titles.
    pub fn title(self) -> &'static str {
        match self {
            Quantity::PMax => "Peak pressure",
            Quantity::PMean => "Mean pressure",
            Quantity::Area => "Contact area",
            Quantity::Length => "Contact length",
            Quantity::Width => "Contact width",
            Quantity::Approach => "Approach",
            Quantity::Mu => "Coefficient of friction",
            Quantity::MuPloughing => "Friction of ploughing",
            Quantity::MuViscous => "Friction of the melt film",
            Quantity::GrooveDepth => "Depth of the groove",
            Quantity::FilmMean => "Mean thickness of the film",
        }
    }

    /// All quantities, in the order files list them.
    pub const ALL: [Quantity; 11] = [
        Quantity::PMax,
        Quantity::PMean,
        Quantity::Area,
        Quantity::Length,
        Quantity::Width,
        Quantity::Approach,
        Quantity::Mu,
        Quantity::MuPloughing,
        Quantity::MuViscous,
        Quantity::GrooveDepth,
        Quantity::FilmMean,
    ];

    /// Those of a contact that slides, or of one at rest.
    pub fn of(sliding: bool) -> &'static [Quantity] {
        const AT_REST: usize = 6;
        if sliding {
            &Quantity::ALL
        } else {
            &Quantity::ALL[..AT_REST]
        }
    }

    /// What an interpolation error is asked of: the coefficient of friction or, at rest, the peak pressure.
    pub fn judged(sliding: bool) -> Quantity {
        if sliding {
            Quantity::Mu
        } else {
            Quantity::PMax
        }
    }

    /// Name without a unit, as `.lut` files spell it.
    pub fn name(self) -> &'static str {
        match self {
            Quantity::PMax => "p_max",
            Quantity::PMean => "p_mean",
            Quantity::Area => "area",
            Quantity::Length => "length",
            Quantity::Width => "width",
            Quantity::Approach => "approach",
            Quantity::Mu => "mu",
            Quantity::MuPloughing => "mu_ploughing",
            Quantity::MuViscous => "mu_viscous",
            Quantity::GrooveDepth => "groove_depth",
            Quantity::FilmMean => "film_mean",
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
            Quantity::Mu => "mu",
            Quantity::MuPloughing => "mu_ploughing",
            Quantity::MuViscous => "mu_viscous",
            Quantity::GrooveDepth => "groove_depth_m",
            Quantity::FilmMean => "film_mean_m",
        }
    }

    /// Unit.
    pub fn unit(self) -> &'static str {
        match self {
            Quantity::PMax | Quantity::PMean => "Pa",
            Quantity::Area => "m2",
            Quantity::Length
            | Quantity::Width
            | Quantity::Approach
            | Quantity::GrooveDepth
            | Quantity::FilmMean => "m",
            Quantity::Mu | Quantity::MuPloughing | Quantity::MuViscous => "1",
        }
    }

    /// The quantity of this [`name`](Self::name).
    pub fn from_name(name: &str) -> Option<Quantity> {
        Quantity::ALL.into_iter().find(|q| q.name() == name)
    }
}
