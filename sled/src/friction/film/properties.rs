//! Input of the film equation: the strip of pressure, sliding conditions, water and ice, hardness,
//! heat into the ice.

use std::f64::consts::{FRAC_2_SQRT_PI, PI, SQRT_2};

use statrs::function::erf::erfc;

use crate::error::{Error, in_range};

/// Material constants of the film and of its two walls, all at 0 C.
///
/// They are independent of temperature. Between 0 and -10 C the conductivity of ice rises by 5 %,
/// its heat capacity falls by 4 %, and the viscosity of water below 0 C rises by 4 % per kelvin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Properties {
    /// Dynamic viscosity of water [Pa s].
    pub water_viscosity: f64,
    /// Density of water [kg/m3].
    pub water_density: f64,
    /// Density of ice [kg/m3].
    pub ice_density: f64,
    /// Specific heat capacity of ice [J/(kg K)].
    pub ice_heat_capacity: f64,
    /// Thermal conductivity of ice [W/(m K)].
    pub ice_conductivity: f64,
    /// Latent heat of melting [J/kg].
    pub latent_heat: f64,
    /// Change of the melting point with pressure, negative for ice [K/Pa].
    pub melting_slope: f64,
    /// Thermal conductivity of the runner's steel [W/(m K)].
    pub steel_conductivity: f64,
    /// Density times specific heat capacity of the steel [J/(m3 K)].
    pub steel_volumetric_heat: f64,
}

impl Properties {
    /// Water, ice Ih and a carbon steel at 0 C.
    ///
    /// | constant | source |
    /// |---|---|
    /// | viscosity 1.79e-3 Pa s, density 999.8 kg/m3 of water | CRC Handbook of Chemistry and Physics, properties of water and steam |
    /// | density 917 kg/m3, latent heat 3.34e5 J/kg, melting slope -7.4e-8 K/Pa | V.F. Petrenko, R.W. Whitworth, Physics of Ice, Oxford 1999 |
    /// | conductivity 2.2 W/(m K), heat capacity 2050 J/(kg K) of ice | Petrenko and Whitworth, rounded to the digits common to 0 and -5 C |
    /// | conductivity 45 W/(m K), volumetric heat 3.6e6 J/(m3 K) of steel | CRC Handbook, plain carbon steel |
    pub const WATER_AND_ICE: Properties = Properties {
        water_viscosity: 1.79e-3,
        water_density: 999.8,
        ice_density: 917.0,
        ice_heat_capacity: 2050.0,
        ice_conductivity: 2.2,
        latent_heat: 3.34e5,
        melting_slope: -7.4e-8,
        steel_conductivity: 45.0,
        steel_volumetric_heat: 3.6e6,
    };

    /// Melting point of ice [C] at the pressure `p` [Pa] above atmospheric.
    ///
    /// `T_m = p dT_m/dp`: linear, 0.4 K too warm at 50 MPa.
    pub fn melting_temperature(&self, p: f64) -> f64 {
        self.melting_slope * p
    }

    /// Thermal diffusivity of ice [m2/s].
    pub fn ice_diffusivity(&self) -> f64 {
        self.ice_conductivity / (self.ice_density * self.ice_heat_capacity)
    }

    /// Heat of melting per volume of water [J/m3].
    pub fn heat_of_water(&self) -> f64 {
        self.water_density * self.latent_heat
    }

    /// Checks that every constant is finite, that conductivities are 0 or more and the others
    /// positive.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the constant's name.
    pub fn check(&self) -> Result<(), Error> {
        let positive = [
            ("water_viscosity", self.water_viscosity),
            ("water_density", self.water_density),
            ("ice_density", self.ice_density),
            ("ice_heat_capacity", self.ice_heat_capacity),
            ("latent_heat", self.latent_heat),
            ("steel_volumetric_heat", self.steel_volumetric_heat),
        ];
        for (name, value) in positive {
            in_range(name, value, value > 0.0, "a positive number")?;
        }
        for (name, value) in [
            ("ice_conductivity", self.ice_conductivity),
            ("steel_conductivity", self.steel_conductivity),
        ] {
            in_range(name, value, value >= 0.0, "0 or more")?;
        }
        in_range("melting_slope", self.melting_slope, true, "a finite number")
    }
}

