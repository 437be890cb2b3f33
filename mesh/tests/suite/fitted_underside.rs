//! Smooth undersides fitted to hulls, against the runners that the hulls were made of.

use kufe_mesh::{
    BobRunner, FittedUnderside, Hull, HullFormat, HullOptions, LugeSteel, Swept, Underside,
    read_obj, tessellate, tessellate_steel,
};

fn through_obj(runner: &Swept, edge: f64) -> Hull {
    let mut file = Vec::new();
    let hull = tessellate(runner, edge).unwrap();
    HullFormat::Obj.write(&hull, &mut file).unwrap();
    read_obj(&file, &HullOptions::default()).unwrap()
}

/// Second derivatives along x and y at the origin, over the contact's size.
fn curvatures(hull: &dyn Underside, dx: f64, dy: f64) -> [f64; 2] {
    let second = |a: f64, b: f64, h: f64| (a + b - 2.0 * hull.height(0.0, 0.0)) / (h * h);
    [
        second(hull.height(dx, 0.0), hull.height(-dx, 0.0), dx),
        second(hull.height(0.0, dy), hull.height(0.0, -dy), dy),
    ]
}

#[test]
fn bob_runner_at_half_and_one_millimetre_keeps_its_curvatures_and_heights() {
    let runner = BobRunner::default().swept().unwrap();
    for (edge, tolerance) in [(0.5e-3, 0.002), (1e-3, 0.01)] {
        let fitted = FittedUnderside::new(&through_obj(&runner, edge), 0.0).unwrap();
        println!("{edge}: {:?}", fitted.quality());
        let [along, across] = curvatures(&fitted, 0.025, 0.14e-3);
        println!("{edge}: {along} {across}");
        assert!((along * 30.0 - 1.0).abs() < tolerance, "{along}");
        assert!((across * 0.005 - 1.0).abs() < tolerance, "{across}");
        let mut worst = 0.0f64;
        for i in -50..=50 {
            for j in -20..=20 {
                let (x, y) = (1e-3 * f64::from(i), 0.02e-3 * f64::from(j));
                worst = worst.max((fitted.height(x, y) - runner.height(x, y)).abs());
            }
        }
        println!("{edge}: {worst:e}");
        assert!(worst < 0.1e-6, "{worst:e}");
        assert_eq!(fitted.mirror_symmetric(), [true, true]);
        assert!(fitted.error_for(13e-6) <= 0.05 * 13e-6);
        assert_eq!(fitted.height(0.3, 0.0051), f64::INFINITY);
        assert_eq!(fitted.height(0.5001, 0.0), f64::INFINITY);
        for y in [0.002, 0.004, 0.0049] {
            let cosine = (1.0 - (y / 0.005f64).powi(2)).sqrt();
            // On the flank no worse than the facets, whose sagitta is 25 µm at 1 mm.
            assert!((fitted.height(0.1, y) - runner.height(0.1, y)).abs() * cosine < 15e-6);
        }
    }
}

/// An open hull over the product of `xs` and `ys`, facing down.
fn sheet(xs: &[f64], ys: &[f64], height: impl Fn(f64, f64) -> f64) -> Hull {
    let mut hull = Hull::default();
    for &x in xs {
        hull.positions
            .extend(ys.iter().map(|&y| [x, y, height(x, y)]));
    }
    let node = |i: usize, j: usize| (i * ys.len() + j) as u32;
    for i in 0..xs.len() - 1 {
        for j in 0..ys.len() - 1 {
            hull.triangles
                .push([node(i, j), node(i + 1, j + 1), node(i + 1, j)]);
            hull.triangles
                .push([node(i, j), node(i, j + 1), node(i + 1, j + 1)]);
        }
    }
    hull
}

fn spaced(half: f64, count: i32) -> Vec<f64> {
    (-count..=count)
        .map(|i| half * f64::from(i) / f64::from(count))
        .collect()
}

#[test]
fn facets_too_coarse_for_the_approach_are_called_so_and_finer_ones_not() {
    // Width 10 mm in 4 or 20 strips, a 5 mm radius.
    let runner = BobRunner::default().swept().unwrap();
    let height = |x: f64, y: f64| runner.height(x, y);
    let coarse =
        FittedUnderside::new(&sheet(&spaced(0.4, 40), &spaced(4.8e-3, 2), height), 0.0).unwrap();
    let error = coarse.error_for(10e-6);
    println!("{error:e}");
    assert!(error > 0.05 * 10e-6, "{error}");
    let fine =
        FittedUnderside::new(&sheet(&spaced(0.4, 40), &spaced(4.8e-3, 10), height), 0.0).unwrap();
    println!("{:?}", fine.quality());
    assert!(fine.error_for(10e-6) <= 0.05 * 10e-6);
}

