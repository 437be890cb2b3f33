//! The ranges of a mount's values, and of what a mesh of hexahedra leaves to say.

use super::range::{Checked, combination, in_range, require};
use crate::case::table::{LoadTable, RunnerTable, TiltWord};

/// Checks a runner's mount, and that it agrees with the load.
pub(crate) fn check_mount(runner: &RunnerTable, load: &LoadTable) -> Checked {
    let Some(mount) = &runner.mount else {
        return Ok(());
    };
    if !runner.elastic {
        return Err(combination(
            "runner.mount",
            "given only with elastic = true",
        ));
    }
    if mount.held.is_empty() == mount.carries.is_empty() {
        return Err(combination(
            "runner.mount",
            "expected either held or carries, with one place at least",
        ));
    }
    for place in &mount.held {
        in_range("runner.mount.held.x_m", place.x_m)?;
        in_range("runner.mount.held.length_m", place.length_m)?;
    }
    for place in &mount.carries {
        in_range("runner.mount.carries.x_m", place.x_m)?;
        in_range("runner.mount.carries.length_m", place.length_m)?;
        in_range("runner.mount.carries.share", place.share)?;
    }
    if mount.carries.is_empty() {
        return Ok(());
    }
    if runner.mesh.is_some() {
        return Err(combination(
            "runner.mount.carries",
            "a mesh is held: expected held, or no mount for all of its top",
        ));
    }
    if load.tilt != TiltWord::Free {
        return Err(combination(
            "load.tilt",
            "expected \"free\": a runner that nothing holds tilts as its load says",
        ));
    }
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

impl RunnerTable {
    /// Checks the keys of a runner that is a mesh.
    pub(super) fn check_mesh(&self) -> Checked {
        if !self.elastic {
            return Err(combination(
                "runner.mesh",
                "given only with elastic = true: expected hull for a rigid runner",
            ));
        }
        let only_a_hulls = [
            ("runner.up", self.up.is_some()),
            ("runner.forward", self.forward.is_some()),
            ("runner.yaw_rad", self.yaw_rad.is_some()),
            ("runner.pitch_rad", self.pitch_rad.is_some()),
            ("runner.roll_rad", self.roll_rad.is_some()),
            ("runner.height_m", self.height_m.is_some()),
        ];
        match only_a_hulls.iter().find(|(_, given)| *given) {
            Some((key, _)) => Err(combination(key, "belongs to a hull, not to a mesh")),
            None => {
                let ranged = [
                    ("runner.scale", self.scale),
                    ("runner.noise_m", self.noise_m),
                ];
                let mut stated = ranged
                    .into_iter()
                    .filter_map(|(key, value)| Some((key, value?)));
                stated.try_for_each(|(key, value)| in_range(key, value))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::case::Case;

    fn case(mount: &str, load: &str) -> String {
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
            case(
                "held = [{ x_m = -0.2, length_m = 0.02 }, { x_m = 0.2, length_m = 0.02 }]",
                ""
            ),
            ""
        );
        assert_eq!(
            case(
                "carries = [{ x_m = -0.2, length_m = 0.02, share = 0.25 }, { x_m = 0.2, length_m = 0.02, share = 0.75 }]",
                "offset_x_m = 0.1"
            ),
            ""
        );
    }

    #[test]
    fn mounts_that_cannot_be_are_refused_with_their_numbers() {
        assert!(case("", "").contains("either held or carries"));
        assert!(case("held = [{ x_m = 0.1, length_m = 0.0 }]", "").contains("length_m = 0"));
        let one =
            |share: f64| format!("carries = [{{ x_m = 0.1, length_m = 0.02, share = {share:?} }}]");
        assert!(
            case(&one(0.7), "offset_x_m = 0.07").contains("0.7: expected shares that sum to 1")
        );
        assert!(
            case(&one(1.0), "")
                .contains("load.offset_x_m = 0: expected the shares' line of action")
        );
        assert!(
            case(&one(1.0), "offset_x_m = 0.1\ntilt = \"fixed\"").contains("expected \"free\"")
        );
        assert!(case("held = [{ x = 0.1, length_m = 0.1 }]", "").contains("unknown field"));
    }
}
