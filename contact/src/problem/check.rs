//! Ranges of the numbers in a problem.

use kufe_fem::Material;

#[cfg(feature = "gpu")]
use crate::StiffnessForm;
use crate::{ElasticRunner, Error, Foundation, Load, Method, Mount, Options, Problem, Tilt};

/// Ranges of the numbers in a problem.
pub(crate) fn check(problem: &Problem, options: &Options) -> Result<Material, Error> {
    let out = |name, value, expected| {
        Err(Error::OutOfRange {
            name,
            value,
            expected,
        })
    };
    let ice = &problem.ice;
    if !(ice.youngs_modulus > 0.0 && ice.youngs_modulus.is_finite()) {
        return out(
            "ice Young's modulus",
            ice.youngs_modulus,
            "a positive number of Pa",
        );
    }
    if !(ice.poissons_ratio > -1.0 && ice.poissons_ratio < 0.5) {
        return out(
            "ice Poisson's ratio",
            ice.poissons_ratio,
            "more than -1 and less than 0.5",
        );
    }
    if let Foundation::RigidBed { thickness } | Foundation::ElasticBed { thickness, .. } =
        ice.foundation
        && !(thickness > 0.0 && thickness.is_finite())
    {
        return out("ice thickness", thickness, "a positive number of m");
    }
    if let Foundation::ElasticBed { bed, .. } = ice.foundation {
        if !(bed.thickness > 0.0 && bed.thickness.is_finite()) {
            return out("bed thickness", bed.thickness, "a positive number of m");
        }
        if !(bed.youngs_modulus > 0.0 && bed.youngs_modulus.is_finite()) {
            return out(
                "bed Young's modulus",
                bed.youngs_modulus,
                "a positive number of Pa",
            );
        }
        if !(bed.poissons_ratio > -1.0 && bed.poissons_ratio < 0.5) {
            return out(
                "bed Poisson's ratio",
                bed.poissons_ratio,
                "more than -1 and less than 0.5",
            );
        }
    }
    if let Some(hardness) = ice.hardness
        && !(hardness > 0.0 && hardness.is_finite())
    {
        return out("ice hardness", hardness, "a positive number of Pa");
    }
    if !problem.track_curvature.is_finite() {
        return out(
            "track curvature",
            problem.track_curvature,
            "a finite number of 1/m",
        );
    }
    match problem.load {
        Load::Force { fz, .. } if !(fz > 0.0 && fz.is_finite()) => {
            return out("normal force", fz, "a positive number of N");
        }
        Load::Approach { approach, .. } if !(approach > 0.0 && approach.is_finite()) => {
            return out("approach", approach, "a positive number of m");
        }
        _ => {}
    }
    if let Some(elastic) = &problem.runner.elastic {
        check_mount(problem, elastic)?;
    }
    let slow = match &problem.runner.elastic {
        None => true,
        Some(elastic) => elastic.solid.is_none() && options.method == Method::CholeskyActiveSet,
    };
    if options.method != Method::Accelerated && !slow {
        return out(
            "elastic bodies that the checking method cannot take",
            1.0,
            "0, or the active set for a runner on the ice's columns",
        );
    }
    #[cfg(feature = "gpu")]
    if options.device.is_some() {
        let found = match (&problem.runner.elastic, options.method) {
            _ if options.stiffness == StiffnessForm::Assembled => Some("an assembled stiffness"),
            (Some(_), _) => Some("an elastic runner"),
            (None, Method::Accelerated) => None,
            (None, _) => Some("a checking method"),
        };
        if let Some(found) = found {
            return Err(Error::NotOnDevice { found });
        }
    }
    if !(options.p_max_tolerance > 0.0 && options.p_max_tolerance.is_finite()) {
        return out(
            "accuracy of the peak pressure",
            options.p_max_tolerance,
            "a positive number",
        );
    }
    Material::new(ice.youngs_modulus, ice.poissons_ratio).map_err(|_| Error::OutOfRange {
        name: "ice material",
        value: ice.youngs_modulus,
        expected: "an elastic solid",
    })
}

/// Places lie on the hull and are longer than nothing; loads without a mount balance the load.
fn check_mount(problem: &Problem, elastic: &ElasticRunner) -> Result<(), Error> {
    let out = |name, value, expected| {
        Err(Error::OutOfRange {
            name,
            value,
            expected,
        })
    };
    if elastic.mount == Mount::Top {
        return Ok(());
    }
    let extent = problem.runner.underside.extent();
    let places = elastic.mount.places();
    if places.is_empty() {
        return out("places of the runner's mount", 0.0, "1 or more");
    }
    for place in places {
        if !(place.length > 0.0 && place.length.is_finite()) {
            return out(
                "length of a mount's place",
                place.length,
                "a positive number of m",
            );
        }
        let half = 0.5 * place.length;
        let slack = 1e-9 * place.length;
        if !(place.x - half >= extent[0] - slack && place.x + half <= extent[1] + slack) {
            return out(
                "middle of a mount's place",
                place.x,
                "a place within the runner's ends",
            );
        }
    }
    let Mount::Loads(loads) = &elastic.mount else {
        return Ok(());
    };
    let Load::Force {
        offset_x,
        tilt: Tilt::Free,
        ..
    } = problem.load
    else {
        return out(
            "held tilts of a runner without a mount",
            2.0,
            "0, a force with free tilt",
        );
    };
    let sum = |f: &dyn Fn(&crate::LoadedPlace) -> f64| loads.iter().map(f).sum::<f64>();
    if (sum(&|l| l.share) - 1.0).abs() > 1e-6 {
        return out("sum of the loads' shares", sum(&|l| l.share), "1");
    }
    let line = sum(&|l| l.share * l.place.x);
    if (line - offset_x).abs() > 1e-6 {
        return out(
            "line of action of the loads",
            line,
            "that of the normal force",
        );
    }
    Ok(())
}
