//! Whether a hull is closed, faces outwards and has a credible size.

use std::{collections::HashMap, fmt};

use crate::error::MeshError;
use crate::hull::triangles::Hull;

/// Hulls longer than this are taken for a unit's mistake [m].
const LARGEST_EXTENT: f64 = 20.0;
/// Hulls shorter than this are taken for a unit's mistake [m].
const SMALLEST_EXTENT: f64 = 0.01;

/// What a hull is like.
#[derive(Clone, Debug, PartialEq)]
pub struct HullReport {
    /// Edges that only one triangle uses.
    pub open_edges: usize,
    /// Edges whose two triangles disagree about the outside.
    pub flipped_edges: usize,
    /// Size along x, y and z [m].
    pub extent: [f64; 3],
    /// Signed volume [m^3]; of little meaning where edges are open.
    pub volume: f64,
    /// What the caller should show.
    pub warnings: Vec<HullWarning>,
}

/// Something about a hull that may be meant, and more often is a mistake.
#[derive(Clone, Debug, PartialEq)]
pub enum HullWarning {
    /// The hull is so large that its unit is likely millimetres.
    TooLarge {
        /// Largest extent [m].
        extent: f64,
    },
    /// The hull is so small that its scale is likely wrong.
    TooSmall {
        /// Largest extent [m].
        extent: f64,
    },
    /// The surface has holes.
    Open {
        /// Edges that only one triangle uses.
        edges: usize,
    },
    /// The hull is longer across than along.
    Across {
        /// Extents along x and y [m].
        extent: [f64; 2],
    },
    /// The file holds several surfaces that share no vertex.
    Apart {
        /// How many.
        bodies: usize,
    },
    /// The vertices of the underside scatter about a smooth surface.
    Noisy {
        /// Their standard deviation [m].
        noise: f64,
    },
    /// Neighbouring triangles disagree about the outside.
    Flipped {
        /// Edges where they do.
        edges: usize,
    },
}

impl fmt::Display for HullWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooLarge { extent } => write!(
                f,
                "the hull is {extent:.4} m large; if the file is in millimetres, set scale = 0.001"
            ),
            Self::TooSmall { extent } => {
                write!(
                    f,
                    "the hull is only {extent:.3e} m large; check its scale (metres in one unit of the file)"
                )
            }
            Self::Open { edges } => {
                write!(
                    f,
                    "the hull is open: {edges} edges belong to one triangle only; its downward-facing part is used"
                )
            }
            Self::Across { extent: [x, y] } => {
                write!(
                    f,
                    "the hull is {y:.4} m across and {x:.4} m along: a runner that points along y needs forward = \"y\""
                )
            }
            Self::Apart { bodies } => {
                write!(
                    f,
                    "the file holds {bodies} bodies apart: the one with the lowest vertex is the runner, the others take no part"
                )
            }
            Self::Noisy { noise } => write!(
                f,
                "the underside's vertices scatter by {:.3} µm about a smooth surface: taken for noise and smoothed; noise_m states another",
                1e6 * noise
            ),
            Self::Flipped { edges } => {
                write!(
                    f,
                    "the hull's triangles disagree about the outside along {edges} edges; unify their winding"
                )
            }
        }
    }
}

/// What is odd about the size of a hull or of a mesh, along x, y and z [m].
pub fn size_warnings(extent: [f64; 3]) -> Vec<HullWarning> {
    let size = extent.iter().copied().fold(0.0, f64::max);
    if size > LARGEST_EXTENT {
        return vec![HullWarning::TooLarge { extent: size }];
    }
    if size < SMALLEST_EXTENT {
        return vec![HullWarning::TooSmall { extent: size }];
    }
    Vec::new()
}

