//! `kufe report` on folders without a page of their own, and what pages of all kinds share.

use serde_json::{Value, json};

use crate::kufe::{Bench, CASE};
use crate::pages::browser::{Browser, DESK, Look, address, chromium};

/// A Hertzian contact and a round hull on a coarse grid: areas of the patch, of the ice around it, and of the hull below its ceiling.
const RIMS: &str = "(() => { \
    const n = 41, xy = (k) => -1.3 + 2.6 * k / (n - 1), at = (i, j) => j * n + i, square = (i, j) => xy(i) ** 2 + xy(j) ** 2; \
    const p = Array.from({ length: n * n }, (_, k) => Math.sqrt(Math.max(0, 1 - square(k % n, Math.floor(k / n))))); \
    const place = (i, j) => [xy(i), xy(j), 0], contact = { p, top: 1 }; \
    const area = ({ positions: v, index }) => { let sum = 0; for (let k = 0; k < index.length; k += 3) { \
        const [a, b, c] = index.slice(k, k + 3).map((m) => [v[3 * m], v[3 * m + 1]]); \
        sum += Math.abs((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])) / 2; } return sum; }; \
    const hull = heightRim(square, 0.64); \
    return [rimOf(contact, at), rimOf(contact, at, true), hull].map((rim) => area(surface(n, n, place, null, rim))); })()";

#[test]
fn rims_follow_the_contact_between_points_and_hulls_leave_the_paper_of_a_cut() {
    let Some(program) = chromium() else { return };
    let bench = Bench::new();
    let bounded = "thickness_m = 0.05\nhardness_pa = 20e6";
    bench.write("case.toml", CASE.replace("thickness_m = 0.05", bounded));
    bench.succeeds(&["press", "case.toml"]);
    bench.succeeds(&["report", "out"]);
    let mut browser = Browser::start(&program, &[]);
    browser.open(&address(&bench.path("out/report.html")), DESK);
    let areas: [f64; 3] = serde_json::from_value(browser.evaluate(RIMS)).expect("areas");
    let round = std::f64::consts::PI;
    // Cells excluded at the rim were 6 % of the patch; chords of a circle are shorter by 0.3 %.
    for (area, exact) in areas.iter().zip([round, 2.6 * 2.6 - round, 0.64 * round]) {
        assert!((area / exact - 1.0).abs() < 5e-3, "{areas:?}");
    }
    let hulls = "[...document.querySelectorAll('.chart path[stroke-dasharray=\"5 4\"]')]";
    let highest = browser.evaluate(&format!("Math.min(...{hulls}.map((p) => p.getBBox().y))"));
    assert!(highest.as_f64().expect("a place") < 0.0, "{highest}");
    let cut = browser.evaluate(&format!(
        "{hulls}.every((p) => p.hasAttribute('clip-path'))"
    ));
    assert_eq!(cut, json!(true));
}

#[test]
fn a_wide_picture_fits_a_phone_and_opens_at_a_click() {
    let Some(program) = chromium() else { return };
    let bench = Bench::new();
    std::fs::create_dir(bench.path("sliding")).expect("a folder");
    bench.write(
        "sliding/friction.json",
        "{ \"points\": [{ \"mu\": 0.0031 }] }",
    );
    let wide = kufe::plot::Figure::new(1500.0, "friction");
    bench.write("sliding/friction.png", wide.png());
    bench.succeeds(&["report", "sliding"]);
    let mut browser = Browser::start(&program, &[]);
    let phone = Look {
        width: 390,
        height: 844,
        dark: true,
    };
    browser.open(&address(&bench.path("sliding/report.html")), phone);
    let widths = "[document.querySelector('img').getBoundingClientRect().width, document.documentElement.scrollWidth]";
    let wide = |found: Value| -> [f64; 2] { serde_json::from_value(found).expect("widths") };
    let [picture, page] = wide(browser.evaluate(widths));
    assert!(
        picture > 300.0 && picture < 390.0 && page <= 390.0,
        "{picture} {page}"
    );
    browser.evaluate("document.querySelector('.picture').click()");
    let [picture, page] = wide(browser.evaluate(widths));
    assert!(picture == 1500.0 && page <= 390.0, "{picture} {page}");
}

