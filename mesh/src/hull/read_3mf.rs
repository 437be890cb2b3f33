//! Hulls from 3MF files.

use std::collections::HashMap;
use std::fmt::Display;
use std::io::{Cursor, Read};
use std::str::FromStr;

use nalgebra::Matrix4;
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use zip::ZipArchive;

use crate::error::MeshError;
use crate::hull::text::unreadable;
use crate::hull::triangles::{Axis, Hull, HullOptions, PlacedMeshes, at_most};

/// Largest unpacked size of all parts of a file together [bytes]: about three million triangles,
/// which take half a gigabyte of memory.
const MAX_BYTES: u64 = 1 << 28;
/// Unpacked bytes per triangle, including its share of the vertices, in a large file.
const BYTES_PER_TRIANGLE: u64 = 48;
/// Largest number of uses of objects in one file, including uses within components.
const MAX_USES: usize = 100_000;
/// The part that holds the model if the package's relationships name none.
const USUAL_MODEL: &str = "3D/3dmodel.model";

/// Reads the build items of a 3MF file with their transforms, in the unit that the file states.
///
/// The positions in metres are multiplied by `options.scale`. The file's up is z unless `options`
/// state another axis.
///
/// # Errors
/// [`MeshError::Value`] with the part of the package, [`MeshError::Invalid`] if its parts unpack to
/// more than 256 MiB (some three million triangles) or its objects, each used many times, make more
/// than a million triangles and more than its parts can hold, and those of a hull without triangles
/// or with positions that are not finite.
pub fn read_3mf(bytes: &[u8], options: &HullOptions) -> Result<Hull, MeshError> {
    let rows = options.rows(Axis::Z)?;
    let mut package = Package::open(bytes)?;
    let root = package.root_model()?;
    let unit = package.model(&root)?.unit;
    let mut placed = PlacedMeshes::default();
    let items = package.model(&root)?.items.clone();
    let scaled = items.into_iter().rev().map(|item| {
        let transform = Matrix4::new_scaling(unit) * item.transform;
        (item, transform)
    });
    let mut waiting: Vec<(Use, Matrix4<f64>)> = scaled.collect();
    let mut uses = 0;
    while let Some((found, transform)) = waiting.pop() {
        uses += 1;
        let part = found.part.as_deref().unwrap_or(&root).to_owned();
        package.model(&part)?;
        placed.capacity = ((MAX_BYTES - package.budget) / BYTES_PER_TRIANGLE) as usize;
        let object = package.models[&part].objects.get(&found.object);
        let object = object.ok_or_else(|| {
            let found = format!("object {}", found.object);
            error(&part, found, "an object of the model")
        })?;
        let known = uses + waiting.len() + object.components.len();
        at_most(MAX_USES, known, "uses of objects")?;
        let triangles = object.triangles.iter().copied();
        placed.add(&object.vertices, triangles, &transform)?;
        // Components without a part of their own are in the part of their object.
        waiting.extend(object.components.iter().rev().map(|component| {
            let mut component = component.clone();
            component.part.get_or_insert_with(|| part.clone());
            let transform = transform * component.transform;
            (component, transform)
        }));
    }
    placed.welded(rows)
}

/// An object used by a build item or as a component.
#[derive(Clone)]
struct Use {
    /// The part of the package that holds the object; `None` for the part that uses it.
    part: Option<String>,
    object: String,
    transform: Matrix4<f64>,
}

/// A mesh, or components.
#[derive(Default)]
struct Object {
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[usize; 3]>,
    components: Vec<Use>,
}

/// A part of the package with its objects.
struct Model {
    /// Length of one unit [m].
    unit: f64,
    objects: HashMap<String, Object>,
    items: Vec<Use>,
}

/// The zip archive with the models read so far.
struct Package<'a> {
    archive: ZipArchive<Cursor<&'a [u8]>>,
    /// Bytes that may still be unpacked.
    budget: u64,
    /// Number of objects, components and build items read.
    declared: usize,
    models: HashMap<String, Model>,
}

impl<'a> Package<'a> {
    fn open(bytes: &'a [u8]) -> Result<Self, MeshError> {
        let archive = ZipArchive::new(Cursor::new(bytes))
            .map_err(|source| error("the file", source, "a zip archive"))?;
        Ok(Self {
            archive,
            budget: MAX_BYTES,
            declared: 0,
            models: HashMap::new(),
        })
    }

