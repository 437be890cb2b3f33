//! The picture of a table.

use kufe_lut::{Plan, Quantity, Slice, Spacing, draw, sweep};

#[test]
fn every_quantity_is_drawn() {
    let plan = Plan::new(
        Spacing::Range {
            from: 200.0,
            to: 8000.0,
        },
        Spacing::Range {
            from: -0.02,
            to: 0.03,
        },
    );
    let swept = sweep(&plan, |p| {
        Ok::<_, std::convert::Infallible>(crate::hertz::runner(p))
    })
    .unwrap();
    let folder = tempfile::tempdir().unwrap();
    for &quantity in Quantity::of(false) {
        let path = folder.path().join(format!("{}.png", quantity.name()));
        draw(&swept.table, quantity, Slice::default(), &[], &path).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        assert!(bytes.starts_with(b"\x89PNG") && bytes.len() > 10_000);
        if let Ok(keep) = std::env::var("KUFE_KEEP_PICTURES") {
            std::fs::copy(
                &path,
                std::path::Path::new(&keep).join(path.file_name().unwrap()),
            )
            .unwrap();
        }
    }
}

#[test]
fn a_table_of_one_node_can_be_drawn() {
    let plan = Plan::new(Spacing::Values(vec![500.0]), Spacing::Values(vec![0.0]));
    let swept = sweep(&plan, |p| {
        Ok::<_, std::convert::Infallible>(crate::hertz::runner(p))
    })
    .unwrap();
    let folder = tempfile::tempdir().unwrap();
    draw(
        &swept.table,
        Quantity::PMax,
        Slice::default(),
        &[],
        &folder.path().join("one.png"),
    )
    .unwrap();
}
