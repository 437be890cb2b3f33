//! Simulated measurements: contact solves seen by the sensor at the pixels of the measured maps.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::Arc;

use kufe::case::effects::{Effect, Map};
use kufe_contact::solve;
use rayon::prelude::*;

use crate::error::Error;
use crate::evidence::maps::measured::rows::Row;
use crate::evidence::maps::sample::sample;
use crate::evidence::maps::sized::SizedEffects;
use crate::procedure::rules::MapRules;

/// Solution of a row before the sensor: a map on its pixels with the smallest cell of the mesh
/// [pixels], or the peak alone.
enum Simulated {
    Map(Map, [usize; 2]),
    Peak(f64),
}

/// Key of a solve: cells, and names and sizes of the effects that change the problem.
type Key = (usize, Vec<(&'static str, u64)>);

/// Rows with cached solves, one per set of effects; effects of the sensor need none of their own.
pub struct Simulations<'a> {
    pub rows: Vec<&'a Row>,
    pub rules: MapRules,
    /// Standard deviation of each value by row, of sensor and discretisation [Pa].
    deviation: Vec<Vec<f64>>,
    solved: RefCell<BTreeMap<Key, Arc<Vec<Simulated>>>>,
}

/// Misfit of simulation and measurement.
#[derive(Clone)]
pub struct Misfit {
    /// Weighted sum of squares.
    pub chi2: f64,
    /// chi2 of each row.
    pub by_row: Vec<f64>,
    /// Number of independent values.
    pub count: f64,
    /// Root mean square over pixels in contact [Pa].
    pub rms: f64,
    /// Weighted residuals, row after row.
    pub rest: Vec<f64>,
    /// Norm of the weighted simulated values.
    pub size: f64,
    /// Differences of the maps' moments by row, which are informative even without overlap.
    pub moments: Vec<f64>,
}

impl Misfit {
    /// Mean square in units of the noise; at least 1, as the stated noise may be too large.
    pub fn mean_square(&self) -> f64 {
        (self.chi2 / (self.count - 1.0).max(1.0)).max(1.0)
    }

    /// Decrease of the sum of squares from this misfit to another of the same rows, by piece.
    /// Neighbouring pixels are correlated, so that the scatter is taken over pieces.
    pub fn falls(&self, other: &Self, pieces: usize) -> Vec<f64> {
        let size = self.rest.len().div_ceil(pieces).max(1);
        let pieces = self.rest.chunks(size).zip(other.rest.chunks(size));
        pieces
            .map(|(a, b)| a.iter().zip(b).map(|(a, b)| a * a - b * b).sum())
            .collect()
    }
}

impl<'a> Simulations<'a> {
    /// Solves each row on two meshes; their difference is the discretisation error of every later
    /// comparison.
    ///
    /// Errors fall at least as the first power of the cell near the rim. With n cells on the coarse
    /// mesh and m on the fine one, the error of the fine solution is `|difference| / (m / n - 1)`.
    /// The largest difference within a cell counts, since the two may agree at a pixel by chance
    /// where a rim lies between two nodes.
    pub fn new(rows: Vec<&'a Row>, rules: &MapRules) -> Result<Self, Error> {
        let mut simulations = Simulations {
            rows,
            rules: *rules,
            deviation: Vec::new(),
            solved: RefCell::default(),
        };
        let none = SizedEffects::new();
        let (coarse, fine) = (
            simulations.simulated(&none, rules.searching_cells)?,
            simulations.simulated(&none, rules.reporting_cells)?,
        );
        let finer = rules.reporting_cells as f64 / rules.searching_cells as f64;
        let factor = 1.0 / (finer - 1.0).max(1e-3);
        let pairs = coarse.iter().zip(fine.iter()).zip(&simulations.rows);
        simulations.deviation = pairs
            .map(|((coarse, fine), row)| match (coarse, fine) {
                (Simulated::Map(a, cell), Simulated::Map(b, _)) => {
                    let both = a.pressure.iter().zip(&b.pressure);
                    let differences: Vec<f64> = both.map(|(a, b)| (a - b).abs()).collect();
                    let largest = largest_within(&differences, [a.nx, a.ny], *cell);
                    let own = row.noise.iter().zip(largest);
                    own.map(|(sd, error)| sd.hypot(factor * error)).collect()
                }
                _ => vec![row.p_max_sd],
            })
            .collect();
        Ok(simulations)
    }

    /// Simulates every row with the effects, on the meshes of the search.
    pub fn searching(&self, active: &SizedEffects) -> Result<Misfit, Error> {
        self.misfit(active, self.rules.searching_cells)
    }

    /// The same on the finer meshes from which sizes are reported.
    pub fn reporting(&self, active: &SizedEffects) -> Result<Misfit, Error> {
        self.misfit(active, self.rules.reporting_cells)
    }

    fn misfit(&self, active: &SizedEffects, cells: usize) -> Result<Misfit, Error> {
        let seen = self.simulated(active, cells)?;
        let mut out = Misfit {
            chi2: 0.0,
            by_row: Vec::new(),
            count: 0.0,
            rms: 0.0,
            rest: Vec::new(),
            size: 0.0,
            moments: Vec::new(),
        };
        let mut values = 0.0;
        for ((row, seen), deviation) in self.rows.iter().zip(seen.iter()).zip(&self.deviation) {
            let from = out.rest.len();
            values += compare(row, seen, deviation, active, &self.rules, &mut out);
            let own: f64 = out.rest[from..].iter().map(|r| r * r).sum();
            out.by_row.push(own);
        }
        out.chi2 = out.by_row.iter().sum();
        out.rms = (out.rms / f64::max(values, 1.0)).sqrt();
        out.size = out.size.sqrt();
        Ok(out)
    }

    /// Simulated maps of the rows; `None` for rows without a measured map.
    pub fn maps(&self, active: &SizedEffects, cells: usize) -> Result<Vec<Option<Map>>, Error> {
        let seen = self.simulated(active, cells)?;
        Ok(seen
            .iter()
            .zip(&self.rows)
            .map(|(seen, row)| match seen {
                Simulated::Map(map, _) => Some(sensed(row, map, active)),
                Simulated::Peak(_) => None,
            })
            .collect())
    }

    /// Simulated peaks of rows without a map, as read by the sensor [Pa]; `None` for the others.
    pub fn peaks(&self, active: &SizedEffects, cells: usize) -> Result<Vec<Option<f64>>, Error> {
        let seen = self.simulated(active, cells)?;
        let pairs = seen.iter().zip(&self.rows);
        Ok(pairs
            .map(|(seen, row)| match seen {
                Simulated::Map(..) => None,
                Simulated::Peak(p_max) => Some(sensed_peak(row, *p_max, active)),
            })
            .collect())
    }

    fn simulated(&self, active: &SizedEffects, cells: usize) -> Result<Arc<Vec<Simulated>>, Error> {
        let sizes = active
            .iter()
            .filter(|(e, v)| !e.is_of_the_sensor() && *v != 0.0)
            .map(|(e, v)| (e.info().name, v.to_bits()));
        let key: Key = (cells, sizes.collect());
        if let Some(seen) = self.solved.borrow().get(&key) {
            return Ok(seen.clone());
        }
        let seen: Vec<Simulated> = self
            .rows
            .par_iter()
            .map(|row| simulate(row, active, cells))
            .collect::<Result<_, _>>()?;
        let seen = Arc::new(seen);
        self.solved.borrow_mut().insert(key, seen.clone());
        Ok(seen)
    }
}

fn simulate(row: &Row, active: &SizedEffects, cells: usize) -> Result<Simulated, Error> {
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
        Some(measured) => {
            let surface = &solution.surface;
            let map = sample(surface, solution.bound(), measured);
            let pixels = |nodes: &[f64], pixel: f64| {
                let cells = nodes.windows(2).map(|pair| pair[1] - pair[0]);
                (cells.fold(f64::INFINITY, f64::min) / pixel).ceil() as usize
            };
            let cell = [
                pixels(&surface.x, measured.dx),
                pixels(&surface.y, measured.dy),
            ];
            Simulated::Map(map, cell)
        }
        None => Simulated::Peak(solution.p_max),
    })
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

