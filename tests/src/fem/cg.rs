//! Preconditioned conjugate gradients.
//!
//! Operator and preconditioner are closures that write their result into the given slice. The loop
//! allocates no memory; the history is reserved before it. Sums are computed in fixed chunks, so
//! that results have the same bits for any number of threads.

use rayon::prelude::*;

/// Why the iteration failed.
#[derive(Clone, Debug, PartialEq)]
pub enum Error {
    /// The tolerance was not reached.
    NotConverged {
        /// Iterations done.
        iterations: usize,
        /// Relative residual or energy error reached.
        residual: f64,
    },
    /// The operator or the preconditioner has a direction of negative or undefined energy.
    Indefinite {
        /// The energy p . K p or r . P^-1 r.
        energy: f64,
    },
}

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stop {
    /// ||b - A x|| <= tolerance ||b||.
    Residual(f64),
    /// Estimated energy norm of the error <= tolerance times the energy norm of the solution.
    ///
    /// The error of the state d = 4 iterations ago is the energy gained since, e (Hestenes and
    /// Stiefel 1952; Z. Strakos and P. Tichy, ETNA 13 (2002), 56-80), plus the remaining gain,
    /// estimated as a geometric series: e / (1 - q), where q is the ratio of e to the gain of the d
    /// iterations before. The error of the present state is smaller.
    Energy(f64),
}

/// Iterations d over which the energy estimate sums.
const ENERGY_DELAY: usize = 4;

/// Options of [`solve`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// The stopping rule.
    pub stop: Stop,
    /// Iterations after which [`Error::NotConverged`] is returned.
    pub max_iterations: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            stop: Stop::Residual(1e-10),
            max_iterations: 10_000,
        }
    }
}

/// History of a solve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    /// Iterations done.
    pub iterations: usize,
    /// ||b - A x|| / ||b|| before the first and after each iteration.
    pub residuals: Vec<f64>,
    /// Energy alpha r . P^-1 r gained by each iteration [J], twice the drop of 1/2 x A x - b x.
    pub energies: Vec<f64>,
}

/// Work vectors of [`solve`], for reuse between solves.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    residual: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
    preconditioned: Vec<f64>,
    partial: Vec<f64>,
}

/// Solves A x = b from the start `x`, A symmetric positive definite, with a symmetric positive
/// definite preconditioner.
///
/// `apply(v, out)` writes A v, `precondition(r, out)` writes P^-1 r. An entry of `x` does not change
/// if both write zero there and `b - A x` is zero there. Returns an error if the tolerance is not
/// reached or a direction has no positive energy.
pub fn solve(
    mut apply: impl FnMut(&[f64], &mut [f64]),
    mut precondition: impl FnMut(&[f64], &mut [f64]),
    b: &[f64],
    x: &mut [f64],
    workspace: &mut Workspace,
    options: &Options,
) -> Result<History, Error> {
    let n = b.len();
    assert_eq!(x.len(), n);
    let Workspace {
        residual: r,
        direction: p,
        image: q,
        preconditioned: z,
        partial,
    } = workspace;
    for v in [&mut *r, &mut *p, &mut *q, &mut *z] {
        v.clear();
        v.resize(n, 0.0);
    }
    partial.clear();
    partial.resize(n.div_ceil(CHUNK), 0.0);

    apply(x, q);
    zip_apply(r, b, q, |r, b, q| *r = b - q);
    let b_norm = dot(b, b, partial).sqrt();
    let r_norm = dot(r, r, partial).sqrt();
    // With b = 0 the residual of the start is the scale.
    let scale = if b_norm > 0.0 { b_norm } else { r_norm };
    let reserve = options.max_iterations.min(4096);
    let mut history = History {
        iterations: 0,
        residuals: Vec::with_capacity(reserve + 1),
        energies: Vec::with_capacity(reserve),
    };
    history
        .residuals
        .push(if scale > 0.0 { r_norm / scale } else { 0.0 });
    if r_norm == 0.0 {
        return Ok(history);
    }
    precondition(r, z);
    p.copy_from_slice(z);
    let mut rz = dot(r, z, partial);
    loop {
        let error = match options.stop {
            Stop::Residual(_) => history.residuals[history.iterations],
            Stop::Energy(_) => energy_error(&history.energies, x, b, r, partial),
        };
        let (Stop::Residual(tolerance) | Stop::Energy(tolerance)) = options.stop;
        if error <= tolerance || rz == 0.0 {
            return Ok(history);
        }
        if history.iterations == options.max_iterations {
            return Err(Error::NotConverged {
                iterations: history.iterations,
                residual: error,
            });
        }
        apply(p, q);
        let pq = dot(p, q, partial);
        for energy in [rz, pq] {
            if !(energy > 0.0 && energy.is_finite()) {
                return Err(Error::Indefinite { energy });
            }
        }
        let alpha = rz / pq;
        axpy(alpha, p, x);
        axpy(-alpha, q, r);
        history.energies.push(alpha * rz);
        history.residuals.push(dot(r, r, partial).sqrt() / scale);
        history.iterations += 1;
        precondition(r, z);
        let next = dot(r, z, partial);
        let beta = next / rz;
        rz = next;
        p.par_chunks_mut(CHUNK)
            .zip(z.par_chunks(CHUNK))
            .for_each(|(p, z)| {
                for (p, z) in p.iter_mut().zip(z) {
                    *p = z + beta * *p;
                }
            });
    }
}

