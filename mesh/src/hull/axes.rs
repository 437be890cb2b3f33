//! From a file's axes and unit to metres, x forward and z up.

use std::{fmt, str::FromStr};

use crate::error::MeshError;

/// An axis of a file, with its sense.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axis {
    /// 0, 1 or 2 for x, y or z.
    pub index: usize,
    /// Whether the axis points the other way.
    pub negative: bool,
}

impl Axis {
    /// The axis +x.
    pub const X: Self = Self {
        index: 0,
        negative: false,
    };
    /// The axis +y.
    pub const Y: Self = Self {
        index: 1,
        negative: false,
    };
    /// The axis +z.
    pub const Z: Self = Self {
        index: 2,
        negative: false,
    };

    fn vector(self) -> [f64; 3] {
        let mut vector = [0.0; 3];
        vector[self.index] = if self.negative { -1.0 } else { 1.0 };
        vector
    }
}

impl FromStr for Axis {
    type Err = MeshError;

    /// Reads `x`, `y`, `z`, `-x`, `-y` or `-z`.
    fn from_str(text: &str) -> Result<Self, MeshError> {
        let (negative, letter) = match text.strip_prefix('-') {
            Some(rest) => (true, rest),
            None => (false, text.strip_prefix('+').unwrap_or(text)),
        };
        let index = ["x", "y", "z"].iter().position(|&l| l == letter);
        let index = index.ok_or_else(|| MeshError::AxisName { found: text.into() })?;
        Ok(Self { index, negative })
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}{}",
            if self.negative { "-" } else { "" },
            ["x", "y", "z"][self.index]
        )
    }
}

/// How a file's coordinates become metres with x forward and z up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HullOptions {
    /// Metres in one unit of the file; 0.001 for millimetres.
    pub scale: f64,
    /// The file's axis that points up; where none is given, y for glTF and z for the others.
    pub up: Option<Axis>,
    /// The file's axis that points forward.
    pub forward: Axis,
}

impl Default for HullOptions {
    fn default() -> Self {
        Self {
            scale: 1.0,
            up: None,
            forward: Axis::X,
        }
    }
}

impl HullOptions {
    /// The rows of the matrix that carries file coordinates to metres, x forward, y left, z up.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] where the scale is not positive, [`MeshError::Axes`] where the axes are parallel.
    pub(crate) fn rows(&self, usual_up: Axis) -> Result<[[f64; 3]; 3], MeshError> {
        if !(self.scale > 0.0 && self.scale.is_finite()) {
            let expected = "a positive number of metres in one unit of the file";
            return Err(MeshError::Parameter {
                name: "scale",
                value: self.scale,
                expected,
            });
        }
        let up = self.up.unwrap_or(usual_up);
        if up.index == self.forward.index {
            return Err(MeshError::Axes {
                up: up.to_string(),
                forward: self.forward.to_string(),
            });
        }
        let (z, x) = (up.vector(), self.forward.vector());
        let y = [
            z[1] * x[2] - z[2] * x[1],
            z[2] * x[0] - z[0] * x[2],
            z[0] * x[1] - z[1] * x[0],
        ];
        Ok([x, y, z].map(|row| row.map(|v| v * self.scale)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_turn_a_y_up_file_right_handed() {
        let options = HullOptions {
            scale: 0.001,
            up: Some("y".parse().unwrap()),
            forward: "-z".parse().unwrap(),
        };
        let rows = options.rows(Axis::Z).unwrap();
        let carry = |p: [f64; 3]| rows.map(|r| r[0] * p[0] + r[1] * p[1] + r[2] * p[2]);
        assert_eq!(carry([0.0, 1000.0, 0.0]), [0.0, 0.0, 1.0]);
        assert_eq!(carry([0.0, 0.0, -1000.0]), [1.0, 0.0, 0.0]);
        assert_eq!(carry([1000.0, 0.0, 0.0]), [0.0, -1.0, 0.0]);
    }

    #[test]
    fn parallel_axes_and_unknown_names_are_refused() {
        let parallel = HullOptions {
            up: Some(Axis::X),
            ..Default::default()
        };
        assert!(
            parallel
                .rows(Axis::Z)
                .unwrap_err()
                .to_string()
                .contains("parallel")
        );
        assert!(
            "w".parse::<Axis>()
                .unwrap_err()
                .to_string()
                .contains("\"w\"")
        );
        let bad_scale = HullOptions {
            scale: f64::NAN,
            ..Default::default()
        };
        assert!(
            bad_scale
                .rows(Axis::Z)
                .unwrap_err()
                .to_string()
                .contains("scale")
        );
    }
}