/// Speed and temperatures of a runner that slides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmConditions {
    /// Sliding speed [m/s].
    pub v: f64,
    /// Temperature of the ice ahead of the runner [C].
    pub ice_c: f64,
    /// Temperature of the runner's steel before it slid [C].
    pub steel_c: f64,
    /// Time of sliding, during which heat went into the steel [s].
    pub sliding_time: f64,
    /// Factor on the viscosity of water, e.g. above 1 for a slurry of ice and water.
    pub viscosity_factor: f64,
    /// Roughness and shear stress of asperities that touch through the film.
    pub boundary: BoundaryContact,
}

impl FilmConditions {
    /// A runner as cold as the ice, ten seconds after its start, over plain water.
    pub fn new(v: f64, ice_c: f64) -> Self {
        FilmConditions {
            v,
            ice_c,
            steel_c: ice_c,
            sliding_time: 10.0,
            viscosity_factor: 1.0,
            boundary: BoundaryContact::NONE,
        }
    }

    /// Viscosity of the film [Pa s].
    pub fn viscosity(&self, properties: &Properties) -> f64 {
        self.viscosity_factor * properties.water_viscosity
    }

    /// Checks the numbers.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a speed, time or factor that is not positive, ice outside -100 to
    /// 0 C, steel outside -100 to 100 C.
    pub fn check(&self) -> Result<(), Error> {
        let positive = "a positive number";
        in_range("v", self.v, self.v > 0.0, positive)?;
        let ice = self.ice_c;
        in_range("ice_c", ice, (-100.0..=0.0).contains(&ice), "-100 to 0 C")?;
        let steel = self.steel_c;
        let steel_range = (-100.0..=100.0).contains(&steel);
        in_range("steel_c", steel, steel_range, "-100 to 100 C")?;
        let time = self.sliding_time;
        in_range("sliding_time", time, time > 0.0, positive)?;
        let factor = self.viscosity_factor;
        in_range("viscosity_factor", factor, factor > 0.0, positive)?;
        let BoundaryContact { roughness, shear } = self.boundary;
        in_range("roughness", roughness, roughness >= 0.0, "0 or more")?;
        in_range("boundary_shear", shear, shear >= 0.0, "0 or more")
    }
}

/// Asperities of steel and ice that touch through the film: mixed lubrication.
///
/// The heights of both surfaces together are Gaussian with the standard deviation `sigma`.
/// Asperities higher than the film thickness `h` touch, with the same shear stress everywhere:
///
/// ```text
/// tau = mu V/h + tau_b phi(h/sigma),    phi(z) = erfc(z/sqrt 2)
/// ```
///
/// `phi` counts both tails, so that it is 1 where there is no film. Source of mixed lubrication: N.
/// Patir, H.S. Cheng, J. Lubr. Technol. 100 (1978) 12-17. Source of the share of a Gaussian
/// surface: J.A. Greenwood, J.B.P. Williamson, Proc. R. Soc. A 295 (1966) 300-319.
///
/// ```
/// use kufe_sled::friction::film::BoundaryContact;
/// let rough = BoundaryContact { roughness: 0.5e-6, shear: 60e3 };
/// assert_eq!(rough.share(0.0), 1.0);
/// assert!((rough.share(0.5e-6) - 0.3173).abs() < 1e-4); // outside one standard deviation
/// assert_eq!(BoundaryContact::NONE.share(1e-9), 0.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundaryContact {
    /// Standard deviation of the heights of steel and ice together [m].
    pub roughness: f64,
    /// Shear stress where they touch [Pa].
    pub shear: f64,
}

impl BoundaryContact {
    /// The film alone.
    pub const NONE: BoundaryContact = BoundaryContact {
        roughness: 0.0,
        shear: 0.0,
    };

    /// Share of the area that touches through a film of thickness `h` [m]; 0 for surfaces without
    /// roughness.
    pub fn share(&self, h: f64) -> f64 {
        let rough = self.roughness > 0.0;
        if rough {
            erfc(h / (SQRT_2 * self.roughness))
        } else {
            0.0
        }
    }

    /// Derivative of [`share`](Self::share) with respect to the thickness [1/m].
    pub(crate) fn share_slope(&self, h: f64) -> f64 {
        if self.roughness > 0.0 {
            let z = h / (SQRT_2 * self.roughness);
            -FRAC_2_SQRT_PI * (-z * z).exp() / (SQRT_2 * self.roughness)
        } else {
            0.0
        }
    }
}

