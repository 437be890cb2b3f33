//! The page of effects is what the catalogue gives.

use std::path::Path;

use kufe::case::effects::CATALOGUE;
use kufe_sled::effects::page::{tables, with_section};

#[test]
fn the_page_holds_the_catalogue() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/effects.md");
    let stands = std::fs::read_to_string(&path).unwrap();
    let rows = CATALOGUE.iter().map(|effect| effect.info());
    let wanted = with_section(&stands, "effects on pressures", &tables(rows));
    let wanted = wanted.expect("the page has its marks");
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
