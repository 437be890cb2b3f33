//! Foreign tables: what they make a reader allocate, and what they can put into an export.

use std::io::{Cursor, Read, Write};

use crate::tables::table;
use kufe_lut::{Table, read_fmu};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// A start and then one entry for ever.
struct Endless {
    start: Cursor<Vec<u8>>,
    entry: &'static [u8],
    at: usize,
    read: usize,
}

impl Endless {
    fn new(start: &str, entry: &'static str) -> Self {
        Endless {
            start: Cursor::new(start.into()),
            entry: entry.as_bytes(),
            at: 0,
            read: 0,
        }
    }
}

impl Read for Endless {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let mut read = self.start.read(buffer)?;
        for byte in &mut buffer[read..] {
            *byte = self.entry[self.at];
            self.at = (self.at + 1) % self.entry.len();
            read += 1;
        }
        self.read += read;
        Ok(read)
    }
}

#[test]
fn lists_without_end_are_refused_before_they_are_large() {
    const LARGEST: usize = 64 << 20;
    for (start, entry) in [
        ("", "[0,"),
        ("{\"axes\":[", "0,"),
        ("{\"axes\":[{\"values\":[", "0,"),
        ("{\"axes\":[{\"values\":[", "[],"),
        (
            "{\"axes\":[",
            "{\"name\":\"\",\"unit\":\"\",\"values\":[0]},",
        ),
        ("{\"quantities\":{\"p_max\":{\"values\":[[", "0,"),
        ("{\"quantities\":{\"p_max\":{\"values\":[", "[0,1,2],"),
        ("{\"method\":[", "\"finite-elements\","),
        ("{\"checks\":[", "{},"),
    ] {
        let mut endless = Endless::new(start, entry);
        assert!(Table::read(&mut endless).is_err());
        assert!(endless.read < LARGEST, "{start} {entry}: {}", endless.read);
    }
}

#[test]
fn a_small_fmu_that_expands_to_a_long_list_is_refused() {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    zip.start_file("resources/table.lut", options).unwrap();
    zip.write_all(b"{\"axes\":[{\"values\":[").unwrap();
    let zeros = b"0,".repeat(1 << 20);
    (0..50).for_each(|_| zip.write_all(&zeros).unwrap());
    let fmu = zip.finish().unwrap().into_inner();
    assert!(fmu.len() < 1 << 20);
    let error = read_fmu(Cursor::new(fmu)).unwrap_err().to_string();
    assert!(error.contains("expected at most 4096 entries"), "{error}");
}

#[test]
fn a_name_from_outside_stays_a_name_in_every_export() {
    let table = table(false);
    let name = "a*/ int evil; /*\r\nsystem('x')\u{85}\u{2028}'<&\">";
    let mut text = Vec::new();
    table.write_header(name, None, &mut text).unwrap();
    table.write_s_function(name, None, &mut text).unwrap();
    table.write_simulink_script(name, &mut text).unwrap();
    table.write_ctypes(name, &mut text).unwrap();
    table.write_csharp(name, &mut text).unwrap();
    let text = String::from_utf8(text).unwrap();
    for foreign in ["int evil", "system('x", "\u{85}", "\u{2028}", "\r"] {
        assert!(!text.contains(foreign), "{foreign:?}");
    }
    let mut fmu = Vec::new();
    if table
        .write_fmu(name, None, kufe_lut::Fmi::V3, &mut fmu)
        .is_err()
    {
        return;
    }
    let mut archive = zip::ZipArchive::new(Cursor::new(fmu)).unwrap();
    let mut description = String::new();
    let mut file = archive.by_name("modelDescription.xml").unwrap();
    file.read_to_string(&mut description).unwrap();
    let escaped =
        "modelName=\"a*/ int evil; /*system(&apos;x&apos;)\u{2028}&apos;&lt;&amp;&quot;&gt;\"";
    assert!(description.contains(escaped), "{description}");
}
