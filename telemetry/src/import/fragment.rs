//! Places of sensors as lines of a model.

use crate::error::Error;
use crate::mapping::Mapping;

/// The lines of `[sled]` in `model.toml` that the places of a mapping's sensors are; none where it states none.
///
/// The three axes of the accelerometer are one sensor; of the slip sensor the model knows the place along the sled.
///
/// # Errors
/// [`Error::Key`] where the axes of the accelerometer are stated in different places.
pub fn model_fragment(mapping: &Mapping, file: &str) -> Result<Option<String>, Error> {
    let place = |column: &str| {
        mapping
            .channels
            .get(column)
            .and_then(|channel| channel.place_m)
    };
    let mut accelerometer: Option<(&str, [f64; 3])> = None;
    for column in ["ax_mps2", "ay_mps2", "az_mps2"] {
        let Some(own) = place(column) else { continue };
        match accelerometer {
            Some((first, other)) if other != own => {
                return Err(Error::Key {
                    file: file.to_string(),
                    key: format!("channels.{column}.place_m"),
                    found: format!("{own:?}"),
                    expected: format!("{other:?}, as for {first}: the model has one accelerometer"),
                });
            }
            _ => accelerometer = Some((column, own)),
        }
    }
    let slip = place("alpha_rad");
    if accelerometer.is_none() && slip.is_none() {
        return Ok(None);
    }
    let mut text = "# Places of the sensors by the mapping, from the centre of gravity [m]; lines of model.toml.\n[sled]\n".to_string();
    if let Some((_, [x, y, z])) = accelerometer {
        text += &format!("accel_x_m = {x:?}\naccel_y_m = {y:?}\naccel_z_m = {z:?}\n");
    }
    if let Some([x, ..]) = slip {
        text += &format!("slip_x_m = {x:?}\n");
    }
    Ok(Some(text))
}
