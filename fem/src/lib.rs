//! Linear elasticity on hexahedra.
