//! The page of recorded runs: its data are the recording's, and a browser draws them.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;

use crate::kufe::{Bench, refused};
use crate::pages::browser::{Browser, DESK, Look, address, chromium};

const PHONE: Look = Look {
    width: 390,
    height: 844,
    dark: true,
};

/// What a sled records at a time, as a function of it.
type Channel = (&'static str, fn(f64) -> f64);

/// Slow motions, far below the low pass.
const CHANNELS: [Channel; 11] = [
    ("ax_mps2", |t| 0.3 * (0.7 * t).sin()),
    ("ay_mps2", |t| 2.0 * (1.1 * t).sin()),
    ("az_mps2", |t| 12.0 + 3.0 * (0.9 * t).cos()),
    ("roll_rate_radps", |t| 0.2 * (1.3 * t).sin()),
    ("pitch_rate_radps", |t| 0.1 * (0.6 * t).cos()),
    ("yaw_rate_radps", |t| 0.5 * (1.7 * t).sin()),
    ("v_mps", |t| 20.0 + 5.0 * (0.1 * t).sin()),
    ("alpha_rad", |t| 0.01 * (2.3 * t).sin()),
    ("delta_rad", |t| 0.02 * (2.9 * t).sin()),
    ("gamma_rad", |t| 0.01 * (1.9 * t).cos()),
    ("s_m", |t| 20.0 * t + 50.0 * (1.0 - (0.1 * t).cos())),
];

/// A run of `seconds` at a rate, begun `late` seconds into the motion, which has this pace; no
/// value of the yaw rate from 3 s to 4 s.
fn recording(seconds: f64, rate: f64, late: f64, pace: f64) -> String {
    let names = CHANNELS.map(|(name, _)| name).join(",");
    let mut text = format!("t_s,{names}\n");
    for i in 0..=(seconds * rate).round() as u32 {
        let t = f64::from(i) / rate;
        text += &format!("{t:.6}");
        for (name, of) in CHANNELS {
            let is_gap = name == "yaw_rate_radps" && (3.0..4.0).contains(&t);
            text += &if is_gap {
                ",".to_owned()
            } else {
                format!(",{:.9}", of(pace * t + late))
            };
        }
        text.push('\n');
    }
    text
}

/// The data of a page.
fn data(bench: &Bench, page: &str) -> (usize, Value) {
    let html = std::fs::read_to_string(bench.path(page)).expect("a page");
    let begin = "<script type=\"application/json\" id=\"data\">";
    let rest = html.split(begin).nth(1).expect("data");
    let text = rest.split("</script>").next().expect("an end");
    (html.len(), serde_json::from_str(text).expect("JSON"))
}

/// Packed values and half a step of them: 16 bits each, the least byte first, the last code none.
fn decoded(packed: &Value) -> (Vec<f64>, f64) {
    let number = |key: &str| packed[key].as_f64().expect("a number");
    let bytes = STANDARD.decode(packed["codes"].as_str().expect("codes"));
    let codes = bytes.expect("base64");
    let value = |pair: &[u8]| match f64::from(pair[0]) + 256.0 * f64::from(pair[1]) {
        65535.0 => f64::NAN,
        code => number("low") + code * number("step"),
    };
    let values = codes.chunks(2).map(value).collect();
    (values, 0.5 * number("step"))
}

#[test]
fn a_page_of_runs_has_the_recorded_values_within_its_resolution() {
    let bench = Bench::new();
    bench.write(
        "runs.csv",
        "run,file,track\nslow,slow.csv,a\nfast,fast.csv,a\ngone,gone.csv,a\n",
    );
    bench.write("slow.csv", recording(12.0, 100.0, 0.0, 1.0));
    bench.write("fast.csv", recording(12.0, 500.0, 2.0, 1.0));
    bench.write("gone.csv", "t_s,v_mps\n0,nothing\n");
    bench.succeeds(&["runs", "view", "runs.csv", "-o", "view.html"]);
    let (_, page) = data(&bench, "view.html");
    assert_eq!(page["rate_hz"], 100.0);
    let left_out = page["left_out"].as_array().expect("a list");
    assert_eq!((left_out.len(), &left_out[0][0]), (1, &Value::from("gone")));
    // The low pass of fast recordings changes the ends by more than their motions' inner part.
    for (k, late, filter, ends) in [(0, 0.0, 0.0, 0), (1, 2.0, 2e-4, 20)] {
        let run = &page["runs"][k];
        for (name, of) in CHANNELS {
            let (values, half_step) = decoded(&run["columns"][name]);
            assert_eq!(values.len(), 1201, "{name}");
            let size = (0..1200)
                .map(|i| of(0.01 * f64::from(i)).abs())
                .fold(0.0, f64::max);
            for (i, value) in values.iter().enumerate().take(1201 - ends).skip(ends) {
                let t = 0.01 * i as f64;
                let near_gap = name == "yaw_rate_radps" && (2.8..4.2).contains(&t);
                if near_gap {
                    let inside = (3.0..3.995).contains(&t);
                    assert_eq!(value.is_nan(), inside, "{name} at {t} s: {value}");
                    continue;
                }
                // Nine decimals of the file, and the rounding of the sum.
                let bound = half_step * (1.0 + 1e-6) + 1e-9 + filter * size;
                let error = (value - of(t + late)).abs();
                assert!(error < bound, "{name} at {t} s: {error} above {bound}");
            }
        }
        // Of 16 bits, half a step is 1/131068 of the range.
        let (_, half_step) = decoded(&run["columns"]["v_mps"]);
        assert!(half_step < 10.0 / 131_000.0, "{half_step}");
        let gap = run["stretches"].as_array().expect("stretches").iter();
        let gap = gap.filter(|one| one["kind"] == "gap").collect::<Vec<_>>();
        let [from, to] = ["from_s", "to_s"].map(|key| gap[0][key].as_f64().expect("a time"));
        assert!(
            (from - 3.0).abs() < 0.011 && (to - 3.995).abs() < 0.011,
            "{gap:?}"
        );
    }
    let missing = ["runs", "view", "runs.csv", "--run", "none", "-o", "n.html"];
    refused(
        bench.folder.path(),
        &missing,
        3,
        &["--run none", "slow, fast"],
    );
}

#[test]
fn a_page_of_44_runs_of_a_minute_is_below_15_megabytes() {
    let bench = Bench::new();
    let mut bytes = Vec::new();
    for count in [1, 2] {
        let mut index = String::from("run,file,track\n");
        for k in 0..count {
            index += &format!("r{k},r{k}.csv,a\n");
            let file = format!("r{k}.csv");
            bench.write(&file, recording(60.0, 500.0, f64::from(k), 1.0));
        }
        bench.write("runs.csv", index);
        bench.succeeds(&["runs", "view", "runs.csv", "-o", "view.html"]);
        bytes.push(data(&bench, "view.html").0);
    }
    let of_44 = bytes[0] + 43 * (bytes[1] - bytes[0]);
    assert!(of_44 < 15_000_000, "{bytes:?}: {of_44}");
}

#[test]
fn the_models_curves_are_those_of_the_sled_that_it_drove() {
    let bench = Bench::new();
    bench.succeeds(&["simulate", "--sample-data", "sample", "-q"]);
    let (model, track) = ("sample/model.toml", "sample/track_east.csv");
    bench.succeeds(&["simulate", model, track, "--no-noise", "-o", "driven", "-q"]);
    let runs = ["runs", "view", "driven/runs.csv", "--model", model];
    bench.succeeds(&[&runs[..], &["-o", "view.html", "-q"]].concat());
    let (_, page) = data(&bench, "view.html");
    let run = &page["runs"][0];
    // The model starts where the first filtered sample is, so that the whole run is compared.
    for (channel, bound) in [
        ("v_mps", 0.02),
        ("yaw_rate_radps", 0.02),
        ("alpha_rad", 2e-3),
        ("az_mps2", 0.5),
    ] {
        let (measured, _) = decoded(&run["columns"][channel]);
        let (model, _) = decoded(&run["model"][channel]);
        assert_eq!(measured.len(), model.len());
        let pairs = measured.iter().zip(&model).filter(|(_, b)| b.is_finite());
        let squares: Vec<f64> = pairs.map(|(a, b)| (a - b) * (a - b)).collect();
        assert!(squares.len() > measured.len() * 9 / 10, "{channel}");
        let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        assert!(rms < bound, "{channel}: {rms}");
    }
    let (behind, _) = decoded(&run["model"]["behind_s"]);
    let most = behind
        .iter()
        .filter(|x| x.is_finite())
        .fold(0.0, |m, x| x.abs().max(m));
    assert!(most < 0.02, "{most} s");
}

#[test]
fn a_page_of_runs_draws_its_channels_and_its_cursor_reads_them() {
    let Some(program) = chromium() else { return };
    let bench = Bench::new();
    bench.write("runs.csv", "run,file,track\none,one.csv,a\ntwo,two.csv,a\n");
    bench.write("one.csv", recording(12.0, 100.0, 0.0, 1.0));
    bench.write("two.csv", recording(12.0, 100.0, 0.0, 1.1));
    bench.succeeds(&["runs", "view", "runs.csv", "-o", "view.html"]);
    let mut browser = Browser::start(&program, &[]);
    for look in [DESK, PHONE] {
        let page = address(&bench.path("view.html")) + "#run=one&over=time";
        // A page that differs only after the # is not loaded anew.
        browser.open("about:blank#", look);
        browser.open(&page, look);
        assert_eq!(browser.text("h1"), "2 runs on a");
        let wide = browser.evaluate("document.documentElement.scrollWidth <= innerWidth");
        assert_eq!(wide, true, "{look:?}");
        // The second plot, below the events, is the speed of the run that the address names.
        let plot = ".one:nth-of-type(2)";
        assert_eq!(browser.text(&format!("{plot} .title")), "speed [m/s]");
        assert!(browser.colours(&format!("{plot} canvas")).0 > 5);
        browser.mouse("mouseMoved", &format!("{plot} canvas"), [0.6, 0.5]);
        let number = |text: String| {
            text.trim_end_matches(" s")
                .parse::<f64>()
                .expect("a number")
        };
        let time = number(browser.text(".sticky .readout"));
        let speed = number(browser.text(&format!("{plot} .values")));
        let expected = 20.0 + 5.0 * (0.1 * time).sin();
        assert!(
            (speed - expected).abs() < 0.01,
            "{time} s: {speed}, {expected}"
        );
        // Both runs over the distance: the time between them has a plot of its own.
        browser.evaluate(
            "(() => { document.querySelectorAll('.run input[type=checkbox]')[1].click(); \
             const over = document.querySelector('.tools select'); over.value = 's'; over.dispatchEvent(new Event('change')); })()",
        );
        browser.settle();
        let title = browser.text(&format!("{plot} .title"));
        assert_eq!(title, "time behind the reference [s]");
        browser.mouse("mouseMoved", &format!("{plot} canvas"), [0.8, 0.5]);
        let readout = browser.text(".sticky .readout");
        let place: f64 = readout.trim_end_matches(" m").parse().expect("a place");
        let behind: f64 = browser
            .text(&format!("{plot} .values"))
            .parse()
            .expect("a time");
        // At the pace of 1.1 a place is reached in a time shorter by that factor.
        let way = CHANNELS[10].1;
        let times = (0..120_000).map(|i| 1e-4 * f64::from(i));
        let reference = times.min_by(|a, b| {
            let off = |t: f64| (way(t) - place).abs();
            off(*a).total_cmp(&off(*b))
        });
        let expected = reference.expect("a time") * (1.0 / 1.1 - 1.0);
        assert!(
            (behind - expected).abs() < 2e-3,
            "{place} m: {behind} s, {expected} s"
        );
        assert_eq!(browser.errors(), Vec::<String>::new());
        browser.keep_picture(&format!("runs_{}.png", look.width), look, look.height);
    }
}

#[test]
fn the_page_of_a_check_opens_the_viewer_at_what_is_odd() {
    let Some(program) = chromium() else { return };
    let bench = Bench::new();
    bench.write(
        "runs.csv",
        "run,file,track\none <1>,one.csv,a\ntwo,two.csv,a\n",
    );
    // A value that leaps at 6 s of the recording, which begins at 100 s.
    let text = recording(12.0, 100.0, 0.0, 1.0);
    let rows = text.lines().enumerate().map(|(k, line)| {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        if k > 0 {
            let time: f64 = cells[0].parse().expect("a time");
            cells[0] = format!("{:.6}", time + 100.0);
        }
        if (601..604).contains(&k) {
            cells[4] = "3.0".to_owned();
        }
        cells.join(",") + "\n"
    });
    bench.write("one.csv", rows.collect::<String>());
    bench.write("two.csv", recording(12.0, 100.0, 0.0, 1.1));
    bench.kufe(&["runs", "check", "runs.csv", "--view", "-o", "check", "-q"]);
    let mut browser = Browser::start(&program, &[]);
    browser.open(&address(&bench.path("check/check.html")), DESK);
    let link = "document.querySelector('.finding a[href*=\"channel=roll_rate_radps\"]').href";
    let link = browser.evaluate(link);
    let link = link.as_str().expect("a link").to_owned();
    for look in [DESK, PHONE] {
        browser.open("about:blank#", look);
        browser.open(&link, look);
        // One run, its channel first, and around six seconds.
        let shown = "document.querySelectorAll('.run input[type=checkbox]:checked').length";
        assert_eq!(browser.evaluate(shown), 1);
        let plot = ".one:nth-of-type(2)";
        assert_eq!(browser.text(&format!("{plot} .title")), "roll rate [°/s]");
        browser.mouse("mouseMoved", &format!("{plot} canvas"), [0.53, 0.5]);
        let time = browser.text(".sticky .readout");
        let time: f64 = time.trim_end_matches(" s").parse().expect("a time");
        assert!((5.0..7.0).contains(&time), "{time} s");
        assert_eq!(browser.errors(), Vec::<String>::new());
    }
    // Without the page of the runs there is nothing to link to.
    bench.kufe(&["runs", "check", "runs.csv", "-o", "check", "-q"]);
    let page = std::fs::read_to_string(bench.path("check/check.html")).expect("a page");
    assert!(!page.contains("view.html") && !bench.path("check/view.html").exists());
}
