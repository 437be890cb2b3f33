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
    let mean = Grid {
        map,
        values: &three_by_three(map),
    };
    (0..map.ny)
        .flat_map(|j| (0..map.nx).map(move |i| (i, j)))
        .map(|(i, j)| {
            let slope = 0.5
                * (mean.at(i, j, 1, 0) - mean.at(i, j, -1, 0))
                    .hypot(mean.at(i, j, 0, 1) - mean.at(i, j, 0, -1));
            let own = share * mean.at(i, j, 0, 0);
            (still.powi(2) + own.powi(2) + (place * slope).powi(2) + (solves * p_max).powi(2))
                .sqrt()
        })
        .collect()
}

struct Grid<'a> {
    map: &'a Map,
    values: &'a [f64],
}

impl Grid<'_> {
    /// The value at a pixel moved by (u, v), clamped at the map's ends.
    fn at(&self, i: usize, j: usize, u: isize, v: isize) -> f64 {
        let i = i.saturating_add_signed(u).min(self.map.nx - 1);
        let j = j.saturating_add_signed(v).min(self.map.ny - 1);
        self.values[j * self.map.nx + i]
    }
}

fn three_by_three(map: &Map) -> Vec<f64> {
    let raw = Grid {
        map,
        values: &map.pressure,
    };
    (0..map.ny)
        .flat_map(|j| (0..map.nx).map(move |i| (i, j)))
        .map(|(i, j)| {
            let around = [-1, 0, 1];
            let sum: f64 = around
                .iter()
                .flat_map(|u| around.map(|v| raw.at(i, j, *u, v)))
                .sum();
            sum / 9.0
        })
        .collect()
}

/// Noise of the sensor from the outermost pixels [Pa].
fn far_noise(map: &Map) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for j in 0..map.ny {
        for i in 0..map.nx {
            if j == 0 || j + 1 == map.ny || i == 0 || i + 1 == map.nx {
                sum += map.pressure[j * map.nx + i].powi(2);
                count += 1.0;
            }
        }
    }
    (sum / f64::max(count, 1.0)).sqrt()
}

/// Relative noise, estimated where the pressure is above three tenths of the largest; 0 for maps
/// too small for an estimate.
fn relative_noise(map: &Map) -> f64 {
    let raw = Grid {
        map,
        values: &map.pressure,
    };
    let mean = three_by_three(map);
    let largest = mean.iter().copied().fold(0.0, f64::max);
    let mut ratios = Vec::new();
    for j in 1..map.ny.saturating_sub(1) {
        for i in 1..map.nx.saturating_sub(1) {
            let own = mean[j * map.nx + i];
            if own < 0.3 * largest || own <= 0.0 {
                continue;
            }
            let mut mixed = 0.0;
            for (u, a) in [(-1, -0.5), (0, 1.0), (1, -0.5)] {
                for (v, b) in [(-1, -0.5), (0, 1.0), (1, -0.5)] {
                    mixed += a * b * raw.at(i, j, u, v);
                }
            }
            ratios.push((mixed / own).abs());
        }
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
