//! `kufe report`: the page as a reader's browser shows it, and what is refused.

use std::path::Path;

use exr::prelude::{ReadChannels, ReadLayers, read};

use crate::kufe::{Bench, CASE, errors, names};
use crate::pages::browser::{Browser, DESK, Look, address, chromium};

const WEBGL: [&str; 2] = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
const LOOKS: [Look; 4] = [
    DESK,
    Look { dark: true, ..DESK },
    Look {
        width: 390,
        height: 844,
        dark: false,
    },
    Look {
        width: 390,
        height: 844,
        dark: true,
    },
];

/// Texts of charts that are partly outside the picture, or touch another along the same axis.
const BEYOND: &str = "[...document.querySelectorAll('.chart svg')].filter((chart) => chart.viewBox.baseVal.width > 0).flatMap((chart) => { \
     const paper = chart.getBoundingClientRect(); \
     const texts = [...chart.querySelectorAll('text[text-anchor=middle]:not([transform])')].map((text) => [text.textContent, text.getBoundingClientRect()]); \
     return texts.filter(([, a], k) => a.right > paper.right || a.left < paper.left || \
         texts.some(([, b], j) => j !== k && Math.abs(a.top - b.top) < 1 && a.left < b.right && b.left < a.right)).map(([text]) => text); })";

/// The pressure of `pressure.exr` at a place [Pa], bilinear between pixel centres, with no word of kufe's own code.
fn pressure(path: &Path, x: f64, y: f64) -> f64 {
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_file(path)
        .expect("an EXR");
    let layer = &image.layer_data;
    let number = |name: &str| match layer
        .attributes
        .other
        .get(&exr::meta::attribute::Text::from(name))
    {
        Some(exr::meta::attribute::AttributeValue::F64(value)) => *value,
        other => panic!("{name}: {other:?}"),
    };
    let channel = layer.channel_data.list.iter().find(|c| c.name == *"p");
    let p: Vec<f32> = channel.expect("p").sample_data.values_as_f32().collect();
    let u = (x - number("origin_x_m")) / number("pixel_x_m");
    let v = (y - number("origin_y_m")) / number("pixel_y_m");
    let (i, j) = (u.floor(), v.floor());
    let at =
        |di: usize, dj: usize| f64::from(p[(j as usize + dj) * layer.size.x() + i as usize + di]);
    let (s, t) = (u - i, v - j);
    (1.0 - t) * ((1.0 - s) * at(0, 0) + s * at(1, 0)) + t * ((1.0 - s) * at(0, 1) + s * at(1, 1))
}

/// Numbers of a readout `x 12.3 mm, y 0.04 mm: 98.7 MPa`.
fn numbers(readout: &str) -> Vec<f64> {
    readout
        .split([' ', ',', ':'])
        .filter_map(|word| word.parse().ok())
        .collect()
}

#[test]
#[ignore = "slow study: .ci/slow"]
fn a_contacts_page_turns_and_its_cursor_reads_the_map() {
    let Some(program) = chromium() else { return };
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    bench.succeeds(&["press", "case.toml", "-o", "a<b>&c"]);
    bench.succeeds(&["report", "a<b>&c", "-o", "page.html"]);
    let size = std::fs::metadata(bench.path("page.html"))
        .expect("a page")
        .len();
    assert!(size < 2_000_000, "{size} bytes");
    let mut browser = Browser::start(&program, &WEBGL);
    browser.open(&address(&bench.path("page.html")), DESK);
    assert!(browser.text("h1").contains("MPa under 1.000 kN"));
    assert_eq!(browser.text("header p"), "a<b>&c");

    let (colours, before) = browser.colours(".stage canvas");
    assert!(colours > 100, "{colours} colours in the view");
    browser.drag(".stage canvas", [0.5, 0.5], [0.7, 0.4]);
    let (_, after) = browser.colours(".stage canvas");
    assert_ne!(before, after, "the view does not turn");
    assert!(browser.colours(".plot canvas").0 > 200);

    let map = bench.path("a<b>&c/pressure.exr");
    let mut in_contact = 0;
    for at in [[0.45, 0.45], [0.55, 0.35], [0.3, 0.5], [0.62, 0.55]] {
        browser.mouse("mouseMoved", ".plot canvas", at);
        let readout = browser.text("#readout");
        let read = numbers(&readout);
        let expected = 1e-6 * pressure(&map, 1e-3 * read[0], 1e-3 * read[1]);
        // Two digits after the point; the map's points are packed to 1/65534 of the peak and may be every second pixel.
        assert!(
            (read[2] - expected).abs() < 0.3,
            "{readout}: the file has {expected}"
        );
        // Hertz: a = 25 mm, b = 0.139 mm, 138.5 MPa, and the requested accuracy of the case.
        let inside = 1.0 - (read[0] / 25.0).powi(2) - (read[1] / 0.139).powi(2);
        if inside > 0.2 {
            let hertz = 138.5 * inside.sqrt();
            assert!(
                (read[2] / hertz - 1.0).abs() < 0.03,
                "{readout}: Hertz has {hertz}"
            );
            in_contact += 1;
        }
    }
    assert!(
        in_contact >= 3,
        "the cursor met the contact {in_contact} times"
    );

    let cut = browser.text("section:nth-of-type(3) h2");
    browser.drag(".plot canvas", [0.6, 0.3], [0.6, 0.3]);
    assert_ne!(
        browser.text("section:nth-of-type(3) h2"),
        cut,
        "the cuts do not follow"
    );
    browser.evaluate(
        "(() => { const s = document.querySelector('.tools select'); s.value = 'whole'; s.dispatchEvent(new Event('change')); })()",
    );
    browser.settle();
    assert!(browser.colours(".stage canvas").0 > 50);
    assert_eq!(browser.errors(), Vec::<String>::new());
}

