//! What the values of a case must fulfil: each its range, and together what is stated here.

pub(crate) mod range;

use crate::case::document::Case;
use crate::case::table::{
    Hardness, IceTable, LoadTable, RunnerTable, Shape, SlidingTable, Thickness, TiltWord,
    TrackTable,
};
use range::{Checked, LARGEST_RADIUS, check_ranges, refuse_if, require};

impl Case {
    /// Checks every value against its range, and that the values fit together.
    ///
    /// # Errors
    /// [`CaseError`](crate::case::CaseError) naming the first key that is wrong.
    pub fn check(&self) -> Checked {
        check_ranges(self)?;
        check_runner(&self.runner)?;
        check_mount(&self.runner, &self.load)?;
        check_ice(&self.ice)?;
        check_track(&self.track)?;
        check_load(&self.load)?;
        match &self.sliding {
            Some(sliding) => check_sliding(sliding, self),
            None => Ok(()),
        }
    }
}

fn check_runner(runner: &RunnerTable) -> Checked {
    let (hull, shape, mesh) = (
        runner.hull.is_some(),
        runner.shape.is_some(),
        runner.mesh.is_some(),
    );
    let two = mesh && (hull || shape);
    refuse_if(
        two,
        "runner.mesh",
        "either hull, shape or mesh, not two of them",
    )?;
    refuse_if(
        !(hull || shape || mesh),
        "runner",
        "expected a hull, a shape or a mesh",
    )?;
    refuse_if(
        hull && shape,
        "runner.shape",
        "either hull or shape, not both",
    )?;
    refuse_if(
        mesh && !runner.elastic,
        "runner.mesh",
        "given only with elastic = true: expected hull for a rigid runner",
    )?;
    // A mesh may state its scale and its noise.
    let of_files = [
        ("runner.scale", runner.scale.is_some() && !mesh),
        ("runner.up", runner.up.is_some()),
        ("runner.forward", runner.forward.is_some()),
        ("runner.yaw_rad", runner.yaw_rad.is_some()),
        ("runner.pitch_rad", runner.pitch_rad.is_some()),
        ("runner.roll_rad", runner.roll_rad.is_some()),
        ("runner.noise_m", runner.noise_m.is_some() && !mesh),
        ("runner.height_m", runner.height_m.is_some()),
    ];
    for (key, given) in of_files {
        refuse_if(given && shape, key, "belongs to a hull, not to a shape")?;
        refuse_if(given && mesh, key, "belongs to a hull, not to a mesh")?;
    }
    refuse_if(
        runner.height_m.is_some() && !runner.elastic,
        "runner.height_m",
        "given only with elastic = true",
    )?;
    if let Some(shape) = &runner.shape {
        check_shape(shape)?;
    }
    let Some(section) = &runner.section else {
        return Ok(());
    };
    refuse_if(
        !matches!(runner.shape, Some(Shape::Bob { .. } | Shape::Luge { .. })),
        "runner.section",
        "belongs to a shape of kind \"bob\" or \"luge\"",
    )?;
    refuse_if(
        section.profile.is_some() && section.points_m.is_some(),
        "runner.section.points_m",
        "either profile or points_m, not both",
    )
}

fn check_shape(shape: &Shape) -> Checked {
    if let Shape::Bob {
        section_radius_m,
        width_m,
        ..
    } = *shape
    {
        require(
            section_radius_m.is_finite(),
            "runner.shape.section_radius_m",
            section_radius_m,
            "a finite radius in metres: a bobsled runner's section is round",
        )?;
        require(
            width_m <= 2.0 * section_radius_m,
            "runner.shape.width_m",
            width_m,
            "at most twice section_radius_m",
        )?;
    }
    match *shape {
        Shape::Bob {
            length_m,
            rocker_radius_m,
            ..
        }
        | Shape::Luge {
            length_m,
            rocker_radius_m,
            ..
        } => require(
            length_m <= 2.0 * rocker_radius_m,
            "runner.shape.length_m",
            length_m,
            "at most twice rocker_radius_m",
        ),
        Shape::Paraboloid { .. } => Ok(()),
    }
}

/// Checks a runner's mount, and that it agrees with the load.
fn check_mount(runner: &RunnerTable, load: &LoadTable) -> Checked {
    let Some(mount) = &runner.mount else {
        return Ok(());
    };
    refuse_if(
        !runner.elastic,
        "runner.mount",
        "given only with elastic = true",
    )?;
    refuse_if(
        mount.held.is_empty() == mount.carries.is_empty(),
        "runner.mount",
        "expected either held or carries, with one place at least",
    )?;
    if mount.carries.is_empty() {
        return Ok(());
    }
    refuse_if(
        runner.mesh.is_some(),
        "runner.mount.carries",
        "a mesh is fixed: expected held, or no mount for all of its top",
    )?;
    refuse_if(
        load.tilt != TiltWord::Free,
        "load.tilt",
        "expected \"free\": a runner that nothing holds tilts as its load says",
    )?;
    let sum: f64 = mount.carries.iter().map(|p| p.share).sum();
    require(
        (sum - 1.0).abs() < 1e-6,
        "runner.mount.carries.share",
        sum,
        "shares that sum to 1",
    )?;
    let line: f64 = mount.carries.iter().map(|p| p.share * p.x_m).sum();
    require(
        (line - load.offset_x_m).abs() < 1e-6,
        "load.offset_x_m",
        load.offset_x_m,
        "the shares' line of action, sum of share times x_m",
    )
}

