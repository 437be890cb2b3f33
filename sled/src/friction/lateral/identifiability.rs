//! Which combinations of the lateral parameters the data determine.

use std::fmt;

use nalgebra::{Matrix3, Vector3};

/// A direction in `(ln K, ln(mu_zeta C), ln C)` and how well it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Combination {
    /// Exponents of K, of the product mu_zeta C and of C apart from that product, of unit length.
    pub exponents: [f64; 3],
    /// Singular value of the Jacobian along it [N per unit logarithm], root mean square over the samples.
    pub singular_value: f64,
    /// Standard deviation of the combination's logarithm, robust to correlation within clusters.
    pub relative_sd: f64,
    /// Whether the data determine it: relative standard deviation below [`Combination::LIMIT`].
    pub determined: bool,
}

impl Combination {
    /// A combination known to worse than a factor of about 1.6 (95 %) is called not determined.
    pub const LIMIT: f64 = 0.25;
}

/// The three combinations, best determined first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Identifiability {
    /// Right singular vectors of the Jacobian with their singular values, in falling order.
    pub combinations: [Combination; 3],
}

impl Identifiability {
    /// From the summed slope `J^T J` and the covariance of the summed score over `samples` samples.
    pub(crate) fn new(slope: &Matrix3<f64>, meat: &Matrix3<f64>, samples: usize) -> Self {
        let eigen = slope.symmetric_eigen();
        let mut order = [0, 1, 2];
        order.sort_by(|&i, &j| eigen.eigenvalues[j].total_cmp(&eigen.eigenvalues[i]));
        let combinations = order.map(|k| {
            let mut direction: Vector3<f64> = eigen.eigenvectors.column(k).into();
            if direction[direction.iamax()] < 0.0 {
                direction = -direction;
            }
            let curvature = eigen.eigenvalues[k].max(0.0);
            let spread = (direction.transpose() * meat * direction)[0].max(0.0);
            let relative_sd = if curvature > 0.0 {
                spread.sqrt() / curvature
            } else {
                f64::INFINITY
            };
            Combination {
                exponents: direction.into(),
                singular_value: (curvature / samples as f64).sqrt(),
                relative_sd,
                determined: relative_sd < Combination::LIMIT,
            }
        });
        Identifiability { combinations }
    }

    /// Number of combinations that the data determine.
    pub fn rank(&self) -> usize {
        self.combinations.iter().filter(|c| c.determined).count()
    }
}

impl fmt::Display for Identifiability {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "the data determine {} of 3 combinations of K, mu_zeta*c and c:",
            self.rank()
        )?;
        for combination in &self.combinations {
            let product: Vec<String> = combination
                .exponents
                .iter()
                .zip(["K", "(mu_zeta*c)", "c"])
                .filter(|(power, _)| power.abs() >= 0.05)
                .map(|(power, name)| format!("{name}^{power:.2}"))
                .collect();
            writeln!(
                f,
                "  {}: singular value {:.3e} N, relative sd {:.2e}: {}",
                product.join(" "),
                combination.singular_value,
                combination.relative_sd,
                if combination.determined {
                    "determined"
                } else {
                    "not determined"
                }
            )?;
        }
        Ok(())
    }
}
