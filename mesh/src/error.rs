//! Errors of hulls, meshes and height maps.

use std::fmt::Display;
use std::path::Path;

use thiserror::Error;

/// Errors of hulls, meshes and height maps.
#[derive(Debug, Error)]
pub enum MeshError {
    /// A value that is not as expected.
    #[error("{place}: found {found}; expected {expected}")]
    Value {
        /// The parameter, or the place in a file.
        place: String,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// A defect of a hull, a mesh or a height map as a whole.
    #[error("{0}")]
    Invalid(String),
    /// A file that cannot be read or written.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: String,
        /// The system's error.
        source: std::io::Error,
    },
    /// A file with invalid content.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: String,
        /// The defect.
        source: Box<MeshError>,
    },
}

impl MeshError {
    /// The error of a value at `place` that is not as expected.
    pub fn value(place: impl Display, found: impl Display, expected: impl Display) -> Self {
        Self::Value {
            place: place.to_string(),
            found: found.to_string(),
            expected: expected.to_string(),
        }
    }

    pub(crate) fn no_triangles() -> Self {
        Self::Invalid("the hull has no triangles".into())
    }

    /// The error of vertices that determine no surface.
    pub(crate) fn no_fit() -> Self {
        Self::Invalid(
            "the hull's underside determines no smooth surface; expected vertices spread along and \
             across it"
                .into(),
        )
    }

    pub(crate) fn too_many(what: &str, limit: usize) -> Self {
        Self::Invalid(format!("more than {limit} {what}"))
    }

    /// The error of triangle `triangle`, from 1, with a corner that is not one of the vertices.
    pub(crate) fn vertex_index(triangle: usize, index: usize, vertices: usize) -> Self {
        Self::Invalid(format!(
            "triangle {triangle} refers to vertex {index}, counted from 0; the hull has {vertices} \
             vertices"
        ))
    }

    /// The error of vertex `vertex`, from 1, at a `position` that is not finite.
    pub(crate) fn not_finite(vertex: usize, position: [f64; 3]) -> Self {
        Self::Invalid(format!(
            "vertex {vertex} is at {position:?}; expected finite coordinates"
        ))
    }

    /// The error with the file that it is in.
    pub fn in_file(self, path: &Path) -> Self {
        Self::File {
            path: path.display().to_string(),
            source: Box::new(self),
        }
    }
}
