//! Data of the pages of a contact and of a series.

use kufe_contact::PressureMap;
use kufe_mesh::Hull;
use serde::Serialize;

use crate::report::grid::PackedGrid;
use crate::results::{
    ContactResult, Description, ErrorPart, Packed, SeriesResult, SeriesRow, pack,
};

/// Data of the page of one contact.
#[derive(Clone, Debug, Serialize)]
pub struct ContactPage {
    /// The peak pressure under which load.
    pub title: String,
    /// The folder or the case.
    pub name: String,
    /// The contact; its case without what has no effect.
    pub result: ContactResult,
    /// Total error of the peak pressure [Pa].
    pub peak_error_pa: f64,
    /// The parts of that error.
    pub peak_error_parts: Vec<ErrorPart>,
    /// The map of each part of the contact.
    pub maps: Vec<PackedGrid>,
    /// The hull in place.
    pub hull: Option<PackedHull>,
}

/// Vertices and triangles of a hull.
#[derive(Clone, Debug, Serialize)]
pub struct PackedHull {
    /// Vertices along the runner [m].
    pub x: Packed,
    /// Vertices across [m].
    pub y: Packed,
    /// Vertices upwards [m].
    pub z: Packed,
    /// Vertices of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl ContactPage {
    /// The data of a contact, on about `points` points along and across of all maps together.
    pub fn new(
        mut result: ContactResult,
        maps: &[PressureMap],
        hull: Option<&Hull>,
        points: [usize; 2],
        name: String,
    ) -> Self {
        result.case = std::mem::take(&mut result.case).effective();
        let (peak, load) = (1e-6 * result.p_max.value, result.fz_n);
        // Where its digits show it.
        let error = Some(1e-6 * result.peak().error).filter(|error| *error >= 0.05);
        let error = error.map_or(String::new(), |error| format!(" ± {error:.1}"));
        let mu = result.sliding.as_ref().map(|s| 1e3 * s.friction.mu.value);
        let mu = mu.map_or(String::new(), |mu| format!(", µ {mu:.2} · 10⁻³"));
        let share = (maps.len() as f64).sqrt();
        let most = points.map(|count| (count as f64 / share) as usize);
        let packed = maps.iter().map(|map| PackedGrid::thinned(map, most));
        ContactPage {
            title: format!("{peak:.1}{error} MPa{mu} under {load:.0} N"),
            name,
            peak_error_pa: result.peak().error,
            peak_error_parts: result.peak_error_parts(),
            result,
            maps: packed.collect(),
            hull: hull.map(PackedHull::from),
        }
    }
}

impl From<&Hull> for PackedHull {
    fn from(hull: &Hull) -> Self {
        let axis = |a: usize| pack(hull.positions.iter().map(|position| position[a]));
        PackedHull {
            x: axis(0),
            y: axis(1),
            z: axis(2),
            triangles: hull.triangles.clone(),
        }
    }
}

/// Data of the page of a series.
#[derive(Clone, Debug, Serialize)]
pub struct SeriesPage {
    /// The folder.
    pub name: String,
    /// The varied keys.
    pub keys: Vec<&'static str>,
    /// The numbers that the page offers to draw.
    pub quantities: [Description; 11],
    /// The contacts.
    pub rows: Vec<SeriesRow>,
}

impl SeriesPage {
    /// The data of a series; all rows vary the keys of the first.
    pub fn new(name: String, rows: Vec<SeriesRow>) -> Self {
        let varied = rows.first().map(|row| row.varied.named());
        SeriesPage {
            name,
            keys: varied.into_iter().flatten().map(|(key, _)| key).collect(),
            quantities: SeriesResult::DRAWN,
            rows,
        }
    }
}
