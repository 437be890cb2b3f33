//! Variance of a pixel of a measured map.
//!
//! ```text
//! var = s0^2 + (k p)^2 + (d |grad p|)^2 + (f p_max)^2
//! ```
//!
//! s0 [Pa] from the rim of the map outside of the contact; k from the mixed second differences of
//! neighbouring pixels, which vanish for smooth maps (after J. Immerkaer, Comput. Vis. Image
//! Underst. 64 (1996) 300-302); d = 1/3 pixel for a pixel's place; f = 0.3 per cent for the solves.

use kufe::case::effects::Map;

use crate::procedure::rules::MapRules;

/// Standard deviation of each pixel [Pa].
pub fn deviations(map: &Map, p_max: f64, rules: &MapRules) -> Vec<f64> {
    let (place, solves) = (rules.pixel_place, rules.solves);
    let (still, share) = (far_noise(map), relative_noise(map));
    let mean = three_by_three(map);
    let of_pixel = |(i, j): (usize, usize)| {
        let at = |u: isize, v: isize| moved(map, &mean, (i, j), [u, v]);
        let slope = 0.5 * (at(1, 0) - at(-1, 0)).hypot(at(0, 1) - at(0, -1));
        let own = share * at(0, 0);
        (still.powi(2) + own.powi(2) + (place * slope).powi(2) + (solves * p_max).powi(2)).sqrt()
    };
    pixels(map).map(of_pixel).collect()
}

/// Whether no pressure of a map exceeds that of its outermost pixels, or its sum is not positive.
pub fn is_blank(map: &Map) -> bool {
    /// Rounding of a constant map.
    const ROUNDING: f64 = 1.0 + 1e-6;
    let largest = three_by_three(map).into_iter().fold(0.0, f64::max);
    let sum: f64 = map.pressure.iter().sum();
    sum <= 0.0 || largest <= ROUNDING * far_noise(map)
}

/// Indices of all pixels along and across.
fn pixels(map: &Map) -> impl Iterator<Item = (usize, usize)> {
    let nx = map.nx;
    (0..nx * map.ny).map(move |k| (k % nx, k / nx))
}

/// The value at a pixel moved by some pixels, clamped at the map's ends.
fn moved(map: &Map, values: &[f64], (i, j): (usize, usize), [u, v]: [isize; 2]) -> f64 {
    let i = i.saturating_add_signed(u).min(map.nx - 1);
    let j = j.saturating_add_signed(v).min(map.ny - 1);
    values[j * map.nx + i]
}

/// The mean of each pixel with its neighbours.
fn three_by_three(map: &Map) -> Vec<f64> {
    let around = [-1, 0, 1];
    let shifts = || around.into_iter().flat_map(|u| around.map(|v| [u, v]));
    let mean = |pixel| {
        let values = shifts().map(|shift| moved(map, &map.pressure, pixel, shift));
        values.sum::<f64>() / 9.0
    };
    pixels(map).map(mean).collect()
}

/// Noise of the sensor from the outermost pixels [Pa].
fn far_noise(map: &Map) -> f64 {
    let is_outermost =
        |(i, j): (usize, usize)| j == 0 || j + 1 == map.ny || i == 0 || i + 1 == map.nx;
    let outermost = pixels(map)
        .zip(&map.pressure)
        .filter(|(at, _)| is_outermost(*at));
    let (sum, count) = outermost.fold((0.0, 0.0), |(sum, n), (_, p)| (sum + p.powi(2), n + 1.0));
    (sum / f64::max(count, 1.0)).sqrt()
}

/// Relative noise, estimated where the pressure is above three tenths of the largest; 0 for maps
/// too small for an estimate.
fn relative_noise(map: &Map) -> f64 {
    const SECOND_DIFFERENCE: [(isize, f64); 3] = [(-1, -0.5), (0, 1.0), (1, -0.5)];
    let mean = three_by_three(map);
    let largest = mean.iter().copied().fold(0.0, f64::max);
    let is_inside = |(i, j): (usize, usize)| {
        (1..map.nx.saturating_sub(1)).contains(&i) && (1..map.ny.saturating_sub(1)).contains(&j)
    };
    let mut ratios = Vec::new();
    for (pixel, own) in pixels(map).zip(mean) {
        if !is_inside(pixel) || own < 0.3 * largest || own <= 0.0 {
            continue;
        }
        let mut mixed = 0.0;
        for (u, a) in SECOND_DIFFERENCE {
            for (v, b) in SECOND_DIFFERENCE {
                mixed += a * b * moved(map, &map.pressure, pixel, [u, v]);
            }
        }
        ratios.push((mixed / own).abs());
    }
    if ratios.len() < 9 {
        return 0.0;
    }
    ratios.sort_by(f64::total_cmp);
    // The squared weights of the differences add up to 1.5^2; 0.6745 is the median of |normal|.
    ratios[ratios.len() / 2] / 0.6745 / 1.5
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::null::random::normal;
    use crate::null::random::stream;

    #[test]
    fn noise_is_separated_from_the_shape_of_the_pressure() {
        let mut rng = stream(3, 1, 0);
        let (nx, ny) = (64, 48);
        let mut map = Map {
            nx,
            ny,
            x0: 0.0,
            y0: 0.0,
            dx: 1.0,
            dy: 1.0,
            pressure: Vec::new(),
        };
        for j in 0..ny {
            for i in 0..nx {
                let (x, y) = ((i as f64 - 31.5) / 22.0, (j as f64 - 23.5) / 18.0);
                let p = 1e8 * (1.0 - x * x - y * y).max(0.0).sqrt();
                map.pressure
                    .push(p * (1.0 + 0.03 * normal(&mut rng)) + 4e5 * normal(&mut rng));
            }
        }
        let share = relative_noise(&map);
        assert!((share / 0.03 - 1.0).abs() < 0.1, "{share}");
        assert!((far_noise(&map) / 4e5 - 1.0).abs() < 0.15);
        let sd = deviations(&map, 1e8, &MapRules::default());
        let peak = sd[24 * nx + 32] / 1e8;
        assert!((peak - 0.03).abs() < 0.006, "{peak}");
    }
}
