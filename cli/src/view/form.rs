//! The form of the page, and its conversion to and from a case.

use std::collections::BTreeMap;
use std::mem::swap;

use kufe::case::{Case, Hardness, Shape, TiltWord};
use kufe_mesh::{BobRunner, LugeSteel};
use serde::{Deserialize, Serialize};

/// A slider: name, range, and value in a form.
type Slider = (&'static str, [f64; 2], fn(&Form) -> f64);

const SLIDERS: [Slider; 8] = [
    ("rocker_radius_m", [2.0, 200.0], |form| form.rocker_radius_m),
    ("section_radius_m", [1e-3, 0.05], |form| {
        form.section_radius_m
    }),
    ("edge_radius_m", [5e-5, 5e-3], |form| form.edge_radius_m),
    ("tilt_rad", [-0.1, 0.1], |form| form.tilt_rad),
    ("fz_n", [50.0, 10_000.0], |form| form.fz_n),
    ("curvature_1pm", [-0.02, 0.08], |form| form.curvature_1pm),
    ("offset_x_m", [-0.4, 0.4], |form| form.offset_x_m),
    ("hardness_pa", [5e6, ELASTIC_PA], |form| form.hardness_pa),
];
/// Upper end of the slider of the hardness [Pa], which means elastic ice.
const ELASTIC_PA: f64 = 1e9;

/// Kind of runner that the form defines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Runner {
    /// A bobsled runner.
    Bob,
    /// A luge steel.
    Luge,
    /// The runner of the case, of any kind.
    None,
}

/// The form's values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Form {
    /// Kind of runner.
    pub shape: Runner,
    /// Radius of the rocker [m].
    pub rocker_radius_m: f64,
    /// Radius of a bobsled runner's section [m].
    pub section_radius_m: f64,
    /// Radius of a luge steel's edge [m].
    pub edge_radius_m: f64,
    /// Fixed roll of a bobsled runner or a hull, tilt of a luge steel's underside [rad].
    pub tilt_rad: f64,
    /// Normal force [N].
    pub fz_n: f64,
    /// Curvature of the track, positive in a valley [1/m].
    pub curvature_1pm: f64,
    /// Line of action of the load along the runner [m].
    pub offset_x_m: f64,
    /// Hardness of the ice [Pa]; at the upper end of the slider the ice is elastic.
    pub hardness_pa: f64,
}

impl Form {
    /// The form with the values of a case.
    pub fn of(case: &Case) -> Form {
        let (bob, luge) = (BobRunner::default(), LugeSteel::default());
        let is_luge = matches!(case.runner.shape, Some(Shape::Luge { .. }));
        let is_rolled = !is_luge && case.load.tilt == TiltWord::Fixed;
        let mut form = Form {
            shape: Runner::None,
            rocker_radius_m: bob.rocker_radius,
            section_radius_m: bob.section_radius,
            edge_radius_m: luge.edge_radius,
            tilt_rad: case.load.roll_rad.filter(|_| is_rolled).unwrap_or(0.0),
            fz_n: case.load.fz_n,
            curvature_1pm: case.track.curvature(),
            offset_x_m: case.load.offset_x_m,
            hardness_pa: match case.ice.hardness_pa {
                Some(Hardness::Stated(hardness_pa)) => hardness_pa,
                _ => ELASTIC_PA,
            },
        };
        match case.runner.shape.clone() {
            Some(mut shape @ Shape::Bob { .. }) => form.exchange(Runner::Bob, &mut shape),
            Some(mut shape @ Shape::Luge { .. }) => form.exchange(Runner::Luge, &mut shape),
            _ => {}
        }
        form
    }

    /// Exchanges the form's radii, and a luge steel's tilt, with those of a shape.
    fn exchange(&mut self, runner: Runner, shape: &mut Shape) {
        self.shape = runner;
        swap(&mut self.rocker_radius_m, shape.rocker_radius_m());
        match shape {
            Shape::Bob {
                section_radius_m, ..
            } => swap(&mut self.section_radius_m, section_radius_m),
            Shape::Luge {
                edge_radius_m,
                tilt_rad,
                ..
            } => {
                swap(&mut self.edge_radius_m, edge_radius_m);
                swap(&mut self.tilt_rad, tilt_rad);
            }
            Shape::Paraboloid { .. } => {}
        }
    }