#[test]
#[ignore = "slow study: .ci/slow"]
fn pages_fit_phones_and_dark_rooms_and_need_no_webgl() {
    let Some(program) = chromium() else { return };
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    bench.succeeds(&["press", "case.toml"]);
    bench.succeeds(&["report", "out"]);
    bench.write(
        "table.toml",
        "case = \"case.toml\"\n[axes]\nfz_n = { values = [400.0, 800.0, 1600.0] }\n\
         curvature_1pm = { values = [-0.01, 0.0, 0.01, 0.02] }\n[accuracy]\nchecks = 2\n",
    );
    bench.succeeds(&["lut", "table.toml", "-o", "front.lut"]);
    bench.succeeds(&["report", "front.lut"]);
    // A short runner near the curvature at which it lies flush, over reduced curvatures.
    bench.write(
        "short.toml",
        CASE.replace(
            "length_m = 1.0, rocker_radius_m = 30.0",
            "length_m = 0.2, rocker_radius_m = 10.0",
        ),
    );
    bench.write(
        "flush.toml",
        "case = \"short.toml\"\n[axes]\nfz_n = { values = [500.0, 1000.0] }\n\
         curvature_1pm = { from = 0.0, to = 0.15, flush = { curvature_1pm = 0.1, scale_1pm_per_n = 1e-6 } }\n\
         [accuracy]\ninterpolation = 0.2\nevaluation = \"bilinear\"\np_max = 0.05\nchecks = 2\n",
    );
    bench.succeeds(&["lut", "flush.toml", "-o", "flush.lut"]);
    bench.succeeds(&["report", "flush.lut"]);
    std::fs::create_dir(bench.path("drivers")).expect("a folder");
    bench.write("drivers/evaluation.json", EVALUATION);
    bench.succeeds(&["report", "drivers"]);
    let lists = ["--fz-n", "500,1000", "--radius-m", "inf,60"];
    bench.succeeds(&[&["press", "case.toml", "-o", "series"][..], &lists].concat());
    bench.succeeds(&["report", "series"]);
    std::fs::create_dir(bench.path("sliding")).expect("a folder");
    bench.write(
        "sliding/friction.json",
        "{ \"points\": [{ \"v_mps\": 10.0, \"mu\": 0.0031 }] }",
    );
    // As wide as a command's widest.
    let wide = kufe::plot::Figure::new(1500.0, "friction");
    bench.write("sliding/friction.png", wide.png());
    bench.succeeds(&["report", "sliding"]);
    let mut browser = Browser::start(&program, &WEBGL);
    for (page, height) in [
        ("out/report.html", 1420),
        ("front.html", 1420),
        ("drivers/report.html", 760),
        ("series/report.html", 900),
        ("sliding/report.html", 760),
    ] {
        let mut papers = Vec::new();
        for look in LOOKS {
            browser.open(&address(&bench.path(page)), look);
            let wide = browser.evaluate("document.documentElement.scrollWidth - innerWidth");
            assert!(
                wide.as_i64().expect("a number") <= 0,
                "{page} is {wide} px too wide at {look:?}"
            );
            // A single number under an axis defines no scale.
            let unscaled = browser.evaluate(
                "[...document.querySelectorAll('.chart svg')].filter((chart) => chart.querySelector('text') && \
                 [...chart.querySelectorAll('text[text-anchor=middle]')].filter((t) => isFinite(t.textContent)).length < 2).length",
            );
            assert_eq!(unscaled.as_i64(), Some(0), "{page} at {look:?}");
            let beyond = browser.evaluate(BEYOND);
            assert_eq!(beyond, serde_json::json!([]), "{page} at {look:?}");
            papers.push(browser.evaluate("getComputedStyle(document.body).backgroundColor"));
            assert_eq!(browser.errors(), Vec::<String>::new(), "{page} at {look:?}");
            if ["out/report.html", "front.html"].contains(&page) {
                assert!(
                    browser.colours(".stage canvas").0 > 100,
                    "{page} at {look:?}"
                );
            }
            let width = if look.width < 600 { "phone" } else { "wide" };
            let scheme = if look.dark { "dark" } else { "light" };
            let name = page.replace("/report", "").replace(".html", "");
            let height = if look.width < 600 { 1900 } else { height };
            browser.keep_picture(&format!("report-{name}-{width}-{scheme}.png"), look, height);
        }
        assert!(papers[0] == papers[2] && papers[1] == papers[3] && papers[0] != papers[1]);
    }
    the_series_page_shows_what_the_table_holds(&mut browser, &bench);
    // A point of each table, looked up by the command and by the page.
    for table in ["front", "flush"] {
        browser.open(&address(&bench.path(&format!("{table}.html"))), DESK);
        browser.mouse("mouseMoved", ".plot canvas", [0.5, 0.4]);
        let read = numbers(&browser.text("#readout"));
        let (fz, curvature) = (read[0].to_string(), read[1].to_string());
        let file = format!("{table}.lut");
        let words = [
            "lut",
            "query",
            &file,
            "--mode",
            "bilinear",
            "--json",
            "--fz-n",
            &fz,
            "--curvature-1pm",
            &curvature,
        ];
        let answer: serde_json::Value =
            serde_json::from_str(&bench.succeeds(&words)).expect("JSON");
        let expected = 1e-6 * answer["p_max_pa"].as_f64().expect("a pressure");
        let shown = read[read.len() - 1];
        assert!(
            (shown / expected - 1.0).abs() < 1e-3,
            "{table}: {shown} {expected}"
        );
        assert_eq!(browser.errors(), Vec::<String>::new(), "{table}");
    }
    drop(browser);

    let mut browser = Browser::start(&program, &["--disable-3d-apis"]);
    browser.open(&address(&bench.path("out/report.html")), DESK);
    assert!(
        browser.text(".stage").contains("no WebGL"),
        "{}",
        browser.text(".stage")
    );
    browser.mouse("mouseMoved", ".plot canvas", [0.45, 0.45]);
    assert!(numbers(&browser.text("#readout"))[2] > 100.0);
    let errors = browser.errors();
    // three.js itself reports a missing WebGL; any other message is an error of the page.
    assert!(
        errors.iter().all(|error| error.contains("WebGL")),
        "{errors:?}"
    );
}