#[test]
fn gathered_runs_are_a_page_and_their_index_no_place_for_it() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("raw")).expect("a folder");
    for name in ["A1", "A2"] {
        let rows: String = (0..50)
            .map(|k| format!("{:.2},20\n", 0.01 * f64::from(k)))
            .collect();
        bench.write(&format!("raw/{name}.csv"), format!("t_s,v_mps\n{rows}"));
    }
    std::fs::create_dir(bench.path("all")).expect("a folder");
    let names = ["--track", "igls", "--session", "monday"];
    bench.succeeds(
        &[
            &["runs", "gather", "raw", "-o", "all/runs.csv", "-q"][..],
            &names,
        ]
        .concat(),
    );
    std::fs::remove_file(bench.path("raw/A2.csv")).expect("a run less");
    let printed: Value =
        serde_json::from_str(&bench.succeeds(&["report", "all", "--json"])).expect("JSON");
    assert_eq!(printed["kind"], "runs");
    let page = std::fs::read_to_string(bench.path("all/report.html")).expect("a page");
    for part in [
        "<h1>all: 2 runs</h1>",
        "<tr><td>monday<td class=n>2\n",
        "<tr><th>run<th>track<th>session<th>file<th>missing\n",
        "<tr><td>A1<td>igls<td>monday<td>",
        "<td>there is no such file\n",
    ] {
        assert!(page.contains(part), "{part}: {page}");
    }
    let output = bench.kufe(&["report", "all", "-o", "all/runs.csv"]);
    assert_eq!(output.status.code(), Some(3));
}

#[test]
fn a_page_begins_with_its_result() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("val")).expect("a folder");
    let tracks = r#"[{ "track": "a<b", "runs": 36, "rmse_n": 91.9, "rmse_braghin_n": 446.9 }]"#;
    let validation = format!(
        r#"{{ "runs": [], "tracks": {tracks}, "left_out_as_fitted": [], "version": "1" }}"#
    );
    bench.write("val/validation.json", validation);
    bench.succeeds(&["report", "val"]);
    let page = std::fs::read_to_string(bench.path("val/report.html")).expect("a page");
    let headline = "val</h1>\n<p>R.m.s. error of the lateral force: a&lt;b 91.90 N over 36 runs (Braghin&#39;s law: 446.9 N).</p>";
    assert!(page.contains(headline), "{page}");
}

#[test]
fn constants_of_steel_are_stated_for_runners_that_deform() {
    let bench = Bench::new();
    bench.write("rigid.toml", CASE);
    let printed = bench.succeeds(&["press", "rigid.toml"]);
    let approach = printed
        .lines()
        .find(|line| line.trim_start().starts_with("approach "));
    assert!(
        approach.is_some_and(|line| line.contains(" ± ")),
        "{printed}"
    );
    bench.succeeds(&["report", "out"]);
    let page = std::fs::read_to_string(bench.path("out/report.html")).expect("a page");
    assert!(!page.contains("210000000000"));
}

#[cfg(unix)]
#[test]
fn a_page_embeds_pictures_only_and_nothing_from_outside_its_folder() {
    use base64::Engine;
    let bench = Bench::new();
    std::fs::create_dir(bench.path("out")).expect("a folder");
    bench.write("out/friction.json", "{ \"points\": [{ \"mu\": 0.0031 }] }");
    bench.write("out/notes.png", "not a picture: a list of passwords");
    bench.succeeds(&["report", "out"]);
    let page = std::fs::read_to_string(bench.path("out/report.html")).expect("a page");
    let packed = base64::engine::general_purpose::STANDARD.encode("not a picture");
    assert!(!page.contains(&packed[..12]));
    bench.write("private.png", kufe::plot::Figure::new(60.0, "").png());
    std::os::unix::fs::symlink("../private.png", bench.path("out/more.png")).expect("a link");
    let refused = bench.kufe(&["report", "out", "--force"]);
    assert_eq!(refused.status.code(), Some(3));
    let reported = crate::kufe::errors(&refused);
    assert!(
        reported.contains("out/more.png: a link that leads out"),
        "{reported}"
    );
}
