//! The temperature of the ice from place to place along a track.

/// Temperatures of the ice at places along a track, in the order of the places.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct IceAlong {
    points: Vec<[f64; 2]>,
}

impl IceAlong {
    /// Of places [m] with their temperatures [degrees Celsius] in any order; those that are no number are passed over.
    pub fn new(points: impl IntoIterator<Item = [f64; 2]>) -> IceAlong {
        let known = |point: &[f64; 2]| point.iter().all(|x| x.is_finite());
        let mut points: Vec<[f64; 2]> = points.into_iter().filter(known).collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        IceAlong { points }
    }

    /// Places [m] with their temperatures [degrees Celsius].
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// The temperature at a place [m]: on a straight line between the nearest, level beyond the ends; none without any.
    pub fn at(&self, s_m: f64) -> Option<f64> {
        let after = self.points.partition_point(|point| point[0] <= s_m);
        let Some(&[b, warm]) = self.points.get(after) else {
            return self.points.last().map(|point| point[1]);
        };
        let Some(&[a, cold]) = self.points[..after].last() else {
            return Some(warm);
        };
        Some(cold + (warm - cold) * (s_m - a) / (b - a))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_sensors_it_is_a_straight_line_and_beyond_them_level() {
        let ice = IceAlong::new([[300.0, -4.0], [100.0, -8.0], [200.0, f64::NAN]]);
        for (s, expected) in [
            (0.0, -8.0),
            (100.0, -8.0),
            (150.0, -7.0),
            (300.0, -4.0),
            (1e6, -4.0),
        ] {
            assert_eq!(ice.at(s), Some(expected), "{s}");
        }
        assert_eq!(IceAlong::default().at(10.0), None);
    }
}