/// Four points on two lines; the table's cells are those of table.json, in MPa.
fn the_series_page_shows_what_the_table_holds(browser: &mut Browser, bench: &Bench) {
    browser.open(&address(&bench.path("series/report.html")), DESK);
    let count = |browser: &mut Browser, what: &str| {
        let found = browser.evaluate(&format!("document.querySelectorAll('{what}').length"));
        found.as_i64().expect("a number")
    };
    assert_eq!(count(browser, ".chart circle"), 4);
    assert_eq!(count(browser, ".legend span"), 2);
    let text = std::fs::read_to_string(bench.path("series/table.json")).expect("a table");
    let rows: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let last = 1e-6 * rows[3]["p_max_pa"].as_f64().expect("a pressure");
    let shown = browser.text("tbody tr:nth-child(4) td:nth-child(4)");
    let shown: f64 = shown
        .split(' ')
        .next()
        .and_then(|w| w.parse().ok())
        .expect("a number");
    assert!((shown / last - 1.0).abs() < 1e-3, "{shown} {last}");
}

#[test]
fn what_cannot_be_reported_on_is_refused_by_name() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    std::fs::create_dir(bench.path("empty")).expect("a folder");
    std::fs::create_dir(bench.path("broken")).expect("a folder");
    std::fs::create_dir(bench.path("half")).expect("a folder");
    bench.succeeds(&["press", "case.toml", "-o", "whole", "-q"]);
    let text = std::fs::read_to_string(bench.path("whole/result.json")).expect("a result");
    let mut broken: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    broken["p_max_pa"] = "high".into();
    bench.write("broken/result.json", broken.to_string());
    std::fs::copy(
        bench.path("whole/result.json"),
        bench.path("half/result.json"),
    )
    .expect("a copy");
    bench.write("half/pressure.exr", "no image");
    for (what, parts) in [
        ("nowhere", vec!["nowhere", "no such file"]),
        ("empty", vec!["empty", "no results: expected"]),
        ("case.toml", vec!["case.toml", "expected a folder"]),
        (
            "broken",
            vec!["result.json", "p_max_pa: invalid type: string \"high\""],
        ),
        ("half", vec!["pressure.exr"]),
    ] {
        let output = bench.kufe(&["report", what]);
        assert_eq!(output.status.code(), Some(3), "{what}");
        let reported = errors(&output);
        assert!(
            parts.iter().all(|part| reported.contains(part)),
            "{reported}"
        );
    }
    assert_eq!(names(&bench.path("empty")), Vec::<String>::new());
    assert_eq!(
        bench
            .kufe(&["report", "whole", "-o", "empty"])
            .status
            .code(),
        Some(3)
    );
}

