//! The unloaded ice: wavy, or a measured height map.

use crate::error::MeshError;
use crate::parameter::{finite, positive_finite};
use crate::shapes::underside::lows;

/// Height of the unloaded ice over the contact plane, which is subtracted from the gap.
pub trait IceSurface: Send + Sync {
    /// Height [m] at (`x` [m], `y` [m]).
    fn height(&self, x: f64, y: f64) -> f64;

    /// Whether the height is even in x and even in y, to rounding.
    fn mirror_symmetric(&self) -> [bool; 2];

    /// Distances along x and y over which the height is smooth [m]: the spacing of a map's points,
    /// an eighth of a wavelength; infinite if not known.
    fn spacing(&self) -> [f64; 2] {
        [f64::INFINITY; 2]
    }

    /// Places (x, y) [m] where measured ice has a local maximum along x or across. Empty for ice
    /// given by a formula.
    fn highs(&self) -> &[[f64; 2]] {
        &[]
    }
}

/// Sinusoidal waves `z = amplitude cos(2 pi (x cos a + y sin a) / wavelength + phase)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waviness {
    /// Half the height from trough to crest [m].
    pub amplitude: f64,
    /// Distance from crest to crest [m].
    pub wavelength: f64,
    /// Angle a between the waves' direction and x [rad].
    pub direction: f64,
    /// Phase at the origin [rad]; 0 puts a crest there.
    pub phase: f64,
}

impl Waviness {
    /// Waves along x with a crest at the origin.
    ///
    /// # Errors
    /// [`MeshError::Value`] where the amplitude is not finite or the wavelength not positive.
    pub fn new(amplitude: f64, wavelength: f64) -> Result<Self, MeshError> {
        positive_finite("wavelength [m]", wavelength)?;
        finite("amplitude [m]", amplitude)?;
        Ok(Self {
            amplitude,
            wavelength,
            direction: 0.0,
            phase: 0.0,
        })
    }
}

impl IceSurface for Waviness {
    fn height(&self, x: f64, y: f64) -> f64 {
        let along = x * self.direction.cos() + y * self.direction.sin();
        self.amplitude * (std::f64::consts::TAU * along / self.wavelength + self.phase).cos()
    }

    fn spacing(&self) -> [f64; 2] {
        let (along, across) = (self.direction.cos(), self.direction.sin());
        [along, across].map(|part| self.wavelength / (8.0 * part.abs()))
    }

    fn mirror_symmetric(&self) -> [bool; 2] {
        let crest_or_trough = self.phase.sin().abs() < 1e-12;
        let (along, across) = (self.direction.cos().abs(), self.direction.sin().abs());
        [
            along < 1e-12 || (across < 1e-12 && crest_or_trough),
            across < 1e-12 || (along < 1e-12 && crest_or_trough),
        ]
    }
}

/// Heights on a regular grid; outside, the heights of the border continue.
///
/// Between the points heights are interpolated by cubic convolution, which is continuous with its
/// slope (Keys 1981, doi 10.1109/TASSP.1981.1163711).
#[derive(Clone, Debug, PartialEq)]
pub struct HeightMap {
    origin: [f64; 2],
    spacing: [f64; 2],
    shape: [usize; 2],
    /// Heights [m], x running fastest.
    heights: Vec<f64>,
    symmetric: [bool; 2],
    /// Its local maxima along x or across.
    highs: Vec<[f64; 2]>,
}

impl HeightMap {
    /// Heights [m] on `shape` = [nx, ny] points, x running fastest, the first at `origin` [m],
    /// `spacing` [m] apart.
    ///
    /// # Errors
    /// [`MeshError::Value`] for a spacing that is not positive, where the number of heights is not
    /// nx ny or an axis has fewer than two points, or where a height is not finite.
    pub fn new(
        origin: [f64; 2],
        spacing: [f64; 2],
        shape: [usize; 2],
        heights: Vec<f64>,
    ) -> Result<Self, MeshError> {
        for axis in 0..2 {
            positive_finite("grid spacing [m]", spacing[axis])?;
            finite("grid origin [m]", origin[axis])?;
        }
        if shape.iter().any(|&n| n < 2) || shape[0].checked_mul(shape[1]) != Some(heights.len()) {
            return Err(MeshError::value(
                format!("height map of {shape:?} points"),
                format!("{} heights", heights.len()),
                "two or more points along each axis, one height each",
            ));
        }
        if let Some(at) = heights.iter().position(|z| !z.is_finite()) {
            let (column, row) = (at % shape[0], at / shape[0]);
            let place = format!("height map, column {column}, row {row}");
            return Err(MeshError::value(place, heights[at], "a finite number"));
        }
        let mut map = Self {
            origin,
            spacing,
            shape,
            heights,
            symmetric: [false; 2],
            highs: Vec::new(),
        };
        let lines = [0, 1].map(|axis| {
            let place = |i: usize| origin[axis] + spacing[axis] * i as f64;
            (0..shape[axis]).map(place).collect::<Vec<f64>>()
        });
        let depth = |i: usize, j: usize| -map.heights[j * shape[0] + i];
        map.highs = lows([&lines[0], &lines[1]], depth);
        map.symmetric = [0, 1].map(|axis| map.is_mirrored(axis));
        Ok(map)
    }

