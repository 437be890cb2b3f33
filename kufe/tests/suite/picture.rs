//! Pictures of tables.

use std::path::Path;

use kufe::charts::{Slice, draw};
use kufe_lut::{Quantity, Table};

fn table(path: &str) -> Table {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path);
    Table::read(&mut std::fs::File::open(path).unwrap()).unwrap()
}

fn is_drawn(table: &Table, quantity: Quantity, slice: Slice) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(format!("{}.png", quantity.name()));
    draw(table, quantity, slice, &[], &path).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    assert!(bytes.starts_with(b"\x89PNG") && bytes.len() > 10_000);
    if let Ok(keep) = std::env::var("KUFE_KEEP_PICTURES") {
        std::fs::copy(&path, Path::new(&keep).join(path.file_name().unwrap())).unwrap();
    }
}

#[test]
fn every_quantity_is_drawn() {
    let table = table("assets/tables/front.lut");
    for &quantity in Quantity::of(false) {
        is_drawn(&table, quantity, Slice::default());
    }
}

#[test]
fn a_slice_of_a_sliding_table_is_drawn() {
    let slice = Slice {
        speed: Some(30.0),
        ..Slice::default()
    };
    is_drawn(&table("tests/data/film/front.lut"), Quantity::Mu, slice);
}
