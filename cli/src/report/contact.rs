//! The page of a solved contact.

use std::path::Path;

use kufe::jobs::Failure;
use kufe::jobs::field::read_exr::read_map;
use kufe::report::{ContactPage, Kind, page as html};
use kufe::results::ContactResult;
use kufe_contact::parted;
use kufe_mesh::{HullOptions, load_hull};

use crate::report::folder_name::folder_name;
use crate::report::read_json::read_json;

/// Largest `result.json` [bytes].
const LONGEST: u64 = 1 << 22;
/// Points along and across of all maps together.
const POINTS: [usize; 2] = [420, 260];
/// More triangles than `hull.glb` holds.
const MOST_TRIANGLES: usize = 20_000;

/// The page of a folder that `kufe press` has written.
pub fn page(folder: &Path) -> Result<String, Failure> {
    let result: ContactResult = read_json(&folder.join("result.json"), LONGEST)?;
    let maps = parted(read_map(&folder.join("pressure.exr"))?);
    let glb = folder.join("hull.glb");
    let hull = if glb.is_file() {
        let (hull, _) = load_hull(&glb, &HullOptions::default()).map_err(Failure::bad_input)?;
        Some(hull).filter(|hull| hull.triangles.len() <= MOST_TRIANGLES)
    } else {
        None
    };
    let data = ContactPage::new(result, &maps, hull.as_ref(), POINTS, folder_name(folder));
    Ok(html(Kind::Press, &data.title, &data))
}