/// Estimated error of the state [`ENERGY_DELAY`] iterations ago over the energy norm of the present
/// one.
fn energy_error(energies: &[f64], x: &[f64], b: &[f64], r: &[f64], partial: &mut [f64]) -> f64 {
    let Some(start) = energies.len().checked_sub(2 * ENERGY_DELAY) else {
        return f64::INFINITY;
    };
    let (before, recent) = energies[start..].split_at(ENERGY_DELAY);
    let (before, recent): (f64, f64) = (before.iter().sum(), recent.iter().sum());
    let q = recent / before;
    if q >= 1.0 {
        return f64::INFINITY;
    }
    // x . A x = x . (b - r).
    let total = dot(x, b, partial) - dot(x, r, partial);
    (recent / (1.0 - q) / total).sqrt()
}

/// Entries summed by one task.
const CHUNK: usize = 4096;

fn dot(a: &[f64], b: &[f64], partial: &mut [f64]) -> f64 {
    a.par_chunks(CHUNK)
        .zip(b.par_chunks(CHUNK))
        .zip(partial.par_iter_mut())
        .for_each(|((a, b), sum)| {
            // Eight partial sums: a fixed order of summation that allows vector instructions.
            let mut lanes = [0.0; 8];
            let (a8, b8) = (a.chunks_exact(8), b.chunks_exact(8));
            let tail: f64 = a8
                .remainder()
                .iter()
                .zip(b8.remainder())
                .map(|(a, b)| a * b)
                .sum();
            for (a, b) in a8.zip(b8) {
                for l in 0..8 {
                    lanes[l] += a[l] * b[l];
                }
            }
            *sum = lanes.iter().sum::<f64>() + tail;
        });
    partial.iter().sum()
}

fn axpy(alpha: f64, x: &[f64], y: &mut [f64]) {
    y.par_chunks_mut(CHUNK)
        .zip(x.par_chunks(CHUNK))
        .for_each(|(y, x)| {
            for (y, x) in y.iter_mut().zip(x) {
                *y += alpha * x;
            }
        });
}

fn zip_apply(out: &mut [f64], a: &[f64], b: &[f64], f: impl Fn(&mut f64, f64, f64) + Sync) {
    out.par_chunks_mut(CHUNK)
        .zip(a.par_chunks(CHUNK).zip(b.par_chunks(CHUNK)))
        .for_each(|(out, (a, b))| {
            for (o, (a, b)) in out.iter_mut().zip(a.iter().zip(b)) {
                f(o, *a, *b);
            }
        });
}

/// Jacobi preconditioner: division by the diagonal. Degrees of freedom whose diagonal entry is not
/// positive are fixed and give zero.
#[derive(Clone, Debug)]
pub struct Jacobi {
    inverse: Vec<f64>,
}

impl Jacobi {
    /// From the operator's diagonal.
    pub fn new(diagonal: &[f64]) -> Self {
        let inverse = diagonal
            .iter()
            .map(|&d| if d > 0.0 { 1.0 / d } else { 0.0 })
            .collect();
        Self { inverse }
    }

    /// `out` = D^-1 `r`.
    pub fn apply(&self, r: &[f64], out: &mut [f64]) {
        zip_apply(out, r, &self.inverse, |o, r, d| *o = r * d);
    }
}
