//! Integration of the film equation along the strip, with adaptive steps.

use nalgebra::{Matrix3, Vector3};

use crate::error::Error;
use crate::friction::film::properties::{
    BoundaryContact, FilmConditions, FilmOptions, HeatIntoIce, Properties, Strip, between,
    steel_transfer,
};

/// Largest number of steps of one integration.
const MAX_STEPS: usize = 20_000;

/// Largest number of step selections; each tightens the tolerance by a factor of ten.
const ROUNDS: usize = 6;

/// The melt film along `strip`: melting, freezing, squeeze-out and drag.
///
/// With `xi` from the leading edge, thickness `h`, and the melting point of the pressure as the
/// film's temperature:
///
/// ```text
/// tau = mu V/h + tau_b phi(h/sigma)                      shear stress of film and asperities
/// rho_i L v_m = tau V - q_i - q_s                        melting by the friction heat not conducted away
/// (V/2) dh/dxi = (rho_i/rho_w) v_m - p h^3/(mu w^2)      water: transport at V/2, squeeze-out sideways
/// F_v = integral tau w dxi                               drag
/// ```
///
/// [`BoundaryContact`] gives the shear stress of the asperities, and
/// [`HeatIntoIce`](crate::friction::film::HeatIntoIce) the heat flux `q_i`. The last term is the
/// squeeze film of a long strip with the mean pressure p (O. Reynolds, Phil. Trans. R. Soc. 177
/// (1886)). The thickness starts at 0 in proportion to `sqrt(xi)`. It never returns to 0: if steel
/// and ice conduct more heat than friction produces (`melt_rate` negative), the film freezes and
/// thins until `tau V` balances the heat. The computed thickness of a slow runner on cold ice falls
/// to nanometres and below. There is then no film in reality: compare [`Film::thinnest`] with the
/// roughness and the size of a molecule.
///
/// The equation is integrated by Radau IIA of order 5 from station to station of the strip. The
/// error of every total is its change when all steps are halved.
///
/// # Errors
/// [`Error::OutOfRange`] for conditions, properties or options out of range;
/// [`Error::NotConverged`] if the accuracy is not reached.
///
/// ```
/// use kufe_sled::friction::film::{FilmConditions, FilmOptions, Properties, Strip, film};
/// let strip = Strip::uniform(0.06, 1.0e-3, 17.7e6)?;
/// let slow = film(&strip, &FilmConditions::new(5.0, -5.0), &Properties::WATER_AND_ICE, &FilmOptions::default())?;
/// let fast = film(&strip, &FilmConditions::new(30.0, -5.0), &Properties::WATER_AND_ICE, &FilmOptions::default())?;
/// assert!(fast.totals.friction > slow.totals.friction);
/// assert!(fast.errors.friction < 1e-6 * fast.totals.friction);
/// # Ok::<(), kufe_sled::Error>(())
/// ```
pub fn film(
    strip: &Strip,
    conditions: &FilmConditions,
    properties: &Properties,
    options: &FilmOptions,
) -> Result<Film, Error> {
    let film_on = |strip: &Strip| {
        let outflow = strip.pressure().to_vec();
        film_with_outflow(strip, outflow, conditions, properties, options)
    };
    let mut film = film_on(strip)?;
    if let Some(coarser) = strip.every_second() {
        film.sampling = Some(film.totals.difference(&film_on(&coarser)?.totals));
    }
    Ok(film)
}

