//! Validation of a case: the range of each value, and conditions between values.

use crate::case::document::Case;
use crate::case::range::{Checked, LARGEST_RADIUS, check_ranges, combination, require};
use crate::case::{Hardness, Shape, Thickness, TiltWord};

impl Case {
    /// Checks every value against its range, and the conditions between values.
    ///
    /// # Errors
    /// [`CaseError`](crate::case::CaseError) naming the first key that is wrong.
    pub fn check(&self) -> Checked {
        check_ranges(self)?;
        let contradictions = [
            runner_contradiction(self),
            mount_contradiction(self),
            ice_contradiction(self),
            load_contradiction(self),
            sliding_contradiction(self),
        ];
        if let Some(text) = contradictions.into_iter().flatten().next() {
            let (key, expected) = text.split_once(": ").unwrap_or(("", text));
            return Err(combination(key, expected));
        }
        check_keys_of_hulls(self)?;
        check_shape(self)?;
        check_shares(self)?;
        let radius = self.track.radius_m.unwrap_or(f64::INFINITY);
        require(
            (1.0..=LARGEST_RADIUS).contains(&radius.abs()) || radius.is_infinite(),
            "track.radius_m",
            radius,
            "a radius in metres from 1 to 1e6 in size, positive in a valley, negative on a crest, or inf",
        )
    }
}

/// First violated condition between keys of the runner, as `key: expectation`.
fn runner_contradiction(case: &Case) -> Option<&'static str> {
    let runner = &case.runner;
    let (hull, shape) = (runner.hull.is_some(), runner.shape.is_some());
    let (mesh, section) = (runner.mesh.is_some(), runner.section.as_ref());
    let has_section = matches!(runner.shape, Some(Shape::Bob { .. } | Shape::Luge { .. }));
    if mesh && (hull || shape) {
        Some("runner.mesh: either hull, shape or mesh, not two of them")
    } else if !(hull || shape || mesh) {
        Some("runner: expected a hull, a shape or a mesh")
    } else if hull && shape {
        Some("runner.shape: either hull or shape, not both")
    } else if mesh && !runner.elastic {
        Some("runner.mesh: given only with elastic = true: expected hull for a rigid runner")
    } else if runner.height_m.is_some() && !runner.elastic {
        Some("runner.height_m: given only with elastic = true")
    } else if section.is_some() && !has_section {
        Some("runner.section: belongs to a shape of kind \"bob\" or \"luge\"")
    } else if section.is_some_and(|s| s.profile.is_some() && s.points_m.is_some()) {
        Some("runner.section.points_m: either profile or points_m, not both")
    } else {
        None
    }
}

/// Refuses keys that describe the file of a hull if the runner is a shape or a mesh. A mesh may
/// have `scale` and `noise_m`.
fn check_keys_of_hulls(case: &Case) -> Checked {
    let runner = &case.runner;
    let mesh = runner.mesh.is_some();
    let expected = if mesh {
        "belongs to a hull, not to a mesh"
    } else if runner.shape.is_some() {
        "belongs to a hull, not to a shape"
    } else {
        return Ok(());
    };
    let given = [
        ("runner.scale", runner.scale.is_some() && !mesh),
        ("runner.up", runner.up.is_some()),
        ("runner.forward", runner.forward.is_some()),
        ("runner.yaw_rad", runner.yaw_rad.is_some()),
        ("runner.pitch_rad", runner.pitch_rad.is_some()),
        ("runner.roll_rad", runner.roll_rad.is_some()),
        ("runner.noise_m", runner.noise_m.is_some() && !mesh),
        ("runner.height_m", runner.height_m.is_some()),
    ];
    match given.into_iter().find(|(_, given)| *given) {
        Some((key, _)) => Err(combination(key, expected)),
        None => Ok(()),
    }
}

fn check_shape(case: &Case) -> Checked {
    let Some(shape) = &case.runner.shape else {
        return Ok(());
    };
    if let Shape::Bob {
        section_radius_m,
        width_m,
        ..
    } = *shape
    {
        require(
            width_m <= 2.0 * section_radius_m,
            "runner.shape.width_m",
            width_m,
            "at most twice section_radius_m",
        )?;
    }
    if let Shape::Paraboloid {
        rocker_radius_m, ..
    } = *shape
    {
        require(
            1.0 / rocker_radius_m > case.track.curvature(),
            "runner.shape.rocker_radius_m",
            rocker_radius_m,
            "a radius whose inverse is above the track's curvature: else a paraboloid's contact has no ends",
        )?;
    }
    let length = shape.length_m().unwrap_or(0.0);
    require(
        length <= 2.0 * *shape.clone().rocker_radius_m(),
        "runner.shape.length_m",
        length,
        "at most twice rocker_radius_m",
    )
}

fn mount_contradiction(case: &Case) -> Option<&'static str> {
    let mount = case.runner.mount.as_ref()?;
    if !case.runner.elastic {
        Some("runner.mount: given only with elastic = true")
    } else if mount.held.is_empty() == mount.carries.is_empty() {
        Some("runner.mount: expected either held or carries, with one place at least")
    } else if mount.carries.is_empty() {
        None
    } else if case.runner.mesh.is_some() {
        Some("runner.mount.carries: a mesh is fixed: expected held, or no mount for its whole top")
    } else if case.load.tilt != TiltWord::Free {
        Some("load.tilt: expected \"free\": a runner without a fixed place tilts under its load")
    } else {
        None
    }
}

