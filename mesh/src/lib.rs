//! Hulls, their smooth undersides, and hexahedral grids.
//!
//! | type | what it is |
//! |---|---|
//! | [`Underside`] | the height of a hull's lower surface over the contact plane |
//! | [`Swept`] | a [`Section`] swept along a [`Rocker`]: [`BobRunner`] and [`LugeSteel`] make one |
//! | [`Hull`] | triangles, read by [`read_obj`], [`read_gltf`], [`read_stl`] or made by [`tessellate`] |
//! | [`FittedUnderside`] | a smooth surface through a hull's vertices |
//! | [`Paraboloid`] | an unbounded paraboloid, for verification |
//! | [`TensorGrid`] | graded coordinates along x, y and z |
//! | [`HexMesh`] | points and eight-node hexahedra; [`write_vtu`], [`read_vtu`], [`read_gmsh`] |
//! | [`mapped_runner_mesh`] | hexahedra between an underside and its mount |
//! | [`IceSurface`] | ice as it is: [`Waviness`], [`HeightMap`] |
//!
//! ```
//! use kufe_mesh::TensorGrid;
//! let grid = TensorGrid { x: vec![0.0, 1.0, 3.0], y: vec![0.0, 1.0], z: vec![-1.0, 0.0] };
//! let mesh = grid.hex_mesh();
//! assert_eq!((mesh.points.len(), mesh.cells.len()), (12, 2));
//! ```

mod arc_length;
mod b_spline;
mod band_cholesky;
mod bob_runner;
mod break_places;
mod downward;
mod error;
mod exr_image;
mod fitted_underside;
mod height_fit;
mod height_map_file;
mod hex_mesh;
mod hull;
mod hull_check;
mod hull_file;
mod ice_surface;
mod luge_steel;
mod mapped_mesh;
mod paraboloid;
mod points_file;
mod profile;
mod read_gltf;
mod read_gmsh;
mod read_obj;
mod read_stl;
mod read_vtu;
mod rocker;
mod section;
mod swept;
mod tensor_grid;
mod tessellate;
mod underside;
mod write_hull;
mod write_vtu;

use b_spline::BSpline;
pub use bob_runner::BobRunner;
pub use error::MeshError;
pub use exr_image::ExrImage;
pub use fitted_underside::{Coarse, FitQuality, FittedUnderside};
pub use height_map_file::load_height_map;
pub use hex_mesh::{HexMesh, Quality};
pub use hull::{Axis, Hull, HullOptions};
pub use hull_check::{HullReport, HullWarning, check_hull};
pub use hull_file::{HullFormat, load_hull};
pub use ice_surface::{HeightMap, IceSurface, Interpolation, Waviness};
pub use luge_steel::LugeSteel;
pub use mapped_mesh::{graded_levels, limit_slope, mapped_runner_mesh, mesh_over_heights};
pub use paraboloid::Paraboloid;
pub use points_file::load_points;
pub use profile::Profile;
pub use read_gltf::read_gltf;
pub use read_gmsh::read_gmsh;
pub use read_obj::read_obj;
pub use read_stl::read_stl;
pub use read_vtu::read_vtu;
pub use rocker::Rocker;
pub use section::Section;
pub use swept::{Ends, Swept};
pub use tensor_grid::TensorGrid;
pub use tessellate::{tessellate, tessellate_turning};
pub use underside::Underside;
pub use write_hull::{write_glb, write_obj, write_stl};
pub use write_vtu::{VtuField, write_pvd, write_vtu};
