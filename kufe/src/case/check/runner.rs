//! The ranges of a runner's values.

use super::range::{Checked, combination, in_range, require};
use crate::case::table::{RunnerTable, SectionTable, Shape};

pub(crate) fn check_runner(runner: &RunnerTable) -> Checked {
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
                in_range("runner.scale", scale)?;
            }
            let stated = [
                ("runner.yaw_rad", runner.yaw_rad),
                ("runner.pitch_rad", runner.pitch_rad),
                ("runner.roll_rad", runner.roll_rad),
                ("runner.noise_m", runner.noise_m),
            ];
            for (key, value) in stated {
                value.map_or(Ok(()), |value| in_range(key, value))?;
            }
            match runner.height_m {
                Some(_) if !runner.elastic => Err(combination(
                    "runner.height_m",
                    "given only with elastic = true",
                )),
                Some(height) => in_range("runner.height_m", height),
                None => Ok(()),
            }
        }
        (None, Some(shape)) => {
            let belongs_to_a_hull = [
                ("runner.scale", runner.scale.is_some()),
                ("runner.up", runner.up.is_some()),
                ("runner.forward", runner.forward.is_some()),
                ("runner.yaw_rad", runner.yaw_rad.is_some()),
                ("runner.pitch_rad", runner.pitch_rad.is_some()),
                ("runner.roll_rad", runner.roll_rad.is_some()),
                ("runner.noise_m", runner.noise_m.is_some()),
                ("runner.height_m", runner.height_m.is_some()),
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
    in_range("runner.youngs_modulus_pa", runner.youngs_modulus_pa)?;
    in_range("runner.poissons_ratio", runner.poissons_ratio)
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
        in_range("runner.section.worn_edge", edge)?;
    }
    match section.worn_m {
        Some(depth) => in_range("runner.section.worn_m", depth),
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
            in_range("runner.shape.length_m", length_m)?;
            in_range("runner.shape.rocker_radius_m", rocker_radius_m)?;
            in_range("runner.shape.section_radius_m", section_radius_m)?;
            in_range("runner.shape.width_m", width_m)?;
            in_range("runner.shape.height_m", height_m)?;
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
            in_range("runner.shape.rocker_radius_m", rocker_radius_m)?;
            in_range("runner.shape.section_radius_m", section_radius_m)
        }
        Shape::Luge {
            length_m,
            rocker_radius_m,
            edge_radius_m,
            tilt_rad,
            width_m,
            height_m,
        } => {
            in_range("runner.shape.length_m", length_m)?;
            in_range("runner.shape.rocker_radius_m", rocker_radius_m)?;
            in_range("runner.shape.edge_radius_m", edge_radius_m)?;
            in_range("runner.shape.width_m", width_m)?;
            in_range("runner.shape.height_m", height_m)?;
            in_range("runner.shape.tilt_rad", tilt_rad)?;
            require(
                length_m <= 2.0 * rocker_radius_m,
                "runner.shape.length_m",
                length_m,
                "at most twice rocker_radius_m",
            )
        }
    }
}
