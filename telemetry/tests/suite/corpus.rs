//! Odd files as loggers, spreadsheets and their users write them, each with its right reading.

use std::path::Path;

use kufe_telemetry::{TextOptions, read_recording};

const N: f64 = f64::NAN;

/// A channel, its unit, and its values.
type Expected<'a> = (&'a str, &'a str, &'a [f64]);

/// Whether a file is read as expected; what is found else.
fn reading(folder: &Path, name: &str, bytes: &[u8], expected: &[Expected]) -> Result<(), String> {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    let log = read_recording(&path, TextOptions::default()).map_err(|error| error.to_string())?;
    for (channel, unit, values) in expected {
        let place = log.find(channel, name).map_err(|error| error.to_string())?;
        let found = &log.channels[place];
        let same = |(a, b): (&f64, &f64)| a.is_nan() && b.is_nan() || (a - b).abs() < 1e-6;
        let equal =
            found.values.len() == values.len() && found.values.iter().zip(*values).all(same);
        if !equal || found.unit.as_deref().unwrap_or("") != *unit {
            return Err(format!("{channel}: {:?} {:?}", found.unit, &found.values));
        }
    }
    Ok(())
}

fn utf16(text: &str, mark: bool, of: fn(u16) -> [u8; 2]) -> Vec<u8> {
    let mark = if mark { "\u{feff}" } else { "" };
    format!("{mark}{text}")
        .encode_utf16()
        .flat_map(of)
        .collect()
}

const AIM: &str = "\"Format\",\"AiM CSV File\"\n\"Venue\",\"Igls\"\n\"Sample Rate\",\"20\"\n\"Duration\",\"123.4\"\n\
    \"Segment Times\",\"0:43.2\",\"0:44.1\"\n\"Beacon Markers\",\"43.2\",\"87.3\"\n\n\
    \"Time\",\"GPS Speed\",\"GPS LatAcc\"\n\"s\",\"km/h\",\"g\"\n\n\"0.000\",\"90.0\",\"0.1\"\n\"0.050\",\"91.0\",\"\"\n\"0.100\",\"92.0\",\"0.3\"\n";

const RACECHRONO: &str = "This file is created using RaceChrono v7.0.0 ( http://racechrono.com/ ).\nFormat,3\nSession title,\"Igls, run 2\"\n\
    Session type,Lap timing\nDriver name,\nCreated,01/02/2021,12:00\nNote,\n\n\
    timestamp,fragment_id,lap_number,elapsed_time,speed,speed,x_acc,speed\n\
    unix time,,,s,m/s,m/s,G,km/h\n,,,,100: gps,calc,101: acc,100: gps\n\
    1611933400.10,0,,0.0,25.0,25.1,0.1,90\n1611933400.20,0,1,0.1,26.0,,0.2,91\n1611933460.00,1,1,59.9,27.0,27.1,0.3,92\n";

const MOTEC: &str = "\"Format\",\"MoTeC CSV File\",,,\"Workbook\",\"\"\n\"Venue\",\"Igls\",,,\"Worksheet\",\"\"\n\"Log Date\",\"01/02/2021\",,,\"\",\"\"\n\
    \"Sample Rate\",\"100.000\",\"Hz\",,\"\",\"\"\n\"Duration\",\"60.1\",\"s\",,\"\",\"\"\n\"Range\",\"entire outing\",,,\"\",\"\"\n\"Beacon Markers\",\"\",,,\"\",\"\"\n\n\
    \"Time\",\"Distance\",\"Ground Speed\",\"G Force Lat\",\"Gyro Yaw\",\"Lap\"\n\"s\",\"m\",\"km/h\",\"G\",\"deg/s\",\"\"\n\n\n\
    \"0.000\",\"0\",\"90.0\",\"0.1\",\"1.0\",\"1\"\n\"0.010\",\"0.25\",\"91.0\",\"0.2\",\"2.0\",\"1\"\n";

const VBOX: &str = "File created on 01/02/2021 at 10:00:00\r\n\r\n[header]\r\nsatellites\r\ntime\r\nlatitude\r\nlongitude\r\nvelocity kmh\r\nheading\r\nvertical velocity m/s\r\nLat_Acc\r\n\r\n\
    [channel units]\r\ng\r\n\r\n[comments]\r\n(c) Racelogic\r\n\r\n[column names]\r\nsats time lat long velocity heading vert-vel Lat_Acc\r\n\r\n[data]\r\n\
    010 095959.90 +03119.09973 -00058.49277 090.0 012.0 +000.10 +0.5\r\n010 095959.95 +03119.09980 +00058.49277 091.0 012.0 +000.20 -0.5\r\n010 100000.00 +03119.09990 -00058.49277 092.0 012.0 -000.10 +0.0\r\n";

