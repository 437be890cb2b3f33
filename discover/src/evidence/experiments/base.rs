//! Base laws of friction that are fitted before candidates are screened.

use kufe_sled::Model;
use kufe_sled::friction::Longitudinal;

use crate::error::Result;
use crate::evidence::experiments::rows::Row;

/// The base law of the model, linear in its coefficients.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Base {
    /// `mu`.
    Fixed,
    /// `mu = 1e-3 (b p^2 - c p + d)`, p in MPa.
    Pressure,
    /// `mu = zeta mu_film`, the melt film on the contact of each row.
    Film,
}

impl Base {
    /// The base law of a model.
    ///
    /// # Errors
    /// [`Error::Sled`](crate::error::Error::Sled) if the model has no friction law for a table of
    /// coefficients.
    pub fn of(model: &Model) -> Result<Base> {
        let keys = &model.friction.longitudinal;
        if keys.film()?.is_some() {
            return Ok(Base::Film);
        }
        Ok(match keys.model()? {
            Longitudinal::Pressure(_) => Base::Pressure,
            Longitudinal::Fixed(_) => Base::Fixed,
        })
    }

    /// Name and unit of each coefficient, and its value in the model for 1 in the fit.
    pub fn coefficients(self) -> &'static [(&'static str, &'static str, f64)] {
        match self {
            Base::Fixed => &[("mu", "", 1.0)],
            Base::Pressure => &[
                ("b", "1e-3/MPa2", 1e3),
                ("c", "1e-3/MPa", -1e3),
                ("d", "1e-3", 1e3),
            ],
            Base::Film => &[("zeta", "", 1.0)],
        }
    }

    pub fn len(self) -> usize {
        self.coefficients().len()
    }

    /// Columns of the design matrix: p^2, p, 1 with p in MPa; 1; or the friction of the film.
    pub fn columns(self, row: &Row) -> Vec<f64> {
        let p = row.pressure / 1e6;
        match self {
            Base::Fixed => vec![1.0],
            Base::Pressure => vec![p * p, p, 1.0],
            Base::Film => vec![row.film],
        }
    }

    /// Derivative of mu with respect to pressure [1/MPa].
    pub fn pressure_slope(self, row: &Row, coefficients: &[f64]) -> f64 {
        match self {
            Base::Pressure => 2.0 * coefficients[0] * row.pressure / 1e6 + coefficients[1],
            _ => 0.0,
        }
    }
}
