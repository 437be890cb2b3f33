//! The ranges of a case's values.

use super::mount::check_mount;
use super::{
    Case, CaseError, Hardness, IceTable, LoadTable, RunnerTable, SectionTable, Shape, Thickness,
    TiltWord,
};
use crate::ICE_TEMPERATURES;

pub(super) type Checked = Result<(), CaseError>;

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
                !radius.is_nan() && radius != 0.0,
                "track.radius_m",
                radius,
                "a radius in metres, positive in a valley, negative on a crest, or inf",
            )?;
        }
        if let Some(curvature) = self.track.curvature_1pm {
            finite("track.curvature_1pm", curvature)?;
            if self.track.radius_m.is_some() {
                return Err(combination(
                    "track.curvature_1pm",
                    "either radius_m or curvature_1pm, not both",
                ));
            }
        }
        check_load(&self.load)?;
        let asked = self.accuracy.p_max;
        require(
            (1e-4..=0.5).contains(&asked),
            "accuracy.p_max",
            asked,
            "a relative error from 0.0001 to 0.5",
        )
    }
}

fn check_runner(runner: &RunnerTable) -> Checked {
    match (&runner.hull, &runner.shape) {
        (None, None) if runner.mesh.is_some() => runner.check_mesh(),
        _ if runner.mesh.is_some() => Err(combination(
            "runner.mesh",
            "either hull, shape or mesh, not two of them",
        )),
        (None, None) => Err(combination("runner", "expected a hull, a shape or a mesh")),
        (Some(_), Some(_)) => Err(combination(
            "runner.shape",
            "either hull or shape, not both",
        )),
        (Some(_), None) => {
            if let Some(scale) = runner.scale {
                positive("runner.scale", scale)?;
            }
            if let Some(noise) = runner.noise_m {
                require(
                    noise.is_finite() && noise >= 0.0,
                    "runner.noise_m",
                    noise,
                    "a standard deviation in metres, 0 or more",
                )?;
            }
            Ok(())
        }
        (None, Some(shape)) => {
            let belongs_to_a_hull = [
                ("runner.scale", runner.scale.is_some()),
                ("runner.up", runner.up.is_some()),
                ("runner.forward", runner.forward.is_some()),
                ("runner.noise_m", runner.noise_m.is_some()),
            ];
            if let Some((key, _)) = belongs_to_a_hull.iter().find(|(_, given)| *given) {
                return Err(combination(key, "belongs to a hull, not to a shape"));
            }
            check_shape(shape)
        }
    }?;
    if let Some(section) = &runner.section {
        check_section(section, runner.shape.as_ref())?;
    }
    modulus("runner.youngs_modulus_pa", runner.youngs_modulus_pa)?;
    poisson("runner.poissons_ratio", runner.poissons_ratio)
}

fn check_section(section: &SectionTable, shape: Option<&Shape>) -> Checked {
    if !matches!(shape, Some(Shape::Bob { .. } | Shape::Luge { .. })) {
        return Err(combination(
            "runner.section",
            "belongs to a shape of kind \"bob\" or \"luge\"",
        ));
    }
    if section.profile.is_some() && section.points_m.is_some() {
        return Err(combination(
            "runner.section.points_m",
            "either profile or points_m, not both",
        ));
    }
    if let Some(edge) = section.worn_edge {
        require(
            (0.0..=1.0).contains(&edge),
            "runner.section.worn_edge",
            edge,
            "a part of the section's radius, 0 to 1",
        )?;
    }
    match section.worn_m {
        Some(depth) => require(
            depth.is_finite() && depth >= 0.0,
            "runner.section.worn_m",
            depth,
            "a depth in metres, 0 or more",
        ),
        None => Ok(()),
    }
}

