//! A runner turned by an angle that the model does not have.

use std::sync::Arc;

use crate::case::effects::underside::shaped::Shaped;
use kufe_contact::{Load, Problem, Tilt};

/// The axis that it is turned about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::case::effects) enum About {
    /// x: positive lifts the left side.
    X,
    /// y: positive lowers the nose.
    Y,
}

/// A held tilt gets the angle on top; with a free one the underside is turned against the frame of the map.
pub(in crate::case::effects) fn turn(problem: &mut Problem, about: About, angle: f64) {
    if angle == 0.0 {
        return;
    }
    if let Load::Force {
        tilt: Tilt::Fixed { pitch, roll },
        ..
    } = &mut problem.load
    {
        match about {
            About::X => *roll += angle,
            About::Y => *pitch += angle,
        }
        return;
    }
    let slope = match about {
        About::X => [0.0, angle.tan()],
        About::Y => [-angle.tan(), 0.0],
    };
    problem.runner.underside = Arc::new(Shaped {
        inner: problem.runner.underside.clone(),
        change: move |x, y, height| height + slope[0] * x + slope[1] * y,
        keeps: [about == About::X, about == About::Y],
    });
}
