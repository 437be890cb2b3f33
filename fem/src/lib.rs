//! Linear elasticity on hexahedra.

mod boussinesq;
mod error;
mod fast_diagonal;
mod material;
mod tensor_axis;
mod tensor_operator;

pub use boussinesq::{boussinesq, boussinesq_stress, love_rectangle};
pub use error::Error;
pub use fast_diagonal::FastDiagonal;
pub use material::Material;
pub use tensor_axis::{Axis, AxisModes, Tridiagonal};
pub use tensor_operator::{HeldFaces, TensorOperator};
