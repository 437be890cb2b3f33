use kufe_contact::*;
use kufe_mesh::Paraboloid;
use std::sync::Arc;
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let a: Vec<f64> = std::env::args()
        .skip(1)
        .map(|s| s.parse().unwrap())
        .collect();
    let (r, s, fz, h, e) = (a[0], a[1], a[2], a[3], a[4]);
    let tilt = if a.get(7).is_some_and(|t| *t > 0.0) {
        Tilt::Free
    } else {
        Tilt::LEVEL
    };
    let mut ice = Ice::half_space(e, 0.33);
    ice.hardness = Some(h);
    let problem = Problem::new(
        Runner::rigid(Arc::new(Paraboloid::new(r, s)?)),
        ice,
        Load::central(fz, tilt),
    );
    let options = Options {
        cells: a.get(5).filter(|c| **c > 0.0).map(|c| *c as usize),
        p_max_tolerance: a.get(6).copied().unwrap_or(0.01),
        ..Options::default()
    };
    let t = std::time::Instant::now();
    let s = match slide(&problem, None, &options) {
        Ok(s) => s,
        Err(e) => {
            println!("{e}");
            return Ok(());
        }
    };
    println!("{:?}", t.elapsed());
    for m in &s.meshes {
        println!("{m:?}");
    }
    println!(
        "front {:?} back {:?}\ndepth {:?}\nmu {:.4e} +- {:.1e} (slope {:.4e})\nahead {:?} fz {} kkt {:.1e} p {} pitch {} A {}",
        s.front,
        s.back,
        s.groove_depth,
        s.ploughing.value / fz,
        s.ploughing.error / fz,
        s.meshes.last().unwrap().ploughing_by_slope / fz,
        s.load_ahead,
        s.contact.fz,
        s.contact.kkt_residual,
        s.contact.p_max,
        s.contact.pitch,
        s.contact.area
    );
    if a.len() > 8 {
        for q in &s.sections {
            println!("{:.5} {:.6} {:.4e}", q.x, q.width, q.pressure);
        }
    }
    Ok(())
}
