//! Longitudinal friction: a fixed coefficient, or a quadratic in the contact pressure.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::{Error, in_range};

/// Which quantity the asperity factor zeta multiplies.
///
/// The paper's text states that asperities raise the pressure, its formula scales the coefficient;
/// both readings are allowed, the formula is the default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ZetaActsOn {
    /// `mu = 1e-3 zeta (b p^2 - c p + d)`, the paper's formula.
    #[default]
    Mu,
    /// `mu = 1e-3 (b (zeta p)^2 - c zeta p + d)`, the paper's text.
    Pressure,
}

/// Friction coefficient as a quadratic in the peak contact pressure, capped.
///
/// ```text
/// mu = min( 1e-3 zeta (b p^2 - c p + d), mu_cap ),   p in MPa
/// ```
///
/// Source: J. von Schleinitz et al., "Modeling Ice Friction for Vehicle Dynamics of a Bobsled",
/// longitudinal friction equation. The cap is dimensionless: the paper's table gives 0.007, which
/// its formula would multiply by 1e-3 once more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressureLaw {
    /// Quadratic coefficient [1e-3/MPa2].
    pub b: f64,
    /// Linear coefficient, entering with a minus sign [1e-3/MPa].
    pub c: f64,
    /// Constant [1e-3].
    pub d: f64,
    /// Largest coefficient of friction, dimensionless.
    pub mu_cap: f64,
    /// Asperity factor, 1 on smooth ice.
    pub zeta: f64,
    /// What the asperity factor multiplies.
    pub zeta_acts_on: ZetaActsOn,
}

impl PressureLaw {
    /// The published parameters: 0.088, 2.01, 14.66, cap 0.007, zeta 1.
    pub const PUBLISHED: PressureLaw = PressureLaw {
        b: 0.088,
        c: 2.01,
        d: 14.66,
        mu_cap: 0.007,
        zeta: 1.0,
        zeta_acts_on: ZetaActsOn::Mu,
    };

    /// Coefficient of friction at the peak pressure `p_pa` [Pa]; NaN gives NaN.
    ///
    /// Never negative: a parabola that dips below zero is cut off there.
    ///
    /// ```
    /// let law = kufe_sled::friction::PressureLaw::PUBLISHED;
    /// assert!((law.mu(11.42e6) - 3.18e-3).abs() < 0.01e-3);
    /// assert_eq!(law.mu(30e6), 0.007);
    /// ```
    pub fn mu(&self, p_pa: f64) -> f64 {
        let mu = self.uncapped(p_pa);
        if mu > self.mu_cap {
            self.mu_cap
        } else if mu < 0.0 {
            0.0
        } else {
            mu
        }
    }

    /// The quadratic before the cap; NaN gives NaN.
    pub fn uncapped(&self, p_pa: f64) -> f64 {
        let (on_mu, on_pressure) = self.factors();
        let p = on_pressure * p_pa * 1e-6;
        1e-3 * on_mu * ((self.b * p - self.c) * p + self.d)
    }

    /// Slope dmu/dp [1/Pa]; 0 where the coefficient is capped or limited to 0.
    pub fn slope(&self, p_pa: f64) -> f64 {
        let mu = self.uncapped(p_pa);
        if mu > self.mu_cap || mu < 0.0 {
            return 0.0;
        }
        let (on_mu, on_pressure) = self.factors();
        let p = on_pressure * p_pa * 1e-6;
        1e-9 * on_mu * on_pressure * (2.0 * self.b * p - self.c)
    }

    /// Checks that every number is finite, cap and zeta positive and the parabola not open
    /// downwards.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the key.
    pub fn check(&self) -> Result<(), Error> {
        in_range("b", self.b, self.b >= 0.0, "a finite number, 0 or more")?;
        in_range("c", self.c, true, "a finite number")?;
        in_range("d", self.d, true, "a finite number")?;
        let cap = self.mu_cap > 0.0 && self.mu_cap <= 1.0;
        in_range("mu_cap", self.mu_cap, cap, "above 0, up to 1 (0.007)")?;
        in_range("zeta", self.zeta, self.zeta > 0.0, "a positive number")
    }

    fn factors(&self) -> (f64, f64) {
        match self.zeta_acts_on {
            ZetaActsOn::Mu => (self.zeta, 1.0),
            ZetaActsOn::Pressure => (1.0, self.zeta),
        }
    }
}

/// Longitudinal friction of one runner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Longitudinal {
    /// A constant coefficient, dimensionless.
    Fixed(f64),
    /// A quadratic in the peak pressure.
    Pressure(PressureLaw),
}

impl Longitudinal {
    /// The paper's quadratic in the pressure.
    pub const PUBLISHED: Longitudinal = Longitudinal::Pressure(PressureLaw::PUBLISHED);

    /// Coefficient of friction at the peak pressure `p_pa` [Pa]; a fixed one ignores the pressure.
    pub fn mu(&self, p_pa: f64) -> f64 {
        match self {
            Longitudinal::Fixed(mu) => *mu,
            Longitudinal::Pressure(law) => law.mu(p_pa),
        }
    }
}

/// Longitudinal force on a runner [N]: `F_x = -mu F_z cos(alpha)`.
///
/// `fz` is the normal force [N], `alpha` the slip angle [rad]. Negative: it acts against the
/// motion.
///
/// ```
/// assert!((kufe_sled::friction::longitudinal_force(1000.0, 0.0, 0.004) + 4.0).abs() < 1e-12);
/// ```
pub fn longitudinal_force(fz: f64, alpha: f64, mu: f64) -> f64 {
    -mu * fz * alpha.cos()
}

