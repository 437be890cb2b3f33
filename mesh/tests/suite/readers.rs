//! Readers neither panic nor allocate more than their input, whatever the bytes.

use kufe_mesh::{
    BobRunner, FittedUnderside, HeightMap, HullFormat, HullOptions, TensorGrid, check_hull,
    read_3mf, read_gltf, read_gmsh, read_obj, read_stl, read_vtu, tessellate, write_vtu,
};
use proptest::{collection::vec, prelude::*};

fn read_all(bytes: &[u8]) {
    let options = HullOptions::default();
    let hulls = [
        read_obj(bytes, &options),
        read_stl(bytes, &options),
        read_3mf(bytes, &options),
        read_gltf(
            bytes,
            &options,
            |_| Err(std::io::ErrorKind::NotFound.into()),
        ),
    ];
    for hull in hulls.into_iter().flatten() {
        if check_hull(&hull).is_ok() {
            let _ = FittedUnderside::new(&hull, 0.0);
        }
    }
    for mesh in [read_vtu(bytes), read_gmsh(bytes)].into_iter().flatten() {
        mesh.quality();
    }
    let _ = HeightMap::from_csv(bytes);
}

/// Files that are right, for changes to start from.
fn right_files() -> Vec<Vec<u8>> {
    let runner = BobRunner {
        length: 0.2,
        ..Default::default()
    }
    .swept()
    .unwrap();
    let hull = tessellate(&runner, 0.01).unwrap();
    let mut files: Vec<Vec<u8>> = [HullFormat::Obj, HullFormat::Gltf, HullFormat::Stl]
        .map(|format| {
            let mut file = Vec::new();
            format.write(&hull, &mut file).unwrap();
            file
        })
        .into();
    let mesh = TensorGrid {
        x: vec![0.0, 1.0, 2.0],
        y: vec![0.0, 1.0],
        z: vec![0.0, 1.0],
    }
    .hex_mesh();
    let mut vtu = Vec::new();
    write_vtu(&mesh, &[], &[], &[], &mut vtu).unwrap();
    files.push(vtu);
    files.push(b"x_m,y_m,z_m\n0,0,1\n1,0,1\n0,1,1\n1,1,2\n".to_vec());
    let nodes = "1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 2\n6 1 0 2\n7 1 1 2\n8 0 1 2\n";
    let gmsh = format!(
        "$MeshFormat\n2.2 0 8\n$Nodes\n8\n{nodes}$EndNodes\n$Elements\n1\n1 5 0 1 2 3 4 5 6 7 8\n"
    );
    files.push(gmsh.into_bytes());
    files
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn arbitrary_bytes_are_read_or_refused(bytes in vec(any::<u8>(), 0..2000)) {
        read_all(&bytes);
    }

    #[test]
    fn arbitrary_bytes_behind_a_right_beginning_are_read_or_refused(
        start in prop::sample::select(vec![
            &b"glTF\x02\0\0\0"[..], b"solid x\n", b"solid x\nfacet vertex ", b"v 0 0 0\nf ", b"$MeshFormat\n4.1 0 8\n$Nodes\n",
            b"<VTKFile type=\"UnstructuredGrid\"><AppendedData encoding=\"raw\">_", b"x_m,y_m,z_m\n",
        ]),
        bytes in vec(any::<u8>(), 0..500),
    ) {
        read_all(&[start, &bytes].concat());
    }

    #[test]
    fn changed_files_are_read_or_refused(
        file in 0usize..6,
        changes in vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        cut in any::<prop::sample::Index>(),
        cuts in any::<bool>(),
    ) {
        thread_local!(static FILES: Vec<Vec<u8>> = right_files());
        let mut bytes = FILES.with(|files| files[file].clone());
        for (place, value) in changes {
            let i = place.index(bytes.len());
            bytes[i] = value;
        }
        if cuts {
            bytes.truncate(cut.index(bytes.len()));
        }
        read_all(&bytes);
    }
}