/// Knots as fine on the coarse side as on the fine one would lie between its vertices, and the
/// surface with them anywhere.
#[test]
fn vertices_that_are_fine_on_one_side_alone_are_followed_on_both() {
    let height = |x: f64, y: f64| x * x / 60.0 + y * y / 0.01;
    let ys = spaced(4e-3, 40);
    let coarse = || (-20..0).map(|i| 0.01 * f64::from(i));
    let fine = || (0..=400).map(|i| 0.5e-3 * f64::from(i));
    let both: Vec<f64> = coarse().chain([0.0]).chain(coarse().map(|x| -x)).collect();
    let turned = fine().map(|x| -x).chain(coarse().map(|x| -x));
    let sorted = |xs: &mut Vec<f64>| xs.sort_by(f64::total_cmp);
    for (mut xs, symmetric) in [
        (both, true),
        (coarse().chain(fine()).collect(), false),
        (turned.collect(), false),
    ] {
        sorted(&mut xs);
        let fitted = FittedUnderside::new(&sheet(&xs, &ys, height), 0.0).unwrap();
        assert_eq!(fitted.mirror_symmetric(), [symmetric, true]);
        let worst = (-75..=75).fold(0.0, |worst: f64, i| {
            let x = 1e-3 * f64::from(i);
            worst.max((fitted.height(x, 0.1e-3) - height(x, 0.1e-3)).abs())
        });
        println!("{worst:e} {:?}", fitted.quality());
        assert!(worst < 5e-9, "{worst:e}");
        assert!(fitted.error_for(12e-6) <= 0.05 * 12e-6);
    }
}

#[test]
fn the_estimated_error_holds_the_true_one() {
    let runner = BobRunner::default().swept().unwrap();
    for strips in [4, 5, 7, 10] {
        let hull = sheet(&spaced(0.4, 40), &spaced(4.6e-3, strips), |x, y| {
            runner.height(x, y)
        });
        let fitted = FittedUnderside::new(&hull, 0.0).unwrap();
        let mut worst = 0.0f64;
        for j in -70..=70 {
            let y = 10e-6 * f64::from(j);
            worst = worst.max((fitted.height(0.01, y) - runner.height(0.01, y)).abs());
        }
        println!("{strips}: {worst:e} {:?}", fitted.quality());
        assert!(
            worst < fitted.quality().resolution_error.max(2e-9),
            "{strips}: {worst:e}"
        );
    }
}

#[test]
fn luge_steels_rounded_edge_is_followed_within_the_estimate() {
    let steel = LugeSteel {
        length: 0.2,
        edge_radius: 1e-3,
        tilt: 0.1,
        ..Default::default()
    };
    let runner = steel.swept().unwrap();
    let ys: Vec<f64> = (-18..=100).map(|i| 0.05e-3 * f64::from(i)).collect();
    let hull = sheet(&spaced(0.05, 25), &ys, |x, y| runner.height(x, y));
    let fitted = FittedUnderside::new(&hull, 0.0).unwrap();
    assert_eq!(fitted.mirror_symmetric(), [true, false]);
    let mut worst = 0.0f64;
    for i in -20..=20 {
        for j in -40..=80 {
            let (x, y) = (1e-3 * f64::from(i), 0.01e-3 * f64::from(j));
            worst = worst.max((fitted.height(x, y) - runner.height(x, y)).abs());
        }
    }
    println!("luge {worst:e} {:?}", fitted.quality());
    assert!(worst < 0.4e-6, "{worst:e}");
    assert!(worst < fitted.quality().resolution_error);
}

/// The curvature jumps across where the edge meets the flat, and along where the ends begin. The
/// more vertices, the more intervals show what the jumps cause next to them; none of that may keep
/// the edge itself from being resolved.
#[test]
fn finer_vertices_on_a_sharp_edge_are_followed_no_worse() {
    let runner = LugeSteel::default().swept().unwrap();
    for edge in [1e-3, 0.25e-3, 0.2e-3] {
        let mut hull = tessellate_steel(&runner, edge).unwrap();
        // As STL keeps them.
        for v in hull.positions.iter_mut().flatten() {
            *v = f64::from(*v as f32);
        }
        let fitted = FittedUnderside::new(&hull, 0.0).unwrap();
        println!("{edge}: {:?}", fitted.quality());
        let mut worst = 0.0f64;
        for i in -20..=20 {
            for j in -80..=120 {
                let (x, y) = (1e-3 * f64::from(i), 1e-6 * f64::from(j));
                worst = worst.max((fitted.height(x, y) - runner.height(x, y)).abs());
            }
        }
        println!("{edge}: {worst:e}");
        assert!(worst < 3e-9, "{edge}: {worst:e}");
        assert!(fitted.error_for(5e-6) <= 0.05 * 5e-6, "{edge}");
    }
}

