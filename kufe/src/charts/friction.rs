//! Charts of friction: a gliding run, mu against pressure, and lateral force against slip angle.

use kufe_sled::friction::{
    Experiment, GRAVITY, GlideRun, IceHouse, LateralSample, MagicFormula, MuFit, PressureLaw,
    ZetaActsOn,
};
use kufe_sled::quantile;

use crate::plot::{Axis, Figure, INK, Layer, PALETTE, Panel, Point, extent};

/// Kinetic energy, potential energy and work on the air of a gliding run, their sum, and the fitted
/// line whose slope is the friction of the ice.
///
/// Energies are relative to the start of the glide; the sum falls by the work on the ice. The
/// section that the line is fitted to is shaded.
pub fn glide_picture(house: &IceHouse, run: &GlideRun) -> Figure {
    let potential = house.potential(run);
    let start = run.line.at(0.0);
    let kinetic: Vec<f64> = run.kinetic.iter().map(|e| e - start).collect();
    let sum = (0..kinetic.len()).map(|k| kinetic[k] + potential[k] + run.aero[k]);
    let sum: Vec<f64> = sum.collect();
    let entry = &run.entry;
    let climb = potential.last().copied().unwrap_or(0.0) / run.s.last().copied().unwrap_or(1.0);
    let friction = -(run.line.slope + climb);
    let weight = entry.conditions.mass_kg * GRAVITY * house.slope_rad.value.cos();
    let mu = 1e3 * friction / weight;
    let (specimen, name, direction) = (&entry.specimen, &entry.run, &entry.direction);
    let title =
        format!("{specimen}, run {name} ({direction}): friction {friction:.2} N, mu {mu:.2}e-3");
    let section = [run.s[run.section.start], run.s[run.section.end - 1]];
    let shaded = Layer::stretch(section, INK.alpha(0.09));
    let parts = [
        ("kinetic", &kinetic, 2),
        ("potential", &potential, 3),
        ("given to the air", &run.aero, 4),
        ("sum of the three", &sum, 0),
    ];
    let mut layers = vec![shaded.named("section that it is fitted to")];
    layers.extend(parts.map(|(name, values, colour)| {
        let points = run.s.iter().copied().zip(values.iter().copied());
        Layer::line(1.0, points, PALETTE[colour]).named(name)
    }));
    let fitted = section.map(|s| (s, run.line.at(s) - start + climb * s));
    layers.push(Layer::line(2.0, fitted, PALETTE[1]).named("line fitted to the sum"));
    let length = run.s.iter().copied().fold(0.0, f64::max);
    let x = Axis::new("distance s [m]").within([0.0, length]);
    let y = Axis::new("energy relative to the start [J]");
    Figure::new(900.0, title).row(420.0, [Panel::new(x, y, layers)])
}

