//! A hull as triangles.

use std::collections::HashMap;

use crate::error::MeshError;

/// Positions and triangles, counter-clockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hull {
    /// Vertex positions [m].
    pub positions: Vec<[f64; 3]>,
    /// Corners of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl Hull {
    /// The hull with equal positions made one vertex and collapsed triangles left out, its
    /// coordinates carried over by `rows`.
    ///
    /// # Errors
    /// [`MeshError::NoTriangles`], [`MeshError::VertexIndex`] where a corner has no position,
    /// [`MeshError::NotFinite`] where a position that a triangle uses is no number.
    pub(crate) fn welded(
        positions: &[[f64; 3]],
        triangles: impl Iterator<Item = [usize; 3]>,
        rows: [[f64; 3]; 3],
    ) -> Result<Self, MeshError> {
        let mut hull = Self::default();
        let mut known: HashMap<[u64; 3], u32> = HashMap::new();
        for (number, corners) in triangles.enumerate() {
            let mut welded = [0; 3];
            for (corner, &index) in welded.iter_mut().zip(&corners) {
                let found = positions.get(index);
                let position = found.ok_or(MeshError::VertexIndex {
                    triangle: number + 1,
                    index,
                    vertices: positions.len(),
                })?;
                if position.iter().any(|v| !v.is_finite()) {
                    return Err(MeshError::NotFinite {
                        vertex: index + 1,
                        position: *position,
                    });
                }
                // Adding zero makes -0 and 0 the same bits.
                let key = position.map(|v| (v + 0.0).to_bits());
                *corner = *known.entry(key).or_insert_with(|| {
                    hull.positions.push(
                        rows.map(|r| r[0] * position[0] + r[1] * position[1] + r[2] * position[2]),
                    );
                    (hull.positions.len() - 1) as u32
                });
            }
            let [a, b, c] = welded;
            if a != b && b != c && c != a {
                hull.triangles.push(welded);
            }
        }
        if hull.triangles.is_empty() {
            return Err(MeshError::NoTriangles);
        }
        if let Some(vertex) = hull
            .positions
            .iter()
            .position(|p| p.iter().any(|v| !v.is_finite()))
        {
            return Err(MeshError::NotFinite {
                vertex: vertex + 1,
                position: hull.positions[vertex],
            });
        }
        Ok(hull)
    }

    /// Smallest and largest coordinates [m].
    pub fn bounds(&self) -> [[f64; 3]; 2] {
        let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for position in &self.positions {
            for axis in 0..3 {
                bounds[0][axis] = bounds[0][axis].min(position[axis]);
                bounds[1][axis] = bounds[1][axis].max(position[axis]);
            }
        }
        bounds
    }

    /// Signed volume `1/6 sum a . (b x c)` [m^3], positive where the triangles of a closed hull face outwards.
    pub fn volume(&self) -> f64 {
        let [low, _] = self.bounds();
        let volume = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| {
                let p = self.positions[i as usize];
                [p[0] - low[0], p[1] - low[1], p[2] - low[2]]
            });
            let cross = [
                b[1] * c[2] - b[2] * c[1],
                b[2] * c[0] - b[0] * c[2],
                b[0] * c[1] - b[1] * c[0],
            ];
            (a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]) / 6.0
        };
        self.triangles.iter().map(volume).sum()
    }

    /// Twice the area vector of triangle `t` [m^2]; it points outwards.
    pub fn normal(&self, t: &[u32; 3]) -> [f64; 3] {
        let [a, b, c] = t.map(|i| self.positions[i as usize]);
        let (u, v) = (
            [b[0] - a[0], b[1] - a[1], b[2] - a[2]],
            [c[0] - a[0], c[1] - a[1], c[2] - a[2]],
        );
        [
            u[1] * v[2] - u[2] * v[1],
            u[2] * v[0] - u[0] * v[2],
            u[0] * v[1] - u[1] * v[0],
        ]
    }
}