/// As [`film`], with squeeze-out by the pressures `outflow` [Pa] at the stations in place of the
/// strip's pressures: for patches that are not much longer than wide.
///
/// # Errors
/// As [`film`].
pub fn film_with_outflow(
    strip: &Strip,
    outflow: Vec<f64>,
    conditions: &FilmConditions,
    properties: &Properties,
    options: &FilmOptions,
) -> Result<Film, Error> {
    conditions.check()?;
    properties.check()?;
    options.check()?;
    let equation = &FilmEquation::new(strip, conditions, properties, outflow);
    let mut tolerance = 0.1 * options.accuracy;
    let mut reached = f64::INFINITY;
    for _ in 0..ROUNDS {
        let (steps, fine) = select_steps(equation, tolerance)?;
        let coarse = sweep(equation, &steps)?;
        let errors = fine.totals.difference(&coarse.totals);
        reached = errors.max_relative(&fine.totals, equation.heats());
        if reached <= options.accuracy {
            let ends = fine.ends.iter().zip(&coarse.ends).enumerate();
            let station = |(k, (h, other)): (usize, (&f64, &f64))| {
                equation.station(k + 1, *h, (h - other).abs())
            };
            return Ok(Film {
                stations: ends.map(station).collect(),
                totals: fine.totals,
                errors,
                sampling: None,
                steps: 2 * steps.len(),
            });
        }
        tolerance = (0.1 * tolerance).max(1e-13);
    }
    Err(Error::NotConverged {
        what: "melt film",
        iterations: ROUNDS,
        residual: reached,
        tolerance: options.accuracy,
    })
}

/// A step in segment `segment` of the strip, in `s = sqrt(xi)`.
struct Step {
    segment: usize,
    from: f64,
    length: f64,
}

impl Step {
    /// The thickness at the end of the step, and the integrals of the totals over the step.
    fn take(&self, equation: &FilmEquation<'_>, before: f64) -> Option<(f64, FilmTotals)> {
        let at = nodes().map(|node| self.from + node * self.length);
        let rates = at.map(|s| equation.rate(self.segment, s));
        let h = step(before, self.length, &rates)?;
        let mut added = FilmTotals::default();
        for (i, weight) in weights().into_iter().enumerate() {
            let rate = equation.totals_rate(self.segment, at[i], h[i]);
            added = added.combined(&rate, |sum, value| sum + weight * self.length * value);
        }
        Some((h[2], added))
    }

    /// As [`Step::take`], in two halves.
    fn take_halved(&self, equation: &FilmEquation<'_>, before: f64) -> Option<(f64, FilmTotals)> {
        let length = self.length / 2.0;
        let half = |from: f64| Step {
            segment: self.segment,
            from,
            length,
        };
        let (middle, first) = half(self.from).take(equation, before)?;
        let (end, second) = half(self.from + length).take(equation, middle)?;
        Some((end, FilmTotals::default().plus(&first).plus(&second)))
    }
}

/// Selects steps such that halving any one changes neither the thickness nor any total by more than
/// `tolerance`, relative to the totals so far. Returns the steps, and the film on the halved steps.
///
/// All totals are controlled, since some singularities do not show in thickness and drag: heat into
/// the ice has a square-root singularity behind each station where the slope of the pressure
/// changes, and melting and freezing have a kink where one turns into the other.
fn select_steps(equation: &FilmEquation<'_>, tolerance: f64) -> Result<(Vec<Step>, Sweep), Error> {
    let last = equation.segment(equation.segments() - 1)[1];
    let shortest = 1e-13 * last;
    let mut steps = Vec::new();
    let (mut h, mut proposed) = (0.0, last);
    let mut sweep = Sweep::default();
    for segment in 0..equation.segments() {
        let [mut from, to] = equation.segment(segment);
        while from < to {
            let rest = to - from;
            let is_last = proposed >= 0.999 * rest;
            let part = proposed.min(0.5 * rest).max(shortest);
            let step = Step {
                segment,
                from,
                length: if is_last { rest } else { part },
            };
            let length = step.length;
            let halved = step.take_halved(equation, h);
            let mut error = f64::INFINITY;
            if let (Some((coarse_h, coarse)), Some((fine_h, fine))) =
                (step.take(equation, h), &halved)
            {
                let so_far = sweep.totals.plus(fine);
                let totals_error = coarse
                    .difference(fine)
                    .max_relative(&so_far, equation.heats());
                error = larger(totals_error, (coarse_h - fine_h).abs() / fine_h);
            }
            let factor = 0.9 * (tolerance / error.max(1e-300)).powf(1.0 / 6.0);
            proposed = length * factor.clamp(0.2, 5.0);
            let is_shortest = length <= shortest;
            match halved.filter(|_| error <= tolerance || is_shortest) {
                Some((next, added)) => {
                    h = next;
                    sweep.totals = sweep.totals.plus(&added);
                    from = if is_last { to } else { from + length };
                    steps.push(step);
                }
                None if is_shortest || !proposed.is_finite() => {
                    return Err(stopped(steps.len(), error, tolerance));
                }
                None => {}
            }
            if steps.len() > MAX_STEPS {
                return Err(stopped(steps.len(), error, tolerance));
            }
        }
        sweep.ends.push(h);
    }
    sweep.totals.average(&sweep.ends);
    Ok((steps, sweep))
}

