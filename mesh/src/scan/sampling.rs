//! How dense and how noisy a hull's vertices are where it touches the ice.

use crate::hull::Hull;
use crate::scan::nodes::{Noise, median, noise_of_hull};

/// Places along the keel at which the vertices are looked at.
const PLACES: usize = 9;
/// Half the length of such a place over that of the hull.
const LONG: f64 = 0.01;
/// Half its width over the radius of the section.
const WIDE: f64 = 0.3;

/// The vertices near the keel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Median length of the triangles' edges [m].
    pub spacing: f64,
    /// Of the vertices, as [`noise_of_hull`] tells it.
    pub noise: Option<Noise>,
}

impl Sampling {
    /// Of a hull in metres, x forward and z up, whose section has this radius [m] where it is lowest.
    ///
    /// `None` where no triangle touches the places along the keel that are looked at.
    pub fn of(hull: &Hull, section_radius: f64) -> Option<Self> {
        let [low, high] = hull.bounds();
        let length = high[0] - low[0];
        let half = [LONG * length, WIDE * section_radius];
        let mut edges = Vec::new();
        for k in 0..PLACES {
            let x = low[0] + length * (0.1 + 0.8 * k as f64 / (PLACES - 1) as f64);
            let along = |p: &[f64; 3]| (p[0] - x).abs() <= half[0];
            let here = || hull.positions.iter().filter(|p| along(p));
            let Some(keel) = here().min_by(|a, b| a[2].total_cmp(&b[2])) else {
                continue;
            };
            let near = |p: &[f64; 3]| {
                along(p) && (p[1] - keel[1]).abs() <= half[1] && p[2] - keel[2] < half[1]
            };
            let corner = |i: u32| hull.positions[i as usize];
            for t in &hull.triangles {
                if t.iter().any(|&i| near(&corner(i))) {
                    edges.extend([[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]].map(|[a, b]| {
                        let (a, b) = (corner(a), corner(b));
                        let square: f64 = (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum();
                        square.sqrt()
                    }));
                }
            }
        }
        Some(Self {
            spacing: median(edges)?,
            noise: noise_of_hull(hull),
        })
    }
}
