//! `kufe hull bob --rocker-points`: a rocker of several radii given as points along the length.

use crate::kufe::{Bench, errors};

/// Points of an arc of `radius` [m].
fn arc(radius: f64) -> String {
    let points = (-20..=20).map(|i| {
        let x = 0.025 * f64::from(i);
        format!("{x},{}\n", radius - (radius * radius - x * x).sqrt())
    });
    format!("x_m,z_m\n{}", points.collect::<String>())
}

#[test]
fn points_of_an_arc_make_the_hull_of_that_rocker_radius() {
    let bench = Bench::new();
    bench.write("rocker.csv", arc(20.0));
    bench.succeeds(&[
        "hull",
        "bob",
        "--edge-length-m",
        "0.002",
        "--rocker-points",
        "rocker.csv",
        "-o",
        "points.obj",
    ]);
    bench.succeeds(&[
        "hull",
        "bob",
        "--edge-length-m",
        "0.002",
        "--rocker-radius-m",
        "20",
        "-o",
        "radius.obj",
    ]);
    let heights = |name: &str| -> Vec<f64> {
        let text = std::fs::read_to_string(bench.path(name)).expect("a hull");
        text.lines()
            .filter(|line| line.starts_with("v "))
            .map(|line| {
                line.split_whitespace()
                    .nth(3)
                    .expect("z")
                    .parse()
                    .expect("a number")
            })
            .collect()
    };
    let (points, radius) = (heights("points.obj"), heights("radius.obj"));
    assert_eq!(points.len(), radius.len());
    let worst = points
        .iter()
        .zip(&radius)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    assert!(worst < 1e-7, "{worst:e} m apart");
}

#[test]
fn a_rocker_with_a_word_in_it_is_named_with_its_row() {
    let bench = Bench::new();
    bench.write("rocker.csv", "x_m,z_m\n-0.5,0.004\n0,low\n0.5,0.004\n");
    let output = bench.kufe(&[
        "hull",
        "bob",
        "--rocker-points",
        "rocker.csv",
        "-o",
        "a.obj",
    ]);
    assert_eq!(output.status.code(), Some(3));
    let said = errors(&output);
    assert!(
        said.contains("row 2") && said.contains("z_m") && said.contains("low"),
        "{said}"
    );
    assert!(!bench.path("a.obj").exists());
}
