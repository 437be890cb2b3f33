//! Where runs lie on the tables of their model, as pictures beside the results.

use std::path::PathBuf;

use kufe::charts::{Slice, table_picture};
use kufe::jobs::{Failure, table::read_table};
use kufe_lut::Sample;
use kufe_sled::Vehicle;

use crate::output::folder::OutputDir;

/// The pictures, front and rear; a model without tables has none.
pub const TABLE_PICTURES: [&str; 2] = ["table_front.png", "table_rear.png"];

/// Draws what each runner asked its table upon that table. Names what was drawn.
///
/// # Errors
/// [`Failure::BadInput`] for a table that cannot be read any more, or a picture that cannot be written.
pub fn draw_tables(
    output: &OutputDir,
    vehicle: &Vehicle,
    samples: &[Vec<Sample>; 2],
) -> Result<Vec<String>, Failure> {
    let mut drawn = Vec::new();
    for ((name, table), requested) in TABLE_PICTURES.iter().zip(vehicle.tables()).zip(samples) {
        let Some(file) = table.map(|table| PathBuf::from(&table.file)) else {
            continue;
        };
        let table = read_table(&file)?;
        let picture = table_picture(&table, table.judged(), Slice::default(), requested)
            .map_err(|error| Failure::BadInput(format!("{}: {error}", file.display())))?;
        output.picture(name, &picture.figure)?;
        drawn.push((*name).to_owned());
    }
    Ok(drawn)
}