    /// The unpacked bytes of a part; `None` if the archive has no part of that name.
    fn unpack(&mut self, part: &str) -> Result<Option<Vec<u8>>, MeshError> {
        let wanted = part.to_ascii_lowercase();
        let mut names = self.archive.file_names().flatten();
        let name = names.find(|name| name.to_ascii_lowercase() == wanted);
        let Some(name) = name.map(|name| name.into_owned()) else {
            return Ok(None);
        };
        drop(names);
        let broken = |source: &dyn Display| error(part, source, "a part that unpacks");
        let mut bytes = Vec::new();
        let file = self.archive.by_name(&name).map_err(|e| broken(&e))?;
        let mut file = file.take(self.budget + 1);
        file.read_to_end(&mut bytes).map_err(|e| broken(&e))?;
        if bytes.len() as u64 > self.budget {
            return Err(MeshError::Invalid(format!(
                "the 3MF file unpacks to more than {} MiB: expected fewer triangles, or the hull as \
                 binary STL",
                MAX_BYTES >> 20
            )));
        }
        self.budget -= bytes.len() as u64;
        Ok(Some(bytes))
    }

    /// The name of the part with the build items.
    fn root_model(&mut self) -> Result<String, MeshError> {
        let relations = self.unpack("_rels/.rels")?.unwrap_or_default();
        let mut root = None;
        elements("_rels/.rels", &relations, |tag, _| {
            let kind = attribute(tag, "Type").unwrap_or_default();
            if tag.local_name().as_ref() == b"Relationship" && kind.ends_with("/3dmodel") {
                root = attribute(tag, "Target");
            }
            Ok(())
        })?;
        let root = root.unwrap_or_else(|| USUAL_MODEL.into());
        Ok(root.trim_start_matches('/').to_owned())
    }

    fn model(&mut self, part: &str) -> Result<&Model, MeshError> {
        if !self.models.contains_key(part) {
            let bytes = self.unpack(part)?;
            let bytes = bytes.ok_or_else(|| error(part, "no such part", "a model"))?;
            let model = Model::parse(part, &bytes, &mut self.declared)?;
            self.models.insert(part.to_owned(), model);
        }
        Ok(&self.models[part])
    }
}

impl Model {
    /// Adds the number of its objects, components and build items to `declared`.
    fn parse(part: &str, bytes: &[u8], declared: &mut usize) -> Result<Self, MeshError> {
        let mut model = Model {
            unit: 1e-3,
            objects: HashMap::new(),
            items: Vec::new(),
        };
        let mut current = String::new();
        elements(part, bytes, |tag, line| {
            let refuse = |name: &str, expected| {
                let found = attribute(tag, name).unwrap_or_default();
                error(part, format!("{name}={found:?} near byte {line}"), expected)
            };
            if let b"object" | b"component" | b"item" = tag.local_name().as_ref() {
                *declared += 1;
                at_most(MAX_USES, *declared, "objects, components and build items")?;
            }
            match tag.local_name().as_ref() {
                b"model" => {
                    if let Some(unit) = attribute(tag, "unit") {
                        let known = UNITS.iter().find(|(name, _)| *name == unit);
                        let expected = "micron, millimeter, centimeter, inch, foot or meter";
                        (_, model.unit) = *known.ok_or_else(|| refuse("unit", expected))?;
                    }
                }
                b"object" => {
                    current = attribute(tag, "id").unwrap_or_default();
                    model.objects.insert(current.clone(), Object::default());
                }
                b"vertex" => {
                    let wrong = |name: &str| refuse(name, "a coordinate");
                    let vertex = three(tag, ["x", "y", "z"], wrong)?;
                    model.object(&current).vertices.push(vertex);
                }
                b"triangle" => {
                    let wrong = |name: &str| refuse(name, "the number of a vertex");
                    let triangle = three(tag, ["v1", "v2", "v3"], wrong)?;
                    model.object(&current).triangles.push(triangle);
                }
                name @ (b"component" | b"item") => {
                    let text = attribute(tag, "transform");
                    let transform = text.map_or(Some(Matrix4::identity()), |t| transform(&t));
                    let path = attribute(tag, "path");
                    let found = Use {
                        part: path.map(|path| path.trim_start_matches('/').into()),
                        object: attribute(tag, "objectid").unwrap_or_default(),
                        transform: transform
                            .ok_or_else(|| refuse("transform", "twelve numbers"))?,
                    };
                    if name == b"item" {
                        model.items.push(found);
                    } else {
                        model.object(&current).components.push(found);
                    }
                }
                _ => {}
            }
            Ok(())
        })?;
        Ok(model)
    }