/// Checks a hull and says what it is like.
///
/// # Errors
/// [`MeshError::InvertedHull`] where a closed hull's triangles face inwards.
pub fn check_hull(hull: &Hull) -> Result<HullReport, MeshError> {
    // Times each edge is walked upwards and downwards in index.
    let mut edges: HashMap<[u32; 2], [u32; 2]> =
        HashMap::with_capacity(hull.triangles.len() * 3 / 2);
    for &[a, b, c] in &hull.triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            edges.entry([from.min(to), from.max(to)]).or_default()[usize::from(from > to)] += 1;
        }
    }
    let open_edges = edges.values().filter(|[up, down]| up + down == 1).count();
    let flipped_edges = edges
        .values()
        .filter(|[up, down]| *up == 2 && *down == 0 || *up == 0 && *down == 2)
        .count();
    let [low, high] = hull.bounds();
    let extent = [high[0] - low[0], high[1] - low[1], high[2] - low[2]];
    let volume = hull.volume();
    if open_edges == 0 && volume < 0.0 {
        return Err(MeshError::InvertedHull { volume });
    }
    let mut warnings = size_warnings(extent);
    if open_edges > 0 {
        warnings.push(HullWarning::Open { edges: open_edges });
    }
    // A disc or a ball is as wide as it is long.
    if extent[1] > 1.5 * extent[0] {
        warnings.push(HullWarning::Across {
            extent: [extent[0], extent[1]],
        });
    }
    let bodies = bodies(hull);
    if bodies > 1 {
        warnings.push(HullWarning::Apart { bodies });
    }
    if flipped_edges > 0 {
        warnings.push(HullWarning::Flipped {
            edges: flipped_edges,
        });
    }
    Ok(HullReport {
        open_edges,
        flipped_edges,
        extent,
        volume,
        warnings,
    })
}

/// Surfaces that share no vertex with one another.
fn bodies(hull: &Hull) -> usize {
    let mut leads: Vec<u32> = (0..hull.positions.len() as u32).collect();
    fn lead(leads: &mut [u32], mut of: u32) -> u32 {
        while leads[of as usize] != of {
            leads[of as usize] = leads[leads[of as usize] as usize];
            of = leads[of as usize];
        }
        of
    }
    for [a, b, c] in &hull.triangles {
        for other in [b, c] {
            let (one, other) = (lead(&mut leads, *a), lead(&mut leads, *other));
            leads[one.max(other) as usize] = one.min(other);
        }
    }
    let mut found: Vec<u32> = hull
        .triangles
        .iter()
        .map(|corners| lead(&mut leads, corners[0]))
        .collect();
    found.sort_unstable();
    found.dedup();
    found.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron(size: f64) -> Hull {
        let positions = vec![
            [0.0; 3],
            [size, 0.0, 0.0],
            [0.0, size, 0.0],
            [0.0, 0.0, size],
        ];
        Hull {
            positions,
            triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
        }
    }

    #[test]
    fn closed_outward_hull_has_its_volume_and_no_warning() {
        let report = check_hull(&tetrahedron(1.0)).unwrap();
        assert!((report.volume - 1.0 / 6.0).abs() < 1e-15);
        assert_eq!(
            (
                report.open_edges,
                report.flipped_edges,
                report.warnings.len()
            ),
            (0, 0, 0)
        );
    }

    #[test]
    fn inverted_hull_is_refused_with_the_fix() {
        let mut hull = tetrahedron(1.0);
        hull.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        let message = check_hull(&hull).unwrap_err().to_string();
        assert!(
            message.contains("inwards") && message.contains("winding"),
            "{message}"
        );
    }

    #[test]
    fn open_flipped_and_millimetre_hulls_are_warned_about() {
        let mut hull = tetrahedron(1000.0);
        hull.triangles.pop();
        hull.triangles[0].swap(1, 2);
        let report = check_hull(&hull).unwrap();
        assert_eq!((report.open_edges, report.flipped_edges), (3, 2));
        assert!(report.warnings[0].to_string().contains("scale = 0.001"));
        assert_eq!(report.warnings.len(), 3);
    }
}
