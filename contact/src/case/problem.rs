//! From a case file to the problem it states.

use std::path::Path;
use std::sync::Arc;

use kufe_mesh::{BobRunner, LugeSteel, Paraboloid, Underside};

use super::check::combination;
use super::{Case, CaseError, RunnerTable, Shape, Thickness, TiltWord};
use crate::{Foundation, Ice, Load, Problem, Runner, Tilt};

impl Case {
    /// The problem that the case states; a hull's path is taken from `base`, the case's folder.
    ///
    /// # Errors
    /// [`CaseError`] where the case is out of range or the hull cannot be had.
    pub fn problem(&self, base: &Path) -> Result<Problem, CaseError> {
        self.check()?;
        Ok(Problem {
            runner: Runner {
                underside: underside(&self.runner, base)?,
            },
            ice: Ice {
                youngs_modulus: self.ice.youngs_modulus_pa,
                poissons_ratio: self.ice.poissons_ratio,
                foundation: match self.ice.thickness_m {
                    Thickness::HalfSpace => Foundation::HalfSpace,
                    Thickness::Layer(thickness) => Foundation::RigidBed { thickness },
                },
                hardness: self.ice.hardness_pa,
            },
            track_curvature: self.track.curvature(),
            load: Load::Force {
                fz: self.load.fz_n,
                offset_x: self.load.offset_x_m,
                offset_y: self.load.offset_y_m,
                tilt: match self.load.tilt {
                    TiltWord::Free => Tilt::Free,
                    TiltWord::Fixed => Tilt::Fixed {
                        pitch: self.load.pitch_rad.unwrap_or(0.0),
                        roll: self.load.roll_rad.unwrap_or(0.0),
                    },
                },
            },
        })
    }
}

fn underside(runner: &RunnerTable, base: &Path) -> Result<Arc<dyn Underside>, CaseError> {
    match (&runner.shape, &runner.hull) {
        (Some(shape), _) => shape_underside(shape),
        (None, Some(hull)) => hull_underside(runner, &base.join(hull)),
        (None, None) => Err(combination("runner", "expected a hull or a shape")),
    }
}

fn shape_underside(shape: &Shape) -> Result<Arc<dyn Underside>, CaseError> {
    Ok(match *shape {
        Shape::Bob {
            length_m,
            rocker_radius_m,
            section_radius_m,
            width_m,
            height_m,
        } => Arc::new(
            BobRunner {
                length: length_m,
                rocker_radius: rocker_radius_m,
                section_radius: section_radius_m,
                width: width_m,
                height: height_m,
                ..BobRunner::default()
            }
            .swept()?,
        ),
        Shape::Paraboloid {
            rocker_radius_m,
            section_radius_m,
        } => Arc::new(Paraboloid::new(rocker_radius_m, section_radius_m)?),
        Shape::Luge {
            length_m,
            rocker_radius_m,
            edge_radius_m,
            tilt_rad,
            width_m,
            height_m,
        } => Arc::new(
            LugeSteel {
                length: length_m,
                rocker_radius: rocker_radius_m,
                edge_radius: edge_radius_m,
                tilt: tilt_rad,
                width: width_m,
                height: height_m,
                ..LugeSteel::default()
            }
            .swept()?,
        ),
    })
}

fn hull_underside(_runner: &RunnerTable, _path: &Path) -> Result<Arc<dyn Underside>, CaseError> {
    Err(combination("runner.hull", "expected a shape"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(shape: &str, rest: &str) -> Case {
        let text = format!(
            "[runner]\nshape = {{ {shape} }}\n[ice]\nyoungs_modulus_pa = 9e9\npoissons_ratio = 0.33\n\
             thickness_m = \"half-space\"\n[load]\nfz_n = 800\n{rest}"
        );
        Case::parse(&text).unwrap_or_else(|error| panic!("{error}\n{text}"))
    }

    #[test]
    fn a_paraboloid_has_the_radii_of_its_case() -> Result<(), CaseError> {
        let shape = "kind = \"paraboloid\", rocker_radius_m = 30, section_radius_m = 0.005";
        let problem = case(
            shape,
            "tilt = \"fixed\"\nroll_rad = 0.01\n[track]\nradius_m = -50\n",
        )
        .problem(Path::new(""))?;
        let height = |x, y| problem.runner.underside.height(x, y);
        assert!((height(0.1, 0.0) / (0.01 / 60.0) - 1.0).abs() < 1e-12);
        assert!((height(0.0, 0.001) / (1e-6 / 0.01) - 1.0).abs() < 1e-12);
        assert_eq!(problem.track_curvature, -0.02);
        assert_eq!(problem.ice.foundation, Foundation::HalfSpace);
        assert_eq!(
            problem.load,
            Load::Force {
                fz: 800.0,
                offset_x: 0.0,
                offset_y: 0.0,
                tilt: Tilt::Fixed {
                    pitch: 0.0,
                    roll: 0.01
                },
            }
        );
        Ok(())
    }

    #[test]
    fn dimensions_that_do_not_fit_are_refused_with_their_numbers() {
        let shape = "kind = \"bob\", length_m = 1, rocker_radius_m = 30, section_radius_m = 0.005, width_m = 0.01, height_m = 0.001";
        let error = case(shape, "")
            .problem(Path::new(""))
            .map(|_| ())
            .expect_err("no height");
        assert!(error.to_string().starts_with("runner.shape: "), "{error}");
    }
}
