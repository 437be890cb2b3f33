//! A rigid indenter on an elastic half-space or on a layer bonded to a rigid bed: boundary
//! elements.
//!
//! Constant pressure on rectangles, surface displacements by Love's formula (A.E.H. Love, Phil.
//! Trans. R. Soc. A 228 (1929) 377), the layer's difference by a Hankel integral, and the contact
//! by projected conjugate gradients after I.A. Polonsky and L.M. Keer, Wear 231 (1999) 206.

use crate::cases::answer::CaseError;
use crate::contact::fourier::Kernel;

/// The ice (or the ice and the runner as one body of contact modulus).
#[derive(Debug, Clone, Copy)]
pub struct Elastic {
    /// Young's modulus [Pa].
    pub youngs_modulus_pa: f64,
    /// Poisson's ratio.
    pub poissons_ratio: f64,
    /// Compliance (1 - nu^2)/E of the other body, 0 when rigid [1/Pa].
    pub other_compliance_1ppa: f64,
    /// Thickness on a rigid bed; infinite for a half-space [m].
    pub thickness_m: f64,
}

impl Elastic {
    /// Displacement under unit point force times distance: `(1 - nu^2)/(pi E)` of both bodies.
    fn point(&self) -> f64 {
        let own = (1.0 - self.poissons_ratio.powi(2)) / self.youngs_modulus_pa;
        (own + self.other_compliance_1ppa) / std::f64::consts::PI
    }

    /// Layer over half-space in the transformed plane, at `t = k h`, less one.
    ///
    /// `((3-4nu) sinh 2t - 2t) / ((3-4nu) cosh 2t + 2t^2 + 5 - 12nu + 8nu^2) - 1`; bonded layer,
    /// K.L. Johnson, Contact Mechanics (1985), ch. 5.
    fn layer_ratio(&self, t: f64) -> f64 {
        let nu = self.poissons_ratio;
        let a = 3.0 - 4.0 * nu;
        let e = (-2.0 * t).exp();
        // multiplied by 2 exp(-2t), so that large t stays finite
        let top = a * (1.0 - e * e) - 4.0 * t * e;
        let bottom = a * (1.0 + e * e) + 2.0 * e * (2.0 * t * t + 5.0 - 12.0 * nu + 8.0 * nu * nu);
        top / bottom - 1.0
    }

    /// What the rigid bed takes away from the displacement under a unit force at a distance,
    /// sampled every `step` of `r/h` up to `count` samples [m/N].
    fn bed(&self, step: f64, count: usize) -> Vec<f64> {
        let own = (1.0 - self.poissons_ratio.powi(2)) / self.youngs_modulus_pa;
        let (dt, terms) = (0.005, 3000);
        let ratios: Vec<f64> = (0..=terms)
            .map(|i| self.layer_ratio(f64::from(i) * dt))
            .collect();
        (0..count)
            .map(|k| {
                let r = k as f64 * step;
                let mut sum = 0.0;
                for (i, ratio) in ratios.iter().enumerate() {
                    let weight = match i {
                        0 => 1.0,
                        _ if i == terms as usize => 1.0,
                        _ if i % 2 == 1 => 4.0,
                        _ => 2.0,
                    };
                    sum += weight * ratio * bessel_j0(i as f64 * dt * r);
                }
                own / (std::f64::consts::PI * self.thickness_m) * sum * dt / 3.0
            })
            .collect()
    }
}

/// Bessel function of order zero, to 1e-7 (Abramowitz and Stegun 9.4.1 and 9.4.3).
fn bessel_j0(x: f64) -> f64 {
    let x = x.abs();
    let horner = |c: &[f64], t: f64| c.iter().rev().fold(0.0, |sum, c| sum * t + c);
    if x <= 3.0 {
        let t = (x / 3.0).powi(2);
        return horner(
            &[
                1.0,
                -2.249_999_7,
                1.265_620_8,
                -0.316_386_6,
                0.044_447_9,
                -0.003_944_4,
                0.000_21,
            ],
            t,
        );
    }
    let t = 3.0 / x;
    let f = horner(
        &[
            0.797_884_56,
            -0.000_000_77,
            -0.005_527_4,
            -0.000_095_12,
            0.001_372_37,
            -0.000_728_05,
            0.000_144_76,
        ],
        t,
    );
    let phase = horner(
        &[
            -std::f64::consts::FRAC_PI_4,
            -0.041_663_97,
            -0.000_039_54,
            0.002_625_73,
            -0.000_541_25,
            -0.000_293_33,
            0.000_135_58,
        ],
        t,
    );
    f * (x + phase).cos() / x.sqrt()
}

/// Integral of 1/r over the rectangle `a x b` centred at (x, y), by Love's formula.
fn love(x: f64, y: f64, a: f64, b: f64) -> f64 {
    let corner = |u: f64, w: f64| {
        let r = u.hypot(w);
        let one = if u == 0.0 { 0.0 } else { u * (w + r).ln() };
        let two = if w == 0.0 { 0.0 } else { w * (u + r).ln() };
        one + two
    };
    let (x1, x2, y1, y2) = (x - 0.5 * a, x + 0.5 * a, y - 0.5 * b, y + 0.5 * b);
    corner(x2, y2) - corner(x1, y2) - corner(x2, y1) + corner(x1, y1)
}

