//! Least squares for a handful of columns, ordinary ones and with what is known beforehand.

/// Residual of `target` after its projection on `columns`; collinear columns are dropped.
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
        let remaining = dot(&rest, &rest);
        if remaining > 1e-12 * size && remaining > 0.0 {
            let scale = 1.0 / remaining.sqrt();
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

/// Residual of `target` after the fit `min |target - C p|^2 + sum_j (p_j / sd_j)^2`; an
/// infinite `sd_j` leaves `p_j` free.
///
/// Normal equations `(C'C + diag(1/sd^2)) p = C' target` by Cholesky, on columns of unit size;
/// collinear columns are dropped.
pub fn ridge_out(columns: &[Vec<f64>], sd: &[f64], target: &[f64]) -> Vec<f64> {
    let size: Vec<f64> = columns.iter().map(|c| dot(c, c).sqrt()).collect();
    let used: Vec<usize> = (0..columns.len()).filter(|&j| size[j] > 0.0).collect();
    let n = used.len();
    let mut factor = vec![vec![0.0; n]; n];
    let mut p: Vec<f64> = vec![0.0; n];
    let mut lost = vec![false; n];
    for (i, &a) in used.iter().enumerate() {
        let mut right = dot(&columns[a], target) / size[a];
        for (j, &b) in used[..=i].iter().enumerate() {
            let mut sum = dot(&columns[a], &columns[b]) / (size[a] * size[b]);
            if i == j {
                sum += (sd[a] * size[a]).powi(-2);
            }
            sum -= dot(&factor[i][..j], &factor[j][..j]);
            factor[i][j] = match (i == j, lost[j]) {
                (true, _) => sum.max(0.0).sqrt(),
                (false, true) => 0.0,
                (false, false) => sum / factor[j][j],
            };
        }
        lost[i] = factor[i][i] < 1e-6;
        right -= dot(&factor[i][..i], &p[..i]);
        p[i] = if lost[i] { 0.0 } else { right / factor[i][i] };
    }
    for i in (0..n).rev() {
        let later: f64 = (i + 1..n).map(|k| factor[k][i] * p[k]).sum();
        p[i] = if lost[i] {
            0.0
        } else {
            (p[i] - later) / factor[i][i]
        };
    }
    let mut rest = target.to_vec();
    for (&a, part) in used.iter().zip(&p) {
        let part = part / size[a];
        for (x, c) in rest.iter_mut().zip(&columns[a]) {
            *x -= part * c;
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ridge_of_one_column_shrinks_as_the_formula_says_and_free_columns_as_a_projection() {
        let column = vec![vec![3.0, 4.0]];
        // p = c'y / (c'c + 1/sd^2) = 25 / (25 + 4)
        let remaining = ridge_out(&column, &[0.5], &column[0]);
        for (x, c) in remaining.iter().zip(&column[0]) {
            assert!((x - c * 4.0 / 29.0).abs() < 1e-12);
        }
        let columns: Vec<Vec<f64>> = (0..4)
            .map(|j| {
                (0..50)
                    .map(|k| ((j + 1) as f64 * 0.37 * k as f64).sin())
                    .collect()
            })
            .chain([vec![0.0; 50]])
            .collect();
        let target: Vec<f64> = (0..50).map(|k| (0.01 * (k * k) as f64).cos()).collect();
        let free = ridge_out(&columns, &[f64::INFINITY; 5], &target);
        for (x, y) in free.iter().zip(&project_out(&columns, &target)) {
            assert!((x - y).abs() < 1e-10);
        }
    }
}