#[test]
fn odd_texts_have_their_right_reading() {
    let t: &[f64] = &[0.0, 0.1];
    let v: &[f64] = &[1.5, 2.5];
    let lines = |rows: &str| rows.replace('|', "\n").into_bytes();
    let plain: &[Expected] = &[("t", "", t), ("v", "", v)];
    let files: Vec<(&str, Vec<u8>, Vec<Expected>)> = vec![
        (
            "aim.csv",
            AIM.into(),
            vec![
                ("Time", "s", &[0.0, 0.05, 0.1]),
                ("GPS LatAcc", "g", &[0.1, N, 0.3]),
            ],
        ),
        (
            "aim_crlf.csv",
            AIM.replace('\n', "\r\n").into(),
            vec![("GPS Speed", "km/h", &[90.0, 91.0, 92.0])],
        ),
        (
            "racechrono.csv",
            RACECHRONO.into(),
            vec![
                (
                    "timestamp",
                    "unix time",
                    &[1611933400.1, 1611933400.2, 1611933460.0],
                ),
                ("speed (calc)", "m/s", &[25.1, N, 27.1]),
                ("speed (100: gps) (column 5)", "m/s", &[25.0, 26.0, 27.0]),
                ("speed (100: gps) (column 8)", "km/h", &[90.0, 91.0, 92.0]),
                ("x_acc", "G", &[0.1, 0.2, 0.3]),
            ],
        ),
        (
            "motec.csv",
            MOTEC.into(),
            vec![
                ("Ground Speed", "km/h", &[90.0, 91.0]),
                ("Gyro Yaw", "deg/s", &[1.0, 2.0]),
                ("Lap", "", &[1.0, 1.0]),
            ],
        ),
        (
            "run.vbo",
            VBOX.into(),
            vec![
                ("time", "s", &[35_999.9, 35_999.95, 36_000.0]),
                ("velocity", "kmh", &[90.0, 91.0, 92.0]),
                ("vert-vel", "m/s", &[0.1, 0.2, -0.1]),
                ("Lat_Acc", "g", &[0.5, -0.5, 0.0]),
            ],
        ),
        (
            "mark.csv",
            [
                b"\xef\xbb\xbf".to_vec(),
                lines("# driver: a, sled: b|# day 3|t,v|0,1.5|0.1,2.5|"),
            ]
            .concat(),
            plain.to_vec(),
        ),
        (
            "hash_names.csv",
            lines("# t,v|0,1.5|0.1,2.5|"),
            plain.to_vec(),
        ),
        (
            "percent.csv",
            lines("% made by a script|% t,v|0,1.5|0.1,2.5|"),
            plain.to_vec(),
        ),
        (
            "comment_rows.csv",
            lines("t,v|0,1.5|# lap 2|0.1,2.5|"),
            plain.to_vec(),
        ),
        (
            "units_row.csv",
            lines("t,v|s,km/h|0,1.5|0.1,2.5|"),
            vec![("t", "s", t), ("v", "km/h", v)],
        ),
        (
            "units_brackets.csv",
            lines("t,v|[s],[km/h]|0,1.5|0.1,2.5|"),
            vec![("v", "km/h", v)],
        ),
        (
            "units_maker.csv",
            lines("t,v,n,w|s,km/h,counts,foo|0,1.5,1,1|0.1,2.5,2,2|"),
            vec![("v", "km/h", v), ("w", "foo", &[1.0, 2.0])],
        ),
        (
            "bracket_name.csv",
            lines("t (s),v [km/h],Acc (front)|0,1.5,1|0.1,2.5,2|"),
            vec![("v", "km/h", v), ("Acc (front)", "", &[1.0, 2.0])],
        ),
        (
            "suffix.csv",
            lines("time_ms,speed_kmh,acc_x_gs,yaw_deg_per_s|0,1.5,1,1|0.1,2.5,2,2|"),
            vec![
                ("time_ms", "ms", t),
                ("speed_kmh", "kmh", v),
                ("acc_x_gs", "gs", &[1.0, 2.0]),
                ("yaw_deg_per_s", "deg per s", &[1.0, 2.0]),
            ],
        ),
        (
            "german.csv",
            lines("Zeit [s];v [km/h]|0,0;1,5|0,1;2,5|"),
            vec![("Zeit", "s", t), ("v", "km/h", v)],
        ),
        (
            "german_points.csv",
            lines("t;v|0.0;1.5|0.1;2.5|"),
            plain.to_vec(),
        ),
        (
            "thousands.csv",
            lines("t;p|0,0;1.234,5|0,1;2.345,5|"),
            vec![("p", "", &[1234.5, 2345.5])],
        ),
        (
            "quoted_commas.csv",
            lines("t,v|\"0,0\",\"1,5\"|\"0,1\",\"2,5\"|"),
            plain.to_vec(),
        ),
        (
            "quoted_thousands.csv",
            lines("t,p|0.0,\"1,234.5\"|0.1,\"2,345.5\"|"),
            vec![("p", "", &[1234.5, 2345.5])],
        ),
        ("tabs.txt", lines("t\tv|0\t1.5|0.1\t2.5|"), plain.to_vec()),
        (
            "tabs_commas.txt",
            lines("t\tv|0\t1,5|0,1\t2,5|"),
            plain.to_vec(),
        ),
        (
            "blanks.txt",
            lines("  t      v|  0.0   1.5|  0.1   2.5|"),
            plain.to_vec(),
        ),
        (
            "blank_after_comma.csv",
            lines("t, v|0.0, 1.5|0.1, 2.5|"),
            plain.to_vec(),
        ),
        (
            "old_mac_and_blank_lines.csv",
            lines("t,v||0,1.5||0.1,2.5|||"),
            plain.to_vec(),
        ),
        (
            "empty_cells.csv",
            lines("t,v,w|0,1.5,|0.1,2.5,|"),
            vec![("v", "", v), ("w", "", &[N, N])],
        ),
        (
            "empty_columns.csv",
            lines("t,,v,,|0,,1.5,,|0.1,,2.5,,|"),
            plain.to_vec(),
        ),
        (
            "last_delimiter.csv",
            lines("t,v|0,1.5,|0.1,2.5,|"),
            plain.to_vec(),
        ),
        (
            "nan.csv",
            lines("t,v|0,1.#QNAN|1,-1.#IND|2,NULL|3,#N/A|4,NaN|5,--|6,1.#INF|7,n/a|8,1.5|"),
            vec![("v", "", &[N, N, N, N, N, N, N, N, 1.5])],
        ),
        (
            "first_row_missing.csv",
            lines("t,v,w|0,,|0.1,2.5,1|0.2,3,2|"),
            vec![("v", "", &[N, 2.5, 3.0])],
        ),
        (
            "utf16le.csv",
            utf16("t,v [°/s]\n0,1.5\n0.1,2.5\n", true, u16::to_le_bytes),
            vec![("v", "°/s", v)],
        ),
        (
            "utf16be.csv",
            utf16("t,v [°/s]\n0,1.5\n0.1,2.5\n", true, u16::to_be_bytes),
            vec![("v", "°/s", v)],
        ),
        (
            "utf16_no_mark.csv",
            utf16("t;v [°/s]\n0;1,5\n0,1;2,5\n", false, u16::to_le_bytes),
            vec![("v", "°/s", v)],
        ),
        (
            "latin1.csv",
            b"t;v [\xb0/s]\n0;1,5\n0,1;2,5\n".to_vec(),
            vec![("v", "°/s", v)],
        ),
        (
            "clock.csv",
            lines("Time,v|13:05:59.9,1.5|13:06:00.0,2.5|"),
            vec![("Time", "s", &[47_159.9, 47_160.0])],
        ),
        (
            "midnight.csv",
            lines("Time,v|23:59:59.9,1.5|00:00:00.0,2.5|00:00:00.1,3|"),
            vec![("Time", "s", &[86_399.9, 86_400.0, 86_400.1])],
        ),
        (
            "date.csv",
            lines("Time,v|2021-03-01 23:59:59.5,1.5|2021-03-02 00:00:00.0,2.5|"),
            vec![("Time", "s", &[1_614_643_199.5, 1_614_643_200.0])],
        ),
        (
            "date_t.csv",
            lines("Time,v|2021-03-01T23:59:59.5Z,1.5|2021-03-02T00:00:00.0Z,2.5|"),
            vec![("Time", "s", &[1_614_643_199.5, 1_614_643_200.0])],
        ),
        (
            "date_german.csv",
            lines("Zeit;v|28.02.2021 23:59:59,5;1,5|01.03.2021 00:00:00,0;2,5|"),
            vec![("Zeit", "s", &[1_614_556_799.5, 1_614_556_800.0])],
        ),
        (
            "date_us.csv",
            lines("Time,v|3/1/2021 11:59:59.5 PM,1.5|3/2/2021 12:00:00.0 AM,2.5|"),
            vec![("Time", "s", &[86_399.5, 86_400.0])],
        ),
        (
            "date_apart.csv",
            lines("Date,Time,v|2021-03-01,10:00:00,1.5|2021-03-01,10:00:00.1,2.5|"),
            vec![("Time", "s", &[36_000.0, 36_000.1]), ("v", "", v)],
        ),
        (
            "packed.csv",
            lines("UTC Time,v|095959.98,1.5|095959.99,2|100000.00,2.5|"),
            vec![("UTC Time", "s", &[35_999.98, 35_999.99, 36_000.0])],
        ),
        (
            "seconds.csv",
            lines("Time,v|59.9,1.5|60.0,2|100.0,2.5|"),
            vec![("Time", "", &[59.9, 60.0, 100.0])],
        ),
        (
            "text_column.csv",
            lines("t,place,v|0,start,1.5|0.1,bend 2,2.5|"),
            plain.to_vec(),
        ),
        (
            "quoted_line_end.csv",
            lines("t,note,v|0,\"one,|two\",1.5|0.1,x,2.5|"),
            plain.to_vec(),
        ),
        (
            "repeated_head.csv",
            lines("t,v|s,m/s|0,1.5|t,v|s,m/s|0.1,2.5|"),
            vec![("t", "s", t), ("v", "m/s", v)],
        ),
        (
            "duplicates.csv",
            lines("t,v,v|0,1.5,1|0.1,2.5,2|"),
            vec![("v (column 2)", "", v), ("v (column 3)", "", &[1.0, 2.0])],
        ),
        (
            "padded_head.csv",
            lines(
                "Driver,a,,,|Sample Rate,100,Hz,,|Markers,43.2,60.1,,|t,v,a,b,c|s,m/s,g,g,g|0,1.5,1,1,1|0.1,2.5,2,2,2|",
            ),
            vec![("t", "s", t), ("v", "m/s", v)],
        ),
        ("cut.csv", lines("t,v|0,1.5|0.1,2.5|0."), plain.to_vec()),
        (
            "exponents.csv",
            lines("t,v|0e0,+1.5E+0|1e-1,.25e1|"),
            plain.to_vec(),
        ),
    ];
    let folder = tempfile::tempdir().unwrap();
    let count = files.len();
    let wrong: Vec<String> = files
        .into_iter()
        .filter_map(|(name, bytes, expected)| {
            let found = reading(folder.path(), name, &bytes, &expected).err()?;
            Some(format!("{name}: {found}"))
        })
        .collect();
    assert!(
        count >= 40 && wrong.is_empty(),
        "{} of {count}:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}

#[test]
fn longitudes_of_race_logic_are_positive_in_the_west() {
    let folder = tempfile::tempdir().unwrap();
    let expected: &[Expected] = &[
        (
            "lat",
            "deg",
            &[3119.09973 / 60.0, 3119.0998 / 60.0, 3119.0999 / 60.0],
        ),
        (
            "long",
            "deg",
            &[58.49277 / 60.0, -58.49277 / 60.0, 58.49277 / 60.0],
        ),
    ];
    reading(folder.path(), "run.vbo", VBOX.as_bytes(), expected).unwrap();
}

#[test]
fn recordings_without_a_channel_say_why() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text, reason) in [
        ("empty.csv", "", "no row of names"),
        ("names.csv", "t,v\n", "no row of names"),
        (
            "words.csv",
            "t,v\n0,1\nfast,slow\n",
            "column \"t\" has \"fast\" in row 3",
        ),
        ("wide.csv", "t,v\n0,1\n1,2,3\n", "found 3 cells, expected 2"),
        ("a.mat", "no MATLAB", "no MATLAB v5 header"),
        ("a.parquet", "PAR1", "a.parquet"),
        ("a.mf4", "MDF     4.10", "a.mf4"),
    ] {
        let error = reading(folder.path(), name, text.as_bytes(), &[]).unwrap_err();
        assert!(
            error.contains(reason) && !error.contains('\n'),
            "{name}: {error}"
        );
    }
}
