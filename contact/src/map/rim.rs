//! The contact's rim below the cell.

use crate::result::solution::SurfaceField;

/// The square of the pressure at the nodes, continued to negative values just outside the contact; NaN farther out.
///
/// Along any line through a smooth contact p^2 is a parabola (exactly so for Hertz), and it passes zero at the
/// rim; so the root of its positive part ends where the contact does, not at a node. The node just
/// inside the rim carries a mean over its hat, which reaches out of the contact: it takes its value from the
/// parabola through the next three. Where the parabola does not fall outwards (an edge of the hull) or has too
/// few nodes, the rim lies half-way.
pub fn squared_pressure(field: &SurfaceField) -> Vec<f64> {
    let (nx, ny) = (field.x.len(), field.y.len());
    let square: Vec<f64> = field.pressure.iter().map(|p| p * p).collect();
    let mut ghosts = Ghosts::new(nx * ny);
    for j in 0..ny {
        let line: Vec<usize> = (0..nx).map(|i| j * nx + i).collect();
        ghosts.continue_line(&field.x, &line, &square);
    }
    for i in 0..nx {
        let line: Vec<usize> = (0..ny).map(|j| j * nx + i).collect();
        ghosts.continue_line(&field.y, &line, &square);
    }
    let mut extended = ghosts.applied(&square);
    fill_corners(&mut extended, &square, &ghosts, nx, ny);
    extended
}

/// Values that lines propose for nodes at the rim; a node takes their weighted mean.
struct Ghosts {
    sum: Vec<f64>,
    weight: Vec<f64>,
}

impl Ghosts {
    fn new(nodes: usize) -> Ghosts {
        Ghosts {
            sum: vec![0.0; nodes],
            weight: vec![0.0; nodes],
        }
    }

    fn propose(&mut self, node: usize, value: f64, weight: f64) {
        self.sum[node] += weight * value;
        self.weight[node] += weight;
    }

    fn has(&self, node: usize) -> bool {
        self.weight[node] > 0.0
    }

    fn applied(&self, square: &[f64]) -> Vec<f64> {
        (0..square.len())
            .map(|n| {
                if self.has(n) {
                    self.sum[n] / self.weight[n]
                } else if square[n] > 0.0 {
                    square[n]
                } else {
                    f64::NAN
                }
            })
            .collect()
    }

    /// Continues every stretch of contact on one line past both of its ends.
    fn continue_line(&mut self, at: &[f64], line: &[usize], square: &[f64]) {
        let mut k = 0;
        while k < line.len() {
            if square[line[k]] <= 0.0 {
                k += 1;
                continue;
            }
            let first = k;
            while k + 1 < line.len() && square[line[k + 1]] > 0.0 {
                k += 1;
            }
            let last = k;
            if first > 0 {
                let inwards: Vec<usize> = (first..=last).collect();
                self.continue_end(at, line, square, first - 1, &inwards);
            }
            if last + 1 < line.len() {
                let inwards: Vec<usize> = (first..=last).rev().collect();
                self.continue_end(at, line, square, last + 1, &inwards);
            }
            k += 1;
        }
    }

    /// `inwards` counts from the outermost node in contact. Long stretches follow their parabola best, so they
    /// weigh more; a half-way rim only counts where nothing better is proposed.
    fn continue_end(
        &mut self,
        at: &[f64],
        line: &[usize],
        square: &[f64],
        outside: usize,
        inwards: &[usize],
    ) {
        let value = |k: usize| square[line[k]];
        let outermost = inwards[0];
        if let [_, a, b, c, ..] = *inwards {
            let parabola = Parabola::through([a, b, c].map(|k| (at[k], value(k))));
            let [rim, beyond] = [parabola.at(at[outermost]), parabola.at(at[outside])];
            if rim < value(a) && beyond < rim {
                let weight = (inwards.len() as f64).powi(2);
                self.propose(line[outermost], rim, weight);
                self.propose(line[outside], beyond.min(0.0), weight);
                return;
            }
        }
        self.propose(line[outside], -value(outermost), 1e-6);
    }
}

/// Newton's form through three points.
struct Parabola {
    nodes: [f64; 2],
    coefficients: [f64; 3],
}

impl Parabola {
    fn through([a, b, c]: [(f64, f64); 3]) -> Parabola {
        let first = (b.1 - a.1) / (b.0 - a.0);
        let second = ((c.1 - b.1) / (c.0 - b.0) - first) / (c.0 - a.0);
        Parabola {
            nodes: [a.0, b.0],
            coefficients: [a.1, first, second],
        }
    }

    fn at(&self, x: f64) -> f64 {
        let [c0, c1, c2] = self.coefficients;
        c0 + (x - self.nodes[0]) * (c1 + c2 * (x - self.nodes[1]))
    }
}

/// In a cell with one corner in contact the far corner continues the plane of the other three.
fn fill_corners(extended: &mut [f64], square: &[f64], ghosts: &Ghosts, nx: usize, ny: usize) {
    let mut corners = Ghosts::new(extended.len());
    for j in 0..ny - 1 {
        for i in 0..nx - 1 {
            let cell = [
                j * nx + i,
                j * nx + i + 1,
                (j + 1) * nx + i + 1,
                (j + 1) * nx + i,
            ];
            let inside: Vec<usize> = (0..4).filter(|&k| square[cell[k]] > 0.0).collect();
            let [corner] = inside[..] else { continue };
            let [one, far, other] = [1, 2, 3].map(|step| cell[(corner + step) % 4]);
            if !ghosts.has(far) {
                let value = extended[one] + extended[other] - extended[cell[corner]];
                corners.propose(far, value.min(0.0), 1.0);
            }
        }
    }
    for (n, value) in extended.iter_mut().enumerate() {
        if corners.has(n) {
            *value = corners.sum[n] / corners.weight[n];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::hertz_field::ellipse;

    #[test]
    fn a_hertz_contact_is_continued_by_its_own_paraboloid() {
        let (a, b, peak) = (0.025, 0.14e-3, 138.5e6);
        let field = ellipse(a, b, peak);
        let extended = squared_pressure(&field);
        let nx = field.x.len();
        let mut continued = 0;
        for (n, value) in extended.iter().enumerate() {
            let exact =
                peak * peak * (1.0 - (field.x[n % nx] / a).powi(2) - (field.y[n / nx] / b).powi(2));
            if field.pressure[n] == 0.0 && !value.is_nan() && exact > -0.2 * peak * peak {
                continued += 1;
                // The lines near the poles are short: half-way rims are off by a cell's share of the peak.
                assert!(
                    (value - exact).abs() < 0.06 * peak * peak,
                    "{value} {exact}"
                );
            }
        }
        assert!(continued > 100, "{continued}");
    }

    #[test]
    fn a_field_without_contact_stays_without() {
        let mut field = ellipse(0.025, 0.14e-3, 1.0);
        field.pressure.fill(0.0);
        assert!(squared_pressure(&field).iter().all(|q| q.is_nan()));
    }
}