/// The contact on a grid of cells around the origin.
#[derive(Debug, Clone)]
pub struct Grid {
    /// Cells along the runner, a power of two.
    pub nx: usize,
    /// Cells across, a power of two.
    pub ny: usize,
    /// Cell size along [m].
    pub dx_m: f64,
    /// Cell size across [m].
    pub dy_m: f64,
    /// Centre of the first cell [m].
    pub x0_m: f64,
    /// Centre of the first cell [m].
    pub y0_m: f64,
}

impl Grid {
    /// A grid of `width` by `height` metres centred at (x, y).
    pub fn around(x_m: f64, y_m: f64, width_m: f64, height_m: f64, nx: usize, ny: usize) -> Self {
        let (dx_m, dy_m) = (width_m / nx as f64, height_m / ny as f64);
        Self {
            nx,
            ny,
            dx_m,
            dy_m,
            x0_m: x_m - 0.5 * (width_m - dx_m),
            y0_m: y_m - 0.5 * (height_m - dy_m),
        }
    }

    /// Centres of the cells, row by row.
    pub fn centres(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        (0..self.nx * self.ny).map(|k| {
            (
                self.x0_m + (k % self.nx) as f64 * self.dx_m,
                self.y0_m + (k / self.nx) as f64 * self.dy_m,
            )
        })
    }

    /// Influence of the cells' pressures on the displacements of their centres.
    pub fn kernel(&self, body: &Elastic) -> Kernel {
        let point = body.point();
        let layered = body.thickness_m.is_finite();
        let reach =
            (self.nx as f64 * self.dx_m).hypot(self.ny as f64 * self.dy_m) / body.thickness_m;
        let step = 0.02_f64.max(reach / 4000.0);
        let bed = if layered {
            body.bed(step, (reach / step) as usize + 3)
        } else {
            Vec::new()
        };
        let area = self.dx_m * self.dy_m;
        Kernel::new(self.nx, self.ny, |i, j| {
            let (x, y) = (i as f64 * self.dx_m, j as f64 * self.dy_m);
            let mut value = point * love(x, y, self.dx_m, self.dy_m);
            if layered {
                let at = (x.hypot(y) / body.thickness_m / step).min((bed.len() - 2) as f64);
                let k = at as usize;
                value += area * (bed[k] + (at - k as f64) * (bed[k + 1] - bed[k]));
            }
            value
        })
    }

    /// Pressures under a load [Pa], for a gap before loading [m] and an upper bound `hardness_pa`.
    ///
    /// The search for the approach starts at `guess_m` above the first touch.
    pub fn press(
        &self,
        kernel: &Kernel,
        gap: &[f64],
        fz_n: f64,
        hardness_pa: f64,
        guess_m: f64,
    ) -> Result<Vec<f64>, CaseError> {
        let area = self.dx_m * self.dy_m;
        let load = |p: &[f64]| p.iter().sum::<f64>() * area;
        let lowest = gap.iter().copied().fold(f64::INFINITY, f64::min);
        let mut p = vec![0.0; gap.len()];
        // bracket the approach, then regula falsi with halved ends (Illinois)
        let mut low = (lowest, -fz_n);
        let mut step = guess_m;
        let mut high = loop {
            let approach = lowest + step;
            self.press_by(kernel, gap, approach, hardness_pa, &mut p)?;
            let off = load(&p) - fz_n;
            if off >= 0.0 {
                break (approach, off);
            }
            low = (approach, off);
            step *= 1.1;
        };
        for _ in 0..60 {
            let approach = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
            self.press_by(kernel, gap, approach, hardness_pa, &mut p)?;
            let off = load(&p) - fz_n;
            if off.abs() < 3e-5 * fz_n {
                break;
            }
            // the end that stays counts half, so that both ends move
            if off < 0.0 {
                low = (approach, off);
                high.1 *= 0.5;
            } else {
                high = (approach, off);
                low.1 *= 0.5;
            }
        }
        Ok(p)
    }