/// The film on given steps: thickness at the end of each segment, and the totals.
#[derive(Default)]
struct Sweep {
    ends: Vec<f64>,
    totals: FilmTotals,
}

fn sweep(equation: &FilmEquation<'_>, steps: &[Step]) -> Result<Sweep, Error> {
    let mut ends = vec![0.0; equation.segments()];
    let mut totals = FilmTotals::default();
    let mut h = 0.0;
    for (done, step) in steps.iter().enumerate() {
        let taken = step.take(equation, h);
        let (next, added) = taken.ok_or_else(|| stopped(done, f64::INFINITY, 0.0))?;
        h = next;
        ends[step.segment] = h;
        totals = totals.plus(&added);
    }
    totals.average(&ends);
    Ok(Sweep { ends, totals })
}

fn stopped(iterations: usize, residual: f64, tolerance: f64) -> Error {
    Error::NotConverged {
        what: "step of the melt film",
        iterations,
        residual,
        tolerance,
    }
}

/// Smallest width, relative to the largest, in the squeeze-out: a strip may narrow to a point.
const MIN_WIDTH_RATIO: f64 = 1e-3;

/// The film's equation along a strip.
///
/// With `s = sqrt(xi)` instead of `xi` the thickness starts as `h = a s` and every term stays
/// finite:
///
/// ```text
/// dh/ds = (4/V) [ (mu V^2/h + tau_b phi(h/sigma) V - q_i - q_s) s/(rho_w L) - s p h^3/(mu w^2) ]
/// ```
struct FilmEquation<'a> {
    strip: &'a Strip,
    /// Pressure of a long strip with the same squeeze-out, at each station [Pa].
    outflow_pressure: Vec<f64>,
    /// Squared width at each station, and its smallest value in the squeeze-out [m2].
    width_squared: Vec<f64>,
    min_width_squared: f64,
    heat_into_ice: HeatIntoIce,
    /// Heat transfer coefficient into the steel [W/(m2 K)].
    steel_transfer: f64,
    /// Temperature of the steel [degrees Celsius].
    steel_c: f64,
    /// Viscosity of water [Pa s].
    viscosity: f64,
    boundary: BoundaryContact,
    /// Speed [m/s].
    v: f64,
    properties: &'a Properties,
}

impl<'a> FilmEquation<'a> {
    fn new(
        strip: &'a Strip,
        conditions: &FilmConditions,
        properties: &'a Properties,
        outflow_pressure: Vec<f64>,
    ) -> Self {
        FilmEquation {
            strip,
            outflow_pressure,
            width_squared: strip.width().iter().map(|w| w * w).collect(),
            min_width_squared: (MIN_WIDTH_RATIO * strip.largest_width()).powi(2),
            heat_into_ice: HeatIntoIce::new(strip, conditions, properties),
            steel_transfer: steel_transfer(conditions, properties),
            steel_c: conditions.steel_c,
            viscosity: conditions.viscosity(properties),
            boundary: match conditions.boundary {
                rough if rough.roughness > 0.0 => rough,
                _ => BoundaryContact::NONE,
            },
            v: conditions.v,
            properties,
        }
    }

