//! Sensor effects: `correct` is the inverse of `disturb`.

use kufe_sled::Sled;
use kufe_sled::effects::{Active, CATALOGUE, Channel, Custom, Kind, Sensor, Signals};

use crate::state::{point, signals};

fn largest_error(a: &Signals, b: &Signals) -> f64 {
    let values = a.value.iter().zip(&b.value);
    let rates = a.rate.iter().zip(&b.rate);
    values
        .chain(rates)
        .fold(0.0, |m, (x, y)| m.max((x - y).abs()))
}

#[test]
fn correct_is_the_inverse_of_disturb() {
    for effect in CATALOGUE.iter() {
        let info = effect.info();
        let on: Vec<f64> = info
            .parameters
            .iter()
            .map(|p| p.default + p.typical)
            .collect();
        let mut restored = signals();
        effect.disturb(&on, &mut restored);
        assert_eq!(
            restored != signals(),
            !effect.on_sensors.is_empty(),
            "{}",
            info.name
        );
        effect.correct(&on, &mut restored);
        let error = largest_error(&restored, &signals());
        assert!(error < 1e-12, "{}: {error}", info.name);
    }
}

#[test]
fn correct_is_the_inverse_for_user_defined_sensor_effects() {
    for (column, formula, value) in [
        ("yaw_rate_radps", "0.3", 0.1),
        ("yaw_rate_radps", "yaw_rate_radps", 0.05),
        (
            "yaw_rate_radps",
            "yaw_rate_radps^2 + 0.01 * roll_rate_radps",
            0.2,
        ),
        ("v_mps", "v_mps * sin(s_m / 7)", 0.02),
        ("ax_mps2", "az_mps2 * (ice_c + 5)", -0.001),
        ("gamma_rad", "sqrt(abs(delta_rad)) + t_s", 0.003),
    ] {
        let channel = Channel::named(&format!("sensor:{column}")).unwrap();
        let own = Active {
            name: "mine".to_owned(),
            kind: Kind::Custom(Custom::new(channel, formula, None).unwrap()),
            values: vec![value],
            track: None,
        };
        let mut read = signals();
        own.disturb(&point(), &mut read);
        let sensor = Sensor::named(column).unwrap();
        assert_ne!(read[sensor], signals()[sensor], "{column}: {formula}");
        own.correct(&point(), &mut read);
        // The rate comes from a finite difference over 1 ms.
        let error = largest_error(&read, &signals());
        assert!(error < 1e-8, "{column}: {formula}: {error}");
        let value_error = (read[sensor] - signals()[sensor]).abs();
        assert!(value_error < 1e-12, "{column}: {formula}: {value_error}");
    }
}

#[test]
fn a_formula_equals_the_same_sensor_effect_of_the_catalogue() {
    let scale = kufe_sled::effects::find("yaw-rate-scale").unwrap();
    let own = Custom::new(Channel::Sensor(Sensor::YawRate), "yaw_rate_radps", None).unwrap();
    let (mut known, mut formula) = (signals(), signals());
    scale.correct(&[0.07], &mut known);
    own.correct(0.07, &point(), &mut formula);
    assert!(largest_error(&known, &formula) < 1e-9);
}

#[test]
fn constants_of_the_sled_change_only_in_correct() {
    let inertia = kufe_sled::effects::find("yaw-inertia").unwrap();
    let mut read = signals();
    inertia.disturb(&[0.1], &mut read);
    assert_eq!(
        read,
        signals(),
        "disturb must not change a constant of the sled"
    );
    inertia.correct(&[0.1], &mut read);
    let expected = Sled {
        j_zz_kgm2: 150.0 * (1.0 + 0.1),
        ..signals().sled
    };
    assert_eq!(read.sled, expected);
}