/// Checks that the shares of a mount carry the whole load along its line of action.
fn check_shares(case: &Case) -> Checked {
    let mount = case.runner.mount.as_ref();
    let Some(mount) = mount.filter(|mount| !mount.carries.is_empty()) else {
        return Ok(());
    };
    let sum: f64 = mount.carries.iter().map(|p| p.share).sum();
    require(
        (sum - 1.0).abs() < 1e-6,
        "runner.mount.carries.share",
        sum,
        "shares that sum to 1",
    )?;
    let line: f64 = mount.carries.iter().map(|p| p.share * p.x_m).sum();
    let offset = case.load.offset_x_m;
    require(
        (line - offset).abs() < 1e-6,
        "load.offset_x_m",
        offset,
        "the shares' line of action, sum of share times x_m",
    )
}

fn ice_contradiction(case: &Case) -> Option<&'static str> {
    let ice = &case.ice;
    let cold = ice.temperature_c.is_some();
    if !cold && ice.youngs_modulus_pa.is_none() {
        Some("ice: expected youngs_modulus_pa, or temperature_c to take it from")
    } else if !cold && ice.poissons_ratio.is_none() {
        Some("ice: expected poissons_ratio, or temperature_c to take it from")
    } else if ice.bed.is_some() && ice.thickness_m == Thickness::HalfSpace {
        Some("ice.bed: a half-space of ice has no bed")
    } else if !cold && ice.hardness_pa == Some(Hardness::FromTemperature) {
        Some("ice.hardness_pa: \"from-temperature\" needs temperature_c")
    } else if ice.waviness.is_some() && ice.surface.is_some() {
        Some("ice.surface: either waviness or surface, not both")
    } else if ice
        .waviness
        .as_ref()
        .is_some_and(|waves| std::f64::consts::TAU * waves.amplitude_m.abs() > waves.wavelength_m)
    {
        Some(
            "ice.waviness.amplitude_m: waves with slopes, 2 pi amplitude_m / wavelength_m, of at most 1",
        )
    } else {
        None
    }
}

fn load_contradiction(case: &Case) -> Option<&'static str> {
    let free = case.load.tilt == TiltWord::Free;
    if case.track.curvature_1pm.is_some() && case.track.radius_m.is_some() {
        Some("track.curvature_1pm: either radius_m or curvature_1pm, not both")
    } else if free && case.load.pitch_rad.is_some() {
        Some("load.pitch_rad: given only with tilt = \"fixed\"")
    } else if free && case.load.roll_rad.is_some() {
        Some("load.roll_rad: given only with tilt = \"fixed\"")
    } else {
        None
    }
}

fn sliding_contradiction(case: &Case) -> Option<&'static str> {
    let sliding = case.sliding.as_ref()?;
    let measured = sliding.hardness.is_some();
    let temperature = case.ice.temperature_c;
    if measured && case.ice.hardness_pa.is_some() {
        Some("sliding.hardness: either ice.hardness_pa or sliding.hardness, not both")
    } else if measured && case.effects.contains_key("hardness") {
        Some("sliding.hardness: either sliding.hardness or the effect hardness, not both")
    } else if temperature.is_some_and(|t| t != sliding.ice_c) {
        Some("sliding.ice_c: the same temperature as ice.temperature_c")
    } else if case.ice.waviness.is_some() || case.ice.surface.is_some() {
        Some("sliding: steady only on even ice, expected no ice.waviness and no ice.surface")
    } else {
        None
    }
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

    #[test]
    fn a_paraboloid_without_an_end_to_its_contact_is_refused() {
        let error = |radii: [&str; 2], curvature: &str| {
            let shape = format!(
                "shape = {{ kind = \"paraboloid\", rocker_radius_m = {}, section_radius_m = {} }}",
                radii[0], radii[1]
            );
            let (before, rest) = GOOD.split_once("shape").expect("a shape");
            let (_, rest) = rest.split_once('\n').expect("a line");
            let text = format!("{before}{shape}\n{rest}");
            let track = format!("curvature_1pm = {curvature}");
            let case =
                Case::parse(&text.replacen("radius_m = inf\n[load]", &(track + "\n[load]"), 1));
            case.err().map_or(String::new(), |error| error.to_string())
        };
        assert_eq!(error(["30.0", "0.005"], "0.033"), "");
        assert_eq!(error(["inf", "0.005"], "-0.01"), "");
        for (radii, curvature, key) in [
            (
                ["30.0", "0.005"],
                "0.034",
                "line 2: runner.shape.rocker_radius_m = 30: expected",
            ),
            (
                ["inf", "0.005"],
                "0.0",
                "line 2: runner.shape.rocker_radius_m = inf: expected",
            ),
            (
                ["30.0", "inf"],
                "0.0",
                "line 2: runner.shape.section_radius_m = inf: expected",
            ),
        ] {
            let found = error(radii, curvature);
            assert!(found.starts_with(key), "{found}");
        }
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
