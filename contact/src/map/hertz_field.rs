//! A closed form to test the map with.

use crate::result::solution::SurfaceField;

/// Hertz's ellipse of pressure on a graded grid, its gap infinite outside `|y| = 2 b`.
pub fn ellipse(a: f64, b: f64, peak: f64) -> SurfaceField {
    let graded = |half: f64| -> Vec<f64> {
        let mut side: Vec<f64> = (1..=40).map(|k| half * 1.05 * k as f64 / 40.0).collect();
        side.extend((1..=12).map(|k| half * (1.05 + 0.05 * 1.4f64.powi(k))));
        let mut nodes: Vec<f64> = side.iter().rev().map(|x| -x).collect();
        nodes.push(0.0);
        nodes.extend(side);
        nodes
    };
    let (x, y) = (graded(a), graded(b));
    let mut field = SurfaceField {
        x: x.clone(),
        y: y.clone(),
        pressure: Vec::new(),
        gap: Vec::new(),
        yielded: vec![0.0; x.len() * y.len()],
        uz: Vec::new(),
    };
    for &yj in &y {
        for &xi in &x {
            let inside = 1.0 - (xi / a).powi(2) - (yj / b).powi(2);
            field.pressure.push(peak * inside.max(0.0).sqrt());
            field.gap.push(if yj.abs() > 2.0 * b {
                f64::INFINITY
            } else {
                (-inside).max(0.0) * 1e-5
            });
            field.uz.push(-1e-5 * (1.0 + inside.max(-2.0)));
        }
    }
    field
}
