//! Columns that are recorded and vary.

use kufe_sled::Run;
use kufe_sled::effects::Column;

use crate::evidence::runs::recordings::frame::Frame;
use crate::evidence::runs::recordings::training_samples::TrainingSamples;

/// The columns that effects may need, recorded in every run and varying in the training runs;
/// missing and constant ones are reported in `remarks`.
pub fn available(
    runs: &[Run],
    training: &[TrainingSamples],
    frames: &[&Frame],
    remarks: &mut Vec<String>,
) -> Vec<Column> {
    let recorded = |name: &str| runs.iter().all(|run| run.columns.contains_key(name));
    let varies = |name: &str| recorded(name) && varies(training, name);
    let mut list = vec![Column::Time];
    let by_file = [
        (Column::Speed, "v_mps"),
        (Column::Slip, "alpha_rad"),
        (Column::Steering, "delta_rad"),
        (Column::RollSplit, "gamma_rad"),
        (Column::RollRate, "roll_rate_radps"),
        (Column::PitchRate, "pitch_rate_radps"),
        (Column::YawRate, "yaw_rate_radps"),
        (Column::VerticalAcceleration, "az_mps2"),
        (Column::LongitudinalAcceleration, "ax_mps2"),
        (Column::Load, "az_mps2"),
        (Column::Humidity, "humidity_pct"),
    ];
    for (column, name) in by_file {
        if varies(name) {
            list.push(column);
        } else {
            let why = if recorded(name) {
                "is constant"
            } else if runs.iter().any(|run| run.columns.contains_key(name)) {
                "is not recorded in every run"
            } else {
                "is not recorded"
            };
            remarks.push(format!(
                "column {name} {why}: effects that need it cannot be tested"
            ));
        }
    }
    // NaN, the value of an unstated condition, does not vary.
    let spread = |value: fn(&Frame) -> f64| {
        frames.iter().all(|f| value(f).is_finite())
            && frames.iter().any(|f| value(f) != value(frames[0]))
    };
    let ices: Vec<f64> = frames.iter().flat_map(|f| f.condition("ice_c")).collect();
    let ice_varies = ices.iter().all(|c| c.is_finite()) && ices.iter().any(|c| *c != ices[0]);
    for (column, varies) in [
        (Column::IceTemperature, ice_varies),
        (Column::AirTemperature, spread(|f| f.air_c)),
        (Column::AirPressure, spread(|f| f.air_pa)),
        (
            Column::Humidity,
            !list.contains(&Column::Humidity) && spread(|f| f.humidity_pct),
        ),
        (
            Column::Wear,
            varies("distance_m") || spread(|f| f.distance_before),
        ),
    ] {
        if varies {
            list.push(column);
        }
    }
    if runs.len() > 1 || recorded("s_m") {
        list.push(Column::Distance);
    }
    list
}

/// Whether two recorded values of a column differ.
fn varies(training: &[TrainingSamples], name: &str) -> bool {
    let columns = training.iter().filter_map(|piece| piece.column(name));
    let mut values = columns.flatten().filter(|x| x.is_finite());
    let first = values.next();
    values.any(|x| Some(x) != first)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(humidity: &[f64]) -> Run {
        Run {
            entry: Default::default(),
            t0_s: 0.0,
            dt_s: 0.01,
            columns: [("humidity_pct".to_owned(), humidity.to_vec())].into(),
            gaps: Default::default(),
            saturated: Default::default(),
            remarks: Vec::new(),
        }
    }

    #[test]
    fn a_column_varies_if_two_recorded_values_differ() {
        let varies = |columns: &[&[f64]]| {
            let runs: Vec<Run> = columns.iter().map(|column| run(column)).collect();
            let samples = |run| TrainingSamples { run, rows: 0..2 };
            varies(
                &runs.iter().map(samples).collect::<Vec<_>>(),
                "humidity_pct",
            )
        };
        let missing = [f64::NAN, f64::NAN];
        assert!(!varies(&[&missing, &[60.0, 60.0]]));
        assert!(varies(&[&missing, &[60.0, 60.0], &[61.0, 61.0]]));
        assert!(!varies(&[&missing]) && !varies(&[]));
    }
}
