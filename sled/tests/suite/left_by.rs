//! Derivatives of the balances in closed form against differences of the balances themselves.

use kufe_sled::effects::{Constants, OperatingPoint, Sensor, Signals};
use kufe_sled::{Balance, Model, Sled, Vehicle, from_sensors};

/// A sled that slips, steers, pitches and turns, all at once.
fn signals(sled: &Sled, k: usize) -> Signals {
    let wave = |c: usize| (1.7 * c as f64 + 0.9 * k as f64).sin();
    let mut signals = Signals {
        sled: Constants {
            accelerometer: [0.3, -0.1, 0.25],
            slip_sensor: -0.6,
            ..sled.constants()
        },
        ..Signals::default()
    };
    signals[Sensor::Ax] = 0.5 * wave(1);
    signals[Sensor::Ay] = 4.0 * wave(2);
    signals[Sensor::Az] = 18.0 + 8.0 * wave(3);
    signals.set(Sensor::RollRate, 0.4 * wave(4), 2.0 * wave(5));
    signals.set(Sensor::PitchRate, 0.5 * wave(6), 1.5 * wave(7));
    signals.set(Sensor::YawRate, 0.3 * wave(8), 1.1 * wave(9));
    signals.set(Sensor::Speed, 28.0 + 7.0 * wave(10), 0.4);
    signals.set(Sensor::Slip, 0.02 * wave(11), 0.1);
    signals.set(Sensor::Steering, 0.03 * wave(12), 0.2);
    signals[Sensor::RollSplit] = 0.05 * wave(13);
    signals
}

fn left(vehicle: &Vehicle, signals: &Signals) -> [f64; 3] {
    let balance = balance(vehicle, signals);
    balance.residual(&balance.laws(vehicle).forces).values()
}

fn balance(vehicle: &Vehicle, signals: &Signals) -> Balance {
    let mut sled = vehicle.sled;
    sled.set_constants(&signals.sled);
    let at = OperatingPoint {
        air_density: 1.2,
        ..OperatingPoint::default()
    };
    let (state, motion) = from_sensors(&sled, signals, &at);
    Balance::new(&sled, &state, &motion)
}

#[test]
fn derivatives_by_every_sensor_and_constant_are_those_of_the_balances() {
    let vehicle = Vehicle::new(&Model::published()).unwrap();
    type Move = (&'static str, f64, fn(&mut Signals, f64));
    let mut moves: Vec<Move> = vec![
        ("mass", 1.0, |s, by| s.sled.mass += by),
        ("pitch inertia", 1.0, |s, by| s.sled.pitch_inertia += by),
        ("yaw inertia", 1.0, |s, by| s.sled.yaw_inertia += by),
        ("front axle", 1e-3, |s, by| s.sled.axles[0] += by),
        ("rear axle", 1e-3, |s, by| s.sled.axles[1] += by),
        ("accelerometer x", 1e-3, |s, by| {
            s.sled.accelerometer[0] += by
        }),
        ("accelerometer y", 1e-3, |s, by| {
            s.sled.accelerometer[1] += by
        }),
        ("accelerometer z", 1e-3, |s, by| {
            s.sled.accelerometer[2] += by
        }),
        ("slip sensor", 1e-3, |s, by| s.sled.slip_sensor += by),
        ("roll acceleration", 1e-3, |s, by| {
            s.rate[Sensor::RollRate as usize] += by
        }),
        ("pitch acceleration", 1e-3, |s, by| {
            s.rate[Sensor::PitchRate as usize] += by
        }),
        ("yaw acceleration", 1e-3, |s, by| {
            s.rate[Sensor::YawRate as usize] += by
        }),
    ];
    moves.extend([
        (
            "ax",
            1e-3,
            (|s, by| s[Sensor::Ax] += by) as fn(&mut Signals, f64),
        ),
        ("ay", 1e-3, |s, by| s[Sensor::Ay] += by),
        ("az", 1e-3, |s, by| s[Sensor::Az] += by),
        ("roll rate", 1e-4, |s, by| s[Sensor::RollRate] += by),
        ("pitch rate", 1e-4, |s, by| s[Sensor::PitchRate] += by),
        ("yaw rate", 1e-4, |s, by| s[Sensor::YawRate] += by),
        ("speed", 1e-3, |s, by| s[Sensor::Speed] += by),
        ("slip", 1e-5, |s, by| s[Sensor::Slip] += by),
        ("steering", 1e-5, |s, by| s[Sensor::Steering] += by),
        ("roll-split", 1e-5, |s, by| s[Sensor::RollSplit] += by),
    ]);
    for k in 0..12 {
        let at = signals(&vehicle.sled, k);
        let here = balance(&vehicle, &at);
        let laws = here.laws(&vehicle);
        let by = here.left_by(&vehicle, &laws, &at);
        for (name, step, moved) in &moves {
            let there = |by: f64| {
                let mut there = at;
                moved(&mut there, by);
                there
            };
            let (up, down) = (there(*step), there(-step));
            let (plus, minus) = (left(&vehicle, &up), left(&vehicle, &down));
            let closed = by.between(&down, &up);
            let largest = plus.iter().zip(minus).map(|(p, m)| (p - m).abs());
            let size = largest.fold(1e-9, f64::max);
            for c in 0..3 {
                // The load's own equation is solved to 1e-6, and the second order of differences is
                // below that.
                let off = (plus[c] - minus[c] - closed[c]).abs();
                assert!(
                    off < 2e-4 * size,
                    "{name} {c} at {k}: {} {}",
                    plus[c] - minus[c],
                    closed[c]
                );
            }
        }
    }
}