fn check_shape(shape: &Shape) -> Checked {
    match *shape {
        Shape::Bob {
            length_m,
            rocker_radius_m,
            section_radius_m,
            width_m,
            height_m,
        } => {
            positive("runner.shape.length_m", length_m)?;
            radius("runner.shape.rocker_radius_m", rocker_radius_m)?;
            positive("runner.shape.section_radius_m", section_radius_m)?;
            positive("runner.shape.width_m", width_m)?;
            positive("runner.shape.height_m", height_m)?;
            require(
                width_m <= 2.0 * section_radius_m,
                "runner.shape.width_m",
                width_m,
                "at most twice section_radius_m",
            )?;
            require(
                length_m <= 2.0 * rocker_radius_m,
                "runner.shape.length_m",
                length_m,
                "at most twice rocker_radius_m",
            )
        }
        Shape::Paraboloid {
            rocker_radius_m,
            section_radius_m,
        } => {
            radius("runner.shape.rocker_radius_m", rocker_radius_m)?;
            radius("runner.shape.section_radius_m", section_radius_m)
        }
        Shape::Luge {
            length_m,
            rocker_radius_m,
            edge_radius_m,
            tilt_rad,
            width_m,
            height_m,
        } => {
            positive("runner.shape.length_m", length_m)?;
            radius("runner.shape.rocker_radius_m", rocker_radius_m)?;
            positive("runner.shape.edge_radius_m", edge_radius_m)?;
            positive("runner.shape.width_m", width_m)?;
            positive("runner.shape.height_m", height_m)?;
            require(
                tilt_rad.is_finite() && tilt_rad.abs() < 1.0,
                "runner.shape.tilt_rad",
                tilt_rad,
                "an angle in radians between -1 and 1",
            )?;
            require(
                length_m <= 2.0 * rocker_radius_m,
                "runner.shape.length_m",
                length_m,
                "at most twice rocker_radius_m",
            )
        }
    }
}

fn check_ice(ice: &IceTable) -> Checked {
    match (ice.temperature_c, ice.youngs_modulus_pa) {
        (Some(temperature), _) => require(
            ICE_TEMPERATURES.contains(&temperature),
            "ice.temperature_c",
            temperature,
            "a temperature from -50 to 0 degrees Celsius",
        )?,
        (None, None) => {
            return Err(combination(
                "ice",
                "expected youngs_modulus_pa, or temperature_c to take it from",
            ));
        }
        (None, Some(_)) => {}
    }
    if let Some(stated) = ice.youngs_modulus_pa {
        modulus("ice.youngs_modulus_pa", stated)?;
    }
    match ice.poissons_ratio {
        Some(stated) => poisson("ice.poissons_ratio", stated)?,
        None if ice.temperature_c.is_none() => {
            return Err(combination(
                "ice",
                "expected poissons_ratio, or temperature_c to take it from",
            ));
        }
        None => {}
    }
    if let Thickness::Layer(thickness) = ice.thickness_m {
        require(
            thickness.is_finite() && thickness > 0.0,
            "ice.thickness_m",
            thickness,
            "a positive thickness in metres or \"half-space\"",
        )?;
    }
    if let Some(bed) = &ice.bed {
        if ice.thickness_m == Thickness::HalfSpace {
            return Err(combination("ice.bed", "a half-space of ice has no bed"));
        }
        modulus("ice.bed.youngs_modulus_pa", bed.youngs_modulus_pa)?;
        poisson("ice.bed.poissons_ratio", bed.poissons_ratio)?;
        positive("ice.bed.thickness_m", bed.thickness_m)?;
    }
    match ice.hardness_pa {
        Some(Hardness::Stated(hardness)) => positive("ice.hardness_pa", hardness)?,
        Some(Hardness::FromTemperature) if ice.temperature_c.is_none() => {
            return Err(combination(
                "ice.hardness_pa",
                "\"from-temperature\" needs temperature_c",
            ));
        }
        _ => {}
    }
    if let Some(waves) = &ice.waviness {
        if ice.surface.is_some() {
            return Err(combination(
                "ice.surface",
                "either waviness or surface, not both",
            ));
        }
        finite("ice.waviness.amplitude_m", waves.amplitude_m)?;
        positive("ice.waviness.wavelength_m", waves.wavelength_m)?;
        finite("ice.waviness.direction_rad", waves.direction_rad)?;
        finite("ice.waviness.phase_rad", waves.phase_rad)?;
    }
    Ok(())
}

