//! The tabulated quantities, and their values at one solved contact.

use serde::{Deserialize, Serialize};

/// Defines the quantities: name, ending of its keys, unit and title.
macro_rules! table_quantities {
    ($($variant:ident, $name:literal, $ending:literal, $unit:literal, $title:literal;)*) => {
        /// A tabulated quantity.
        #[derive(
            Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
        )]
        #[serde(rename_all = "snake_case")]
        pub enum Quantity {
            $(#[doc = concat!($title, " [", $unit, "].")] $variant),*
        }

        /// Number of quantities.
        const COUNT: usize = [$($name),*].len();

        /// Name, key, key of the estimated error, unit and title of every quantity, in the order
        /// of the enum.
        const DESCRIPTIONS: [[&str; 5]; COUNT] = [$([
            $name,
            concat!($name, $ending),
            concat!($name, "_error", $ending),
            $unit,
            $title,
        ]),*];

        impl Quantity {
            /// All quantities, in the order files list them.
            pub const ALL: [Quantity; COUNT] = [$(Quantity::$variant),*];
        }
    };
}

table_quantities! {
    PMax, "p_max", "_pa", "Pa", "Peak pressure";
    PMean, "p_mean", "_pa", "Pa", "Mean pressure";
    Area, "area", "_m2", "m2", "Contact area";
    Length, "length", "_m", "m", "Contact length";
    Width, "width", "_m", "m", "Contact width";
    Approach, "approach", "_m", "m", "Approach";
    Mu, "mu", "", "1", "Coefficient of friction";
    MuPloughing, "mu_ploughing", "", "1", "Friction of ploughing";
    MuViscous, "mu_viscous", "", "1", "Friction of the melt film";
    MuBoundary, "mu_boundary", "", "1", "Friction of boundary contact";
    GrooveDepth, "groove_depth", "_m", "m", "Depth of the groove";
    FilmMean, "film_mean", "_m", "m", "Mean thickness of the film";
}

/// Number of quantities of a contact at rest: the first ones of the list.
const AT_REST: usize = 6;

impl Quantity {
    /// The quantities of a sliding contact, or of a contact at rest.
    pub fn of(sliding: bool) -> &'static [Quantity] {
        if sliding {
            &Quantity::ALL
        } else {
            &Quantity::ALL[..AT_REST]
        }
    }

    /// The quantity that a tolerance applies to: the coefficient of friction or, at rest, the peak
    /// pressure.
    pub fn judged(sliding: bool) -> Quantity {
        if sliding {
            Quantity::Mu
        } else {
            Quantity::PMax
        }
    }

    /// Name without a unit, as `.lut` files spell it.
    pub fn name(self) -> &'static str {
        DESCRIPTIONS[self as usize][0]
    }

    /// Key with its unit, as CSV columns and `result.json` spell it.
    pub fn key(self) -> &'static str {
        DESCRIPTIONS[self as usize][1]
    }

    /// Key of the estimated error, with its unit.
    pub fn error_key(self) -> &'static str {
        DESCRIPTIONS[self as usize][2]
    }

    /// Unit; `1` for a dimensionless quantity.
    pub fn unit(self) -> &'static str {
        DESCRIPTIONS[self as usize][3]
    }

    /// Name in titles.
    pub fn title(self) -> &'static str {
        DESCRIPTIONS[self as usize][4]
    }

    /// The quantity of this [`name`](Self::name).
    pub fn from_name(name: &str) -> Option<Quantity> {
        Quantity::ALL.into_iter().find(|q| q.name() == name)
    }

    /// The quantity of a [`key`](Self::key), or of an [`error_key`](Self::error_key) with `true`.
    pub(crate) fn from_key(key: &str) -> Option<(Quantity, bool)> {
        let has_key = |q: &Quantity| q.key() == key || q.error_key() == key;
        let quantity = Quantity::ALL.into_iter().find(has_key)?;
        Some((quantity, quantity.error_key() == key))
    }

    /// The expectation that a value violates; `None` for a valid value. Pressures, sizes and
    /// friction must be positive. Ploughing and groove may be 0 (on ice that does not yield), and
    /// boundary friction too (if the film separates steel and ice). A subnormal number is the
    /// result of an underflow.
    pub(crate) fn expectation(self, value: f64) -> Option<&'static str> {
        match self {
            _ if value.is_subnormal() => Some("0 or a number of at least 2.3e-308 in size"),
            Quantity::Approach => None,
            Quantity::MuPloughing | Quantity::MuBoundary | Quantity::GrooveDepth => {
                (value < 0.0).then_some("0 or a positive number")
            }
            _ => (value <= 0.0).then_some("a positive number"),
        }
    }

    /// The expectation that an estimated error violates; `None` for a valid error.
    pub(crate) fn error_expectation(error: f64) -> Option<&'static str> {
        let wrong = error < 0.0 || error.is_subnormal();
        wrong.then_some("0 or a positive number, at least 2.3e-308")
    }
}

