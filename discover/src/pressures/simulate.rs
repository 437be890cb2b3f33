//! Measurements simulated: contact solves, seen on the measured maps' pixels through the sensor.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::Arc;

use kufe_contact::effects::{Effect, Map};
use kufe_contact::{Solution, solve};
use rayon::prelude::*;

use super::rows::Row;
use crate::Error;

/// Cells over half the patch of the solves.
const CELLS: usize = 12;
/// Cells of the solves that show what the mesh alone does.
const FINER: usize = 18;
/// Pixels that count as one independent value along each direction.
const PATCH: f64 = 4.0;

/// Effects with their sizes.
pub type Active = Vec<(&'static dyn Effect, f64)>;

/// What a solve gives of a row before the sensor: a map on its pixels, or the peak alone.
enum Seen {
    Map(Map),
    Peak(f64),
}

/// Names and sizes of the effects that change the problem itself.
type Key = Vec<(&'static str, u64)>;

/// Rows that are solved once for each set of effects; those of the sensor need no solve of their own.
pub struct Bench<'a> {
    /// The rows.
    pub rows: Vec<&'a Row>,
    /// Difference of the solves from finer ones, by row and pixel [Pa].
    mesh_error: Vec<Vec<f64>>,
    solved: RefCell<BTreeMap<Key, Arc<Vec<Seen>>>>,
}

/// Simulation against measurement.
pub struct Misfit {
    /// Sum of squares in units of the noise.
    pub chi2: f64,
    /// Independent values.
    pub count: f64,
    /// Root mean square over pixels in contact [Pa].
    pub rms: f64,
    /// Weighted residuals, row after row.
    pub rest: Vec<f64>,
}

impl<'a> Bench<'a> {
    /// Solves each row on two meshes, whose difference counts as an error of every later comparison.
    ///
    /// # Errors
    /// Those of the contact solver.
    pub fn new(rows: Vec<&'a Row>) -> Result<Self, Error> {
        let mesh_error = rows
            .par_iter()
            .map(|row| {
                let coarse = simulate(row, &Vec::new(), CELLS)?;
                let fine = simulate(row, &Vec::new(), FINER)?;
                Ok(match (coarse, fine) {
                    (Seen::Map(a), Seen::Map(b)) => {
                        let pairs = a.pressure.iter().zip(&b.pressure);
                        pairs.map(|(a, b)| a - b).collect()
                    }
                    _ => Vec::new(),
                })
            })
            .collect::<Result<_, Error>>()?;
        Ok(Bench {
            rows,
            mesh_error,
            solved: RefCell::default(),
        })
    }

    /// Simulates every row with the effects.
    ///
    /// # Errors
    /// Those of the contact solver.
    pub fn misfit(&self, active: &Active) -> Result<Misfit, Error> {
        let key: Key = active
            .iter()
            .filter(|(e, v)| !e.is_of_the_sensor() && *v != 0.0)
            .map(|(e, v)| (e.info().name, v.to_bits()))
            .collect();
        let known = self.solved.borrow().get(&key).cloned();
        let seen = match known {
            Some(seen) => seen,
            None => {
                let seen: Vec<Seen> = self
                    .rows
                    .par_iter()
                    .map(|row| simulate(row, active, CELLS))
                    .collect::<Result<_, _>>()?;
                let seen = Arc::new(seen);
                self.solved.borrow_mut().insert(key, seen.clone());
                seen
            }
        };
        let mut out = Misfit {
            chi2: 0.0,
            count: 0.0,
            rms: 0.0,
            rest: Vec::new(),
        };
        let mut values = 0.0;
        for ((row, seen), error) in self.rows.iter().zip(seen.iter()).zip(&self.mesh_error) {
            values += compare(row, seen, error, active, &mut out);
        }
        out.chi2 = out.rest.iter().map(|r| r * r).sum();
        out.rms = (out.rms / f64::max(values, 1.0)).sqrt();
        Ok(out)
    }
}

fn simulate(row: &Row, active: &Active, cells: usize) -> Result<Seen, Error> {
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
        Some(measured) => Seen::Map(sample(&solution, measured)),
        None => Seen::Peak(solution.p_max),
    })
}

/// Adds a row's weighted residuals, its independent values and its squares [Pa2]; the number of its values comes back.
fn compare(row: &Row, seen: &Seen, mesh_error: &[f64], active: &Active, out: &mut Misfit) -> f64 {
    let (map, measured) = match (seen, &row.map) {
        (Seen::Map(map), Some(measured)) => (map, measured),
        (Seen::Map(_), None) => unreachable!("a map is simulated where one was measured"),
        (Seen::Peak(p_max), _) => {
            let gain = |(e, v): &(&'static dyn Effect, f64)| match e.info().name {
                "sensor-gain" => 1.0 + v,
                _ => 1.0,
            };
            let r = row.p_max - p_max * active.iter().map(gain).product::<f64>();
            out.rest.push(r / row.p_max_sd);
            out.count += 1.0;
            out.rms += r * r;
            return 1.0;
        }
    };
    let mut map = map.clone();
    for (effect, size) in active {
        effect.sense(*size, &mut map);
    }
    // A patch of pixels counts as one value, no larger than a 64th of the map.
    let patch = (PATCH * PATCH)
        .min((map.nx * map.ny) as f64 / 64.0)
        .max(1.0);
    let mut touched = 0.0;
    let pairs = measured.pressure.iter().zip(&map.pressure);
    for ((m, s), error) in pairs.zip(mesh_error) {
        out.rms += (m - s).powi(2);
        let variance = row.noise.powi(2) + error.powi(2);
        out.rest.push((m - s) / (variance * patch).sqrt());
        if *s > 0.0 {
            touched += 1.0;
        }
    }
    out.count += touched / patch;
    f64::max(touched, 1.0)
}

/// The solution's pressure on the measured map's pixels: bilinear between nodes, the mean of nine points a pixel.
fn sample(solution: &Solution, like: &Map) -> Map {
    let surface = &solution.surface;
    let (nx, ny) = (surface.x.len(), surface.y.len());
    let place = |nodes: &[f64], x: f64| -> Option<(usize, f64)> {
        let at = nodes.partition_point(|n| *n <= x);
        (at > 0 && at < nodes.len())
            .then(|| (at - 1, (x - nodes[at - 1]) / (nodes[at] - nodes[at - 1])))
    };
    let value = |x: f64, y: f64| -> f64 {
        match (place(&surface.x, x), place(&surface.y, y)) {
            (Some((i, a)), Some((j, b))) if i + 1 < nx && j + 1 < ny => {
                let p = |i: usize, j: usize| surface.pressure[j * nx + i];
                (1.0 - b) * ((1.0 - a) * p(i, j) + a * p(i + 1, j))
                    + b * ((1.0 - a) * p(i, j + 1) + a * p(i + 1, j + 1))
            }
            _ => 0.0,
        }
    };
    let mut map = like.clone();
    for j in 0..map.ny {
        for i in 0..map.nx {
            let (x, y) = (map.x0 + i as f64 * map.dx, map.y0 + j as f64 * map.dy);
            let mut sum = 0.0;
            for u in [-1.0, 0.0, 1.0] {
                for v in [-1.0, 0.0, 1.0] {
                    sum += value(x + u * map.dx / 3.0, y + v * map.dy / 3.0);
                }
            }
            map.pressure[j * map.nx + i] = sum / 9.0;
        }
    }
    map
}
