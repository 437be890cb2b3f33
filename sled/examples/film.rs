//! The melt film under a bob runner as a function of speed and temperature of the ice.
//!
//! Under a runner the ice is at its melting point. Shear heats the film. Heat that the ice does not
//! conduct away melts more ice, and the load squeezes water out sideways. The balance gives the
//! film's thickness and the drag.

use kufe_sled::friction::film::{FilmConditions, FilmOptions, Properties, Strip, film};

fn main() -> Result<(), kufe_sled::Error> {
    // A patch 65 mm long: ice of hardness 17.7 MPa yields under a round section, then springs back.
    let (front, length, width, hardness) = (48.7e-3, 65.4e-3, 1.06e-3, 17.7e6);
    let stations: Vec<f64> = (0..=60).map(|k| length * k as f64 / 60.0).collect();
    let ellipse = |share: f64| (1.0 - share * share).max(0.0).sqrt();
    let widths = stations
        .iter()
        .map(|xi| width * ellipse((1.0 - xi / front).max(0.0)));
    let pressures = stations
        .iter()
        .map(|xi| hardness * ellipse(((xi - front) / (length - front)).clamp(0.0, 1.0)));
    let strip = Strip::new(stations.clone(), widths.collect(), pressures.collect())?;

    println!("ice [C]  speed [m/s]  friction [1e-3]   +-       film [µm]  into ice [%]");
    let mut table = Vec::new();
    for ice_c in [-10.0, -5.0, -2.0] {
        for v in [5.0, 15.0, 35.0] {
            let conditions = FilmConditions::new(v, ice_c);
            let film = film(
                &strip,
                &conditions,
                &Properties::WATER_AND_ICE,
                &FilmOptions::default(),
            )?;
            let totals = film.totals;
            println!(
                "{ice_c:7.1}  {v:11.1}  {:15.3}  {:.1e}  {:9.3}  {:12.1}",
                1e3 * totals.friction,
                1e3 * film.errors.friction,
                1e6 * totals.mean_thickness,
                100.0 * totals.into_ice / totals.dissipated,
            );
            // Heat balance: friction heat melts ice or goes into one of the two walls.
            let melting = Properties::WATER_AND_ICE.latent_heat * (totals.melted - totals.refrozen);
            let balance = totals.dissipated - melting - totals.into_ice - totals.into_steel;
            assert!(balance.abs() < 1e-6 * totals.dissipated);
            table.push(totals.friction);
        }
    }
    // Friction rises with the speed on every ice, and with colder ice at every speed.
    for row in table.chunks_exact(3) {
        assert!(row.windows(2).all(|pair| pair[1] > pair[0]));
    }
    for k in 0..3 {
        assert!(table[k] > table[3 + k] && table[3 + k] > table[6 + k]);
    }
    Ok(())
}