/// The method that solved a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Finite elements in ice and runner.
    #[default]
    FiniteElements,
    /// Boundary elements on the contact plane, verified by finite elements at the ends of the axes.
    BoundaryElements,
}

impl Method {
    /// Whether it is the default, which files omit.
    pub(crate) fn is_default(&self) -> bool {
        *self == Method::default()
    }
}

/// Values and estimated errors of the quantities of one solved contact.
///
/// ```
/// use kufe_lut::{Figures, Quantity};
/// let figures = Figures::at_rest([1.5e8, 1e8, 1e-5, 0.05, 3e-4, 1e-5])
///     .with_error(Quantity::PMax, 1e6);
/// assert_eq!(figures.get(Quantity::PMax), Some(1.5e8));
/// assert_eq!(figures.get(Quantity::Mu), None);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Figures {
    /// Values in the order of [`Quantity::ALL`]; NaN where absent.
    values: [f64; COUNT],
    /// Estimated discretisation errors; NaN where absent.
    errors: [f64; COUNT],
    /// The method that solved the contact.
    pub method: Method,
}

impl PartialEq for Figures {
    fn eq(&self, other: &Self) -> bool {
        let bits = |figures: &Figures| {
            [figures.values, figures.errors].map(|list| list.map(|value| (value + 0.0).to_bits()))
        };
        bits(self) == bits(other) && self.method == other.method
    }
}

impl Figures {
    /// Peak pressure [Pa], mean pressure [Pa], area [m2], length [m], width [m] and approach [m] of
    /// a contact at rest.
    pub fn at_rest(values: [f64; AT_REST]) -> Self {
        let empty = Figures {
            values: [f64::NAN; COUNT],
            errors: [f64::NAN; COUNT],
            method: Method::default(),
        };
        let pairs = Quantity::of(false).iter().zip(values);
        pairs.fold(empty, |figures, (quantity, value)| {
            figures.with(*quantity, value)
        })
    }

    /// Sets the value of a quantity, in its unit.
    #[must_use]
    pub fn with(mut self, quantity: Quantity, value: f64) -> Self {
        self.values[quantity as usize] = value;
        self
    }

    /// Sets the estimated error of a quantity, in its unit.
    #[must_use]
    pub fn with_error(mut self, quantity: Quantity, error: f64) -> Self {
        self.errors[quantity as usize] = error;
        self
    }

    /// Sets the method.
    #[must_use]
    pub fn by(mut self, method: Method) -> Self {
        self.method = method;
        self
    }

    /// The value of a quantity; `None` for a quantity of sliding in a contact at rest.
    pub fn get(&self, quantity: Quantity) -> Option<f64> {
        let value = self.values[quantity as usize];
        (!value.is_nan()).then_some(value)
    }

    /// The estimated error of a quantity; `None` if unknown.
    pub fn error(&self, quantity: Quantity) -> Option<f64> {
        let error = self.errors[quantity as usize];
        (!error.is_nan()).then_some(error)
    }

    /// Whether the runner slides.
    pub fn is_sliding(&self) -> bool {
        !self.values[Quantity::Mu as usize].is_nan()
    }

    /// The estimated error of the [judged](Quantity::judged) quantity, relative to its value.
    pub fn relative_error(&self) -> f64 {
        let judged = Quantity::judged(self.is_sliding()) as usize;
        self.errors[judged].abs() / self.values[judged].abs()
    }

    /// Key and value of the first figure that is infinite or missing.
    pub(crate) fn not_finite(&self) -> Option<(&'static str, f64)> {
        let sliding = self.is_sliding();
        let judged = Quantity::judged(sliding);
        let mut figures = Quantity::of(sliding).iter().flat_map(|&quantity| {
            let error = self.errors[quantity as usize];
            let optional = error.is_nan() && quantity != judged;
            [
                (quantity.key(), self.values[quantity as usize]),
                (quantity.error_key(), if optional { 0.0 } else { error }),
            ]
        });
        figures.find(|(_, value)| !value.is_finite())
    }
}
