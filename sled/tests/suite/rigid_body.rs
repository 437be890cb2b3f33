//! Transfer of accelerations, rotations and slips against an independent computation for a moving
//! rigid body.

use kufe_sled::one_track::{body_to_front, front_to_body};
use kufe_sled::{GRAVITY, Model, slips, to_centre_of_gravity};
use nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;

/// Attitude over time [rad]: three successive rotations about body axes, each an arbitrary smooth
/// function.
fn attitude(t: f64, k: &[f64; 6]) -> Rotation3<f64> {
    let angle = |a: f64, w: f64, phase: f64| a * (w * t + phase).sin();
    Rotation3::from_axis_angle(&Vector3::z_axis(), angle(k[0], 1.7, 0.3))
        * Rotation3::from_axis_angle(&Vector3::y_axis(), angle(k[1], 2.3, 1.1))
        * Rotation3::from_axis_angle(&Vector3::x_axis(), angle(k[2], 2.9, -0.4))
}

fn centre(t: f64, k: &[f64; 6]) -> Vector3<f64> {
    Vector3::new(
        30.0 * t + k[3] * (1.3 * t).sin(),
        k[4] * (0.9 * t).cos(),
        k[5] * (2.1 * t).sin(),
    )
}

/// First and second derivative by eighth-order central differences.
fn differences<T>(f: impl Fn(f64) -> T, t: f64, h: f64) -> (T, T)
where
    T: std::ops::Mul<f64, Output = T>
        + std::ops::Add<Output = T>
        + std::ops::Sub<Output = T>
        + Copy,
{
    let first = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
    let second = [8.0 / 5.0, -1.0 / 5.0, 8.0 / 315.0, -1.0 / 560.0];
    let at = |i: i32| f(t + f64::from(i) * h);
    let mut velocity = (at(1) - at(-1)) * first[0];
    let mut acceleration = at(0) * (-205.0 / 72.0) + (at(1) + at(-1)) * second[0];
    for i in 2..=4 {
        velocity = velocity + (at(i) - at(-i)) * first[i as usize - 1];
        acceleration = acceleration + (at(i) + at(-i)) * second[i as usize - 1];
    }
    (velocity * (1.0 / h), acceleration * (1.0 / (h * h)))
}

/// Angular velocity in body axes, from the skew part of R^T dR/dt.
fn rates(t: f64, k: &[f64; 6]) -> Vector3<f64> {
    let (derivative, _) = differences(|t| *attitude(t, k).matrix(), t, 0.004);
    let skew = attitude(t, k).matrix().transpose() * derivative;
    Vector3::new(
        0.5 * (skew[(2, 1)] - skew[(1, 2)]),
        0.5 * (skew[(0, 2)] - skew[(2, 0)]),
        0.5 * (skew[(1, 0)] - skew[(0, 1)]),
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn transferred_acceleration_equals_the_second_difference_of_a_point(
        k in prop::array::uniform6(-1.0..1.0f64),
        r in prop::array::uniform3(-1.0..1.0f64),
        t in 0.0..3.0f64,
    ) {
        // The truncation error h^8 f^(10) / 3150 and the rounding error 1e-15 / h^2 are both below
        // 1e-10.
        let h = 0.008;
        let up = Vector3::new(0.0, 0.0, GRAVITY);
        let point = |t: f64| centre(t, &k) - Vector3::new(30.0 * t, 0.0, 0.0) + attitude(t, &k) * Vector3::from(r);
        let body = attitude(t, &k).inverse();
        let (_, at_sensor) = differences(point, t, h);
        let (_, at_centre) = differences(|t| centre(t, &k) - Vector3::new(30.0 * t, 0.0, 0.0), t, h);
        let (angular_acceleration, _) = differences(|t| rates(t, &k), t, h);
        let found = to_centre_of_gravity(
            (body * (at_sensor + up)).into(),
            rates(t, &k).into(),
            angular_acceleration.into(),
            r,
        );
        let expected = body * (at_centre + up);
        for axis in 0..3 {
            prop_assert!((found[axis] - expected[axis]).abs() < 1e-9, "{} against {}", found[axis], expected[axis]);
        }
    }

    #[test]
    fn runner_frame_is_roll_split_times_steering(
        force in prop::array::uniform3(-5e3..5e3f64),
        delta in -0.2..0.2f64,
        gamma in -0.3..0.3f64,
    ) {
        let turn = Rotation3::from_axis_angle(&Vector3::x_axis(), gamma)
            * Rotation3::from_axis_angle(&Vector3::z_axis(), delta);
        let expected = turn * Vector3::from(force);
        let found = front_to_body(force, delta, gamma);
        let back = body_to_front(found, delta, gamma);
        for axis in 0..3 {
            prop_assert!((found[axis] - expected[axis]).abs() < 1e-9);
            prop_assert!((back[axis] - force[axis]).abs() < 1e-9);
        }
    }
}

#[test]
fn slips_at_the_axles_equal_those_of_the_velocities_there() {
    let sled = Model::published().sled;
    // Velocity at the slip sensor and yaw rate. For small angles v_y(x) = v_y(x_s) + yaw (x - x_s).
    let (v, alpha, yaw, delta) = (30.0, 0.01, -0.2, 0.03);
    let found = slips(&sled, alpha, yaw, v, delta);
    let at = |x: f64| {
        let vy = -v * f64::tan(alpha) + yaw * (x - sled.slip_x_m);
        -vy.atan2(v)
    };
    // The formula of the format is linear in the angles. The residual is of third order.
    let cubic = 0.03_f64.powi(3);
    assert!((found.cog - at(0.0)).abs() < cubic);
    assert!((found.front - at(sled.l_f_m) - delta).abs() < cubic);
    assert!((found.rear - at(-sled.l_r_m)).abs() < cubic);
    // Steering to the left makes the front runner push to the left.
    assert!(slips(&sled, 0.0, 0.0, v, 0.01).front > 0.0);
}

#[test]
fn transfer_equals_the_acceleration_matrix_of_the_paper() {
    // The acceleration matrix of the paper, written out.
    let (w, d, r) = ([0.4, -1.3, 0.7], [3.0, -2.0, 1.5], [-0.35, 0.07, 0.12]);
    let [p, q, y] = w;
    let [dp, dq, dy] = d;
    let matrix = [
        [-q * q - y * y, p * q - dy, p * y + dq],
        [p * q + dy, -p * p - y * y, q * y - dp],
        [p * y - dq, q * y + dp, -p * p - q * q],
    ];
    let a = [1.0, 2.0, 20.0];
    let found = to_centre_of_gravity(a, w, d, r);
    for i in 0..3 {
        let expected = a[i] - (0..3).map(|j| matrix[i][j] * r[j]).sum::<f64>();
        assert!((found[i] - expected).abs() < 1e-12);
    }
}
