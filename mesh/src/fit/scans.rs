//! Repeated synthetic scans of a hull, each fitted at the cost of one right-hand side.

use std::sync::Arc;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::error::MeshError;
use crate::fit::downward::Downward;
use crate::fit::fitted_underside::Surface;
use crate::fit::spline::{FactoredFit, Sample};
use crate::hull::triangles::Hull;
use crate::shapes::underside::Underside;

/// Synthetic scans of a fitted surface whose fits share their places, weights, knots and factorised
/// equations.
///
/// A fit is linear in the heights, and noise changes only the heights. The knots are those of the
/// first fit, although noise would change them slightly.
pub struct Scans<'a> {
    surface: &'a Surface,
    factored: FactoredFit,
    /// The fit's vertices, on the surface.
    samples: Vec<Sample>,
    /// Their numbers in the hull.
    vertices: Vec<u32>,
    noise: f64,
}

impl<'a> Scans<'a> {
    pub(crate) fn new(surface: &'a Surface, hull: &Hull, noise: f64) -> Result<Self, MeshError> {
        let part = Downward::of(hull)?;
        let mut samples = part.samples(&surface.arc_length);
        for (sample, n) in samples.iter_mut().zip(part.gentle()) {
            sample.height = projected_height(surface, part.points[n], noise);
        }
        let vertices = part.gentle().map(|n| part.vertices[n]).collect();
        let axes = surface.spline.axes.clone();
        Ok(Scans {
            surface,
            factored: FactoredFit::new(&samples, axes).ok_or_else(MeshError::no_fit)?,
            samples,
            vertices,
            noise,
        })
    }

    /// The fit of the scan with this seed, with the hull's outline and symmetry.
    ///
    /// # Errors
    /// [`MeshError::Invalid`] if the heights do not determine a surface.
    pub fn fit(&self, seed: u64) -> Result<Arc<dyn Underside>, MeshError> {
        let last = self.vertices.iter().copied().max().unwrap_or(0) as usize;
        let moves: Vec<f64> = moves(self.noise, seed).take(last + 1).collect();
        let moved = self.samples.iter().zip(&self.vertices);
        let moved = moved.map(|(sample, &vertex)| Sample {
            height: sample.height + moves[vertex as usize],
            ..*sample
        });
        let mut spline = self.factored.fit(moved).ok_or_else(MeshError::no_fit)?;
        let even = (0..2).filter(|&axis| self.surface.symmetric[axis]);
        even.for_each(|axis| spline.symmetrise(axis));
        Ok(Arc::new(Surface {
            spline,
            ..self.surface.clone()
        }))
    }
}

/// Height of the surface at a vertex; the vertex's own height if it is farther off than six times
/// `noise` [m] and so belongs to another part of the hull.
pub(crate) fn projected_height(surface: &Surface, [x, y, z]: [f64; 3], noise: f64) -> f64 {
    let on = surface.spline_height(x, y);
    if (on - z).abs() <= 6.0 * noise { on } else { z }
}

/// Normally distributed noise of this standard deviation [m], one value per vertex of a hull.
pub(crate) fn moves(noise: f64, seed: u64) -> impl Iterator<Item = f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    std::iter::repeat_with(move || {
        let drawn: f64 = StandardNormal.sample(&mut random);
        noise * drawn
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::fitted_underside::FittedUnderside;
    use crate::shapes::underside::Paraboloid;

    /// Along the keel a scan's fit with the stored factor and a new fit differ by far less than
    /// either differs from the surface.
    #[test]
    fn a_fit_with_the_stored_factor_equals_a_new_fit_of_the_same_scan()
    -> Result<(), Box<dyn std::error::Error>> {
        const SIDE: u32 = 61;
        let shape = Paraboloid::new(2.0, 0.01)?;
        let half = [0.03, 1.2e-3];
        let at =
            |axis: usize, k: u32| half[axis] * (2.0 * f64::from(k) / f64::from(SIDE - 1) - 1.0);
        let positions = (0..SIDE * SIDE).map(|n| {
            let (x, y) = (at(0, n % SIDE), at(1, n / SIDE));
            [x, y, shape.height(x, y)]
        });
        let corners = (0..(SIDE - 1) * (SIDE - 1)).flat_map(|n| {
            let a = n / (SIDE - 1) * SIDE + n % (SIDE - 1);
            [[a, a + SIDE, a + 1], [a + 1, a + SIDE, a + SIDE + 1]]
        });
        let exact = Hull {
            positions: positions.collect(),
            triangles: corners.collect(),
        };
        let noise = 2e-7;
        let smooth = FittedUnderside::new(&exact, 0.0)?;
        let hull = smooth.scanned(&exact, noise, 77);
        let base = FittedUnderside::new(&hull, noise)?;
        let scans = base.scans(&hull, noise)?;
        // Heights count from each surface's own lowest point: differences less their mean.
        let apart = |a: &dyn Underside, b: &dyn Underside| {
            let differences: Vec<f64> = (0..400)
                .map(|k| {
                    [
                        half[0] * (f64::from(k) / 200.0 - 1.0) * 0.9,
                        0.9 * half[1] * f64::from(k % 21 - 10) / 10.0,
                    ]
                })
                .map(|[x, y]| a.height(x, y) - b.height(x, y))
                .collect();
            let mean = differences.iter().sum::<f64>() / 400.0;
            (differences.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / 400.0).sqrt()
        };
        for seed in 0..4 {
            let again = FittedUnderside::new(&base.scanned(&hull, noise, seed), noise)?;
            let again_factored = scans.fit(seed)?;
            let (between, moved) = (apart(again_factored.as_ref(), &again), apart(&again, &base));
            println!("{between:.2e} m apart, {moved:.2e} m from the surface");
            assert!(
                moved > 0.02 * noise && between < 0.05 * moved,
                "{between} {moved}"
            );
        }
        Ok(())
    }
}