    /// Heat of melting per kilogram of ice [J/kg], and per cubic metre of water [J/m3].
    fn heats(&self) -> [f64; 2] {
        [self.properties.latent_heat, self.properties.heat_of_water()]
    }

    /// Segments between stations.
    fn segments(&self) -> usize {
        self.strip.xi().len() - 1
    }

    /// Ends of segment `k` in `s = sqrt(xi)`.
    fn segment(&self, k: usize) -> [f64; 2] {
        [self.strip.xi()[k].sqrt(), self.strip.xi()[k + 1].sqrt()]
    }

    fn pressure(&self, k: usize, xi: f64) -> f64 {
        between(self.strip.xi(), self.strip.pressure(), k, xi)
    }

    fn width_squared(&self, k: usize, xi: f64) -> f64 {
        between(self.strip.xi(), &self.width_squared, k, xi).max(0.0)
    }

    /// Ratio of the squeeze-out to `h^3` [1/(m2 s)].
    fn squeeze(&self, k: usize, xi: f64) -> f64 {
        let p = between(self.strip.xi(), &self.outflow_pressure, k, xi);
        p / (self.viscosity * self.width_squared(k, xi).max(self.min_width_squared))
    }

    fn heat_into_steel(&self, k: usize, xi: f64) -> f64 {
        let melting = self.properties.melting_temperature(self.pressure(k, xi));
        self.steel_transfer * (melting - self.steel_c)
    }

    /// The equation at `s` in segment `k`.
    fn rate(&self, k: usize, s: f64) -> Rate {
        let xi = s * s;
        let heat = self.properties.heat_of_water();
        let lost = self.heat_into_ice.scaled(xi) + s * self.heat_into_steel(k, xi);
        Rate {
            alpha: 4.0 * self.viscosity * self.v * s / heat,
            beta: 4.0 / self.v * lost / heat,
            gamma: 4.0 / self.v * s * self.squeeze(k, xi),
            delta: 4.0 * self.boundary.shear * s / heat,
            boundary: self.boundary,
        }
    }

    /// Derivatives of the totals with respect to `s` for the thickness `h`. `mean_thickness` is here
    /// that of the volume, and `boundary_share` that of the area.
    fn totals_rate(&self, k: usize, s: f64, h: f64) -> FilmTotals {
        let xi = s * s;
        let width = self.width_squared(k, xi).sqrt();
        let area = 2.0 * s * width;
        let viscous_drag = self.viscosity * self.v / h * area;
        let asperity_area = self.boundary.share(h) * area;
        let boundary_drag = self.boundary.shear * asperity_area;
        let dissipated = (viscous_drag + boundary_drag) * self.v;
        let into_ice = 2.0 * width * self.heat_into_ice.scaled(xi);
        let into_steel = self.heat_into_steel(k, xi) * area;
        let melting = (dissipated - into_ice - into_steel) / self.properties.latent_heat;
        FilmTotals {
            load: self.pressure(k, xi) * area,
            area,
            viscous_drag,
            boundary_drag,
            boundary_share: asperity_area,
            dissipated,
            into_ice,
            into_steel,
            melted: melting.max(0.0),
            refrozen: (-melting).max(0.0),
            squeezed_out: self.squeeze(k, xi) * h.powi(3) * area,
            mean_thickness: h * area,
            ..FilmTotals::default()
        }
    }

