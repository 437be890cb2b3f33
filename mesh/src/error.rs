//! What can be wrong with a hull, a mesh or a height map.

use std::path::Path;

use thiserror::Error;

/// Why a hull, a mesh or a height map was refused.
#[derive(Debug, Error)]
pub enum MeshError {
    /// A number out of its range.
    #[error("{name} is {value}; expected {expected}")]
    Parameter {
        /// The parameter's name.
        name: &'static str,
        /// The value found.
        value: f64,
        /// What was expected.
        expected: &'static str,
    },
    /// A point of a profile that does not fit.
    #[error("{name}, point {row}: found {value}; expected {expected}")]
    ProfilePoint {
        /// Which profile.
        name: &'static str,
        /// The point's number, from 1.
        row: usize,
        /// The value found.
        value: f64,
        /// What was expected.
        expected: &'static str,
    },
    /// Too few points.
    #[error("{name}: {found} points; at least {needed} are needed")]
    TooFewPoints {
        /// What the points describe.
        name: &'static str,
        /// Points found.
        found: usize,
        /// Points needed.
        needed: usize,
    },
    /// An axis that is none of the six.
    #[error("axis {found:?}; expected x, y, z, -x, -y or -z")]
    AxisName {
        /// What was found.
        found: String,
    },
    /// Up and forward along the same axis.
    #[error("up = {up} and forward = {forward} are parallel; expected two different axes")]
    Axes {
        /// The axis up.
        up: String,
        /// The axis forward.
        forward: String,
    },
    /// A hull with nothing to touch.
    #[error("the hull has no triangles")]
    NoTriangles,
    /// A triangle's corner that does not exist.
    #[error(
        "triangle {triangle} refers to vertex {index}, counted from 0; the hull has {vertices} vertices"
    )]
    VertexIndex {
        /// The triangle's number, from 1.
        triangle: usize,
        /// The vertex it refers to, from 0.
        index: usize,
        /// Vertices there are.
        vertices: usize,
    },
    /// A position that is no number.
    #[error("vertex {vertex} is at {position:?}; expected finite coordinates")]
    NotFinite {
        /// The vertex's number, from 1.
        vertex: usize,
        /// Its position.
        position: [f64; 3],
    },
    /// A hull inside out.
    #[error(
        "the hull's triangles face inwards (signed volume {volume:.3e} m^3); reverse their winding (flip normals)"
    )]
    InvertedHull {
        /// Signed volume [m^3].
        volume: f64,
    },
    /// More than is sensible.
    #[error("more than {limit} {what}")]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// The limit.
        limit: usize,
    },
    /// A file's ending that names no known format.
    #[error(
        "the ending {found:?} names no hull format; expected obj, gltf, glb or stl, or 3mf to read"
    )]
    HullFormat {
        /// The ending found.
        found: String,
    },
    /// A file of exact shapes, which no reader here takes.
    #[error(
        "the file holds exact shapes, and hulls are read as triangles: expected obj, gltf, glb, stl or 3mf; \
         `gmsh {path} -2 -clmax 0.5 -format stl -bin -o {stl}` makes triangles of 0.5 mm of it, in millimetres (scale = 0.001)"
    )]
    ExactShapes {
        /// The file.
        path: String,
        /// What its triangles may be called.
        stl: String,
    },
    /// A word in a text file that does not fit.
    #[error("not a readable {format} file: line {line}: found {found}; expected {expected}")]
    Syntax {
        /// The file's format.
        format: &'static str,
        /// The line, from 1.
        line: usize,
        /// What was found.
        found: String,
        /// What was expected.
        expected: &'static str,
    },
    /// An STL file shorter than it says.
    #[error("the STL file announces {facets} facets, which need {needed} bytes; it has {found}")]
    StlLength {
        /// Facets announced.
        facets: u64,
        /// Bytes they need.
        needed: u64,
        /// Bytes there are.
        found: usize,
    },
    /// A glTF file that cannot be parsed.
    #[error("not a readable glTF file: {0}")]
    Gltf(#[from] gltf::Error),
    /// A glTF file whose triangles are compressed.
    #[error(
        "the glTF file is compressed by {method}, which is not read; export it without compression (in Blender: import it, \
         export glTF with Compression off)"
    )]
    GltfCompressed {
        /// The method.
        method: &'static str,
    },
    /// A 3MF file that cannot be read.
    #[error("not a readable 3MF file: {part}: found {found}; expected {expected}")]
    ThreeMf {
        /// The part of the package.
        part: String,
        /// What was found.
        found: String,
        /// What was expected.
        expected: &'static str,
    },
    /// A GLB header with an impossible length.
    #[error("the GLB header announces {announced} bytes; the file has {found}")]
    GlbLength {
        /// Bytes announced.
        announced: usize,
        /// Bytes there are.
        found: usize,
    },
    /// A buffer shorter than the glTF file says.
    #[error("glTF buffer {index} announces {announced} bytes; it has {found}")]
    GltfBuffer {
        /// The buffer's index.
        index: usize,
        /// Bytes announced.
        announced: usize,
        /// Bytes there are.
        found: usize,
    },
    /// A buffer's file that cannot be read.
    #[error("glTF buffer file {uri:?}: {source}")]
    GltfFile {
        /// The file's address.
        uri: String,
        /// Why.
        source: std::io::Error,
    },
    /// An accessor that does not fit its data.
    #[error("glTF accessor {index}: {problem}")]
    GltfAccessor {
        /// The accessor's index.
        index: usize,
        /// What is wrong.
        problem: &'static str,
    },
    /// A node reached twice.
    #[error("glTF node {index} is reached twice; expected a tree")]
    GltfNode {
        /// The node's index.
        index: usize,
    },
    /// A file that cannot be read or written.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: String,
        /// Why.
        source: std::io::Error,
    },
    /// What is wrong with a file.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: String,
        /// What is wrong.
        source: Box<MeshError>,
    },
    /// A hull without an underside.
    #[error("no triangle of the hull faces down; check `up`, and that the triangles face outwards")]
    NothingFacesDown,
    /// A vertex far below the surface that faces down, among facets as steep as flanks.
    #[error(
        "the hull's lowest vertex, at x = {:.6}, y = {:.6}, z = {:.6} m, lies {by} m below the surface that faces down: a stray vertex?",
        .at[0], .at[1], .at[2]
    )]
    StrayVertex {
        /// Where it is [m].
        at: [f64; 3],
        /// How far below [m].
        by: f64,
    },
    /// Vertices that determine no surface.
    #[error(
        "the hull's underside determines no smooth surface; expected vertices spread along and across it"
    )]
    NoFit,
    /// An open hull that is to deform, whose top nobody states.
    #[error(
        "the hull is open ({edges} edges belong to one triangle only), and an elastic runner is filled up to its top: expected \
         runner.height_m, from its lowest point to its flat top (its highest vertex is at {highest:.4} m)"
    )]
    TopNotKnown {
        /// Edges that only one triangle uses.
        edges: usize,
        /// Height of the highest vertex over the lowest point [m].
        highest: f64,
    },
    /// A hull that upright columns do not fill.
    #[error(
        "the hull cannot be filled with columns from its underside to its top at {top:.4} m: {:.1} % {found}; expected at most {:.0} %: \
         another runner.height_m, or hexahedra of its own (runner.mesh)",
        100.0 * share.abs(), 100.0 * allowed
    )]
    NotFilled {
        /// What is amiss.
        found: &'static str,
        /// Its part.
        share: f64,
        /// The largest part allowed.
        allowed: f64,
        /// Height of the top over the lowest point [m].
        top: f64,
    },
    /// A mesh without cells.
    #[error("the mesh has no hexahedra")]
    NoCells,
    /// A cell's corner that does not exist.
    #[error("cell {cell} refers to node {node}, counted from 0; the mesh has {points} nodes")]
    CellNode {
        /// The cell's number, from 1.
        cell: usize,
        /// The node it refers to, from 0.
        node: usize,
        /// Nodes there are.
        points: usize,
    },
    /// A cell that is no hexahedron.
    #[error("cell {cell} has {found}; expected eight-node hexahedra only")]
    CellType {
        /// The cell's number, from 1.
        cell: usize,
        /// Its type.
        found: String,
    },
    /// Coordinates that do not increase.
    #[error(
        "{name}: {count} values, the one at index {index} out of order; expected two or more increasing numbers"
    )]
    NotIncreasing {
        /// Which coordinates.
        name: &'static str,
        /// Index of the value that does not increase.
        index: usize,
        /// Number of values.
        count: usize,
    },
    /// A column of hexahedra with no hull over it.
    #[error(
        "the column at x = {x} m, y = {y} m has the underside at {height} m; expected a height below the top at {top} m"
    )]
    OutsideHull {
        /// The column's x [m].
        x: f64,
        /// The column's y [m].
        y: f64,
        /// Height of the underside there [m]; infinite where there is no hull.
        height: f64,
        /// Height of the top [m].
        top: f64,
    },
    /// A field that does not fit its mesh.
    #[error("field {name:?} has {found} numbers; expected {expected}")]
    FieldLength {
        /// The field's name.
        name: String,
        /// Numbers found.
        found: usize,
        /// Numbers expected.
        expected: usize,
    },
    /// A VTU file that cannot be written.
    #[error("the VTU file cannot be written: {0}")]
    Vtu(String),
    /// A VTU file that cannot be read.
    #[error("not a readable VTU file: {array}: {problem}")]
    VtuRead {
        /// Which array or element.
        array: String,
        /// What is wrong.
        problem: &'static str,
    },
    /// A height map with the wrong number of heights.
    #[error(
        "height map of {shape:?} points with {found} heights; expected two or more points along each axis, one height each"
    )]
    MapShape {
        /// Points along x and y.
        shape: [usize; 2],
        /// Heights found.
        found: usize,
    },
    /// A height that is no number.
    #[error("height map, column {column}, row {row}: found {value}; expected a finite number")]
    MapHeight {
        /// Index along x.
        column: usize,
        /// Index along y.
        row: usize,
        /// The value found.
        value: f64,
    },
    /// A height map's row that cannot be read.
    #[error("height map, row {row}, column {column}: found {found}; expected a number in [m]")]
    MapRow {
        /// The row in the file, from 1.
        row: usize,
        /// The column.
        column: &'static str,
        /// What was found.
        found: String,
    },
    /// Points that fill no regular grid.
    #[error("height map: {points} points at {} different x and {} different y: {problem}", shape[0], shape[1])]
    MapGrid {
        /// Different x and y.
        shape: [usize; 2],
        /// Number of points.
        points: usize,
        /// What is wrong.
        problem: &'static str,
    },
    /// Not the EXR image that was expected.
    #[error("EXR image: {problem}")]
    Exr {
        /// What is wrong.
        problem: String,
    },
    /// A height map in an unknown format.
    #[error("height maps of format {found:?} are not read; expected csv or exr")]
    MapFormat {
        /// The file's ending.
        found: String,
    },
    /// A measured curve's table with other columns.
    #[error("columns {found}: expected {},{}", columns[0], columns[1])]
    PointColumns {
        /// The columns found.
        found: String,
        /// The columns expected.
        columns: [&'static str; 2],
    },
    /// A measured curve's row that cannot be read.
    #[error("row {row}, column {column}: {found}: expected a number of m")]
    PointRow {
        /// The row under the header, from 1.
        row: usize,
        /// The column.
        column: &'static str,
        /// What was found.
        found: String,
    },
}

impl MeshError {
    /// The error with the file that it is in.
    pub fn in_file(self, path: &Path) -> Self {
        Self::File {
            path: path.display().to_string(),
            source: Box::new(self),
        }
    }
}
