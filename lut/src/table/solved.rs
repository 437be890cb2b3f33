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
    /// Estimated errors of mean pressure, area, length, width and approach; `None` in tables that were made without them.
    pub errors: Option<Errors>,
    /// What sliding adds; `None` for a contact at rest.
    pub sliding: Option<Sliding>,
    /// Which method solved it; no figure.
    pub method: Method,
}

/// Estimated discretisation errors of a contact's figures beside its peak pressure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Of the mean pressure [Pa].
    pub p_mean: f64,
    /// Of the area [m2].
    pub area: f64,
    /// Of the length [m].
    pub length: f64,
    /// Of the width [m].
    pub width: f64,
    /// Of the approach [m].
    pub approach: f64,
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

/// Keys of figures that every contact has.
const AT_REST: [&str; 7] = [
    "p_max_pa",
    "p_max_error_pa",
    "p_mean_pa",
    "area_m2",
    "length_m",
    "width_m",
    "approach_m",
];
/// Keys of [`Errors`].
const ERRORS: [&str; 5] = [
    "p_mean_error_pa",
    "area_error_m2",
    "length_error_m",
    "width_error_m",
    "approach_error_m",
];
/// Keys of [`Sliding`].
const SLIDING: [&str; 6] = [
    "mu",
    "mu_error",
    "mu_ploughing",
    "mu_viscous",
    "groove_depth_m",
    "film_mean_m",
];

impl Solved {
    /// Keys of [`figures`](Self::figures) of contacts that slide or rest, with or without [`errors`](Self::errors).
    pub fn keys(sliding: bool, errors: bool) -> Vec<&'static str> {
        let with = |keys: &'static [&'static str], are: bool| keys.iter().filter(move |_| are);
        let further = with(&ERRORS, errors).chain(with(&SLIDING, sliding));
        AT_REST.iter().chain(further).copied().collect()
    }

    /// Those of this contact.
    pub fn own_keys(&self) -> Vec<&'static str> {
        Self::keys(self.sliding.is_some(), self.errors.is_some())
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

    /// The solver's own estimated error of a figure; `None` where it is not kept.
    pub fn error(&self, quantity: Quantity) -> Option<f64> {
        Some(match quantity {
            Quantity::PMax => self.p_max_error,
            Quantity::PMean => self.errors?.p_mean,
            Quantity::Area => self.errors?.area,
            Quantity::Length => self.errors?.length,
            Quantity::Width => self.errors?.width,
            Quantity::Approach => self.errors?.approach,
            Quantity::Mu => self.sliding?.mu_error,
            _ => return None,
        })
    }

    /// The solver's own estimated error, relative: of the coefficient of friction or, at rest, of the peak pressure.
    pub fn relative_error(&self) -> f64 {
        match &self.sliding {
            None => self.p_max_error.abs() / self.p_max.abs(),
            Some(sliding) => sliding.mu_error.abs() / sliding.mu.abs(),
        }
    }

    /// All figures in the order of [`own_keys`](Self::own_keys).
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
        if let Some(errors) = &self.errors {
            figures.extend([
                errors.p_mean,
                errors.area,
                errors.length,
                errors.width,
                errors.approach,
            ]);
        }
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
        let (at_rest, further) = figures.split_at(AT_REST.len());
        let all = ERRORS.len() + SLIDING.len();
        let (errors, further) = match further.len() {
            n if n == ERRORS.len() || n == all => further.split_at(ERRORS.len()),
            _ => (&[][..], further),
        };
        let errors = match *errors {
            [p_mean, area, length, width, approach] => Some(Errors {
                p_mean,
                area,
                length,
                width,
                approach,
            }),
            _ => None,
        };
        let sliding = match *further {
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
            _ => panic!("{} figures, expected 7, 12, 13 or 18", figures.len()),
        };
        Solved {
            p_max: at_rest[0],
            p_max_error: at_rest[1],
            p_mean: at_rest[2],
            area: at_rest[3],
            length: at_rest[4],
            width: at_rest[5],
            approach: at_rest[6],
            errors,
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