    /// Pressures for a given approach, starting from `p`, which takes the result.
    fn press_by(
        &self,
        kernel: &Kernel,
        gap: &[f64],
        approach: f64,
        hardness_pa: f64,
        p: &mut [f64],
    ) -> Result<(), CaseError> {
        let n = gap.len();
        let mut direction = vec![0.0; n];
        let mut last_norm = f64::INFINITY;
        let mut last_free = vec![false; n];
        let mut change = f64::INFINITY;
        const MOST: usize = 600;
        for iteration in 0..MOST {
            let u = kernel.apply(p);
            let residual: Vec<f64> = (0..n).map(|k| u[k] + gap[k] - approach).collect();
            let free: Vec<bool> = (0..n)
                .map(|k| {
                    (p[k] > 0.0 && p[k] < hardness_pa)
                        || (p[k] <= 0.0 && residual[k] < 0.0)
                        || (p[k] >= hardness_pa && residual[k] > 0.0)
                })
                .collect();
            let norm: f64 = (0..n)
                .filter(|&k| free[k])
                .map(|k| residual[k].powi(2))
                .sum();
            let scale = approach.abs().max(1e-9);
            let count = free.iter().filter(|f| **f).count().max(1);
            if (norm / count as f64).sqrt() < 1e-5 * scale && change < 1e-4 && iteration > 0 {
                return Ok(());
            }
            let same = free == last_free;
            let ratio = if same { norm / last_norm } else { 0.0 };
            for k in 0..n {
                direction[k] = if free[k] {
                    residual[k] + ratio * direction[k]
                } else {
                    0.0
                };
            }
            let moved = kernel.apply(&direction);
            let down: f64 = (0..n)
                .filter(|&k| free[k])
                .map(|k| direction[k] * moved[k])
                .sum();
            if down <= 0.0 {
                return Ok(());
            }
            let up: f64 = (0..n)
                .filter(|&k| free[k])
                .map(|k| residual[k] * direction[k])
                .sum();
            let step = up / down;
            let (mut difference, mut total) = (0.0, 0.0);
            for k in 0..n {
                let next = (p[k] - step * direction[k]).clamp(0.0, hardness_pa);
                difference += (next - p[k]).abs();
                total += next;
                p[k] = next;
            }
            change = difference / total.max(1.0);
            last_norm = norm;
            last_free = free;
        }
        if change < 1e-4 {
            Ok(())
        } else {
            Err(CaseError::Contact {
                iterations: MOST,
                change,
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ICE: Elastic = Elastic {
        youngs_modulus_pa: 9e9,
        poissons_ratio: 0.33,
        other_compliance_1ppa: 0.0,
        thickness_m: f64::INFINITY,
    };

    #[test]
    fn sphere_reaches_hertz_peak_pressure_within_one_percent() {
        let (radius, fz) = (0.05_f64, 50.0_f64);
        let e = ICE.youngs_modulus_pa / (1.0 - 0.33_f64.powi(2));
        let a = (0.75 * fz * radius / e).cbrt();
        let hertz = 1.5 * fz / (std::f64::consts::PI * a * a);
        let grid = Grid::around(0.0, 0.0, 2.6 * a, 2.6 * a, 64, 64);
        let gap: Vec<f64> = grid
            .centres()
            .map(|(x, y)| (x * x + y * y) / (2.0 * radius))
            .collect();
        let p = grid
            .press(&grid.kernel(&ICE), &gap, fz, f64::INFINITY, a * a / radius)
            .unwrap();
        let peak = p.iter().copied().fold(0.0, f64::max);
        assert!((peak / hertz - 1.0).abs() < 0.01, "{peak} {hertz}");
    }

    #[test]
    fn a_thick_layer_acts_as_a_half_space_and_a_thin_one_as_a_confined_spring() {
        let thick = Elastic {
            thickness_m: 1.0,
            ..ICE
        };
        assert!(thick.layer_ratio(20.0).abs() < 1e-12);
        // kh -> 0: u/p = h (1 + nu)(1 - 2 nu) / (E (1 - nu))
        let t = 1e-4;
        let ratio = thick.layer_ratio(t) + 1.0;
        let nu = 0.33;
        let confined = (1.0 + nu) * (1.0 - 2.0 * nu) / (1.0 - nu) / 9e9;
        let transformed = 2.0 * (1.0 - nu * nu) / 9e9 / t * ratio;
        assert!(
            (transformed / confined - 1.0).abs() < 1e-3,
            "{transformed} {confined}"
        );
    }

    #[test]
    fn the_bed_cancels_the_half_space_far_from_the_force() {
        let thin = Elastic {
            thickness_m: 0.002,
            ..ICE
        };
        let bed = thin.bed(0.5, 41);
        let r: f64 = 20.0 * 0.5 * 0.002;
        let difference = thin.point() / r + bed[20];
        assert!(difference.abs() < 0.02 * thin.point() / r, "{difference}");
    }

    #[test]
    fn hardness_bounds_the_pressure_and_the_load_is_kept() {
        let grid = Grid::around(0.0, 0.0, 2.4e-3, 2.4e-3, 32, 32);
        let gap: Vec<f64> = grid.centres().map(|(x, y)| (x * x + y * y) / 0.1).collect();
        let kernel = grid.kernel(&ICE);
        let free = grid
            .press(&kernel, &gap, 50.0, f64::INFINITY, 5e-6)
            .unwrap();
        let cap = 0.6 * free.iter().copied().fold(0.0, f64::max);
        let p = grid.press(&kernel, &gap, 50.0, cap, 5e-6).unwrap();
        let load: f64 = p.iter().sum::<f64>() * grid.dx_m * grid.dy_m;
        assert!(p.iter().all(|&p| (0.0..=cap).contains(&p)));
        assert!((load / 50.0 - 1.0).abs() < 1e-4, "{load}");
    }
}
