//! Symmetric positive definite systems with a narrow band.

/// The lower band of a symmetric matrix, row by row.
pub(crate) struct Band {
    size: usize,
    width: usize,
    rows: Vec<f64>,
}

impl Band {
    /// A zero matrix of `size` rows with `width` entries left of the diagonal.
    pub fn new(size: usize, width: usize) -> Self {
        Self {
            size,
            width,
            rows: vec![0.0; size * (width + 1)],
        }
    }

    /// Adds `value` at (`row`, `column`), `column <= row`.
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        self.rows[row * (self.width + 1) + self.width + column - row] += value;
    }

    /// Solves the system by Cholesky factorisation; none where the matrix is not positive definite.
    pub fn solve(mut self, mut right: Vec<f64>) -> Option<Vec<f64>> {
        let (n, w) = (self.size, self.width);
        let stride = w + 1;
        for i in 0..n {
            let first = i.saturating_sub(w);
            let (done, rest) = self.rows.split_at_mut(i * stride);
            let row = &mut rest[..stride];
            for j in first..=i {
                // Both rows hold their columns from `start` on; the products are contiguous.
                let start = first.max(j.saturating_sub(w));
                let count = j - start;
                let (a, b) = (w + start - i, w + start - j);
                if j < i {
                    let other = &done[j * stride..(j + 1) * stride];
                    let sum: f64 = dot(&row[a..a + count], &other[b..b + count]);
                    row[w + j - i] = (row[w + j - i] - sum) / other[w];
                } else {
                    let sum: f64 = dot(&row[a..a + count], &row[a..a + count]);
                    let pivot = row[w] - sum;
                    if pivot.is_nan() || pivot <= 0.0 {
                        return None;
                    }
                    row[w] = pivot.sqrt();
                }
            }
        }
        for i in 0..n {
            let first = i.saturating_sub(w);
            let row = &self.rows[i * stride..(i + 1) * stride];
            let sum = dot(&row[w + first - i..w], &right[first..i]);
            right[i] = (right[i] - sum) / row[w];
        }
        for i in (0..n).rev() {
            let first = i.saturating_sub(w);
            let row = &self.rows[i * stride..(i + 1) * stride];
            right[i] /= row[w];
            let value = right[i];
            for (r, l) in right[first..i].iter_mut().zip(&row[w + first - i..w]) {
                *r -= l * value;
            }
        }
        Some(right)
    }
}

/// Sum of products in four interleaved sums, which the compiler turns into vectors.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = a4
        .remainder()
        .iter()
        .zip(b4.remainder())
        .map(|(x, y)| x * y)
        .sum();
    for (x, y) in a4.zip(b4) {
        for k in 0..4 {
            sums[k] += x[k] * y[k];
        }
    }
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn band_solution_satisfies_the_system() {
        let (n, w) = (40, 5);
        let entry = |i: usize, j: usize| {
            if i == j {
                12.0
            } else {
                ((3 * i + 5 * j) % 7) as f64 / 7.0 - 0.4
            }
        };
        let mut band = Band::new(n, w);
        for i in 0..n {
            (i.saturating_sub(w)..=i).for_each(|j| band.add(i, j, entry(i, j)));
        }
        let right: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
        let solution = band.solve(right.clone()).unwrap();
        for (i, wanted) in right.iter().enumerate() {
            let row: f64 = (i.saturating_sub(w)..(i + w + 1).min(n))
                .map(|j| entry(i.max(j), i.min(j)) * solution[j])
                .sum();
            assert!((row - wanted).abs() < 1e-13);
        }
    }

    #[test]
    fn an_indefinite_matrix_has_no_solution() {
        let mut band = Band::new(2, 1);
        band.add(0, 0, 1.0);
        band.add(1, 0, 2.0);
        band.add(1, 1, 1.0);
        assert!(band.solve(vec![1.0, 1.0]).is_none());
    }
}
