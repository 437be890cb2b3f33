//! Ordinary least squares for a handful of columns.

/// What is left of `target` after its projection on `columns`; collinear columns are dropped.
///
/// Modified Gram-Schmidt, twice, which is enough for a handful of columns.
pub fn project_out(columns: &[Vec<f64>], target: &[f64]) -> Vec<f64> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for column in columns {
        let mut rest = column.clone();
        let size = dot(&rest, &rest);
        for _ in 0..2 {
            remove(&basis, &mut rest);
        }
        let left = dot(&rest, &rest);
        if left > 1e-12 * size && left > 0.0 {
            let scale = 1.0 / left.sqrt();
            rest.iter_mut().for_each(|x| *x *= scale);
            basis.push(rest);
        }
    }
    let mut rest = target.to_vec();
    for _ in 0..2 {
        remove(&basis, &mut rest);
    }
    rest
}

fn remove(basis: &[Vec<f64>], from: &mut [f64]) {
    for direction in basis {
        let part = dot(direction, from);
        for (x, d) in from.iter_mut().zip(direction) {
            *x -= part * d;
        }
    }
}

/// Inner product.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Variance about the mean; 0 for an empty slice.
pub fn variance(values: &[f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / values.len() as f64
}

/// Cosine between two vectors; 0 where one of them vanishes.
pub fn cosine(a: &[f64], b: &[f64]) -> f64 {
    let size = (dot(a, a) * dot(b, b)).sqrt();
    if size > 0.0 { dot(a, b) / size } else { 0.0 }
}