    /// The film of thickness `h` at station `k` after the first.
    fn station(&self, k: usize, h: f64, thickness_error: f64) -> FilmStation {
        let (xi, pressure) = (self.strip.xi()[k], self.strip.pressure()[k]);
        let heat_into_ice = self.heat_into_ice.scaled(xi) / xi.sqrt();
        let heat_into_steel = self.heat_into_steel(k - 1, xi);
        let boundary_share = self.boundary.share(h);
        let shear = self.viscosity * self.v / h + self.boundary.shear * boundary_share;
        let melting = shear * self.v - heat_into_ice - heat_into_steel;
        FilmStation {
            xi,
            width: self.strip.width()[k],
            pressure,
            thickness: h,
            thickness_error,
            temperature: self.properties.melting_temperature(pressure),
            melt_rate: melting / (self.properties.ice_density * self.properties.latent_heat),
            shear,
            boundary_share,
            heat_into_ice,
            heat_into_steel,
        }
    }
}

/// The film's equation at one place: `dh/ds = alpha/h - beta - gamma h^3 + delta phi(h/sigma)`.
#[derive(Clone, Copy, Debug)]
struct Rate {
    /// Viscous heat.
    alpha: f64,
    /// Heat into the walls.
    beta: f64,
    /// Squeeze-out.
    gamma: f64,
    /// Heat of boundary friction.
    delta: f64,
    /// Asperities that touch through the film.
    boundary: BoundaryContact,
}

impl Rate {
    fn value(&self, h: f64) -> f64 {
        let film = self.alpha / h - self.beta - self.gamma * h.powi(3);
        film + self.delta * self.boundary.share(h)
    }

    fn slope(&self, h: f64) -> f64 {
        let film = -self.alpha / (h * h) - 3.0 * self.gamma * h * h;
        film + self.delta * self.boundary.share_slope(h)
    }

    /// Root of one implicit Euler step by bisection to a few per cent, the start of Newton's method.
    fn implicit_euler(&self, before: f64, step: f64) -> f64 {
        let mut low = 0.0;
        let mut high =
            before + (step * self.alpha).sqrt() + step * ((-self.beta).max(0.0) + self.delta);
        for _ in 0..8 {
            let middle = 0.5 * (low + high);
            if middle - before - step * self.value(middle) < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }
}

/// Abscissas of the stages; the last is the end of the step.
fn nodes() -> [f64; 3] {
    let root = 6.0_f64.sqrt();
    [(4.0 - root) / 10.0, (4.0 + root) / 10.0, 1.0]
}

/// Weights of the stages in an integral over the step, exact for polynomials of degree 4.
fn weights() -> [f64; 3] {
    let root = 6.0_f64.sqrt();
    [(16.0 - root) / 36.0, (16.0 + root) / 36.0, 1.0 / 9.0]
}

fn stages() -> Matrix3<f64> {
    let root = 6.0_f64.sqrt();
    let first = [(88.0 - 7.0 * root) / 360.0, (296.0 - 169.0 * root) / 1800.0];
    let second = [(296.0 + 169.0 * root) / 1800.0, (88.0 + 7.0 * root) / 360.0];
    let last = [(-2.0 + 3.0 * root) / 225.0, (-2.0 - 3.0 * root) / 225.0];
    let rows = [
        [first[0], first[1], last[0]],
        [second[0], second[1], last[1]],
        weights(),
    ];
    Matrix3::from_row_slice(rows.as_flattened())
}

/// Thickness at the three stages of one step of Radau IIA of order 5 from the thickness `before`;
/// the last stage is the end of the step. `None` without convergence.
///
/// The method is stable for any stiffness and does not need the rate at the beginning of the step,
/// which is unbounded at the leading edge. It is exact for a thickness that grows linearly in `s`.
/// Source: E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd ed., Springer
/// 1996, section IV.5.
fn step(before: f64, step: f64, rates: &[Rate; 3]) -> Option<[f64; 3]> {
    let (nodes, stages) = (nodes(), stages());
    let mut h = Vector3::from_fn(|i, _| rates[i].implicit_euler(before, nodes[i] * step));
    for _ in 0..40 {
        let value = Vector3::from_fn(|i, _| rates[i].value(h[i]));
        let residual = h - Vector3::repeat(before) - step * stages * value;
        let slope = Vector3::from_fn(|i, _| rates[i].slope(h[i]));
        let jacobian = Matrix3::identity() - step * stages * Matrix3::from_diagonal(&slope);
        let correction = jacobian.lu().solve(&residual)?;
        let mut largest = 0.0_f64;
        for i in 0..3 {
            let next = (h[i] - correction[i]).max(0.2 * h[i]);
            largest = largest.max((next / h[i] - 1.0).abs());
            h[i] = next;
        }
        if !largest.is_finite() {
            return None;
        }
        if largest < 1e-9 {
            return Some([h[0], h[1], h[2]]);
        }
    }
    None
}

/// The film at one station of the strip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmStation {
    /// Distance from the leading edge [m].
    pub xi: f64,
    /// Width of the strip [m].
    pub width: f64,
    /// Pressure averaged over the width [Pa].
    pub pressure: f64,
    /// Thickness of the film [m].
    pub thickness: f64,
    /// Discretisation error of the thickness [m].
    pub thickness_error: f64,
    /// Temperature of film and ice surface: the melting point under the pressure [C].
    pub temperature: f64,
    /// Melting rate as a velocity of the ice surface, negative where the film freezes [m/s].
    pub melt_rate: f64,
    /// Shear stress on the ice, of the film and of touching asperities [Pa].
    pub shear: f64,
    /// Share of the area where steel and ice touch.
    pub boundary_share: f64,
    /// Heat into the ice [W/m2].
    pub heat_into_ice: f64,
    /// Heat into the steel [W/m2].
    pub heat_into_steel: f64,
}