/// The map as read by the sensor.
fn sensed(row: &Row, map: &Map, active: &SizedEffects) -> Map {
    let mut map = map.clone();
    for (effect, size) in row.sensor.iter().chain(active) {
        effect.sense(*size, &mut map);
    }
    map
}

/// The peak as read by the sensor.
fn sensed_peak(row: &Row, p_max: f64, active: &SizedEffects) -> f64 {
    let gain = |(e, v): &(&'static Effect, f64)| e.peak_factor(*v);
    let all = row.sensor.iter().chain(active);
    p_max * all.map(gain).product::<f64>()
}

/// Adds a row's weighted residuals, independent values and squares [Pa2]; returns its count.
fn compare(
    row: &Row,
    seen: &Simulated,
    deviation: &[f64],
    active: &SizedEffects,
    rules: &MapRules,
    out: &mut Misfit,
) -> f64 {
    let (map, measured) = match (seen, &row.map) {
        (Simulated::Map(map, _), Some(measured)) => (sensed(row, map, active), measured),
        (Simulated::Map(..), None) => unreachable!("a map is simulated where one was measured"),
        (Simulated::Peak(p_max), _) => {
            let simulated = sensed_peak(row, *p_max, active);
            let r = row.p_max - simulated;
            out.rest.push(r / deviation[0]);
            out.size += (simulated / deviation[0]).powi(2);
            out.count += 1.0;
            out.rms += r * r;
            return 1.0;
        }
    };
    let (own, like) = (moments(measured), moments(&map));
    out.moments.extend([
        (own.sum / like.sum.max(1e-300)).ln(),
        (own.middle[0] - like.middle[0]) / own.spread[0],
        (own.middle[1] - like.middle[1]) / own.spread[1],
        (own.spread[0] / like.spread[0]).ln(),
        (own.spread[1] / like.spread[1]).ln(),
    ]);
    // A patch of pixels, at most a 64th of the map, counts as one value.
    let patch = rules
        .independent_pixels
        .powi(2)
        .min((map.nx * map.ny) as f64 / 64.0)
        .max(1.0);
    let mut touched = 0.0;
    let pairs = measured.pressure.iter().zip(&map.pressure);
    for ((m, s), sd) in pairs.zip(deviation) {
        out.rms += (m - s).powi(2);
        let weight = 1.0 / (sd * patch.sqrt());
        out.rest.push((m - s) * weight);
        out.size += (s * weight).powi(2);
        if *s > 0.0 {
            touched += 1.0;
        }
    }
    out.count += touched / patch;
    f64::max(touched, 1.0)
}

/// Sum, centre and spread of a map.
struct Moments {
    sum: f64,
    middle: [f64; 2],
    spread: [f64; 2],
}

/// Moments of the pixels above a tenth of the largest; the spread is at least a pixel.
fn moments(map: &Map) -> Moments {
    let least = 0.1 * map.pressure.iter().copied().fold(0.0, f64::max);
    let (mut sum, mut first, mut second) = (0.0, [0.0; 2], [0.0; 2]);
    for (k, p) in map.pressure.iter().enumerate().filter(|(_, p)| **p > least) {
        sum += p;
        for (a, place) in [(k % map.nx) as f64, (k / map.nx) as f64]
            .into_iter()
            .enumerate()
        {
            first[a] += p * place;
            second[a] += p * place * place;
        }
    }
    let (from, step) = ([map.x0, map.y0], [map.dx, map.dy]);
    let middle = [0, 1].map(|a| first[a] / f64::max(sum, 1e-300));
    let spread = [0, 1].map(|a| (second[a] / f64::max(sum, 1e-300) - middle[a].powi(2)).max(1.0));
    Moments {
        sum: sum.max(1e-300),
        middle: [0, 1].map(|a| from[a] + step[a] * middle[a]),
        spread: [0, 1].map(|a| step[a] * spread[a].sqrt()),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc as Shared;

    use kufe_contact::{Ice, Load, Problem, Runner, Tilt, hertz};
    use kufe_mesh::Paraboloid;

    use super::*;
    use crate::evidence::maps::measured::noise::deviations;

    /// A map of Hertz's closed form without noise, at these forces [N].
    #[test]
    fn an_exact_map_differs_by_at_most_the_solver_error() -> Result<(), Box<dyn std::error::Error>>
    {
        let (radius_x, radius_y, e, nu) = (30.0, 0.005, 9.0e9, 0.33);
        let rules = MapRules::default();
        for fz in [800.0, 2000.0] {
            let exact = hertz(radius_x, radius_y, e / (1.0 - nu * nu), fz)?;
            let [a, b] = [exact.a, exact.b];
            let (nx, ny) = (64, 48);
            let (dx, dy) = (3.0 * a / nx as f64, 3.0 * b / ny as f64);
            let (x0, y0) = (-1.5 * a + 0.5 * dx, -1.5 * b + 0.5 * dy);
            // A pixel of the sensor is the mean over its area.
            let fine = |k: usize| (k as f64 + 0.5) / 8.0 - 0.5;
            let at = |x: f64, y: f64| {
                exact.p_max * (1.0 - (x / a).powi(2) - (y / b).powi(2)).max(0.0).sqrt()
            };
            let pressure: Vec<f64> = (0..nx * ny)
                .map(|k| {
                    let (x, y) = (x0 + (k % nx) as f64 * dx, y0 + (k / nx) as f64 * dy);
                    let points = (0..64).map(|p| at(x + fine(p % 8) * dx, y + fine(p / 8) * dy));
                    points.sum::<f64>() / 64.0
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
            let runner = Runner::rigid(Shared::new(Paraboloid::new(radius_x, radius_y)?));
            let load = Load::central(fz, Tilt::Free);
            let row = Row {
                name: String::new(),
                problem: Problem::new(runner, Ice::half_space(e, nu), load),
                p_max: exact.p_max,
                p_max_sd: 0.015 * exact.p_max,
                noise: deviations(&map, exact.p_max, &rules),
                map: Some(map),
                fz,
                sensor: SizedEffects::new(),
            };
            let simulations = Simulations::new(vec![&row], &rules)?;
            let none = SizedEffects::new();
            for misfit in [simulations.searching(&none)?, simulations.reporting(&none)?] {
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
