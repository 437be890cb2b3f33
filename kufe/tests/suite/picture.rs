//! Pictures of tables.

use std::path::Path;

use kufe::charts::table_picture;
use kufe_lut::{Point, Quantity, Table};

fn table(path: &str) -> Table {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path);
    Table::read(&mut std::fs::File::open(path).unwrap()).unwrap()
}

fn is_drawn(table: &Table, quantity: Quantity, slice: Point) {
    let picture = table_picture(table, quantity, slice, &[]).unwrap();
    let bytes = picture.figure.png();
    assert!(bytes.starts_with(b"\x89PNG") && bytes.len() > 10_000);
    if let Ok(keep) = std::env::var("KUFE_KEEP_PICTURES") {
        let name = format!("{}.png", quantity.name());
        std::fs::write(Path::new(&keep).join(name), bytes).unwrap();
    }
}

#[test]
fn every_quantity_is_drawn() {
    let table = table("assets/tables/front.lut");
    for &quantity in Quantity::of(false) {
        is_drawn(&table, quantity, Point::default());
    }
}

#[test]
fn a_slice_of_a_sliding_table_is_drawn() {
    let slice = Point {
        speed: Some(30.0),
        ..Point::default()
    };
    is_drawn(&table("tests/data/film/front.lut"), Quantity::Mu, slice);
}
