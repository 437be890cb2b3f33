//! A mapping from its text.

use crate::error::Error;
use crate::mapping::check::check;
use crate::mapping::file::Mapping;

impl Mapping {
    /// Reads a mapping and checks what can be checked without its files.
    ///
    /// # Errors
    /// [`Error::File`] with the line where it is no TOML or a key is unknown; [`Error::Key`].
    pub fn parse(text: &str, file: &str) -> Result<Mapping, Error> {
        let mapping: Mapping = toml::from_str(text)
            .map_err(|error| Error::file(file, error.to_string().trim_end().replace('\n', " ")))?;
        check(&mapping, file)?;
        Ok(mapping)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_example_is_a_mapping_with_its_comments_and_without() {
        let text = crate::MAPPING_EXAMPLE;
        let mapping = Mapping::parse(text, "mapping.toml").unwrap();
        assert_eq!(mapping.lead(), "imu");
        assert_eq!(mapping.channels.len(), kufe_sled::COLUMNS.len());
        // Every key that stands in a comment is one.
        let keys = text
            .replace("# rate_hz = 500", "#- rate_hz = 500")
            .replace("# a column", "#- a column");
        let all: Vec<String> = keys
            .lines()
            .map(|line| match line.strip_prefix("# ") {
                Some(rest) if rest.contains(" = ") || rest.starts_with("[[") => rest.to_string(),
                _ => line.to_string(),
            })
            .filter(|line| {
                !line.contains("kufe runs init")
                    && !line.contains("Its clock is")
                    && !line.contains("A column is")
            })
            .collect();
        let all = Mapping::parse(&all.join("\n"), "mapping.toml").unwrap();
        assert_eq!(all.run.len(), 1);
        assert_eq!(all.logger["gps"].also.len(), 1);
    }

    #[test]
    fn unknown_keys_and_values_out_of_range_are_named() {
        for (key, value, said) in [
            (
                "rate_hz = 100.0",
                "rate_hz = 0.5",
                "rate_hz: found 0.5, expected a number from 1 to 10000",
            ),
            ("rate_hz = 100.0", "rate_hz = nan", "rate_hz: found NaN"),
            (
                "clock = \"imu\"",
                "clock = \"mu\"",
                "clock: found mu, expected one of: gps, imu",
            ),
            (
                "time_unit = \"ms\"",
                "time_unit = \"kg\"",
                "logger.gps.time_unit: found kg, expected",
            ),
            (
                "ice_c = -8.0",
                "ice_c = 20.0",
                "index.ice_c: found 20, expected a number from -60 to 5",
            ),
            (
                "sign = -1",
                "sign = -10",
                "channels.ay_mps2.sign: found -10, expected 1 or -1",
            ),
            (
                "v_mps = { logger = \"gps\"",
                "v_mps = { logger = \"gsp\"",
                "channels.v_mps.logger: found gsp, expected one of",
            ),
            ("[index] ", "[indecks] ", "indecks"),
            (
                "# [[run]]",
                "[[run]]\nname = \"a\"\n[[run]]\nname = \"a\"\n#",
                "run.name: found a twice, expected each run once",
            ),
            (
                "scale = 12.0",
                "scale = 0.0",
                "channels.delta_rad.scale: found 0",
            ),
            (
                "unit = \"km/h\"",
                "unit = \"kg\"",
                "channels.v_mps.unit: found kg, expected a unit that converts to m/s",
            ),
        ] {
            let text = crate::MAPPING_EXAMPLE.replacen(key, value, 1);
            assert_ne!(text, crate::MAPPING_EXAMPLE, "{key}");
            let error = Mapping::parse(&text, "mapping.toml")
                .unwrap_err()
                .to_string();
            assert!(error.contains(said) && !error.contains('\n'), "{error}");
        }
    }
}
