//! Convolution on a regular grid by the fast Fourier transform.

/// Sines and cosines of a transform of `2^k` points.
fn twiddles(n: usize) -> Vec<(f64, f64)> {
    (0..n / 2)
        .map(|k| (std::f64::consts::TAU * k as f64 / n as f64).sin_cos())
        .collect()
}

/// In-place radix-2 transform of `2^k` complex numbers; `inverse` leaves out the division by n.
fn transform(re: &mut [f64], im: &mut [f64], table: &[(f64, f64)], inverse: bool) {
    let n = re.len();
    let sign = if inverse { 1.0 } else { -1.0 };
    let mut j = 0;
    for i in 1..n {
        let mut bit = n >> 1;
        while j & bit != 0 {
            j ^= bit;
            bit >>= 1;
        }
        j |= bit;
        if i < j {
            re.swap(i, j);
            im.swap(i, j);
        }
    }
    let mut length = 2;
    while length <= n {
        let half = length / 2;
        let stride = n / length;
        for start in (0..n).step_by(length) {
            for k in 0..half {
                let (s, c) = (sign * table[k * stride].0, table[k * stride].1);
                let (a, b) = (start + k, start + k + half);
                let (x, y) = (re[b] * c - im[b] * s, re[b] * s + im[b] * c);
                (re[b], im[b]) = (re[a] - x, im[a] - y);
                re[a] += x;
                im[a] += y;
            }
        }
        length *= 2;
    }
}

/// A kernel that depends on the distance between cells, on a grid of `nx` by `ny` cells.
#[derive(Debug, Clone)]
pub struct Kernel {
    nx: usize,
    ny: usize,
    re: Vec<f64>,
    im: Vec<f64>,
}

impl Kernel {
    /// From its values at column and row distances; `nx` and `ny` must be powers of two.
    pub fn new(nx: usize, ny: usize, value: impl Fn(usize, usize) -> f64) -> Self {
        assert!(
            nx.is_power_of_two() && ny.is_power_of_two(),
            "grid {nx} x {ny}"
        );
        let (mx, my) = (2 * nx, 2 * ny);
        let mut re = vec![0.0; mx * my];
        for j in 0..my {
            for i in 0..mx {
                re[j * mx + i] = value(i.min(mx - i), j.min(my - j));
            }
        }
        let mut im = vec![0.0; mx * my];
        transform2(&mut re, &mut im, mx, my, false);
        Self { nx, ny, re, im }
    }

    /// The convolution with a field of `ny` rows of `nx`; exact, by zero padding.
    pub fn apply(&self, field: &[f64]) -> Vec<f64> {
        let (mx, my) = (2 * self.nx, 2 * self.ny);
        let mut re = vec![0.0; mx * my];
        let mut im = vec![0.0; mx * my];
        for j in 0..self.ny {
            re[j * mx..j * mx + self.nx].copy_from_slice(&field[j * self.nx..(j + 1) * self.nx]);
        }
        transform2(&mut re, &mut im, mx, my, false);
        for k in 0..mx * my {
            (re[k], im[k]) = (
                re[k] * self.re[k] - im[k] * self.im[k],
                re[k] * self.im[k] + im[k] * self.re[k],
            );
        }
        transform2(&mut re, &mut im, mx, my, true);
        let scale = 1.0 / (mx * my) as f64;
        (0..self.ny)
            .flat_map(|j| (0..self.nx).map(move |i| j * mx + i))
            .map(|k| re[k] * scale)
            .collect()
    }
}

fn transform2(re: &mut [f64], im: &mut [f64], nx: usize, ny: usize, inverse: bool) {
    let (along, across) = (twiddles(nx), twiddles(ny));
    for j in 0..ny {
        let row = j * nx..(j + 1) * nx;
        transform(&mut re[row.clone()], &mut im[row], &along, inverse);
    }
    let mut column_re = vec![0.0; ny];
    let mut column_im = vec![0.0; ny];
    for i in 0..nx {
        for j in 0..ny {
            column_re[j] = re[j * nx + i];
            column_im[j] = im[j * nx + i];
        }
        transform(&mut column_re, &mut column_im, &across, inverse);
        for j in 0..ny {
            re[j * nx + i] = column_re[j];
            im[j * nx + i] = column_im[j];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn convolution_equals_the_double_sum() {
        let kernel = |i: usize, j: usize| 1.0 / (1.0 + i as f64 + 2.0 * j as f64);
        let field: Vec<f64> = (0..32).map(|k| f64::from((k * 7) % 11)).collect();
        let fast = Kernel::new(8, 4, kernel).apply(&field);
        for j in 0..4_usize {
            for i in 0..8_usize {
                let slow: f64 = (0..32)
                    .map(|k| kernel(i.abs_diff(k % 8), j.abs_diff(k / 8)) * field[k])
                    .sum();
                assert!((fast[j * 8 + i] - slow).abs() < 1e-12 * slow.abs().max(1.0));
            }
        }
    }
}
