//! Hulls, their smooth undersides, and hexahedral grids.
//!
//! | type | what it is |
//! |---|---|
//! | [`Underside`] | the height of a hull's lower surface over the contact plane |
//! | [`Swept`] | a [`Section`] swept along a [`Rocker`]: [`BobRunner`] and [`LugeSteel`] make one |
//! | [`Hull`] | triangles, read by [`read_obj`], [`read_gltf`], [`read_stl`], [`read_3mf`] or made by [`tessellate`] |
//! | [`FittedUnderside`] | a smooth surface through a hull's vertices |
//! | [`Paraboloid`] | an unbounded paraboloid, for verification |
//! | [`TensorGrid`] | graded coordinates along x, y and z |
//! | [`HexMesh`] | points and eight-node hexahedra; [`write_vtu`], [`read_vtu`], [`read_gmsh`] |
//! | [`Filled`] | a scanned hull as the space between its underside and its flat top |
//! | [`mapped_runner_mesh`] | hexahedra between an underside and its mount |
//! | [`IceSurface`] | the height of the unloaded ice: [`Waviness`], [`HeightMap`] |
//!
//! ```
//! use kufe_mesh::TensorGrid;
//! let grid = TensorGrid { x: vec![0.0, 1.0, 3.0], y: vec![0.0, 1.0], z: vec![-1.0, 0.0] };
//! let mesh = grid.hex_mesh();
//! assert_eq!((mesh.points.len(), mesh.cells.len()), (12, 2));
//! ```

mod error;
mod fit;
mod hexahedra;
mod hull;
mod ice;
mod input;
mod parameter;
mod scan;
mod shapes;

pub use error::MeshError;
pub use fit::{FitQuality, FittedUnderside, Scans, smaller_by};
pub use hexahedra::{
    Filled, HexMesh, Quality, TensorGrid, VtuField, graded_levels, limit_slope, mapped_runner_mesh,
    mesh_over_heights, read_gmsh, read_vtu, write_pvd, write_vtp, write_vtu,
};
pub use hull::{
    Axis, Hull, HullFormat, HullOptions, HullReport, check_hull, checked_runner, hull_files,
    load_hull, read_3mf, read_gltf, read_obj, read_stl, size_warnings, tessellate,
    tessellate_steel,
};
pub use ice::{ExrImage, HeightMap, IceSurface, Waviness, load_height_map};
pub use scan::{
    Estimate, Noise, Orientation, PlacedScan, ScanFrame, keel_spacing, noise_of_faces,
    noise_of_hull, strips_of_hull, strips_warning, unlike_runner,
};
pub use shapes::{
    BobRunner, Ends, LugeSteel, Paraboloid, Profile, Rocker, Section, Swept, Underside, load_points,
};