/// Two drivers on two tracks, as `kufe evaluate` writes it.
const EVALUATION: &str = include_str!("../../data/evaluation.json");

#[test]
fn a_cases_lists_are_written_out_and_steel_only_where_it_gives() {
    let Some(program) = chromium() else { return };
    let bench = Bench::new();
    bench.write("rigid.toml", CASE);
    let elastic = "[runner]\nelastic = true\nshape = { kind = \"bob\", length_m = 0.3, rocker_radius_m = 30.0, section_radius_m = 0.005, width_m = 0.010, height_m = 0.020 }\n\
                   mount = { held = [{ x_m = -0.1, length_m = 0.02 }, { x_m = 0.1, length_m = 0.02 }] }\n\
                   [ice]\nyoungs_modulus_pa = 9.0e9\npoissons_ratio = 0.33\nthickness_m = 0.05\n[load]\nfz_n = 500.0\n[accuracy]\np_max = 0.1\n";
    bench.write("elastic.toml", elastic);
    let mut browser = Browser::start(&program, &WEBGL);
    for (name, places, steel) in [("rigid", false, false), ("elastic", true, true)] {
        bench.succeeds(&["press", &format!("{name}.toml"), "-o", name]);
        bench.succeeds(&["report", name]);
        browser.open(&address(&bench.path(&format!("{name}/report.html"))), DESK);
        let page = browser.text("body");
        assert!(!page.contains("[object"), "{name}: {page}");
        let has = |text| page.contains(text);
        assert_eq!(
            has("x_m -0.1") && has("x_m 0.1") && has("length_m 0.02"),
            places,
            "{name}: {page}"
        );
        assert_eq!(has("runner.youngs_modulus_pa"), steel, "{name}: {page}");
        assert!(has("ice.youngs_modulus_pa"), "{name}: {page}");
        // The loads of the mount are among the results: a column per place, of which the forces sum to the load.
        let shown = "[...document.querySelectorAll('.panel')].filter((p) => !p.hidden && p.textContent.includes('pushes its mount'))";
        let upwards = format!(
            "{shown}.flatMap((p) => [...p.querySelectorAll('tbody tr')].filter((r) => r.textContent.includes('upwards'))\
             .flatMap((r) => [...r.cells].slice(1).map((c) => Number(c.textContent))))"
        );
        let forces = browser.evaluate(&upwards);
        let forces: Vec<f64> = serde_json::from_value(forces).expect("numbers");
        assert_eq!(
            forces.len(),
            if steel { 2 } else { 0 },
            "{name}: {forces:?}"
        );
        assert!(
            !steel || (forces.iter().sum::<f64>() - 500.0).abs() < 0.1,
            "{forces:?}"
        );
    }
}
