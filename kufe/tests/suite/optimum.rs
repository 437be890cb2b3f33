//! The shape with the least friction.

use kufe::jobs::case_file::LoadedCase;
use kufe::jobs::slide::{Parameter, optimise};
use kufe::jobs::{Failure, Watch};
use kufe_contact::Options;
use kufe_sled::friction::Span;

#[test]
fn inaccurate_runners_are_retained_with_their_errors_and_reported() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("case.toml");
    let case = "[runner]\nshape = { kind = \"bob\", length_m = 1.0, rocker_radius_m = 30.0, \
                section_radius_m = 0.004, width_m = 0.008, height_m = 0.030 }\n\
                [ice]\nyoungs_modulus_pa = 9.0e9\npoissons_ratio = 0.33\n\
                thickness_m = \"half-space\"\n[load]\nfz_n = 950.0\ntilt = \"fixed\"\n";
    std::fs::write(&path, case).unwrap();
    let loaded = LoadedCase::read(&path).unwrap();
    let parameter = Parameter {
        key: "rocker_radius_m".to_owned(),
        span: Span::new(20.0, 40.0).unwrap(),
    };
    // Too few unknowns for the default accuracy of 1 %.
    let options = Options {
        max_dofs: 200_000,
        ..Options::default()
    };
    let found = optimise(
        &loaded,
        [30.0, -8.0],
        &[parameter],
        &Watch::default(),
        &options,
    )
    .unwrap();
    assert!(
        matches!(found.short, Some(Failure::NotConverged(_))),
        "{:?}",
        found.short
    );
    // Seven runners and the best.
    assert_eq!(found.points.len(), 8);
    for point in &found.points {
        let mu = point.friction.mu;
        assert!((0.0..0.2).contains(&(mu.error / mu.value)), "{mu:?}");
    }
}