/// Accuracy of the integration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmOptions {
    /// Largest relative discretisation error of every total, 1e-10 to 0.1. Errors of heat and
    /// water, which may be small differences, are relative to the dissipated power and to the water
    /// that it would melt. 1e-8 is reached on every patch that was tried (thousands, some with
    /// steps in the pressure); if not, [`Error::NotConverged`] states the error that was reached.
    pub accuracy: f64,
}

impl Default for FilmOptions {
    fn default() -> Self {
        FilmOptions { accuracy: 1e-6 }
    }
}

impl FilmOptions {
    /// Checks the number.
    ///
    /// # Errors
    /// [`Error::OutOfRange`].
    pub fn check(&self) -> Result<(), Error> {
        let holds = (1e-10..=0.1).contains(&self.accuracy);
        in_range("accuracy", self.accuracy, holds, "1e-10 to 0.1")
    }
}

/// A contact patch much longer than wide, given at stations from its leading edge.
///
/// Between stations the pressure and the *square* of the width are linear. A round section of
/// radius `r` at the depth `D` has `w^2 = 8 r D`, linear in depth, so that few stations resolve the
/// rounded ends of a patch.
#[derive(Clone, Debug, PartialEq)]
pub struct Strip {
    xi: Vec<f64>,
    width: Vec<f64>,
    pressure: Vec<f64>,
}

impl Strip {
    /// A strip from stations `xi` [m], widths [m] and pressures averaged over the width [Pa], three
    /// columns of equal length.
    ///
    /// # Errors
    /// [`Error::TooFew`] for fewer than two stations or columns of unequal length.
    /// [`Error::OutOfRange`] if the stations do not start at 0 and ascend, if a width is negative
    /// or, between the ends, 0, if a pressure is negative, if no load is carried, or if a number is
    /// not finite.
    pub fn new(xi: Vec<f64>, width: Vec<f64>, pressure: Vec<f64>) -> Result<Self, Error> {
        let n = xi.len();
        for (what, have, holds, needed) in [
            ("stations of a strip", n, n >= 2, 2),
            (
                "widths of a strip, one per station",
                width.len(),
                width.len() == n,
                n,
            ),
            (
                "pressures of a strip, one per station",
                pressure.len(),
                pressure.len() == n,
                n,
            ),
        ] {
            if !holds {
                return Err(Error::too_few(what, have, needed));
            }
        }
        in_range("xi", xi[0], xi[0] == 0.0, "0 at the leading edge")?;
        for pair in xi.windows(2) {
            in_range("xi", pair[1], pair[1] > pair[0], "stations that ascend")?;
        }
        for (k, &w) in width.iter().enumerate() {
            let end = k == 0 || k + 1 == n;
            let holds = w > 0.0 || end && w == 0.0;
            let expected = "above 0 between the ends, 0 or more there";
            in_range("width", w, holds, expected)?;
        }
        for &p in &pressure {
            in_range("pressure", p, p >= 0.0, "0 or more")?;
        }
        let strip = Strip {
            xi,
            width,
            pressure,
        };
        let carried: f64 = (0..n).map(|k| strip.width[k] * strip.pressure[k]).sum();
        in_range("pressure", carried, carried > 0.0, "a load that is carried")?;
        Ok(strip)
    }

    /// A rectangle of `length` [m] and `width` [m] under the uniform `pressure` [Pa].
    ///
    /// # Errors
    /// [`Error::OutOfRange`] as for [`Strip::new`].
    pub fn uniform(length: f64, width: f64, pressure: f64) -> Result<Self, Error> {
        Strip::new(vec![0.0, length], vec![width; 2], vec![pressure; 2])
    }

    /// Stations from the leading edge [m], the first 0.
    pub fn xi(&self) -> &[f64] {
        &self.xi
    }

    /// Widths at the stations [m].
    pub fn width(&self) -> &[f64] {
        &self.width
    }

    /// Pressures averaged over the width at the stations [Pa].
    pub fn pressure(&self) -> &[f64] {
        &self.pressure
    }

    /// Length from the leading to the trailing edge [m].
    pub fn length(&self) -> f64 {
        self.xi[self.xi.len() - 1]
    }

    /// Largest width [m].
    pub fn largest_width(&self) -> f64 {
        self.width.iter().copied().fold(0.0, f64::max)
    }

    /// Ratio of the length to the largest width.
    pub fn aspect(&self) -> f64 {
        self.length() / self.largest_width()
    }

