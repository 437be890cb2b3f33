//! Data of the pages of a contact and of a series of contacts.

use kufe_contact::PressureMap;
use kufe_mesh::Hull;
use serde::Serialize;

use crate::plot::{Scale, quantity, shown_unit};
use crate::report::grid::PackedGrid;
use crate::results::{
    ContactResult, Datum, Description, Figure, Packed, SeriesResult, SeriesRow, pack,
};

/// Data of the page of one contact.
#[derive(Clone, Debug, Serialize)]
pub struct ContactPage {
    /// Title: peak pressure, friction and load.
    pub title: String,
    /// Name of the folder or the case.
    pub name: String,
    /// The contact; its case is without keys that have no effect.
    pub result: ContactResult,
    /// The formatted figures.
    pub figures: Vec<Figure>,
    /// The map of each part of the contact.
    pub maps: Vec<PackedGrid>,
    /// The hull after approach and tilt.
    pub hull: Option<PackedHull>,
}

/// Vertices and triangles of a hull.
#[derive(Clone, Debug, Serialize)]
pub struct PackedHull {
    /// Coordinates of the vertices along the runner [m].
    pub x: Packed,
    /// Coordinates of the vertices across the runner [m].
    pub y: Packed,
    /// Heights of the vertices [m].
    pub z: Packed,
    /// Indices of the vertices of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl ContactPage {
    /// The data of a contact; all maps together have about `points` points along and across.
    ///
    /// # Errors
    /// Those of a number that cannot be written as JSON.
    pub fn new(
        mut result: ContactResult,
        maps: &[PressureMap],
        hull: Option<&Hull>,
        points: [usize; 2],
        name: String,
    ) -> serde_json::Result<Self> {
        let figures = result.figures()?;
        result.case = std::mem::take(&mut result.case).effective();
        let (peak, load) = (result.p_max, quantity(result.fz_n, "N"));
        let mu = result.sliding.as_ref().map(|sliding| sliding.friction.mu);
        let mu = mu.map_or(String::new(), |mu| format!(", µ {mu}"));
        let share = (maps.len() as f64).sqrt();
        let points = points.map(|count| (count as f64 / share) as usize);
        let packed = maps.iter().map(|map| PackedGrid::thinned(map, points));
        Ok(ContactPage {
            title: format!("{peak}{mu} under {load}"),
            name,
            figures,
            result,
            maps: packed.collect(),
            hull: hull.map(PackedHull::from),
        })
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

/// A quantity that a page draws.
#[derive(Clone, Debug, Serialize)]
pub struct DrawnQuantity {
    /// Keys and label.
    #[serde(flatten)]
    pub of: Description,
    /// Display unit, in which the largest value is at least 1.
    pub unit: String,
    /// Number of display units in one SI unit.
    pub times: f64,
}

/// Data of the page of a series.
#[derive(Clone, Debug, Serialize)]
pub struct SeriesPage {
    /// The folder.
    pub name: String,
    /// The varied keys.
    pub keys: Vec<&'static str>,
    /// The quantities that the page can draw.
    pub quantities: Vec<DrawnQuantity>,
    /// The contacts.
    pub rows: Vec<SeriesRow>,
}

impl SeriesPage {
    /// The data of a series; all rows vary the keys of the first.
    pub fn new(name: String, rows: Vec<SeriesRow>) -> Self {
        let varied = rows.first().map(|row| row.varied.named());
        let data = rows.iter().filter_map(|row| Datum::of(row).ok());
        let data: Vec<Datum> = data.collect();
        let quantities = SeriesResult::DRAWN.map(|of| {
            let values = data
                .iter()
                .filter_map(|row| row.group()?.get(of.key)?.number());
            let Scale { unit, times } = Scale::of_all(&shown_unit(of.key), values);
            DrawnQuantity { of, unit, times }
        });
        SeriesPage {
            name,
            keys: varied.into_iter().flatten().map(|(key, _)| key).collect(),
            quantities: quantities.into(),
            rows,
        }
    }
}
