//! A closed form to test files and pictures with.

use kufe_contact::PressureMap;

/// Hertz's ellipse of half axes 25 and 0.14 mm on pixels, its gap infinite beyond `|y| = 0.28 mm`.
pub fn hertz_map() -> PressureMap {
    let (a, b, peak) = (0.025, 0.14e-3, 138.5e6);
    let (nx, ny) = (384, 384);
    let (dx, dy) = (3.0 * a / nx as f64, 5.0 * b / ny as f64);
    let (x0, y0) = (-1.5 * a + 0.5 * dx, -2.5 * b + 0.5 * dy);
    let places = (0..ny).flat_map(|j| (0..nx).map(move |i| (i, j)));
    let places: Vec<(f64, f64)> = places
        .map(|(i, j)| (x0 + i as f64 * dx, y0 + j as f64 * dy))
        .collect();
    let inside = |x: f64, y: f64| 1.0 - (x / a).powi(2) - (y / b).powi(2);
    let over = |value: &dyn Fn(f64, f64) -> f64| places.iter().map(|&(x, y)| value(x, y)).collect();
    PressureMap {
        x0,
        y0,
        dx,
        dy,
        nx,
        ny,
        pressure: over(&|x, y| peak * inside(x, y).max(0.0).sqrt()),
        gap: over(&|x, y| {
            if y.abs() > 2.0 * b {
                f64::INFINITY
            } else {
                (-inside(x, y)).max(0.0) * 1e-5
            }
        }),
        uz: over(&|x, y| -1e-5 * (1.0 + inside(x, y).max(-2.0))),
    }
}
