//! How dense and how noisy a hull's vertices are where it touches the ice.

use crate::hull::Hull;
use crate::scan::polynomial::fit;

/// Places along the keel at which the vertices are looked at.
const PLACES: usize = 9;
/// Half the length of such a place over that of the hull.
const LONG: f64 = 0.01;
/// Half its width over the radius of the section: there a circle is a polynomial of fourth order to 1e-6 of the radius.
const WIDE: f64 = 0.3;
/// Powers of the surface at a place.
const POWERS: [[i32; 2]; 9] = [
    [0, 0],
    [1, 0],
    [2, 0],
    [0, 1],
    [0, 2],
    [0, 3],
    [0, 4],
    [1, 1],
    [1, 2],
];

/// The vertices near the keel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Median length of the triangles' edges [m].
    pub spacing: f64,
    /// Standard deviation of the vertices' heights about a smooth surface [m]; `None` where they are too few to tell.
    pub noise: Option<f64>,
    /// Vertices that the figures come from.
    pub vertices: usize,
}

impl Sampling {
    /// Of a hull in metres, x forward and z up, whose section has this radius [m] where it is lowest.
    ///
    /// At places along the keel the heights are fitted by a polynomial of second order along and fourth across; what is left is noise,
    /// and the median over the places is told. `None` where no triangle touches such a place.
    pub fn of(hull: &Hull, section_radius: f64) -> Option<Self> {
        let [low, high] = hull.bounds();
        let length = high[0] - low[0];
        let half = [LONG * length, WIDE * section_radius];
        let mut noises = Vec::new();
        let mut edges = Vec::new();
        let mut vertices = 0;
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
            let patch: Vec<&[f64; 3]> = hull.positions.iter().filter(|p| near(p)).collect();
            let places: Vec<[f64; 2]> = patch.iter().map(|p| [p[0], p[1]]).collect();
            let heights: Vec<f64> = patch.iter().map(|p| p[2]).collect();
            noises.extend(fit(&places, &heights, &POWERS).map(|fitted| fitted.deviation));
            vertices += patch.len();
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
            noise: median(noises),
            vertices,
        })
    }
}

/// The middle one of some values.
pub(crate) fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}
