//! The page of effects is what the catalogue gives.

use std::path::Path;

use kufe_sled::effects::{CATALOGUE, columns_of_forces, columns_of_sensors, page};

#[test]
fn the_page_holds_the_catalogue() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/effects.md");
    let stands = std::fs::read_to_string(&path).unwrap();
    let columns = format!(
        "On forces: `{}`. On a sensor: `{}`.\n",
        columns_of_forces().join(" "),
        columns_of_sensors().join(" ")
    );
    let tables = page::tables(CATALOGUE.iter().map(|effect| &effect.info));
    let wanted = page::with_section(&stands, "effects of the sled", &tables)
        .and_then(|page| page::with_section(&page, "columns of expressions", &columns))
        .expect("the page has its marks");
    if std::env::var_os("KUFE_WRITE_DOCS").is_some() {
        std::fs::write(&path, wanted).unwrap();
        return;
    }
    assert!(
        stands == wanted,
        "docs/effects.md is not what the files of the effects say; write it anew: \
         KUFE_WRITE_DOCS=1 cargo test --release -p kufe-sled -p kufe page"
    );
}