    /// Ranges of the sliders by name.
    pub fn ranges() -> BTreeMap<&'static str, [f64; 2]> {
        let sliders = SLIDERS.into_iter();
        sliders.map(|(name, ends, _)| (name, ends)).collect()
    }

    /// The case of the form: `base` with the form's runner, track and load.
    ///
    /// # Errors
    /// A sentence where a number is outside its slider.
    pub fn case(&self, base: &Case) -> Result<Case, String> {
        for (name, [from, to], value) in SLIDERS {
            let (slack, value) = (1e-9 * (to - from), value(self));
            if !(from - slack..=to + slack).contains(&value) {
                return Err(format!("{name} = {value}: expected {from} to {to}"));
            }
        }
        let mut case = base.clone();
        case.load.fz_n = self.fz_n;
        case.track.radius_m = None;
        case.track.curvature_1pm = Some(self.curvature_1pm);
        case.load.offset_x_m = self.offset_x_m;
        // The upper end of the slider, up to rounding.
        let bounded = self.hardness_pa < 0.999 * ELASTIC_PA;
        case.ice.hardness_pa = match base.ice.hardness_pa {
            _ if bounded => Some(Hardness::Stated(self.hardness_pa)),
            Some(Hardness::Stated(_)) => None,
            other => other,
        };
        if self.shape != Runner::Luge {
            if self.tilt_rad != 0.0 {
                case.load.tilt = TiltWord::Fixed;
                case.load.roll_rad = Some(self.tilt_rad);
            } else if case.load.tilt == TiltWord::Fixed {
                case.load.roll_rad = Some(0.0);
            }
        }
        let (bob, luge) = (BobRunner::default(), LugeSteel::default());
        let mut shape = match (self.shape, base.runner.shape.clone()) {
            (Runner::None, _) => return Ok(case),
            (Runner::Bob, Some(shape @ Shape::Bob { .. })) => shape,
            (Runner::Luge, Some(shape @ Shape::Luge { .. })) => shape,
            (Runner::Bob, _) => Shape::Bob {
                length_m: bob.length,
                rocker_radius_m: bob.rocker_radius,
                section_radius_m: bob.section_radius,
                width_m: bob.width,
                height_m: bob.height,
            },
            (Runner::Luge, _) => Shape::Luge {
                length_m: luge.length,
                rocker_radius_m: luge.rocker_radius,
                edge_radius_m: luge.edge_radius,
                tilt_rad: luge.tilt,
                width_m: luge.width,
                height_m: luge.height,
            },
        };
        self.clone().exchange(self.shape, &mut shape);
        if let Shape::Bob { width_m, .. } = &mut shape {
            // The width is at most the diameter of the section, so that its sides are not vertical.
            *width_m = width_m.min(2.0 * self.section_radius_m);
        }
        case.runner.shape = Some(shape);
        case.runner.hull = None;
        Ok(case)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kufe::jobs::case_file::LoadedCase;

    #[test]
    fn the_form_of_a_case_gives_the_case_back() -> Result<(), Box<dyn std::error::Error>> {
        let base = LoadedCase::example()
            .map_err(|failure| failure.to_string())?
            .case;
        let form = Form::of(&base);
        let mut back = form.case(&base)?;
        assert_eq!(back.track.curvature(), base.track.curvature());
        back.track = base.track.clone();
        assert_eq!(back, base);
        Ok(())
    }

    #[test]
    fn a_hull_is_loaded_elsewhere_rolled_and_pressed_on_softer_ice() {
        let mut base = LoadedCase::example().expect("a case").case;
        base.runner.shape = None;
        base.runner.hull = Some("bob.stl".into());
        let form = Form {
            offset_x_m: 0.05,
            tilt_rad: 0.01,
            hardness_pa: 20e6,
            ..Form::of(&base)
        };
        assert_eq!(form.shape, Runner::None);
        let case = form.case(&base).expect("a case");
        assert_eq!(
            (case.load.offset_x_m, case.ice.hardness_pa),
            (0.05, Some(Hardness::Stated(20e6)))
        );
        assert_eq!(
            (case.load.tilt, case.load.roll_rad),
            (TiltWord::Fixed, Some(0.01))
        );
        assert_eq!(case.runner, base.runner);
        let again = Form::of(&case);
        assert_eq!(again, form);
        // At its end the slider removes the bound.
        let elastic = Form {
            hardness_pa: Form::ranges()["hardness_pa"][1],
            ..form
        };
        assert_eq!(elastic.case(&case).expect("a case").ice.hardness_pa, None);
    }

    #[test]
    fn numbers_beyond_the_sliders_are_refused_by_name() -> Result<(), Box<dyn std::error::Error>> {
        let base = LoadedCase::example()
            .map_err(|failure| failure.to_string())?
            .case;
        let form = Form {
            fz_n: 1e9,
            ..Form::of(&base)
        };
        let message = form.case(&base).expect_err("far too much");
        assert!(message.contains("fz_n = 1000000000"), "{message}");
        let unknown = "{\"shape\":\"bob\",\"hull\":\"/etc/passwd\"}";
        assert!(serde_json::from_str::<Form>(unknown).is_err());
        Ok(())
    }
}