/// Integrals and means of the film over the strip.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FilmTotals {
    /// Load that the strip carries [N].
    pub load: f64,
    /// Area of the strip [m2].
    pub area: f64,
    /// Drag of the sheared film [N].
    pub viscous_drag: f64,
    /// Drag where steel and ice touch [N].
    pub boundary_drag: f64,
    /// Ratio of both drags to the load, dimensionless.
    pub friction: f64,
    /// Ratio of the drag of the sheared film to the load, dimensionless.
    pub viscous_friction: f64,
    /// Ratio of the drag where steel and ice touch to the load, dimensionless.
    pub boundary_friction: f64,
    /// Share of the area where steel and ice touch.
    pub boundary_share: f64,
    /// Power of friction: both drags times speed [W].
    pub dissipated: f64,
    /// Heat flow into the ice [W].
    pub into_ice: f64,
    /// Heat flow into the steel [W].
    pub into_steel: f64,
    /// Rate of melting, summed where ice melts [kg/s].
    pub melted: f64,
    /// Rate of freezing, summed where water freezes [kg/s].
    pub refrozen: f64,
    /// Water that is squeezed out sideways [m3/s].
    pub squeezed_out: f64,
    /// Thickness averaged over the area [m].
    pub mean_thickness: f64,
    /// Largest thickness at a station [m].
    pub max_thickness: f64,
}

impl FilmTotals {
    /// Makes ratios and means of the integrals, and sets the largest thickness at a station.
    fn average(&mut self, stations: &[f64]) {
        self.max_thickness = stations.iter().copied().fold(0.0, f64::max);
        self.viscous_friction = self.viscous_drag / self.load;
        self.boundary_friction = self.boundary_drag / self.load;
        self.friction = self.viscous_friction + self.boundary_friction;
        self.mean_thickness /= self.area;
        self.boundary_share /= self.area;
    }

