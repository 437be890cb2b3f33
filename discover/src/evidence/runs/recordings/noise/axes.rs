//! Noise of an instrument's axes by their spectra.

use kufe_sled::effects::Sensor;

use crate::evidence::runs::recordings::noise::colour::Colour;
use crate::evidence::runs::recordings::noise::periodogram::Periodogram;
use crate::evidence::runs::recordings::training_samples::TrainingSamples;

/// Noise of one recorded column.
#[derive(Clone, Copy, Debug)]
pub struct ColumnNoise {
    /// Standard deviation at the recorded rate.
    pub sd: f64,
    pub colour: Colour,
}

/// Noise of each axis of an instrument, by its spectrum.
pub fn of_instrument(
    training: &[TrainingSamples],
    axes: &[Sensor],
    from_hz: f64,
    max_ratio: f64,
) -> Option<Vec<ColumnNoise>> {
    // A column that is always constant, as a roll split of zeros, is not measured: it has no noise.
    let varies = |axis: &Sensor| training.iter().any(|piece| piece.varies(axis.name()));
    if !axes.iter().any(varies) {
        let silent = ColumnNoise {
            sd: 0.0,
            colour: Colour::WHITE,
        };
        return Some(vec![silent; axes.len()]);
    }
    let dt = training.first()?.run.dt_s;
    let same_rate: Vec<&TrainingSamples> = training.iter().filter(|p| p.run.dt_s == dt).collect();
    let spectrum = |axis: &Sensor| {
        let columns = same_rate
            .iter()
            .filter_map(|piece| piece.column(axis.name()));
        let columns: Vec<&[f64]> = columns.collect();
        Periodogram::of(&columns, dt, from_hz).filter(|_| varies(axis))
    };
    let seen: Vec<Option<Periodogram>> = axes.iter().map(spectrum).collect();
    of_axes(&seen, dt, max_ratio)
}

/// Noise of each axis; an axis that is constant or dominated by motion gets the noise of the
/// quietest one.
fn of_axes(seen: &[Option<Periodogram>], dt: f64, max_ratio: f64) -> Option<Vec<ColumnNoise>> {
    let power = |axis: &Periodogram| axis.lowest();
    let by_power = |a: &&Periodogram, b: &&Periodogram| power(a).total_cmp(&power(b));
    let quiet = seen.iter().flatten().min_by(by_power)?;
    let noise = |axis: &Periodogram| {
        let (colour, sd) = Colour::of(axis, dt)?;
        Some(ColumnNoise { sd, colour })
    };
    let of_quiet = noise(quiet)?;
    let of_axis = |axis: &Option<Periodogram>| {
        let is_noise = |axis: &&Periodogram| power(axis) <= max_ratio * power(quiet);
        let noise = axis.as_ref().filter(is_noise).and_then(noise);
        noise.unwrap_or(of_quiet)
    };
    Some(seen.iter().map(of_axis).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::null::random::{normal, stream};

    /// Spectrum of an Ornstein-Uhlenbeck process, in steps of a tenth of a row.
    fn spectrum(knee_hz: f64, sd: f64, axis: u64) -> Option<Periodogram> {
        const DT: f64 = 0.001;
        let decay = (-2.0 * std::f64::consts::PI * knee_hz * DT).exp();
        let columns: Vec<Vec<f64>> = (0..20)
            .map(|run| {
                let rng = &mut stream(7, axis, run);
                let mut own = normal(rng);
                let mut next = || {
                    own = decay * own + (1.0 - decay * decay).sqrt() * normal(rng);
                    sd * own
                };
                let fine: Vec<f64> = (0..18_000).map(|_| next()).collect();
                fine.into_iter().step_by(10).collect()
            })
            .collect();
        let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        Periodogram::of(&columns, 0.01, 4.0)
    }

    #[test]
    fn an_axis_dominated_by_motion_takes_the_quietest_noise() {
        let seen = [
            spectrum(14.0, 1.0, 0),
            spectrum(3.5, 1.0, 1),
            spectrum(5.0, 20.0, 2),
        ];
        let own = of_axes(&seen, 0.01, 10.0).unwrap();
        let knees = [14.0, 3.5, 14.0];
        for (noise, knee_hz) in own.iter().zip(knees) {
            assert!((0.9..1.1).contains(&noise.sd), "{own:?}");
            let off = noise.colour.knee_hz / knee_hz;
            assert!((0.7..1.4).contains(&off), "{own:?}");
        }
        // Without the bound the whole spectrum is taken for noise.
        let all = of_axes(&seen, 0.01, f64::INFINITY).unwrap();
        assert!((18.0..22.0).contains(&all[2].sd), "{all:?}");
    }
}