fn check_load(load: &LoadTable) -> Checked {
    require(
        load.fz_n.is_finite() && load.fz_n > 0.0,
        "load.fz_n",
        load.fz_n,
        "a positive force in newtons",
    )?;
    finite("load.offset_x_m", load.offset_x_m)?;
    finite("load.offset_y_m", load.offset_y_m)?;
    for (key, angle) in [
        ("load.pitch_rad", load.pitch_rad),
        ("load.roll_rad", load.roll_rad),
    ] {
        let Some(angle) = angle else { continue };
        if load.tilt == TiltWord::Free {
            return Err(combination(key, "given only with tilt = \"fixed\""));
        }
        require(
            angle.is_finite() && angle.abs() < 1.0,
            key,
            angle,
            "an angle in radians between -1 and 1",
        )?;
    }
    Ok(())
}

fn modulus(key: &'static str, value: f64) -> Checked {
    require(
        value.is_finite() && value > 0.0,
        key,
        value,
        "a positive modulus in pascals",
    )
}

fn poisson(key: &'static str, value: f64) -> Checked {
    require(
        (0.0..0.5).contains(&value),
        key,
        value,
        "at least 0 and below 0.5",
    )
}

pub(super) fn positive(key: &'static str, value: f64) -> Checked {
    require(
        value.is_finite() && value > 0.0,
        key,
        value,
        "a positive number",
    )
}

fn radius(key: &'static str, value: f64) -> Checked {
    require(
        value > 0.0,
        key,
        value,
        "a positive radius in metres or inf",
    )
}

pub(super) fn finite(key: &'static str, value: f64) -> Checked {
    require(value.is_finite(), key, value, "a finite number")
}

pub(super) fn require(
    holds: bool,
    key: &'static str,
    value: f64,
    expected: &'static str,
) -> Checked {
    if holds {
        return Ok(());
    }
    Err(CaseError::OutOfRange {
        line: 0,
        key,
        value: value.to_string(),
        expected,
    })
}

pub(super) fn combination(key: &'static str, expected: &'static str) -> CaseError {
    CaseError::Combination {
        line: 0,
        key,
        expected,
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Case, CaseError};

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
                "line 4: ice.youngs_modulus_pa = NaN: expected a positive modulus in pascals",
            ),
            (
                "9.0e9",
                "-9.0e9",
                "line 4: ice.youngs_modulus_pa = -9000000000: expected a positive modulus in pascals",
            ),
            (
                "0.33",
                "0.5",
                "line 5: ice.poissons_ratio = 0.5: expected at least 0 and below 0.5",
            ),
            (
                "thickness_m = 0.05",
                "thickness_m = 0",
                "line 6: ice.thickness_m = 0: expected a positive thickness in metres or \"half-space\"",
            ),
            (
                "thickness_m = 0.05",
                "thickness_m = \"half\"",
                "line 6: `thickness_m = \"half\"`: invalid value: string \"half\", expected a thickness in metres or \"half-space\"",
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
                "line 10: load.fz_n = 0: expected a positive force in newtons",
            ),
            (
                "fz_n = 1000.0",
                "fz_n = -5.0",
                "line 10: load.fz_n = -5: expected",
            ),
            (
                "fz_n = 1000.0",
                "fz_n = \"1 kN\"",
                "line 10: `fz_n = \"1 kN\"`: invalid type: string \"1 kN\", expected f64",
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
                "line 2: runner.shape.length_m = -1: expected a positive number",
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