/// The coefficient of friction against the peak pressure: specimens with both standard deviations,
/// the fit with its confidence band, and the capped law that simulations use.
pub fn mu_picture(experiments: &[Experiment], fit: &MuFit, law: &PressureLaw) -> Figure {
    let at = |e: &Experiment| -> Point { (1e-6 * e.p_max_pa, 1e3 * e.mu) };
    let sd = |e: &Experiment| [1e-6 * e.p_max_sd_pa, 1e3 * e.mu_sd];
    let ends = experiments
        .iter()
        .flat_map(|e| [at(e).0 - sd(e)[0], at(e).0 + sd(e)[0]]);
    let [low, high] = extent(ends);
    let margin = 0.08 * (high - low);
    let (low, high) = ((low - margin).max(0.0), high + margin);
    let largest = experiments.iter().map(|e| at(e).1 + sd(e)[1]);
    let top = 1.08 * largest.fold(1e3 * law.mu_cap, f64::max);
    let [blue, red, grey] = [PALETTE[0], PALETTE[1], PALETTE[6]];
    let asperities = match (law.zeta == 1.0, law.zeta_acts_on) {
        (true, _) => String::new(),
        (false, ZetaActsOn::Mu) => format!(", times zeta = {}", law.zeta),
        (false, ZetaActsOn::Pressure) => format!(", p times zeta = {}", law.zeta),
    };
    let MuFit { b, c, d, .. } = fit;
    let formula = format!("{b:.4} p² − {c:.3} p + {d:.2}{asperities}");
    let places = (0..=200).map(|k| low + (high - low) * f64::from(k) / 200.0);
    let curve = places.clone().map(|p| (p, 1e3 * law.mu(1e6 * p)));
    let band = |p: f64| fit.band(1e6 * p);
    let lower = places.clone().map(|p| (p, 1e3 * band(p).low));
    let upper = places.rev().map(|p| (p, 1e3 * band(p).high));
    let name = format!("{:.0} % band of the fit", 100.0 * fit.confidence);
    let bars = experiments.iter().flat_map(|e| {
        let ((p, mu), [p_sd, mu_sd]) = (at(e), sd(e));
        let along = [(p - p_sd, mu), (p + p_sd, mu)];
        [along, [(p, mu - mu_sd), (p, mu + mu_sd)]]
    });
    let specimens = Layer::dots(4.0, experiments.iter().map(at), red);
    let mut layers = vec![
        Layer::area(lower.chain(upper), blue.alpha(0.15)).named(name),
        Layer::line(2.0, curve, blue).named(formula),
        Layer::line(1.0, [low, high].map(|p| (p, 1e3 * law.mu_cap)), grey).named("cap"),
        Layer::segments(1.0, bars, red),
        specimens.named("specimens, one standard deviation"),
    ];
    if experiments.len() <= 24 {
        layers.extend(experiments.iter().map(|e| {
            // Above a point above the curve, below one below; leftwards near the right edge.
            let is_right = at(e).0 > low + 0.85 * (high - low);
            let right = if is_right { -0.5 } else { 0.5 };
            let up = if e.mu < law.mu(e.p_max_pa) { -0.8 } else { 0.8 };
            Layer::text(at(e), &*e.specimen, [right, up], INK)
        }));
    }
    let x = Axis::new("peak pressure p_max [MPa]").within([low, high]);
    let y = Axis::new("coefficient of friction mu [1e-3]").within([0.0, top]);
    let title = "Friction over peak contact pressure";
    Figure::new(900.0, title).row(460.0, [Panel::new(x, y, layers)])
}

/// Largest number of points of a panel; more would only hide one another.
const MAX_POINTS: usize = 6000;

/// Lateral force against slip angle, measured and fitted: one panel per third of the samples,
/// sorted by normal force, with the fitted law at the mean load of the third.
pub fn fit_picture(runner: &str, samples: &[LateralSample], law: &MagicFormula) -> Figure {
    let sorted = |value: fn(&LateralSample) -> f64| {
        let mut values: Vec<f64> = samples.iter().map(value).collect();
        values.sort_by(f64::total_cmp);
        values
    };
    let loads = sorted(|sample| sample.fz);
    let cuts = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0].map(|share| quantile(&loads, share));
    let slips = sorted(|sample| sample.alpha.to_degrees().abs());
    // A range that includes the rarest slip angles would compress all others.
    let reach = 1.15 * quantile(&slips, 0.9995).max(0.2);
    let panel = |third: usize| {
        let (low, high) = (cuts[third], cuts[third + 1]);
        let inside = |fz: f64| fz >= low && (fz < high || third == 2);
        let here: Vec<&LateralSample> = samples.iter().filter(|s| inside(s.fz)).collect();
        let mean = here.iter().map(|sample| sample.fz).sum::<f64>() / here.len().max(1) as f64;
        let force = |degrees: f64| (degrees, law.force(degrees.to_radians(), mean));
        let points = here.iter().map(|s| (s.alpha.to_degrees(), s.fy));
        let points = points.filter(|(degrees, _)| degrees.abs() <= reach);
        let sizes = points.clone().map(|(_, fy)| fy.abs());
        let most = sizes.fold(force(reach).1, f64::max);
        let every = here.len().div_ceil(MAX_POINTS).max(1);
        let curve = (-200..=200).map(|k| force(reach * f64::from(k) / 200.0));
        let measured = Layer::dots(1.0, points.step_by(every), PALETTE[5].alpha(0.5));
        let fitted = Layer::line(3.0, curve, PALETTE[1]);
        let layers = vec![
            measured.named("measured"),
            fitted.named(format!("fit at {:.1} kN", 1e-3 * mean)),
        ];
        let x = Axis::new("slip angle [degrees]").within([-reach, reach]);
        let y = Axis::new("lateral force [N]").within([-1.05 * most, 1.05 * most]);
        let range = format!("{:.1} to {:.1} kN", 1e-3 * low, 1e-3 * high);
        Panel::new(x, y, layers).titled(format!("{runner} runner, {range}"))
    };
    Figure::new(1500.0, "").row(420.0, [0, 1, 2].map(panel))
}
