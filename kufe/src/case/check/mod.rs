//! The ranges of a case's values.

mod ice;
mod mount;
pub(crate) mod range;
mod runner;
mod sliding;

use crate::case::document::Case;
use crate::case::table::{LoadTable, TiltWord};
use ice::check_ice;
use mount::check_mount;
use range::{Checked, LARGEST_RADIUS, combination, in_range, require};
use runner::check_runner;
use sliding::check_sliding;

impl Case {
    /// Checks every value against its range.
    ///
    /// # Errors
    /// [`CaseError`] naming the first key that is wrong.
    pub fn check(&self) -> Checked {
        check_runner(&self.runner)?;
        check_mount(&self.runner, &self.load)?;
        check_ice(&self.ice)?;
        if let Some(radius) = self.track.radius_m {
            require(
                (1.0..=LARGEST_RADIUS).contains(&radius.abs()) || radius.is_infinite(),
                "track.radius_m",
                radius,
                "a radius in metres from 1 to 1e6 in size, positive in a valley, negative on a crest, or inf",
            )?;
        }
        if let Some(curvature) = self.track.curvature_1pm {
            in_range("track.curvature_1pm", curvature)?;
            if self.track.radius_m.is_some() {
                return Err(combination(
                    "track.curvature_1pm",
                    "either radius_m or curvature_1pm, not both",
                ));
            }
        }
        check_load(&self.load)?;
        check_sliding(self)?;
        in_range("accuracy.p_max", self.accuracy.p_max)
    }
}

fn check_load(load: &LoadTable) -> Checked {
    in_range("load.fz_n", load.fz_n)?;
    in_range("load.offset_x_m", load.offset_x_m)?;
    in_range("load.offset_y_m", load.offset_y_m)?;
    for (key, angle) in [
        ("load.pitch_rad", load.pitch_rad),
        ("load.roll_rad", load.roll_rad),
    ] {
        let Some(angle) = angle else { continue };
        if load.tilt == TiltWord::Free {
            return Err(combination(key, "given only with tilt = \"fixed\""));
        }
        in_range(key, angle)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::case::{Case, CaseError};

    const GOOD: &str = r#"[runner]
shape = { kind = "bob", length_m = 1.0, rocker_radius_m = 30.0, section_radius_m = 0.005, width_m = 0.010, height_m = 0.030 }
[ice]
youngs_modulus_pa = 9.0e9
poissons_ratio = 0.33
thickness_m = 0.05
[track]
radius_m = inf
[load]
fz_n = 1000.0
[accuracy]
p_max = 0.01
"#;

    #[test]
    fn a_case_survives_writing_and_reading() -> Result<(), CaseError> {
        let case = Case::parse(GOOD)?;
        assert_eq!(Case::parse(&case.to_toml()?)?, case);
        assert_eq!(case.runner.youngs_modulus_pa, 210e9);
        assert_eq!(case.track.curvature(), 0.0);
        Ok(())
    }

    #[test]
    fn every_bad_value_is_named_with_its_line_and_range() {
        let rows = [
            (
                "9.0e9",
                "nan",
                "line 4: ice.youngs_modulus_pa = NaN: expected a modulus in pascals from 1e6 to 1e13",
            ),
            (
                "9.0e9",
                "-9.0e9",
                "line 4: ice.youngs_modulus_pa = -9e9: expected a modulus in pascals from 1e6",
            ),
            (
                "0.33",
                "0.5",
                "line 5: ice.poissons_ratio = 0.5: expected a Poisson's ratio from 0 to 0.499",
            ),
            (
                "thickness_m = 0.05",
                "thickness_m = 0",
                "line 6: ice.thickness_m = 0: expected a thickness in metres from 0.001 to 100",
            ),
            (
                "thickness_m = 0.05",
                "thickness_m = \"half\"",
                "line 6: `thickness_m = \"half\"`: found \"half\", expected a thickness in metres or \"half-space\"",
            ),
            (
                "rocker_radius_m = 30.0",
                "rocker_radius_m = 1e308",
                "line 2: runner.shape.rocker_radius_m = 1e308: expected a radius in metres from 0.05 to 1e6, or inf",
            ),
            (
                "radius_m = inf",
                "radius_m = -1e308",
                "line 8: track.radius_m = -1e308: expected a radius",
            ),
            (
                "radius_m = inf",
                "radius_m = nan",
                "line 8: track.radius_m = NaN: expected a radius",
            ),
            (
                "radius_m = inf",
                "radius_m = 50.0\ncurvature_1pm = 0.02",
                "line 9: track.curvature_1pm: either",
            ),
            (
                "fz_n = 1000.0",
                "fz_n = 0.0",
                "line 10: load.fz_n = 0: expected a force in newtons from 0.001 to 1e7",
            ),
            (
                "fz_n = 1000.0",
                "fz_n = -5.0",
                "line 10: load.fz_n = -5: expected",
            ),
            (
                "fz_n = 1000.0",
                "fz_n = \"1 kN\"",
                "line 10: load.fz_n = \"1 kN\": expected a force in newtons from 0.001 to 1e7",
            ),
            (
                "fz_n = 1000.0",
                "fz = 1000.0",
                "line 10: `fz = 1000.0`: unknown field `fz`, expected one of `fz_n`",
            ),
            (
                "fz_n = 1000.0",
                "fz_n = 1.0\npitch_rad = 0.1",
                "line 11: load.pitch_rad: given only with",
            ),
            (
                "length_m = 1.0",
                "length_m = -1.0",
                "line 2: runner.shape.length_m = -1: expected a length in metres from 0.01 to 10",
            ),
            (
                "kind = \"bob\"",
                "kind = \"boat\"",
                "line 2: `shape = { kind = \"boat\"",
            ),
            (
                "width_m = 0.010",
                "breadth_m = 0.010",
                "unknown field `breadth_m`",
            ),
            (
                "p_max = 0.01",
                "p_max = 0.0",
                "line 12: accuracy.p_max = 0: expected a relative error",
            ),
            ("[accuracy]", "[accurate]", "unknown field `accurate`"),
            ("[load]", "[load", "line 9: `[load`:"),
        ];
        for (from, to, expected) in rows {
            let text = GOOD.replacen(from, to, 1);
            assert_ne!(text, GOOD, "{from} is not in the case");
            let error = Case::parse(&text).expect_err(to).to_string();
            assert!(error.contains(expected), "{to}: {error}");
            assert_eq!(error.lines().count(), 1, "{to}: {error}");
        }
    }

    #[test]
    fn a_runner_is_a_hull_or_a_shape_and_not_both() {
        let error = |text: &str| Case::parse(text).expect_err(text).to_string();
        let both = GOOD.replacen("[runner]", "[runner]\nhull = \"a.obj\"", 1);
        assert!(error(&both).contains("runner.shape: either hull or shape"));
        let neither = GOOD.replacen("shape = {", "# shape = {", 1);
        assert!(error(&neither).contains("line 1: runner: expected a hull, a shape or a mesh"));
        let scaled = GOOD.replacen("[runner]", "[runner]\nscale = 0.001", 1);
        assert!(error(&scaled).contains("runner.scale: belongs to a hull"));
    }
}
