//! The solver's two kernels on a graphics processor, by portable compute shaders (Vulkan, Metal, Direct3D 12).
//!
//! | type | what it is |
//! |---|---|
//! | [`Device`] | the processor and what it can hold |
//! | [`Solver`] | a linear solve: conjugate gradients on the device inside iterative refinement on the processor |
//! | [`DeviceCg`] | those conjugate gradients, with the kernels they are made of |
//! | [`EndPlane`] | what a constraint on the plane that elimination ends on reads and changes |
//!
//! Devices compute in single precision; residuals are taken in double precision by [`crate::TensorOperator`], so a solve
//! reaches the tolerances that [`crate::cg::solve`] does.
//!
//! ```
//! use kufe_fem::gpu::{Device, Options, Solver};
//! use kufe_fem::{End, PlanewiseDiagonal, TensorOperator};
//! use kufe_mesh::TensorGrid;
//!
//! let axis: Vec<f64> = (0..9).map(|i| 0.01 * f64::from(i)).collect();
//! let grid = TensorGrid { x: axis.clone(), y: axis.clone(), z: axis };
//! let held = [[[false, true], [false, true], [true, false]]; 3];
//! let operator = TensorOperator::new(&grid, 6.6e9, 3.4e9, held);
//! let preconditioner = PlanewiseDiagonal::new(&operator, End::High);
//! let mut load = vec![0.0; 3 * grid.node_count()];
//! load[3 * grid.node_count() - 81] = 1000.0;
//! let mut u = vec![0.0; load.len()];
//! match Device::open() {
//!     Ok(device) => {
//!         let mut solver = Solver::new(&device, &operator, &preconditioner)?;
//!         let history = solver.solve(&load, &mut u, &Options::default())?;
//!         assert!(history.residuals.last().is_some_and(|residual| *residual <= 1e-10));
//!     }
//!     Err(error) => println!("{error}"),
//! }
//! # Ok::<(), kufe_fem::Error>(())
//! ```

mod cg;
mod device;
mod elimination;
mod end_plane;
mod narrow;
mod operator;
mod place;
mod preconditioner;
mod product;
mod refinement;
mod sums;
mod units;

pub use cg::DeviceCg;
pub use device::open::Device;
pub use end_plane::EndPlane;
pub use refinement::{History, Options, Solver};
pub use sums::Progress;
