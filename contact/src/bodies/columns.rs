//! The columns of the contact plane that a body stands on, and its side of the plane.

/// A rectangle of columns of the contact plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Columns {
    /// First column along x and along y.
    pub first: [usize; 2],
    /// Number of columns along x and along y.
    pub count: [usize; 2],
    /// Number of the plane's nodes along x.
    pub plane_width: usize,
}

impl Columns {
    /// A plane node's column along x and y in this rectangle.
    pub fn local(&self, node: usize) -> Option<[usize; 2]> {
        let i = (node % self.plane_width).checked_sub(self.first[0])?;
        let j = (node / self.plane_width).checked_sub(self.first[1])?;
        (i < self.count[0] && j < self.count[1]).then_some([i, j])
    }

    /// The plane node of a column of this rectangle.
    pub fn node(&self, [i, j]: [usize; 2]) -> usize {
        (self.first[1] + j) * self.plane_width + self.first[0] + i
    }
}

/// Which way the gap moves with a body's vertical displacement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    /// The body below, the ice: rising closes the gap.
    Below,
    /// The body above, the runner: rising opens it.
    Above,
}

impl Side {
    /// The gap shrinks by this times the vertical displacement.
    pub fn sign(self) -> f64 {
        match self {
            Side::Below => 1.0,
            Side::Above => -1.0,
        }
    }
}
