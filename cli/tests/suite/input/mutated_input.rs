//! Readers on damaged files: valid ones with bytes changed, cut, doubled and swapped. No input may panic, hang or
//! make a reader take memory that the file does not justify. `KUFE_FUZZ_SECONDS` sets the time a reader gets. Hulls and
//! cases are here; `mutated_data.rs` has what the rest of the program reads.

use kufe::case::Case;
use std::io::Write;

use kufe_mesh::{
    BobRunner, HullFormat, HullOptions, check_hull, read_3mf, read_gltf, read_obj, read_stl,
    tessellate,
};

use crate::input::damage::rounds;

const EXAMPLE: &str = include_str!("../../../../kufe/assets/example.toml");

fn hull_seed(format: HullFormat) -> Vec<u8> {
    let runner = BobRunner {
        length: 0.05,
        height: 0.01,
        ..BobRunner::default()
    };
    let hull = tessellate(&runner.swept().expect("a runner"), 0.01).expect("a hull");
    let mut bytes = Vec::new();
    format.write(&hull, &mut bytes).expect("memory");
    bytes
}

#[test]
fn damaged_case_files_are_cases_or_errors_of_one_line() {
    rounds(
        "case",
        &[EXAMPLE.as_bytes().to_vec()],
        |bytes| match Case::parse(&String::from_utf8_lossy(bytes)) {
            Ok(case) => {
                let written = case.to_toml().expect("text");
                assert_eq!(Case::parse(&written).expect("a case"), case);
                true
            }
            Err(error) => {
                assert_eq!(error.to_string().lines().count(), 1, "{error}");
                false
            }
        },
    );
}

#[test]
fn damaged_obj_files_are_hulls_or_errors() {
    rounds("obj", &[hull_seed(HullFormat::Obj)], |bytes| {
        read_obj(bytes, &HullOptions::default()).is_ok_and(|hull| check_hull(&hull).is_ok())
    });
}

#[test]
fn damaged_stl_files_are_hulls_or_errors() {
    let text = b"solid s\nfacet normal 0 0 -1\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\nendloop\nendfacet\nendsolid s\n";
    rounds(
        "stl",
        &[hull_seed(HullFormat::Stl), text.to_vec()],
        |bytes| {
            read_stl(bytes, &HullOptions::default()).is_ok_and(|hull| check_hull(&hull).is_ok())
        },
    );
}

#[test]
fn damaged_gltf_files_are_hulls_or_errors() {
    let nothing = |_: &str| Err(std::io::ErrorKind::NotFound.into());
    rounds("gltf", &[hull_seed(HullFormat::Gltf)], |bytes| {
        read_gltf(bytes, &HullOptions::default(), nothing)
            .is_ok_and(|hull| check_hull(&hull).is_ok())
    });
}

#[test]
fn damaged_3mf_files_are_hulls_or_errors() {
    let text = "<?xml version=\"1.0\"?>\n<model unit=\"millimeter\" \
                xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"><resources><object id=\"1\" type=\"model\">\
                <mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"100\" y=\"0\" z=\"0\"/>\
                <vertex x=\"0\" y=\"10\" z=\"0\"/><vertex x=\"0\" y=\"0\" z=\"10\"/></vertices><triangles>\
                <triangle v1=\"0\" v2=\"2\" v3=\"1\"/><triangle v1=\"0\" v2=\"1\" v3=\"3\"/>\
                <triangle v1=\"0\" v2=\"3\" v3=\"2\"/><triangle v1=\"1\" v2=\"2\" v3=\"3\"/></triangles></mesh></object>\
                </resources><build><item objectid=\"1\"/></build></model>";
    let seeds = [
        zip::CompressionMethod::Stored,
        zip::CompressionMethod::Deflated,
    ]
    .map(|method| {
        let mut package = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
        let options = zip::write::SimpleFileOptions::default().compression_method(method);
        package
            .start_file("3D/3dmodel.model", options)
            .expect("memory");
        package.write_all(text.as_bytes()).expect("memory");
        package.finish().expect("memory").into_inner()
    });
    rounds("3mf", &seeds, |bytes| {
        read_3mf(bytes, &HullOptions::default()).is_ok()
    });
}