    fn object(&mut self, id: &str) -> &mut Object {
        self.objects.entry(id.to_owned()).or_default()
    }
}

/// Calls `visit` with each start tag of an XML document and the bytes read up to it.
fn elements(
    part: &str,
    bytes: &[u8],
    mut visit: impl FnMut(&BytesStart, u64) -> Result<(), MeshError>,
) -> Result<(), MeshError> {
    let mut reader = Reader::from_reader(bytes);
    loop {
        match reader.read_event() {
            Ok(Event::Eof) => return Ok(()),
            Ok(Event::Start(tag) | Event::Empty(tag)) => visit(&tag, reader.buffer_position())?,
            Ok(_) => {}
            Err(source) => {
                let found = format!("{source} near byte {}", reader.error_position());
                return Err(error(part, found, "well-formed XML"));
            }
        }
    }
}

/// The value of the attribute of this name, whatever its namespace.
fn attribute(tag: &BytesStart, name: &str) -> Option<String> {
    let mut attributes = tag.attributes().flatten();
    let found = attributes.find(|a| a.key.local_name().as_ref() == name.as_bytes())?;
    found.unescape_value().ok().map(|value| value.into_owned())
}

/// The numbers of three attributes.
fn three<T: FromStr>(
    tag: &BytesStart,
    names: [&str; 3],
    wrong: impl Fn(&str) -> MeshError,
) -> Result<[T; 3], MeshError> {
    let [a, b, c] = names.map(|name| {
        let number = attribute(tag, name).and_then(|text| text.trim().parse().ok());
        number.ok_or_else(|| wrong(name))
    });
    Ok([a?, b?, c?])
}

/// Metres in the units of a model.
const UNITS: [(&str, f64); 6] = [
    ("micron", 1e-6),
    ("millimeter", 1e-3),
    ("centimeter", 1e-2),
    ("inch", 0.0254),
    ("foot", 0.3048),
    ("meter", 1.0),
];

/// The matrix of twelve numbers: the images of the three axes and of the origin.
fn transform(text: &str) -> Option<Matrix4<f64>> {
    let numbers: Result<Vec<f64>, _> = text.split_whitespace().map(str::parse).collect();
    let numbers = numbers.ok()?;
    (numbers.len() == 12).then(|| {
        Matrix4::from_fn(|row, column| match row {
            3 => f64::from(u8::from(column == 3)),
            _ => numbers[3 * column + row],
        })
    })
}

