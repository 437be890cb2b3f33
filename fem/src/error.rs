//! Errors of this crate.

/// Errors of this crate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// Young's modulus is not a positive finite number.
    #[error("Young's modulus is {found} Pa; expected a positive finite number")]
    YoungsModulus {
        /// The value found [Pa].
        found: f64,
    },
    /// Poisson's ratio is outside the range of a stable, compressible solid.
    #[error("Poisson's ratio is {found}; expected -1 < nu < 0.5")]
    PoissonsRatio {
        /// The value found.
        found: f64,
    },
    /// A corner of a cell names a node that the mesh does not have.
    #[error("cell {cell} names node {node}; expected a node below {node_count}")]
    NodeIndex {
        /// The cell.
        cell: usize,
        /// The node that it names.
        node: usize,
        /// Number of nodes.
        node_count: usize,
    },
    /// A cell is turned inside out, flat, or has a coordinate that is not finite.
    #[error(
        "cell {cell} has the Jacobian determinant {determinant} m^3 at a Gauss point or its centre; \
         expected a positive number (corners in VTK's order, no inverted or flat cells)"
    )]
    InvertedCell {
        /// The cell.
        cell: usize,
        /// The smallest determinant [m^3].
        determinant: f64,
    },
    /// A mesh without cells.
    #[error("the mesh has no cells; expected at least one hexahedron")]
    NoCells,
    /// The mesh is too large for 32-bit node numbers.
    #[error("the mesh has {node_count} nodes; expected at most {limit}")]
    TooManyNodes {
        /// Number of nodes.
        node_count: usize,
        /// Largest number allowed.
        limit: usize,
    },
    /// A list has another length than expected.
    #[error("{what}: {found} entries; expected {expected}")]
    Length {
        /// Content of the list.
        what: &'static str,
        /// Entries found.
        found: usize,
        /// Entries expected.
        expected: usize,
    },
    /// A displacement is prescribed at a node or component that does not exist, or is not finite.
    #[error(
        "displacement {value} m prescribed for component {component} of node {node}; expected a finite value, \
         a component below 3 and a node below {node_count}"
    )]
    Prescribed {
        /// The node.
        node: usize,
        /// The component: 0, 1 or 2 for x, y or z.
        component: usize,
        /// The value [m].
        value: f64,
        /// Number of nodes.
        node_count: usize,
    },
    /// One displacement is prescribed twice with different values.
    #[error("component {component} of node {node} is prescribed as {first} m and as {second} m")]
    PrescribedTwice {
        /// The node.
        node: usize,
        /// The component: 0, 1 or 2 for x, y or z.
        component: usize,
        /// The value prescribed first [m].
        first: f64,
        /// The value prescribed second [m].
        second: f64,
    },
    /// Elimination met a pivot that is not positive: the body can move as a mechanism.
    #[error(
        "the stiffness of {free_dofs} free displacements is not positive definite; expected supports that hold every \
         rigid motion of every part"
    )]
    NotPositiveDefinite {
        /// Number of free displacements.
        free_dofs: usize,
    },
    /// The factor does not fit into memory or index range.
    #[error("the Cholesky factor of {free_dofs} free displacements does not fit: {reason}")]
    FactorTooLarge {
        /// Number of free displacements.
        free_dofs: usize,
        /// Error of the factorisation.
        reason: String,
    },
    /// The assembled stiffness does not fit into the allowed memory.
    #[error(
        "the assembled stiffness of {dofs} displacements needs {:.2} GB; expected at most {:.2} GB",
        *needed as f64 / 1e9,
        *limit as f64 / 1e9
    )]
    MatrixTooLarge {
        /// Number of displacements.
        dofs: usize,
        /// Memory needed for assembling [bytes].
        needed: u64,
        /// Allowed memory [bytes].
        limit: u64,
    },
}
