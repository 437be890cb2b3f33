//! Ranges of the numbers in a problem.

use kufe_fem::Material;

use crate::{Error, Foundation, Load, Method, Options, Problem};

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
    if problem.runner.elastic.is_some() && options.method != Method::Accelerated {
        return out(
            "elastic bodies under a checking method",
            2.0,
            "1, the ice alone",
        );
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