    /// The strip on every second station, and the last one; `None` below four stations.
    ///
    /// The change of a result on it shows how well the stations resolve width and pressure.
    pub fn every_second(&self) -> Option<Self> {
        let n = self.xi.len();
        if n < 4 {
            return None;
        }
        let thinned = |values: &[f64]| -> Vec<f64> {
            let mut chosen: Vec<f64> = values[..n - 1].iter().copied().step_by(2).collect();
            chosen.push(values[n - 1]);
            chosen
        };
        let [xi, width, pressure] = [&self.xi, &self.width, &self.pressure].map(|x| thinned(x));
        Strip::new(xi, width, pressure).ok()
    }
}

/// Linear interpolation at `at` between the values at the ends of segment `k` of `xi`.
pub(crate) fn between(xi: &[f64], values: &[f64], k: usize, at: f64) -> f64 {
    let share = (at - xi[k]) / (xi[k + 1] - xi[k]);
    values[k] + share * (values[k + 1] - values[k])
}

/// Molar gas constant [J/(mol K)], exact in the SI of 2019.
const GAS_CONSTANT: f64 = 8.314_462_618;

/// 0 C [K].
const ZERO_CELSIUS: f64 = 273.15;

/// Temperature at which the activation energy of the creep of ice changes [C].
const KNEE: f64 = -8.0;

/// Activation energy above the knee, where water between the grains helps [J/mol].
const ENERGY_ABOVE: f64 = 120.0e3;

/// Activation energy below the knee [J/mol].
const ENERGY_BELOW: f64 = 78.0e3;

/// Stress exponent of the creep of ice.
pub const HARDNESS_EXPONENT: f64 = 3.0;

/// Indentation hardness of ice, extrapolated from one known point by the creep law.
///
/// An indentation by creep at the rate `A H^n exp(-Q/(R T))` within the contact time `t` gives
///
/// ```text
/// H(T, t) = H_0 (t/t_0)^(-1/n) exp( integral from T_0 to T of Q/(n R) d(1/T) ),   n = 3
/// Q = 120 kJ/mol above -8 C, 78 kJ/mol below,   H <= T/(dT_m/dp)
/// ```
///
/// The energies and the law: P. Barnes, D. Tabor, J.C.F. Walker, Proc. R. Soc. Lond. A 324 (1971)
/// 127-155. Across -8 C the integral is taken piecewise, so that the hardness is continuous. The
/// bound is pressure melting, [`pressure_melting_bound`].
///
/// ```
/// use kufe_sled::friction::film::{IceHardness, Properties};
/// let hardness = IceHardness::new(17.7e6, -5.0, 2.0e-3)?; // 17.7 MPa at -5 C within 2 ms
/// let colder = hardness.at(-15.0, 2.0e-3, &Properties::WATER_AND_ICE)?;
/// let slower = hardness.at(-5.0, 16.0e-3, &Properties::WATER_AND_ICE)?;
/// assert!(colder > 17.7e6);
/// assert!((slower / 17.7e6 - 0.5).abs() < 1e-12);
/// # Ok::<(), kufe_sled::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IceHardness {
    pressure: f64,
    temperature: f64,
    contact_time: f64,
}

impl IceHardness {
    /// From the hardness `pressure` [Pa] that was measured at `temperature` [C] within
    /// `contact_time` [s].
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a pressure or time that is not positive, or a temperature
    /// outside -100 to 0 C.
    pub fn new(pressure: f64, temperature: f64, contact_time: f64) -> Result<Self, Error> {
        in_range("pressure", pressure, pressure > 0.0, "a positive number")?;
        check(temperature, contact_time)?;
        Ok(IceHardness {
            pressure,
            temperature,
            contact_time,
        })
    }

    /// Hardness [Pa] at `temperature` [C] within `contact_time` [s], at most the pressure that
    /// melts the ice.
    ///
    /// The contact time of a runner with contact length `l` at the speed `V` is `l/V`. The hardness
    /// at 0 C is 0, since ice there melts under any pressure.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a time that is not positive, or a temperature outside -100 to 0 C.
    pub fn at(
        &self,
        temperature: f64,
        contact_time: f64,
        properties: &Properties,
    ) -> Result<f64, Error> {
        check(temperature, contact_time)?;
        let warmth = exponent(temperature) - exponent(self.temperature);
        let time = (contact_time / self.contact_time).powf(-1.0 / HARDNESS_EXPONENT);
        let creep = self.pressure * time * warmth.exp();
        Ok(creep.min(pressure_melting_bound(temperature, properties)))
    }
}