    fn is_mirrored(&self, axis: usize) -> bool {
        let extent = self.spacing[axis] * (self.shape[axis] - 1) as f64;
        let largest = self.heights.iter().fold(0.0f64, |m, z| m.max(z.abs()));
        let [nx, ny] = self.shape;
        let mirrored = |k: usize| {
            let mirror = match axis {
                0 => k / nx * nx + nx - 1 - k % nx,
                _ => (ny - 1 - k / nx) * nx + k % nx,
            };
            (self.heights[k] - self.heights[mirror]).abs() <= 1e-12 * largest
        };
        (2.0 * self.origin[axis] + extent).abs() <= 1e-9 * extent && (0..nx * ny).all(mirrored)
    }

    /// Weights of four neighbouring points, the first of them, clamped to the border.
    fn weights(&self, axis: usize, position: f64) -> ([usize; 4], [f64; 4]) {
        let last = self.shape[axis] - 1;
        let place = ((position - self.origin[axis]) / self.spacing[axis]).clamp(0.0, last as f64);
        let i = (place as usize).min(last - 1);
        let t = place - i as f64;
        let points = [i.saturating_sub(1), i, i + 1, (i + 2).min(last)];
        let weights = [
            t * (-0.5 + t * (1.0 - 0.5 * t)),
            1.0 + t * t * (-2.5 + 1.5 * t),
            t * (0.5 + t * (2.0 - 1.5 * t)),
            t * t * (-0.5 + 0.5 * t),
        ];
        (points, weights)
    }
}

impl IceSurface for HeightMap {
    fn height(&self, x: f64, y: f64) -> f64 {
        let ((columns, along), (rows, across)) = (self.weights(0, x), self.weights(1, y));
        let row = |j: usize| -> f64 {
            let row = &self.heights[j * self.shape[0]..];
            columns.iter().zip(&along).map(|(&i, w)| w * row[i]).sum()
        };
        rows.iter().zip(&across).map(|(&j, w)| w * row(j)).sum()
    }

    fn spacing(&self) -> [f64; 2] {
        self.spacing
    }

    fn mirror_symmetric(&self) -> [bool; 2] {
        self.symmetric
    }

    fn highs(&self) -> &[[f64; 2]] {
        &self.highs
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waves_along_an_axis_are_symmetric_and_oblique_ones_are_not() {
        assert_eq!(
            Waviness::new(1e-6, 0.1).unwrap().mirror_symmetric(),
            [true, true]
        );
        let oblique = Waviness {
            direction: 0.3,
            ..Waviness::new(1e-6, 0.1).unwrap()
        };
        assert_eq!(oblique.mirror_symmetric(), [false, false]);
        assert!((oblique.height(0.0, 0.0) - 1e-6).abs() < 1e-20);
    }

    fn map(n: usize, f: impl Fn(f64, f64) -> f64) -> HeightMap {
        let step = 2.0 / (n - 1) as f64;
        let at = |k: usize| (-1.0 + step * (k % n) as f64, -1.0 + step * (k / n) as f64);
        let heights = (0..n * n).map(at).map(|(x, y)| f(x, y)).collect();
        HeightMap::new([-1.0; 2], [step; 2], [n, n], heights).unwrap()
    }

    fn worst(map: &HeightMap, f: impl Fn(f64, f64) -> f64) -> f64 {
        let at = |i: i32| 0.017 * f64::from(i);
        let errors = (-40..=40).flat_map(|i| (-40..=40).map(move |j| (at(i), at(j))));
        errors
            .map(|(x, y)| (map.height(x, y) - f(x, y)).abs())
            .fold(0.0, f64::max)
    }

    #[test]
    fn interpolation_converges_with_third_order() {
        let f = |x: f64, y: f64| (3.0 * x).sin() * (2.0 * y).cos();
        let errors = [21, 41, 81].map(|n| worst(&map(n, f), f));
        let slope = (errors[0] / errors[2]).log2() / 2.0;
        assert!((slope - 3.0).abs() < 0.3, "{slope}");
    }

    #[test]
    fn the_border_goes_on_and_symmetry_is_seen() {
        let bowl = map(11, |x, y| x * x + y);
        assert!((bowl.height(5.0, 0.0) - bowl.height(1.0, 0.0)).abs() < 1e-15);
        assert_eq!(bowl.mirror_symmetric(), [true, false]);
    }
}
