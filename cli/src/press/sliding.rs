//! What sliding is written to: the groove and the film.

use std::io::{self, Write};

use kufe::jobs::field::{groove_map, groove_picture, write_exr};
use kufe::jobs::slide::SolvedSliding;
use kufe::jobs::{Failure, SolvedContact};
use kufe_contact::PressureMap;

use crate::output::staging::Staging;

const COMMENTS: &str = "depth: plastic depth of the ice [m]. Column i, row j of the pixels is centred at x = origin_x_m + i pixel_x_m \
    (along the runner, which slides towards +x), y = origin_y_m + j pixel_y_m (across): column 0 is the groove that is left.";

/// Writes groove.exr, groove.png and film.csv.
///
/// # Errors
/// [`Failure::BadInput`] with the file that cannot be written.
pub fn write(
    staging: &Staging,
    pressed: &SolvedContact,
    map: &PressureMap,
    slid: &SolvedSliding,
) -> Result<(), Failure> {
    let depths = groove_map::depths(map, &pressed.solution.surface, &slid.groove.depth);
    let numbers = [
        ("fz_n", pressed.solution.fz),
        ("hardness_pa", slid.hardness.value),
    ];
    staging.write("groove.exr", |mut file| {
        write_exr::write_channels(&mut file, map, COMMENTS, &numbers, &[("depth", &depths)])
    })?;
    staging.write("film.csv", |file| write_film(file, slid))?;
    groove_picture::write(&staging.path("groove.png"), pressed, slid)
        .map_err(|error| staging.failure("groove.png", &error))
}

/// The film station by station, from the front.
fn write_film(mut file: impl Write, slid: &SolvedSliding) -> io::Result<()> {
    writeln!(
        file,
        "x_m,width_m,pressure_pa,film_m,temperature_c,melt_mps,shear_pa"
    )?;
    for station in &slid.film.film.stations {
        writeln!(
            file,
            "{:.9e},{:.6e},{:.6e},{:.6e},{:.6},{:.6e},{:.6e}",
            slid.film.front - station.xi,
            station.width,
            station.pressure,
            station.thickness,
            station.temperature,
            station.melt_rate,
            station.shear
        )?;
    }
    Ok(())
}
