//! Tables as C code.

use crate::c::run_c;
use crate::tables::{reduced, table};
use kufe_lut::{Error, Fmi, Interpolator, Mode, Point, Quantity, Table};
use std::fmt::Write as _;

#[test]
fn the_header_compiles_and_computes_what_the_library_computes() {
    let folder = tempfile::tempdir().unwrap();
    let (front, rear, flush) = (table(false), table(true), reduced());
    let write = |table: &Table, name: &str, radius| {
        let mut file = std::fs::File::create(folder.path().join(format!("{name}.h"))).unwrap();
        table.write_header(name, radius, &mut file).unwrap();
    };
    write(&front, "front", None);
    write(&rear, "2-rear", Some(25.0));
    write(&flush, "flush", None);
    let mut points = Vec::new();
    for i in 0..40 {
        for j in 0..40 {
            points.push((100.0 * 1.13f64.powi(i), -0.025 + 0.0015 * f64::from(j)));
        }
    }
    points.extend([
        (200.0, 0.0),
        (8000.0, 0.028),
        (1e300, -1.0),
        (f64::NAN, 0.0),
        (500.0, f64::NAN),
    ]);
    let mut main = String::from(
        "#include <stdio.h>\n#include \"front.h\"\n#include \"2-rear.h\"\n#include \"flush.h\"\n\
         static void show(kufe_lut_interpolated l) { printf(\"%.17g %d\\n\", l.value, l.out_of_range); }\n\
         int main(void) {\n  static const double at[][2] = {\n",
    );
    for (fz, curvature) in &points {
        let c = |v: &f64| {
            if v.is_nan() {
                "NAN".into()
            } else {
                format!("{v:e}")
            }
        };
        writeln!(main, "    {{ {}, {} }},", c(fz), c(curvature)).unwrap();
    }
    main += "  };\n  for (unsigned n = 0; n < sizeof at / sizeof at[0]; ++n) {\n";
    for own in ["front", "lut_2_rear", "flush"] {
        for quantity in Quantity::of(false) {
            for mode in Mode::ALL {
                writeln!(
                    main,
                    "    show({own}_{}_{}(at[n][0], at[n][1]));",
                    quantity.name(),
                    mode.name()
                )
                .unwrap();
            }
        }
    }
    main +=
        "  }\n  printf(\"%.17g\\n\", kufe_lut_curvature_from_pitch(31.0, -0.7));\n  return 0;\n}\n";
    std::fs::write(folder.path().join("main.c"), main).unwrap();
    let Some(text) = run_c(folder.path(), "main.c", &[], "") else {
        return;
    };
    let mut lines = text.lines();
    let lookups: Vec<(bool, Interpolator)> = [(&front, None), (&rear, Some(25.0)), (&flush, None)]
        .into_iter()
        .flat_map(|(table, radius)| {
            Quantity::of(false).iter().flat_map(move |&quantity| {
                Mode::ALL.map(|mode| {
                    let exact = mode == Mode::Bilinear && table.axes().flush().is_none();
                    let lookup = Interpolator::new(table, quantity, mode, radius);
                    (exact, lookup.unwrap())
                })
            })
        })
        .collect();
    for &(fz, curvature) in &points {
        for (exact, lookup) in &lookups {
            let (value, flag) = lines.next().unwrap().split_once(' ').unwrap();
            let value: f64 = value.parse().unwrap();
            let own = lookup.at(Point::at_rest(fz, curvature));
            assert_eq!(flag == "1", own.out_of_range);
            if own.value.is_nan() {
                assert!(value.is_nan());
            } else {
                // The same operations in the same order; only log and exp may come from another
                // libm.
                assert!(
                    (value / own.value - 1.0).abs() < 1e-14,
                    "{value} {}",
                    own.value
                );
                if *exact {
                    assert_eq!(value, own.value);
                }
            }
        }
    }
    let curvature: f64 = lines.next().unwrap().parse().unwrap();
    assert_eq!(curvature, kufe_lut::curvature_from_pitch(31.0, -0.7));
}

#[test]
fn an_export_of_a_rocker_table_needs_one_of_its_radii() {
    let table = table(true);
    let failed = |radius| {
        table
            .write_header("front", radius, &mut Vec::new())
            .unwrap_err()
    };
    assert!(matches!(failed(None), Error::RockerNeeded { .. }));
    assert!(failed(Some(24.0)).to_string().contains("20, 25, 30"));
    assert!(
        table
            .write_fmu("front", Some(25.0), Fmi::V2, &mut Vec::new())
            .is_ok()
    );
}