    /// Applies `f` field by field.
    fn combined(&self, other: &Self, f: impl Fn(f64, f64) -> f64) -> Self {
        FilmTotals {
            load: f(self.load, other.load),
            area: f(self.area, other.area),
            viscous_drag: f(self.viscous_drag, other.viscous_drag),
            boundary_drag: f(self.boundary_drag, other.boundary_drag),
            friction: f(self.friction, other.friction),
            viscous_friction: f(self.viscous_friction, other.viscous_friction),
            boundary_friction: f(self.boundary_friction, other.boundary_friction),
            boundary_share: f(self.boundary_share, other.boundary_share),
            dissipated: f(self.dissipated, other.dissipated),
            into_ice: f(self.into_ice, other.into_ice),
            into_steel: f(self.into_steel, other.into_steel),
            melted: f(self.melted, other.melted),
            refrozen: f(self.refrozen, other.refrozen),
            squeezed_out: f(self.squeezed_out, other.squeezed_out),
            mean_thickness: f(self.mean_thickness, other.mean_thickness),
            max_thickness: f(self.max_thickness, other.max_thickness),
        }
    }

    fn plus(&self, other: &Self) -> Self {
        self.combined(other, |a, b| a + b)
    }

    /// Absolute differences, field by field.
    fn difference(&self, other: &Self) -> Self {
        self.combined(other, |a, b| (a - b).abs())
    }

    /// The largest of these errors relative to `value`. The error of the boundary drag, which may
    /// be almost 0, is relative to both drags. Errors of heat and water, which may be small
    /// differences, are relative to the dissipated power and to the ice and water that it would
    /// melt, by the heats of melting per mass of ice [J/kg] and per volume of water [J/m3].
    fn max_relative(&self, value: &Self, [heat_of_ice, heat_of_water]: [f64; 2]) -> f64 {
        let power = value.dissipated;
        // Before the first pressure the load and its error are 0.
        let relative = |error: f64, value: f64| if error == 0.0 { 0.0 } else { error / value };
        [
            relative(self.load, value.load),
            relative(self.area, value.area),
            relative(self.viscous_drag, value.viscous_drag),
            relative(self.boundary_drag, value.viscous_drag + value.boundary_drag),
            relative(self.mean_thickness, value.mean_thickness),
            relative(self.into_ice, power),
            relative(self.into_steel, power),
            relative(self.melted * heat_of_ice, power),
            relative(self.refrozen * heat_of_ice, power),
            relative(self.squeezed_out * heat_of_water, power),
        ]
        .into_iter()
        .fold(0.0, larger)
    }
}

/// The larger of two errors; infinity if `error` is NaN.
fn larger(largest: f64, error: f64) -> f64 {
    if error.is_nan() {
        f64::INFINITY
    } else {
        largest.max(error)
    }
}

/// The melt film along a strip.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// The film at the stations of the strip, without the leading edge, where the thickness is 0
    /// and the shear unbounded.
    pub stations: Vec<FilmStation>,
    /// Integrals and means over the strip.
    pub totals: FilmTotals,
    /// Discretisation error of each total: its change when every step of the integration is halved.
    pub errors: FilmTotals,
    /// Change of each total with every second station of the strip only; `None` below four
    /// stations. It shows how well the stations resolve the patch.
    pub sampling: Option<FilmTotals>,
    /// Steps of the integration.
    pub steps: usize,
}

impl Film {
    /// The station with the thinnest film, to be compared with the roughness.
    pub fn thinnest(&self) -> Option<&FilmStation> {
        let stations = self.stations.iter();
        stations.min_by(|a, b| a.thickness.total_cmp(&b.thickness))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_that_is_no_number_is_the_largest_whatever_follows_it() {
        let value = FilmTotals {
            viscous_drag: 1.0,
            mean_thickness: 1.0,
            dissipated: 1.0,
            ..FilmTotals::default()
        };
        let errors = FilmTotals {
            viscous_drag: f64::NAN,
            mean_thickness: 0.1,
            ..FilmTotals::default()
        };
        assert_eq!(errors.max_relative(&value, [1.0; 2]), f64::INFINITY);
    }
}
