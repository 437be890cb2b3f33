//! A point of a table and the figures of the contact solved there.

use crate::table::quantity::Quantity;

/// The figures of one solved contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solved {
    /// Peak pressure [Pa].
    pub p_max: f64,
    /// Estimated discretisation error of the peak pressure [Pa].
    pub p_max_error: f64,
    /// Force over contact area [Pa].
    pub p_mean: f64,
    /// Contact area [m2].
    pub area: f64,
    /// Extent of the contact along the runner [m].
    pub length: f64,
    /// Extent of the contact across the runner [m].
    pub width: f64,
    /// Rigid approach [m].
    pub approach: f64,
    /// What sliding adds; `None` for a contact at rest.
    pub sliding: Option<Sliding>,
    /// Which method solved it; no figure.
    pub method: Method,
}

/// Which method solved a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Finite elements in ice and runner.
    #[default]
    FiniteElements,
    /// Boundary elements on the contact plane, which finite elements confirmed at the ends of what was swept.
    BoundaryElements,
}

impl Method {
    /// Both.
    pub const ALL: [Method; 2] = [Method::FiniteElements, Method::BoundaryElements];

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Method::FiniteElements => "finite-elements",
            Method::BoundaryElements => "boundary-elements",
        }
    }

    /// The method of this name.
    pub fn named(name: &str) -> Option<Self> {
        Method::ALL.into_iter().find(|method| method.name() == name)
    }
}

/// What a runner that slides adds to the figures of its contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sliding {
    /// Coefficient of friction.
    pub mu: f64,
    /// Estimated error of it.
    pub mu_error: f64,
    /// Part of it that ploughs the groove.
    pub mu_ploughing: f64,
    /// Part of it that shears the melt film.
    pub mu_viscous: f64,
    /// Depth of the groove [m].
    pub groove_depth: f64,
    /// Thickness of the film averaged over the patch [m].
    pub film_mean: f64,
}

/// Keys of [`Solved::figures`] of a runner that slides.
const KEYS: [&str; 13] = [
    "p_max_pa",
    "p_max_error_pa",
    "p_mean_pa",
    "area_m2",
    "length_m",
    "width_m",
    "approach_m",
    "mu",
    "mu_error",
    "mu_ploughing",
    "mu_viscous",
    "groove_depth_m",
    "film_mean_m",
];
/// How many of them a contact at rest has.
const AT_REST: usize = 7;

impl Solved {
    /// Keys of [`figures`](Self::figures), sliding or at rest.
    pub fn keys(sliding: bool) -> &'static [&'static str] {
        if sliding { &KEYS } else { &KEYS[..AT_REST] }
    }

    /// One figure; `None` where a contact at rest has none of its kind.
    pub fn get(&self, quantity: Quantity) -> Option<f64> {
        Some(match quantity {
            Quantity::PMax => self.p_max,
            Quantity::PMean => self.p_mean,
            Quantity::Area => self.area,
            Quantity::Length => self.length,
            Quantity::Width => self.width,
            Quantity::Approach => self.approach,
            Quantity::Mu => self.sliding?.mu,
            Quantity::MuPloughing => self.sliding?.mu_ploughing,
            Quantity::MuViscous => self.sliding?.mu_viscous,
            Quantity::GrooveDepth => self.sliding?.groove_depth,
            Quantity::FilmMean => self.sliding?.film_mean,
        })
    }

    /// The solver's own estimated error, relative: of the coefficient of friction or, at rest, of the peak pressure.
    pub fn relative_error(&self) -> f64 {
        match &self.sliding {
            None => self.p_max_error.abs() / self.p_max.abs(),
            Some(sliding) => sliding.mu_error.abs() / sliding.mu.abs(),
        }
    }

    /// All figures in the order of [`keys`](Self::keys).
    pub fn figures(&self) -> Vec<f64> {
        let mut figures = vec![
            self.p_max,
            self.p_max_error,
            self.p_mean,
            self.area,
            self.length,
            self.width,
            self.approach,
        ];
        if let Some(sliding) = &self.sliding {
            figures.extend([
                sliding.mu,
                sliding.mu_error,
                sliding.mu_ploughing,
                sliding.mu_viscous,
                sliding.groove_depth,
                sliding.film_mean,
            ]);
        }
        figures
    }

    /// The inverse of [`figures`](Self::figures), by finite elements.
    ///
    /// # Panics
    /// Where there are not as many as [`keys`](Self::keys).
    pub fn from_figures(figures: &[f64]) -> Self {
        let sliding = match figures[AT_REST..] {
            [] => None,
            [
                mu,
                mu_error,
                mu_ploughing,
                mu_viscous,
                groove_depth,
                film_mean,
            ] => Some(Sliding {
                mu,
                mu_error,
                mu_ploughing,
                mu_viscous,
                groove_depth,
                film_mean,
            }),
            _ => panic!(
                "{} figures, expected {AT_REST} or {}",
                figures.len(),
                KEYS.len()
            ),
        };
        Solved {
            p_max: figures[0],
            p_max_error: figures[1],
            p_mean: figures[2],
            area: figures[3],
            length: figures[4],
            width: figures[5],
            approach: figures[6],
            sliding,
            method: Method::default(),
        }
    }
}

/// Where a contact is solved.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Normal force [N].
    pub fz: f64,
    /// Track curvature in the vertical plane, positive in a valley [1/m].
    pub curvature: f64,
    /// Rocker radius of the runner where the table has that axis [m].
    pub rocker_radius: Option<f64>,
    /// Speed where the table has that axis [m/s].
    pub speed: Option<f64>,
    /// Temperature of the ice where the table has that axis [C].
    pub ice_c: Option<f64>,
}

impl Point {
    /// Keys and values of the axes that the point has, in the order of the axes.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, f64)> {
        [
            ("fz_n", Some(self.fz)),
            ("curvature_1pm", Some(self.curvature)),
            ("rocker_radius_m", self.rocker_radius),
            ("v_mps", self.speed),
            ("ice_c", self.ice_c),
        ]
        .into_iter()
        .filter_map(|(key, value)| Some((key, value?)))
    }
}

impl std::fmt::Display for Point {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (n, (key, value)) in self.named().enumerate() {
            let comma = if n == 0 { "" } else { ", " };
            write!(f, "{comma}{key} = {value}")?;
        }
        Ok(())
    }
}