/// Pressure [Pa] that melts ice of the temperature `temperature` [C]; no contact exceeds it for
/// long.
///
/// `p = T/(dT_m/dp)`: 13.5 MPa per kelvin below 0 C. Infinite if the melting point does not fall
/// with pressure.
pub fn pressure_melting_bound(temperature: f64, properties: &Properties) -> f64 {
    if properties.melting_slope < 0.0 {
        (temperature.min(0.0) / properties.melting_slope).abs()
    } else {
        f64::INFINITY
    }
}

/// `Q/(n R T)` relative to its value at the knee, so that it is continuous there.
fn exponent(temperature: f64) -> f64 {
    let inverse = 1.0 / (temperature + ZERO_CELSIUS);
    let knee = 1.0 / (KNEE + ZERO_CELSIUS);
    let warm = temperature > KNEE;
    let energy = if warm { ENERGY_ABOVE } else { ENERGY_BELOW };
    energy / (HARDNESS_EXPONENT * GAS_CONSTANT) * (inverse - knee)
}

fn check(temperature: f64, contact_time: f64) -> Result<(), Error> {
    let cold = (-100.0..=0.0).contains(&temperature);
    in_range("temperature", temperature, cold, "-100 to 0 C")?;
    let holds = contact_time > 0.0;
    in_range("contact_time", contact_time, holds, "a positive number")
}

/// Heat flux into ice with its surface at the melting point from the arrival of the runner's
/// leading edge.
///
/// Conduction in depth alone (the Peclet number of a bob runner is a million) into ice at `T_ice`,
/// with `D = T_m(p(xi)) - T_ice`:
///
/// ```text
/// q_i(xi) = k_i sqrt(V/(pi kappa)) [ D(0)/sqrt(xi) + integral_0^xi D'(s)/sqrt(xi - s) ds ]
/// ```
///
/// The integral is exact for the pressure of a [`Strip`], linear between its stations. Under
/// uniform pressure the flux is `k_i D/sqrt(pi kappa xi/V)`. Source: H.S. Carslaw, J.C. Jaeger,
/// Conduction of Heat in Solids, 2nd ed., Oxford 1959, section 2.5 with Duhamel's theorem.
///
/// The flux is negative where the pressure lowers the melting point below the temperature of the
/// ice.
#[derive(Clone, Debug)]
pub struct HeatIntoIce {
    factor: f64,
    first: f64,
    xi: Vec<f64>,
    slopes: Vec<f64>,
}

impl HeatIntoIce {
    /// For the pressures of `strip`.
    pub fn new(strip: &Strip, conditions: &FilmConditions, properties: &Properties) -> Self {
        let kappa = properties.ice_diffusivity();
        let factor = if kappa > 0.0 {
            properties.ice_conductivity * (conditions.v / (PI * kappa)).sqrt()
        } else {
            0.0
        };
        let (xi, p) = (strip.xi(), strip.pressure());
        let melting = |k: usize| properties.melting_temperature(p[k]);
        HeatIntoIce {
            factor,
            first: melting(0) - conditions.ice_c,
            xi: xi.to_vec(),
            slopes: (1..xi.len())
                .map(|k| (melting(k) - melting(k - 1)) / (xi[k] - xi[k - 1]))
                .collect(),
        }
    }

    /// `q_i sqrt(xi)` at `xi` [m], finite at the leading edge [W/m^1.5].
    pub fn scaled(&self, xi: f64) -> f64 {
        let mut sum = 0.0;
        for (slope, ends) in self.slopes.iter().zip(self.xi.windows(2)) {
            if ends[0] >= xi {
                break;
            }
            sum += 2.0 * slope * ((xi - ends[0]).sqrt() - (xi - ends[1]).max(0.0).sqrt());
        }
        self.factor * (self.first + xi.sqrt() * sum)
    }
}

/// Heat transfer coefficient of the steel, a half-space heated during the sliding time [W/(m2 K)].
///
/// `q_s = sqrt(k_s rho_s c_s/(pi t)) (T_m - T_s)` with the time `t` of sliding, since the film
/// stays at the same place of the steel. About 2 kW/(m2 K) after 10 s, while friction gives
/// megawatts per m2. Source: as [`HeatIntoIce`].
pub(crate) fn steel_transfer(conditions: &FilmConditions, properties: &Properties) -> f64 {
    let effusivity_squared = properties.steel_conductivity * properties.steel_volumetric_heat;
    (effusivity_squared / (PI * conditions.sliding_time)).sqrt()
}