#[test]
fn scattered_vertices_off_any_grid_give_the_curvatures() {
    let runner = BobRunner::default().swept().unwrap();
    let (xs, ys) = (spaced(0.3, 300), spaced(4.5e-3, 12));
    let mut hull = sheet(&xs, &ys, |x, y| runner.height(x, y));
    for p in &mut hull.positions {
        let shift = |a: f64| (1e4 * (p[0] * a + p[1])).sin();
        let (dx, dy) = (0.3e-3 * shift(3.0), 0.1e-3 * shift(7.0));
        (p[0], p[1]) = (p[0] + dx, p[1] + dy);
        p[2] = runner.height(p[0], p[1]);
    }
    let fitted = FittedUnderside::new(&hull, 0.0).unwrap();
    let [along, across] = curvatures(&fitted, 0.025, 0.14e-3);
    println!("{along} {across} {:?}", fitted.quality());
    assert!((along * 30.0 - 1.0).abs() < 0.01, "{along}");
    assert!((across * 0.005 - 1.0).abs() < 0.01, "{across}");
}

#[test]
fn a_scan_with_five_micrometres_of_noise_keeps_the_curvatures() {
    use rand::SeedableRng;
    use rand_distr::Distribution;
    let runner = BobRunner::default().swept().unwrap();
    let mut hull = sheet(&spaced(0.3, 600), &spaced(4.5e-3, 45), |x, y| {
        runner.height(x, y)
    });
    let noise = 5e-6;
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(7);
    let normal = rand_distr::Normal::new(0.0, noise).unwrap();
    for p in &mut hull.positions {
        p[2] += normal.sample(&mut random);
    }
    let fitted = FittedUnderside::new(&hull, noise).unwrap();
    let [along, across] = curvatures(&fitted, 0.025, 0.3e-3);
    println!("{along} {across} {:?}", fitted.quality());
    assert!((along * 30.0 - 1.0).abs() < 0.05, "{along}");
    assert!((across * 0.005 - 1.0).abs() < 0.05, "{across}");
    assert!((fitted.quality().residual_rms / noise - 1.0).abs() < 0.1);
    let mut worst = 0.0f64;
    let level = fitted.height(0.0, 0.0);
    for i in -30..=30 {
        for j in -10..=10 {
            let (x, y) = (1e-3 * f64::from(i), 0.03e-3 * f64::from(j));
            worst = worst.max((fitted.height(x, y) - level - runner.height(x, y)).abs());
        }
    }
    println!("scan {worst:e}");
    assert!(worst < 0.2 * noise, "{worst:e}");
    assert_eq!(fitted.quality().outliers_warning(), None);
    // A grain of dust at the lowest node next to x = 60 mm.
    let near = |p: &&mut [f64; 3]| (p[0] - 0.06).abs() < 0.3e-3 && p[1].abs() < 0.06e-3;
    let dusty = hull.positions.iter_mut().find(near).unwrap();
    dusty[2] -= 80e-6;
    let expected = format!("at x = {:.1} mm", 1e3 * dusty[0]);
    let fitted = FittedUnderside::new(&hull, noise).unwrap();
    let warning = fitted.quality().outliers_warning().unwrap_or_default();
    assert!(
        warning.starts_with("outliers: 1 vert") && warning.contains(&expected),
        "{warning}"
    );
}

#[test]
fn hulls_without_an_underside_are_refused() {
    let up = sheet(&spaced(0.4, 10), &spaced(4e-3, 4), |_, y| y * y);
    let turned = Hull {
        triangles: up.triangles.iter().map(|t| [t[0], t[2], t[1]]).collect(),
        ..up.clone()
    };
    assert!(
        FittedUnderside::new(&turned, 0.0)
            .unwrap_err()
            .to_string()
            .contains("faces down")
    );
    assert!(
        FittedUnderside::new(&up, -1.0)
            .unwrap_err()
            .to_string()
            .contains("noise")
    );
    let few = sheet(&[-0.1, 0.0, 0.1], &spaced(4e-3, 1), |_, y| y * y);
    assert!(
        FittedUnderside::new(&few, 0.0)
            .unwrap_err()
            .to_string()
            .contains("at least 16")
    );
}

#[test]
fn a_hole_is_the_longest_gap_of_a_contact_patch() {
    let xs: Vec<f64> = (-60..=60).map(|i| 1e-3 * f64::from(i)).collect();
    let ys: Vec<f64> = (-20..=20).map(|j| 0.05e-3 * f64::from(j)).collect();
    let mut hull = sheet(&xs, &ys, |x, y| x * x / 60.0 + y * y / 0.01);
    let patch = [-0.025, 0.025, -0.14e-3, 0.14e-3];
    let gap = |hull: &Hull| {
        let [from, to] = FittedUnderside::new(hull, 0.0).unwrap().longest_gap(patch);
        to - from
    };
    assert!((gap(&hull) - 1e-3).abs() < 1e-9);
    let positions = hull.positions.clone();
    let is_in_hole = |corner: &u32| {
        let [x, y, _] = positions[*corner as usize];
        x > -0.0205 && x < 0.0105 && y.abs() < 0.5e-3
    };
    hull.triangles
        .retain(|corners| !corners.iter().any(is_in_hole));
    assert!((gap(&hull) - 32e-3).abs() < 1e-9);
}