fn error(part: &str, found: impl Display, expected: &str) -> MeshError {
    unreadable("3MF", part, found, expected)
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use zip::ZipWriter;
    use zip::write::SimpleFileOptions;

    use super::*;

    const MESH: &str = r#"<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1e0" y="0" z="0"/><vertex x="0" y="1" z="0"/>
        </vertices><triangles><triangle v1="0" v2="1" v3="2"/></triangles></mesh>"#;

    fn package(parts: &[(&str, String)]) -> Vec<u8> {
        let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, text) in parts {
            archive
                .start_file(*name, SimpleFileOptions::default())
                .unwrap();
            archive.write_all(text.as_bytes()).unwrap();
        }
        archive.finish().unwrap().into_inner()
    }

    fn model(unit: &str, objects: &str, build: &str) -> String {
        format!(
            r#"<?xml version="1.0"?><model {unit} xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">
               <resources>{objects}</resources><build>{build}</build></model>"#
        )
    }

    fn read(text: String) -> Result<Hull, MeshError> {
        read_3mf(&package(&[(USUAL_MODEL, text)]), &HullOptions::default())
    }

    #[test]
    fn units_and_transforms_are_applied() {
        let object = format!(r#"<object id="1" type="model">{MESH}</object>"#);
        let item = r#"<item objectid="1"/>"#;
        for (unit, metres) in [
            ("", 1e-3),
            (r#"unit="millimeter""#, 1e-3),
            (r#"unit="inch""#, 0.0254),
            (r#"unit="meter""#, 1.0),
        ] {
            let hull = read(model(unit, &object, item)).unwrap();
            assert_eq!(hull.positions[1], [metres, 0.0, 0.0], "{unit}");
        }
        // A component scaled by two along x and moved by five along z, mirrored along y by the
        // build.
        let parts = format!(
            r#"{object}<object id="2"><components>
               <component objectid="1" transform="2 0 0 0 1 0 0 0 1 0 0 5"/></components></object>"#
        );
        let mirrored = r#"<item objectid="2" transform="1 0 0 0 -1 0 0 0 1 10 0 0"/>"#;
        let hull = read(model(r#"unit="meter""#, &parts, mirrored)).unwrap();
        assert_eq!(hull.bounds(), [[10.0, -1.0, 5.0], [12.0, 0.0, 5.0]]);
        assert_eq!(hull.normal(&hull.triangles[0])[2], 2.0);
    }

    #[test]
    fn models_are_found_by_relationship_and_path() {
        let other = r#"xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06""#;
        let root = model(
            other,
            r#"<object id="8"><components><component p:path="/3D/Objects/one.model" objectid="1"/></components></object>"#,
            r#"<item objectid="8"/>"#,
        );
        let relations = r#"<Relationships><Relationship Target="/3D/root.model" Id="rel0"
            Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>"#;
        let object = format!(r#"<object id="1">{MESH}</object>"#);
        let bytes = package(&[
            ("_rels/.rels", relations.into()),
            ("3D/root.model", root),
            ("3D/Objects/one.model", model("", &object, "")),
        ]);
        let hull = read_3mf(&bytes, &HullOptions::default()).unwrap();
        assert_eq!(hull.triangles, [[0, 1, 2]]);
    }

    #[test]
    fn an_object_used_too_often_is_refused() {
        let triangle = r#"<triangle v1="0" v2="1" v3="2"/>"#;
        let mesh = MESH.replace(triangle, &triangle.repeat(1000));
        let object = format!(r#"<object id="1">{mesh}</object>"#);
        let text = model("", &object, &r#"<item objectid="1"/>"#.repeat(1001));
        let message = read(text).unwrap_err().to_string();
        assert!(message.contains("more than 1000000 triangles"), "{message}");
    }

    #[test]
    fn broken_files_are_refused() {
        let object = format!(r#"<object id="1">{MESH}</object>"#);
        let item = r#"<item objectid="1"/>"#;
        let circle =
            r#"<object id="1"><components><component objectid="1"/></components></object>"#;
        for (text, part) in [
            (model("", &object, r#"<item objectid="7"/>"#), "object 7"),
            (model(r#"unit="ell""#, &object, item), "ell"),
            (
                model("", &object.replace("v3=\"2\"", "v3=\"9\""), item),
                "refers to vertex 9",
            ),
            (model("", &object.replace("1e0", "1,0"), item), "1,0"),
            (model("", circle, item), "uses of objects"),
            (
                model("", &object, &item.repeat(MAX_USES)),
                "more than 100000 objects",
            ),
            (model("", &object, ""), "no triangles"),
            ("<model><<".into(), "well-formed"),
        ] {
            let message = read(text).unwrap_err().to_string();
            assert!(message.contains(part), "{message}");
        }
        let message = |bytes: &[u8]| {
            read_3mf(bytes, &HullOptions::default())
                .unwrap_err()
                .to_string()
        };
        assert!(message(b"no zip").contains("zip archive"));
        assert!(message(&package(&[])).contains("3D/3dmodel.model"));
    }
    #[test]
    fn a_file_that_unpacks_to_too_much_is_refused_with_what_to_do()
    -> Result<(), Box<dyn std::error::Error>> {
        let bytes = package(&[(USUAL_MODEL, " ".repeat(100))]);
        let mut file = Package::open(&bytes)?;
        file.budget = 99;
        let error = file.model(USUAL_MODEL).err().ok_or("it was read")?;
        assert_eq!(
            error.to_string(),
            "the 3MF file unpacks to more than 256 MiB: expected fewer triangles, or the hull as \
             binary STL"
        );
        Ok(())
    }
}
