//! The page of a solved contact.

use std::path::Path;

use kufe::jobs::Failure;
use kufe::jobs::field::read_exr::read_map;
use kufe::report::{Grid, Kind, pack, page as html};
use kufe_contact::{PressureMap, parted};
use kufe_mesh::{Hull, HullOptions, load_hull};
use serde_json::{Value, json};

use crate::output::documents::without_idle_steel;
use crate::report::folder_name::folder_name;
use crate::report::read_json::read_json;

/// `result.json` is a page of figures; what is longer than this is something else [bytes].
const LONGEST: u64 = 1 << 22;
/// Points along and across of all maps together.
const POINTS: [usize; 2] = [420, 260];
/// More triangles than `hull.glb` holds are something else.
const MOST_TRIANGLES: usize = 20_000;

/// The figures that the page shows, all of them numbers.
const FIGURES: [&str; 12] = [
    "p_max_pa",
    "p_mean_pa",
    "area_m2",
    "length_m",
    "width_m",
    "approach_m",
    "pitch_rad",
    "roll_rad",
    "fz_n",
    "seconds",
    "dofs",
    "iterations",
];

/// The page of a folder that `kufe press` has written.
pub fn page(folder: &Path) -> Result<String, Failure> {
    let path = folder.join("result.json");
    let result = read_json(&path, LONGEST)?;
    let told = |reason: String| Failure::BadInput(format!("{}: {reason}", path.display()));
    if let Some(key) = FIGURES.iter().find(|key| !result[*key].is_number()) {
        return Err(told(format!("{key} = {}: expected a number", result[*key])));
    }
    if !result["history"].is_array() {
        return Err(told(format!(
            "history = {}: expected a list",
            result["history"]
        )));
    }
    let maps = parted(read_map(&folder.join("pressure.exr"))?);
    let glb = folder.join("hull.glb");
    let hull = if glb.is_file() {
        let (hull, _) = load_hull(&glb, &HullOptions::default())
            .map_err(|error| Failure::BadInput(error.to_string()))?;
        Some(hull).filter(|hull| hull.triangles.len() <= MOST_TRIANGLES)
    } else {
        None
    };
    let data = contact(&result, &maps, hull.as_ref(), POINTS, &folder_name(folder));
    let title = data["title"].as_str().unwrap_or_default();
    Ok(html(Kind::Press, title, &data))
}

/// A contact's data as the page's scripts read them, on about `points` points of all maps together.
pub fn contact(
    result: &Value,
    maps: &[PressureMap],
    hull: Option<&Hull>,
    points: [usize; 2],
    name: &str,
) -> Value {
    let share = (maps.len() as f64).sqrt();
    let most = points.map(|count| (count as f64 / share) as usize);
    let number = |key: &str| result[key].as_f64().unwrap_or(f64::NAN);
    let title = format!(
        "{:.1} MPa under {:.0} N",
        1e-6 * number("p_max_pa"),
        number("fz_n")
    );
    let mut figures = result.clone();
    let (mut history, mut case, mut warnings) = (json!([]), json!({}), json!([]));
    if let Some(figures) = figures.as_object_mut() {
        for (key, place) in [
            ("history", &mut history),
            ("case", &mut case),
            ("warnings", &mut warnings),
        ] {
            if let Some(value) = figures.shift_remove(key) {
                *place = value;
            }
        }
    }
    without_idle_steel(&mut case);
    json!({
        "title": title,
        "name": name,
        "result": figures,
        "history": history,
        "case": case,
        "warnings": warnings,
        "maps": maps.iter().map(|map| grid(map).thinned(most)).collect::<Vec<_>>(),
        "hull": hull.map(packed),
    })
}

fn grid(map: &PressureMap) -> Grid<'_> {
    Grid {
        nx: map.nx,
        ny: map.ny,
        x0: map.x0,
        y0: map.y0,
        dx: map.dx,
        dy: map.dy,
        pressure: &map.pressure,
        gap: &map.gap,
        uz: &map.uz,
    }
}

fn packed(hull: &Hull) -> Value {
    let axis = |a: usize| pack(hull.positions.iter().map(|position| position[a]));
    json!({ "x": axis(0), "y": axis(1), "z": axis(2), "triangles": hull.triangles })
}
