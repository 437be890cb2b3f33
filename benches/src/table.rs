//! A table of pressures, and points at which it is evaluated.

use kufe_lut::{Axes, Figures, Quantity, Table};

const QUERIES: usize = 1 << 20;

/// A table of `size` x `size` nodes: non-uniform breakpoints, pressures that follow a power
/// law of the load.
pub fn pressure_table(size: usize) -> Result<Table, kufe_lut::Error> {
    let t = |i: usize| i as f64 / (size - 1) as f64;
    let fz = (0..size).map(|i| 200.0 * 40f64.powf(t(i))).collect();
    let curvature = (0..size).map(|j| -0.02 + 0.048 * t(j).sqrt()).collect();
    table_of(fz, curvature, |fz, curvature| {
        1.4e8 * (fz / 1e3).cbrt() * (1.0 - 30.0 * curvature).powf(0.6)
    })
}

/// A table over loads [N] and curvatures [1/m] with the peak pressure [Pa] of a formula.
pub fn table_of(
    fz: Vec<f64>,
    curvature: Vec<f64>,
    p_max: impl Fn(f64, f64) -> f64,
) -> Result<Table, kufe_lut::Error> {
    let axes = Axes::new(fz, curvature)?;
    let nodes = axes.points().into_iter().map(|point| {
        let p_max = p_max(point.fz, point.curvature);
        let figures = Figures::at_rest([p_max, p_max / 1.5, 1e-5, 0.05, 3e-4, 1e-5]);
        figures.with_error(Quantity::PMax, 0.0)
    });
    let nodes: Vec<Figures> = nodes.collect();
    Table::new(axes, &nodes, Vec::new())
}

/// A million pseudo-random loads [N] and curvatures [1/m], equal in every call.
pub fn random_queries() -> Vec<(f64, f64)> {
    let mut state = 1u64;
    let mut random = || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    (0..QUERIES)
        .map(|_| (200.0 + 7800.0 * random(), -0.02 + 0.048 * random()))
        .collect()
}
