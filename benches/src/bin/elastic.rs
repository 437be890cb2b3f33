//! Elastic runners: iterations over the gallery.

use std::sync::Arc;
use std::time::Instant;

use kufe_contact::{
    ElasticRunner, Foundation, Ice, Load, LoadedPlace, Mount, Options, Place, Problem, Runner,
    Tilt, solve,
};
use kufe_mesh::{BobRunner, LugeSteel, Underside};

fn main() {
    let bob = |rocker: f64, section: f64| -> (Arc<dyn Underside>, f64) {
        let b = BobRunner {
            rocker_radius: rocker,
            section_radius: section,
            width: 0.01_f64.min(2.0 * section),
            ..BobRunner::default()
        };
        (Arc::new(b.swept().unwrap()), b.height)
    };
    let luge = |rocker: f64, tilt: f64| -> (Arc<dyn Underside>, f64) {
        let b = LugeSteel {
            rocker_radius: rocker,
            tilt,
            ..LugeSteel::default()
        };
        (Arc::new(b.swept().unwrap()), b.height)
    };
    let only: Option<usize> = std::env::args().nth(1).and_then(|a| a.parse().ok());
    let cases = [
        ("bob round", bob(30.0, 0.005), 0.0),
        ("bob sharp", bob(30.0, 0.002), 0.0),
        ("bob low rocker", bob(20.0, 0.005), 0.0),
        ("bob high rocker", bob(45.0, 0.005), 0.0),
        ("bob valley 40", bob(30.0, 0.005), 1.0 / 40.0),
        ("bob valley 20", bob(30.0, 0.005), 1.0 / 20.0),
        ("luge", luge(25.0, 0.02), 0.0),
        ("luge tilt .1", luge(25.0, 0.1), 0.0),
        ("luge valley 40", luge(25.0, 0.02), 1.0 / 40.0),
    ];
    for (index, (name, (underside, top), curvature)) in cases.into_iter().enumerate() {
        if only.is_some_and(|o| o != index) {
            continue;
        }
        for kind in [0, 1, 2, 3] {
            let elastic = ["rigid", "top", "places", "loads"][kind];
            let problem = Problem {
                runner: Runner {
                    underside: underside.clone(),
                    elastic: (kind > 0).then(|| ElasticRunner {
                        flank: std::env::var("FLANK").ok().and_then(|f| f.parse().ok()),
                        mount: mount(kind, index >= 6),
                        ..ElasticRunner::held_at_top(210e9, 0.3, top)
                    }),
                },
                ice: Ice {
                    youngs_modulus: 9e9,
                    poissons_ratio: 0.33,
                    foundation: Foundation::HalfSpace,
                    hardness: None,
                },
                track_curvature: curvature,
                load: Load::Force {
                    fz: 1000.0,
                    offset_x: 0.0,
                    offset_y: 0.0,
                    tilt: if kind == 3 {
                        Tilt::Free
                    } else {
                        Tilt::Fixed {
                            pitch: 0.0,
                            roll: 0.0,
                        }
                    },
                },
            };
            let begun = Instant::now();
            let cells = std::env::args()
                .nth(2)
                .and_then(|a| a.parse().ok())
                .unwrap_or(8);
            match solve(
                &problem,
                &Options {
                    cells: Some(cells),
                    ..Options::default()
                },
            ) {
                Ok(s) => println!(
                    "{name} {elastic}: its {} dofs {} runner nodes {} p {:.2} MPa ({:?} sets) {:.2} s",
                    s.iterations,
                    s.dofs,
                    s.runner_volume.as_ref().map_or(0, |r| r.displacement.len()),
                    s.p_max / 1e6,
                    s.history
                        .iter()
                        .map(|h| (h.contact_nodes, h.iterations))
                        .collect::<Vec<_>>(),
                    begun.elapsed().as_secs_f64()
                ),
                Err(e) => println!("{name} {elastic}: {e}"),
            }
        }
    }
}

fn mount(kind: usize, luge: bool) -> Mount {
    let (x, length) = if luge { (0.15, 0.012) } else { (0.25, 0.04) };
    let places = [-x, x].map(|x| Place { x, length });
    match kind {
        1 => Mount::Top,
        2 => Mount::Places(places.to_vec()),
        _ => Mount::Loads(
            places
                .map(|place| LoadedPlace { place, share: 0.5 })
                .to_vec(),
        ),
    }
}