/// The keys of `[friction.longitudinal]` as written in a model file.
///
/// Either `mu`, or `b`, `c`, `d` with `mu_cap` and optionally `zeta` and `zeta_acts_on`, or tables
/// of mu alone with optionally `zeta`, or `film` with optionally `zeta`. The paths of the tables
/// are stored here and opened by [`Vehicle::new`](crate::Vehicle::new).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LongitudinalKeys {
    /// Fixed coefficient, dimensionless.
    pub mu: Option<f64>,
    /// Quadratic coefficient [1e-3/MPa2].
    pub b: Option<f64>,
    /// Linear coefficient [1e-3/MPa].
    pub c: Option<f64>,
    /// Constant [1e-3].
    pub d: Option<f64>,
    /// Largest coefficient of friction, dimensionless; 0.007 where absent.
    pub mu_cap: Option<f64>,
    /// Asperity factor, of tables of mu too; 1 where absent.
    pub zeta: Option<f64>,
    /// What the asperity factor multiplies; the coefficient where absent.
    pub zeta_acts_on: Option<ZetaActsOn>,
    /// The melt film on the contact that each friction experiment states, times `zeta`; no law for a
    /// sled, whose runners have tables.
    pub film: Option<bool>,
    /// Lookup table of the front runner's pressure or, without `mu` and the quadratic, of its mu, a
    /// path.
    pub front_table: Option<String>,
    /// As `front_table`, of the rear runner.
    pub rear_table: Option<String>,
}

impl LongitudinalKeys {
    /// The factor on mu if mu is read from the tables; `None` if another key states a law.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a factor that is not positive.
    pub fn tabled(&self) -> Result<Option<f64>, Error> {
        let is_table = |key: &str| key.ends_with("_table");
        let law = self.stated().any(|key| key != "zeta" && !is_table(key));
        if law || !self.stated().any(is_table) {
            return Ok(None);
        }
        self.factor().map(Some)
    }

    /// The asperity factor.
    fn factor(&self) -> Result<f64, Error> {
        let zeta = self.zeta.unwrap_or(1.0);
        in_range("zeta", zeta, zeta > 0.0, "a positive number")?;
        Ok(zeta)
    }

    /// Stated keys, except `film`.
    fn stated(&self) -> impl Iterator<Item = &'static str> {
        let keys = [
            ("mu", self.mu.is_some()),
            ("b", self.b.is_some()),
            ("c", self.c.is_some()),
            ("d", self.d.is_some()),
            ("mu_cap", self.mu_cap.is_some()),
            ("zeta", self.zeta.is_some()),
            ("zeta_acts_on", self.zeta_acts_on.is_some()),
            ("front_table", self.front_table.is_some()),
            ("rear_table", self.rear_table.is_some()),
        ];
        let stated = keys.into_iter().filter(|(_, stated)| *stated);
        stated.map(|(key, _)| key)
    }

    /// The factor on mu if the melt film of friction experiments is the law (`film = true`); `None`
    /// otherwise.
    ///
    /// # Errors
    /// [`Error::KeysExclude`] where another law is stated, [`Error::OutOfRange`] for a factor that
    /// is not positive.
    pub fn film(&self) -> Result<Option<f64>, Error> {
        if self.film != Some(true) {
            return Ok(None);
        }
        if let Some(other) = self.stated().find(|key| *key != "zeta") {
            return Err(Error::KeysExclude {
                key: "film",
                other,
                expected: "film alone, or with zeta",
            });
        }
        self.factor().map(Some)
    }

    /// The law that the keys state, unless it is [tabled](Self::tabled).
    ///
    /// # Errors
    /// [`Error::MissingKey`] if the law is the [`film`](Self::film) of friction experiments or the
    /// quadratic is incomplete, [`Error::KeysExclude`] if `mu` is stated with a key of the
    /// quadratic, [`Error::OutOfRange`] for numbers that no friction law has.
    pub fn model(&self) -> Result<Longitudinal, Error> {
        const EITHER: &str =
            "either mu, or b, c, d and mu_cap, or front_table and rear_table of mu";
        if self.film()?.is_some() {
            return Err(Error::MissingKey {
                key: "mu",
                expected: "mu, or b, c and d, or front_table and rear_table of mu (kufe lut): film = true is a law of friction experiments alone",
            });
        }
        if let Some(mu) = self.mu {
            let mut others = self.stated().filter(|key| *key != "mu");
            if let Some(other) = others.find(|key| !key.ends_with("_table")) {
                return Err(Error::KeysExclude {
                    key: "mu",
                    other,
                    expected: EITHER,
                });
            }
            in_range("mu", mu, (0.0..=1.0).contains(&mu), "0 to 1 (0.004)")?;
            return Ok(Longitudinal::Fixed(mu));
        }
        let need = |key: &'static str, value: Option<f64>| {
            value.ok_or(Error::MissingKey {
                key,
                expected: EITHER,
            })
        };
        let law = PressureLaw {
            b: need("b", self.b)?,
            c: need("c", self.c)?,
            d: need("d", self.d)?,
            mu_cap: self.mu_cap.unwrap_or(PressureLaw::PUBLISHED.mu_cap),
            zeta: self.zeta.unwrap_or(1.0),
            zeta_acts_on: self.zeta_acts_on.unwrap_or_default(),
        };
        law.check()?;
        Ok(Longitudinal::Pressure(law))
    }
}

impl From<PressureLaw> for LongitudinalKeys {
    fn from(law: PressureLaw) -> Self {
        LongitudinalKeys {
            b: Some(law.b),
            c: Some(law.c),
            d: Some(law.d),
            mu_cap: Some(law.mu_cap),
            zeta: Some(law.zeta),
            zeta_acts_on: Some(law.zeta_acts_on),
            ..Default::default()
        }
    }
}
