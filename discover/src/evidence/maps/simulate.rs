//! Simulated measurements: contact solves seen by the sensor at the pixels of the measured maps,
//! each in the position of its film that fits best ([`Film::register`]).

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::Arc;

use kufe::case::effects::{Effect, Map};
use kufe_contact::solve;
use rayon::prelude::*;

use crate::error::Result;
use crate::evidence::maps::registration::{Film, Moments, Registered};
use crate::evidence::maps::rows::Row;
use crate::evidence::maps::sample::SolvedPressure;
use crate::procedure::rules::MapRules;

/// Effects with their sizes, in the order in which they were found.
pub type SizedEffects = Vec<(&'static Effect, f64)>;

/// Measured pressure, in standard deviations of its noise, above which a pixel counts as in contact
/// although the simulation has no contact there: less than one of a million by chance.
const ABOVE_NOISE: f64 = 5.0;

/// Pieces of the residuals over which misfits are compared.
pub const PIECES: usize = 16;

/// Solution of a row before the sensor: the pressure of a row with a map, or the peak alone.
enum Simulated {
    Pressure(SolvedPressure),
    Peak(f64),
}

/// Key of a solve: cells, and names and sizes of the effects that change the problem.
type Key = (usize, Vec<(&'static str, u64)>);

/// Rows with cached solves, one per set of effects; effects of the sensor need no further solve.
pub struct Simulations<'a> {
    pub rows: Vec<&'a Row>,
    pub rules: MapRules,
    /// Weight of each pixel by row, from the errors of sensor and discretisation [1/Pa].
    weights: Vec<Vec<f64>>,
    solved: RefCell<BTreeMap<Key, Arc<Vec<Simulated>>>>,
}

/// Misfit of simulation and measurement.
#[derive(Clone, Default)]
pub struct Misfit {
    /// Weighted sum of squares.
    pub chi2: f64,
    /// chi2 of each row.
    pub by_row: Vec<f64>,
    /// Part of chi2 at the pixels in contact, simulated or measured. The pixels around them contain
    /// noise alone, and their number depends on the size of the film.
    pub in_contact: f64,
    /// Number of independent values in contact.
    pub count: f64,
    /// Number of pixels in contact and of peaks.
    values: f64,
    /// Root mean square over these [Pa].
    pub rms: f64,
    /// Weighted residuals, row after row.
    pub residuals: Vec<f64>,
    /// Norm of the weighted simulated values.
    pub size: f64,
    /// Differences of the maps' moments by row, which are informative even without overlap.
    pub moments: Vec<f64>,
}

impl Misfit {
    /// Mean square in contact in units of the noise; at least 1, as the stated noise may be too
    /// large.
    pub fn mean_square(&self) -> f64 {
        (self.in_contact / (self.count - 1.0).max(1.0)).max(1.0)
    }

    /// Adds the difference from a simulated peak [Pa]; `rms` is a sum of squares until all rows are
    /// added.
    fn add_peak(&mut self, row: &Row, simulated: f64) {
        let r = row.p_max - simulated;
        self.residuals.push(r / row.p_max_sd);
        self.size += (simulated / row.p_max_sd).powi(2);
        self.in_contact += (r / row.p_max_sd).powi(2);
        self.count += 1.0;
        self.values += 1.0;
        self.rms += r * r;
    }

    /// Adds the differences from a simulated map, and the film's position in standard deviations.
    fn add_map(
        &mut self,
        measured: &Map,
        simulated: &Registered,
        weights: &[f64],
        rules: &MapRules,
    ) {
        let map = &simulated.map;
        let (of_measured, of_simulated) = (Moments::of_map(measured), Moments::of_map(map));
        let offset = |axis: usize| {
            let shift = simulated.position.shift[axis];
            (of_measured.middle[axis] - of_simulated.middle[axis] + shift)
                / of_measured.spread[axis]
        };
        let spread = |axis: usize| (of_measured.spread[axis] / of_simulated.spread[axis]).ln();
        let sum = (of_measured.sum / of_simulated.sum).ln();
        let moments = [sum, offset(0), offset(1), spread(0), spread(1)];
        self.moments.extend(moments);
        let as_one = patch(measured, rules);
        let mut in_contact = 0.0;
        let pairs = measured.pressure.iter().zip(&map.pressure);
        for ((m, s), weight) in pairs.zip(weights) {
            self.residuals.push((m - s) * weight);
            self.size += (s * weight).powi(2);
            if *s > 0.0 || m * weight * as_one.sqrt() > ABOVE_NOISE {
                in_contact += 1.0;
                self.rms += (m - s).powi(2);
                self.in_contact += ((m - s) * weight).powi(2);
            }
        }
        // The prior's part of the sum of squares.
        self.residuals.extend(simulated.z);
        self.count += in_contact / as_one;
        self.values += in_contact;
    }

    /// Decrease of the sum of squares from this misfit to another one of the same rows, by piece of
    /// the residuals. Neighbouring pixels are correlated, so that the scatter is taken over pieces.
    pub fn decreases(&self, other: &Self) -> Vec<f64> {
        let size = self.residuals.len().div_ceil(PIECES).max(1);
        let own = self.residuals.chunks(size);
        own.zip(other.residuals.chunks(size))
            .map(|(a, b)| a.iter().zip(b).map(|(a, b)| a * a - b * b).sum())
            .collect()
    }
}

impl<'a> Simulations<'a> {
    /// Solves each row on two meshes; their difference is the discretisation error of every later
    /// comparison.
    pub fn new(rows: Vec<&'a Row>, rules: &MapRules) -> Result<Self> {
        let mut simulations = Simulations {
            rows,
            rules: *rules,
            weights: Vec::new(),
            solved: RefCell::default(),
        };
        let none = SizedEffects::new();
        let coarse = simulations.simulated(&none, rules.searching_cells)?;
        let fine = simulations.simulated(&none, rules.reporting_cells)?;
        let pairs = coarse.iter().zip(fine.iter()).zip(&simulations.rows);
        simulations.weights = pairs
            .map(|((coarse, fine), row)| match (coarse, fine, &row.map) {
                (Simulated::Pressure(coarse), Simulated::Pressure(fine), Some(film)) => {
                    pixel_weights(row, film, [coarse, fine], rules)
                }
                _ => Vec::new(),
            })
            .collect();
        Ok(simulations)
    }

    /// Simulates every row with the effects, on the meshes of the search.
    pub fn searching(&self, active: &SizedEffects) -> Result<Misfit> {
        self.misfit(active, self.rules.searching_cells)
    }

    /// Simulates every row with the effects, on the finer meshes from which sizes are reported.
    pub fn reporting(&self, active: &SizedEffects) -> Result<Misfit> {
        self.misfit(active, self.rules.reporting_cells)
    }

    fn misfit(&self, active: &SizedEffects, cells: usize) -> Result<Misfit> {
        let registered = self.registered(active, cells)?;
        let peaks = self.peaks(active, cells)?;
        let mut out = Misfit::default();
        for (k, row) in self.rows.iter().enumerate() {
            let from = out.residuals.len();
            match (&row.map, &registered[k], peaks[k]) {
                (Some(film), Some(simulated), _) => {
                    out.add_map(film, simulated, &self.weights[k], &self.rules);
                }
                (_, _, Some(peak)) => out.add_peak(row, peak),
                _ => unreachable!("a row has a map or a peak"),
            }
            let chi2 = out.residuals[from..].iter().map(|r| r * r).sum();
            out.by_row.push(chi2);
        }
        out.chi2 = out.by_row.iter().sum();
        out.rms = (out.rms / out.values.max(1.0)).sqrt();
        out.size = out.size.sqrt();
        Ok(out)
    }

    /// Simulated maps of the rows, registered; `None` for rows without a measured map.
    pub fn registered(
        &self,
        active: &SizedEffects,
        cells: usize,
    ) -> Result<Vec<Option<Registered>>> {
        let seen = self.simulated(active, cells)?;
        let rows = self.rows.par_iter().zip(seen.par_iter());
        Ok(rows
            .zip(&self.weights)
            .map(|((row, seen), weights)| match (seen, &row.map) {
                (Simulated::Pressure(solved), Some(film)) => {
                    Some(register(row, film, solved, weights, active))
                }
                _ => None,
            })
            .collect())
    }

    /// Simulated peaks of rows without a map, as read by the sensor [Pa]; `None` for the others.
    pub fn peaks(&self, active: &SizedEffects, cells: usize) -> Result<Vec<Option<f64>>> {
        let seen = self.simulated(active, cells)?;
        let pairs = seen.iter().zip(&self.rows);
        Ok(pairs
            .map(|(seen, row)| match seen {
                Simulated::Pressure(_) => None,
                Simulated::Peak(p_max) => {
                    let effects = row.sensor.iter().chain(active);
                    let factors = effects.map(|(effect, size)| effect.peak_factor(*size));
                    Some(p_max * factors.product::<f64>())
                }
            })
            .collect())
    }

    /// Solutions of the rows with the effects, from the cache if possible.
    fn simulated(&self, active: &SizedEffects, cells: usize) -> Result<Arc<Vec<Simulated>>> {
        let sizes = active
            .iter()
            .filter(|(e, v)| !e.is_of_the_sensor() && *v != 0.0)
            .map(|(e, v)| (e.info().name, v.to_bits()));
        let key: Key = (cells, sizes.collect());
        if let Some(seen) = self.solved.borrow().get(&key) {
            return Ok(seen.clone());
        }
        let seen = self.rows.par_iter().map(|row| simulate(row, active, cells));
        let seen: Vec<Simulated> = seen.collect::<Result<_, _>>()?;
        let seen = Arc::new(seen);
        self.solved.borrow_mut().insert(key, seen.clone());
        Ok(seen)
    }
}

/// Solves one row with the effects.
fn simulate(row: &Row, active: &SizedEffects, cells: usize) -> Result<Simulated> {
    let mut problem = row.problem.clone();
    for (effect, size) in active {
        effect.alter(*size, &mut problem);
    }
    let options = kufe_contact::Options {
        cells: Some(cells),
        residual: 1e-6,
        ..kufe_contact::Options::default()
    };
    let solution = solve(&problem, &options)?;
    Ok(match &row.map {
        Some(_) => Simulated::Pressure(SolvedPressure::new(&solution.surface, solution.bound())),
        None => Simulated::Peak(solution.p_max),
    })
}

/// Weight of each pixel of a film from the errors of sensor and discretisation [1/Pa], by the
/// solutions on two meshes without effects.
///
/// Errors decrease at least as the first power of the cell near the rim. With n cells on the coarse
/// mesh and m on the fine one, the error of the fine solution is `|difference| / (m / n - 1)`. The
/// largest difference within a cell counts, since the two solutions may agree at a pixel by chance
/// where a rim lies between two nodes. Both are evaluated in the film's position that fits the fine
/// solution.
fn pixel_weights(
    row: &Row,
    film: &Map,
    [coarse, fine]: [&SolvedPressure; 2],
    rules: &MapRules,
) -> Vec<f64> {
    let finer = rules.reporting_cells as f64 / rules.searching_cells as f64;
    let factor = 1.0 / (finer - 1.0).max(1e-3);
    let by_noise = weights(film, row.noise.iter().copied(), rules);
    let position = register(row, film, fine, &by_noise, &SizedEffects::new()).position;
    let [a, b] = [coarse, fine].map(|solved| solved.on(film, &position).pressure);
    let differences: Vec<f64> = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).collect();
    let [along, across] = coarse.smallest_cell();
    let cell = [along / film.dx, across / film.dy].map(|pixels| pixels.ceil() as usize);
    let largest = largest_within(&differences, [film.nx, film.ny], cell);
    let own = row.noise.iter().zip(largest);
    weights(film, own.map(|(sd, error)| sd.hypot(factor * error)), rules)
}

/// Running maximum within a rectangle of pixels around each pixel.
fn largest_within(values: &[f64], [nx, ny]: [usize; 2], [along, across]: [usize; 2]) -> Vec<f64> {
    let near = |k: usize, reach: usize, n: usize| k.saturating_sub(reach)..(k + reach + 1).min(n);
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let rows: Vec<f64> = (0..nx * ny)
        .map(|k| largest(&mut near(k % nx, along, nx).map(|i| values[k - k % nx + i])))
        .collect();
    (0..nx * ny)
        .map(|k| largest(&mut near(k / nx, across, ny).map(|j| rows[j * nx + k % nx])))
        .collect()
}

/// The solved pressure as read by the sensor, in the position of the film that fits best.
fn register(
    row: &Row,
    measured: &Map,
    solved: &SolvedPressure,
    weights: &[f64],
    active: &SizedEffects,
) -> Registered {
    let film = Film {
        measured,
        weights,
        tolerance: row.film,
    };
    film.register(solved, &|map| {
        for (effect, size) in row.sensor.iter().chain(active) {
            effect.sense(*size, map);
        }
    })
}

/// Pixels that count as one independent value, at most a 64th of the map.
fn patch(map: &Map, rules: &MapRules) -> f64 {
    let max_pixels = (map.nx * map.ny) as f64 / 64.0;
    rules.independent_pixels.powi(2).min(max_pixels).max(1.0)
}

/// Weight of each pixel [1/Pa].
fn weights(map: &Map, deviations: impl Iterator<Item = f64>, rules: &MapRules) -> Vec<f64> {
    let root = patch(map, rules).sqrt();
    deviations.map(|sd| 1.0 / (sd * root)).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc as Shared;

    use kufe::case::effects::find;
    use kufe_contact::{Ice, Load, Problem, Runner, Tilt, hertz};
    use kufe_mesh::Paraboloid;

    use super::*;
    use crate::evidence::maps::noise::deviations;
    use crate::evidence::maps::polish::polish;
    use crate::evidence::maps::registration::FilmTolerance;
    use crate::null::random::{normal, stream};

    const RADII: [f64; 2] = [30.0, 0.005];
    const E: f64 = 9.0e9;
    const NU: f64 = 0.33;
    /// Shift [m] and rotation [rad] of a film that was placed by hand.
    const MOVED: ([f64; 2], f64) = ([-0.25e-3, 0.17e-3], 5e-3);
    const IN_PLACE: ([f64; 2], f64) = ([0.0, 0.0], 0.0);

    /// A row with the map of Hertz's closed form at a force [N], `gain` times, on a film whose
    /// point X lies at `x = R(-rotation) (X - shift)`; its window follows the contact.
    fn hertz_row(
        fz: f64,
        (shift, rotation): ([f64; 2], f64),
        gain: f64,
        rules: &MapRules,
    ) -> Result<Row, Box<dyn std::error::Error>> {
        let exact = hertz(RADII[0], RADII[1], E / (1.0 - NU * NU), fz)?;
        let [a, b] = [exact.a, exact.b];
        let (nx, ny) = (64, 64);
        let half = [1.5 * a, 1.5 * b + 5e-3 * a];
        let [dx, dy] = [2.0 * half[0] / nx as f64, 2.0 * half[1] / ny as f64];
        let [x0, y0] = [shift[0] - half[0] + 0.5 * dx, shift[1] - half[1] + 0.5 * dy];
        let (sin, cos) = rotation.sin_cos();
        let at = |x: f64, y: f64| {
            let (along, across) = (x - shift[0], y - shift[1]);
            let (x, y) = (cos * along + sin * across, cos * across - sin * along);
            exact.p_max * (1.0 - (x / a).powi(2) - (y / b).powi(2)).max(0.0).sqrt()
        };
        // A pixel of the sensor is the mean over its area.
        let fine = |k: usize| (k as f64 + 0.5) / 8.0 - 0.5;
        let pressure: Vec<f64> = (0..nx * ny)
            .map(|k| {
                let (x, y) = (x0 + (k % nx) as f64 * dx, y0 + (k / nx) as f64 * dy);
                let points = (0..64).map(|p| at(x + fine(p % 8) * dx, y + fine(p / 8) * dy));
                gain * points.sum::<f64>() / 64.0
            })
            .collect();
        let map = Map {
            nx,
            ny,
            x0,
            y0,
            dx,
            dy,
            pressure,
        };
        let runner = Runner::rigid(Shared::new(Paraboloid::new(RADII[0], RADII[1])?));
        let load = Load::central(fz, Tilt::Free);
        Ok(Row {
            name: String::new(),
            problem: Problem::new(runner, Ice::half_space(E, NU), load),
            p_max: exact.p_max,
            p_max_sd: 0.015 * exact.p_max,
            noise: deviations(&map, exact.p_max, rules),
            map: Some(map),
            fz,
            film: FilmTolerance {
                shift: rules.film_shift_m,
                rotation: rules.film_rotation_rad,
            },
            sensor: SizedEffects::new(),
        })
    }

    #[test]
    fn an_exact_map_differs_by_at_most_the_solver_error_wherever_its_film_lies()
    -> Result<(), Box<dyn std::error::Error>> {
        let rules = MapRules::default();
        let none = SizedEffects::new();
        for (fz, position) in [(800.0, IN_PLACE), (2000.0, IN_PLACE), (800.0, MOVED)] {
            let row = hertz_row(fz, position, 1.0, &rules)?;
            let simulations = Simulations::new(vec![&row], &rules)?;
            for misfit in [simulations.searching(&none)?, simulations.reporting(&none)?] {
                // The prior of the position adds 0.5^2 + 0.34^2 + 1^2.
                let mean_square = misfit.chi2 / misfit.count;
                println!(
                    "{fz} N: {mean_square:.3}, {:.3e} Pa, {:.1}",
                    misfit.rms, misfit.chi2
                );
                assert!(mean_square < 1.0, "{fz} N: {mean_square}");
            }
        }
        Ok(())
    }

    #[test]
    fn shift_and_rotation_of_a_film_are_estimated_within_their_errors()
    -> Result<(), Box<dyn std::error::Error>> {
        let rules = MapRules::default();
        let row = hertz_row(800.0, MOVED, 1.0, &rules)?;
        let simulations = Simulations::new(vec![&row], &rules)?;
        let films = simulations.registered(&SizedEffects::new(), rules.reporting_cells)?;
        let film = films[0].as_ref().expect("a map");
        let (shift, rotation) = MOVED;
        let truth = [
            shift[0] / rules.film_shift_m,
            shift[1] / rules.film_shift_m,
            rotation / rules.film_rotation_rad,
        ];
        for (k, truth) in truth.into_iter().enumerate() {
            let (z, error) = (film.z[k], film.errors[k]);
            println!("{k}: {z:.4} +- {error:.4}, {truth:.4}");
            // Without noise only the mesh and the prior differ.
            assert!(
                (z - truth).abs() < error.max(0.01),
                "{k}: {z} +- {error}, {truth}"
            );
        }
        Ok(())
    }

    #[test]
    fn a_gain_is_the_same_in_place_and_moved_and_a_film_without_tolerance_stays()
    -> Result<(), Box<dyn std::error::Error>> {
        let rules = MapRules::default();
        let gain = find("sensor-gain").expect("in the catalogue");
        for position in [IN_PLACE, MOVED] {
            let row = hertz_row(800.0, position, 1.06, &rules)?;
            let simulations = Simulations::new(vec![&row], &rules)?;
            let sizes = polish(&simulations, &vec![(gain, 0.055)], &[0.01])?;
            let size = sizes.active[0].1;
            println!("gain {size:.4} +- {:.4}", sizes.errors[0]);
            assert!((size - 0.06).abs() < 0.003, "{size}");
            let at_zero = polish(&simulations, &vec![(gain, 0.0)], &[0.01])?.errors[0];
            assert!((at_zero / sizes.errors[0] - 1.0).abs() < 0.2, "{at_zero}");
        }
        let fixed = MapRules {
            film_shift_m: 0.0,
            film_rotation_rad: 0.0,
            ..rules
        };
        let row = hertz_row(800.0, MOVED, 1.0, &fixed)?;
        let misfit = Simulations::new(vec![&row], &fixed)?.searching(&SizedEffects::new())?;
        assert!(misfit.chi2 > 10.0 * misfit.count, "{}", misfit.chi2);
        Ok(())
    }

    #[test]
    fn noise_around_the_contact_is_no_misfit() -> Result<(), Box<dyn std::error::Error>> {
        let rules = MapRules::default();
        let mut row = hertz_row(800.0, MOVED, 1.0, &rules)?;
        let mut rng = stream(5, 1, 0);
        let map = row.map.as_mut().expect("a map");
        for p in &mut map.pressure {
            *p = (*p * (1.0 + 0.03 * normal(&mut rng)) + 3e5 * normal(&mut rng)).max(0.0);
        }
        row.noise = deviations(map, row.p_max, &rules);
        let simulations = Simulations::new(vec![&row], &rules)?;
        let misfit = simulations.reporting(&SizedEffects::new())?;
        println!("{:.1} of {:.1} values", misfit.in_contact, misfit.count);
        // Less than a third of the film is in contact.
        assert!(misfit.count < 0.3 * 256.0, "{}", misfit.count);
        assert!(
            misfit.in_contact < rules.unclean * misfit.count,
            "{}",
            misfit.in_contact
        );
        Ok(())
    }

    #[test]
    fn the_largest_value_within_a_cell_is_found_along_both_axes() {
        let mut values = vec![0.0; 35];
        values[2 * 7 + 3] = 2.0;
        let largest = largest_within(&values, [7, 5], [2, 1]);
        for (k, value) in largest.into_iter().enumerate() {
            let (i, j) = ((k % 7) as i32, (k / 7) as i32);
            let inside = (i - 3).abs() <= 2 && (j - 2).abs() <= 1;
            assert_eq!(value, if inside { 2.0 } else { 0.0 });
        }
    }
}
