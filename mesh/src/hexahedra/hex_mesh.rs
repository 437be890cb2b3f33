//! Meshes of eight-node hexahedra.

/// Points and eight-node hexahedra.
#[derive(Clone, Debug, PartialEq)]
pub struct HexMesh {
    /// Node positions [m].
    pub points: Vec<[f64; 3]>,
    /// Corners of each cell in VTK's order: the lower face counter-clockwise seen from above
    /// (z up), then the upper face above it.
    pub cells: Vec<[usize; 8]>,
}
