//! The curvature and the bank that runs are aligned to.

use crate::track::shape::TrackShape;

/// Curvature [1/m] and bank [rad] of a track at every metre.
#[derive(Clone, Debug)]
pub(crate) struct Course {
    /// The first metre [m].
    pub from_m: f64,
    /// Both; NaN where they are not known.
    pub metres: Vec<[f64; 2]>,
    /// How much both vary along the track: their standard deviations.
    pub spread: [f64; 2],
}

impl Course {
    /// From values at every metre.
    pub(crate) fn new(from_m: f64, metres: Vec<[f64; 2]>) -> Course {
        let spread = [0, 1].map(|k| {
            let values = metres.iter().map(|at| at[k]).filter(|x| x.is_finite());
            let count = values.clone().count().max(1) as f64;
            let mean = values.clone().sum::<f64>() / count;
            let variance = values.map(|x| (x - mean).powi(2)).sum::<f64>() / count;
            variance.sqrt().max(f64::MIN_POSITIVE)
        });
        Course {
            from_m,
            metres,
            spread,
        }
    }

    /// Of a surveyed track.
    pub(crate) fn of(shape: &TrackShape) -> Course {
        let count = (shape.finish_m - shape.start_m) as usize + 1;
        let at = |i: usize| {
            let s = shape.start_m + i as f64;
            [shape.curvature.value(s), shape.bank.value(s)]
        };
        Course::new(shape.start_m, (0..count).map(at).collect())
    }

    /// Both at a place [m], on a straight line between metres, and their slopes; `None` beyond the ends and where one is not known.
    pub(crate) fn at(&self, s: f64) -> Option<([f64; 2], [f64; 2])> {
        let along = s - self.from_m;
        if along < 0.0 {
            return None;
        }
        let i = along as usize;
        let (a, b) = (self.metres.get(i)?, self.metres.get(i + 1)?);
        let slope = [b[0] - a[0], b[1] - a[1]];
        let share = along - i as f64;
        let value = [a[0] + share * slope[0], a[1] + share * slope[1]];
        value
            .iter()
            .all(|x| x.is_finite())
            .then_some((value, slope))
    }
}