fn check_ice(ice: &IceTable) -> Checked {
    let without = ice.temperature_c.is_none();
    refuse_if(
        without && ice.youngs_modulus_pa.is_none(),
        "ice",
        "expected youngs_modulus_pa, or temperature_c to take it from",
    )?;
    refuse_if(
        without && ice.poissons_ratio.is_none(),
        "ice",
        "expected poissons_ratio, or temperature_c to take it from",
    )?;
    refuse_if(
        ice.bed.is_some() && ice.thickness_m == Thickness::HalfSpace,
        "ice.bed",
        "a half-space of ice has no bed",
    )?;
    refuse_if(
        without && ice.hardness_pa == Some(Hardness::FromTemperature),
        "ice.hardness_pa",
        "\"from-temperature\" needs temperature_c",
    )?;
    refuse_if(
        ice.waviness.is_some() && ice.surface.is_some(),
        "ice.surface",
        "either waviness or surface, not both",
    )
}

fn check_track(track: &TrackTable) -> Checked {
    if let Some(radius) = track.radius_m {
        require(
            (1.0..=LARGEST_RADIUS).contains(&radius.abs()) || radius.is_infinite(),
            "track.radius_m",
            radius,
            "a radius in metres from 1 to 1e6 in size, positive in a valley, negative on a crest, \
             or inf",
        )?;
    }
    refuse_if(
        track.curvature_1pm.is_some() && track.radius_m.is_some(),
        "track.curvature_1pm",
        "either radius_m or curvature_1pm, not both",
    )
}

fn check_load(load: &LoadTable) -> Checked {
    let free = load.tilt == TiltWord::Free;
    let expected = "given only with tilt = \"fixed\"";
    refuse_if(free && load.pitch_rad.is_some(), "load.pitch_rad", expected)?;
    refuse_if(free && load.roll_rad.is_some(), "load.roll_rad", expected)
}

fn check_sliding(sliding: &SlidingTable, case: &Case) -> Checked {
    let anchored = sliding.hardness.is_some();
    refuse_if(
        anchored && case.ice.hardness_pa.is_some(),
        "sliding.hardness",
        "either ice.hardness_pa or sliding.hardness, not both",
    )?;
    refuse_if(
        anchored && case.effects.contains_key("hardness"),
        "sliding.hardness",
        "either sliding.hardness or the effect hardness, not both",
    )?;
    refuse_if(
        case.ice.temperature_c.is_some_and(|t| t != sliding.ice_c),
        "sliding.ice_c",
        "the same temperature as ice.temperature_c",
    )?;
    refuse_if(
        case.ice.waviness.is_some() || case.ice.surface.is_some(),
        "sliding",
        "even ice: on ice of varying height no sliding is steady, expected no ice.waviness and no \
         ice.surface",
    )
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

    fn mounted(mount: &str, load: &str) -> String {
        let shape = "shape = { kind = \"bob\", length_m = 1.0, rocker_radius_m = 30.0, section_radius_m = 0.005, width_m = 0.010, height_m = 0.030 }";
        let text = format!(
            "[runner]\n{shape}\nelastic = true\nmount = {{ {mount} }}\n[ice]\nyoungs_modulus_pa = 9e9\n\
             poissons_ratio = 0.33\nthickness_m = 0.05\n[load]\nfz_n = 1000.0\n{load}"
        );
        match Case::parse(&text) {
            Ok(case) => {
                assert_eq!(
                    Case::parse(&case.to_toml().expect("TOML")).expect("its own"),
                    case
                );
                String::new()
            }
            Err(error) => error.to_string(),
        }
    }

    #[test]
    fn mounts_are_read_and_written() {
        assert_eq!(
            mounted(
                "held = [{ x_m = -0.2, length_m = 0.02 }, { x_m = 0.2, length_m = 0.02 }]",
                ""
            ),
            ""
        );
        assert_eq!(
            mounted(
                "carries = [{ x_m = -0.2, length_m = 0.02, share = 0.25 }, { x_m = 0.2, length_m = 0.02, share = 0.75 }]",
                "offset_x_m = 0.1"
            ),
            ""
        );
    }

    #[test]
    fn mounts_that_cannot_be_are_refused_with_their_numbers() {
        assert!(mounted("", "").contains("either held or carries"));
        assert!(mounted("held = [{ x_m = 0.1, length_m = 0.0 }]", "").contains("length_m = 0"));
        let one =
            |share: f64| format!("carries = [{{ x_m = 0.1, length_m = 0.02, share = {share:?} }}]");
        assert!(
            mounted(&one(0.7), "offset_x_m = 0.07").contains("0.7: expected shares that sum to 1")
        );
        assert!(
            mounted(&one(1.0), "")
                .contains("load.offset_x_m = 0: expected the shares' line of action")
        );
        assert!(
            mounted(&one(1.0), "offset_x_m = 0.1\ntilt = \"fixed\"").contains("expected \"free\"")
        );
        assert!(mounted("held = [{ x = 0.1, length_m = 0.1 }]", "").contains("unknown field"));
    }
}
