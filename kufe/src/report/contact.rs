//! Data of the pages of a contact and of a series.

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
    /// The peak pressure under which load.
    pub title: String,
    /// The folder or the case.
    pub name: String,
    /// The contact; its case without what has no effect.
    pub result: ContactResult,
    /// The figures as people read them.
    pub figures: Vec<Figure>,
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
    ///
    /// # Errors
    /// Those of a number that JSON cannot state.
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
        let most = points.map(|count| (count as f64 / share) as usize);
        let packed = maps.iter().map(|map| PackedGrid::thinned(map, most));
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
    /// Its keys and its label.
    #[serde(flatten)]
    pub of: Description,
    /// The unit in which its largest value is at least 1.
    pub unit: String,
    /// How many of that make one SI unit.
    pub times: f64,
}

/// Data of the page of a series.
#[derive(Clone, Debug, Serialize)]
pub struct SeriesPage {
    /// The folder.
    pub name: String,
    /// The varied keys.
    pub keys: Vec<&'static str>,
    /// The numbers that the page offers to draw.
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
