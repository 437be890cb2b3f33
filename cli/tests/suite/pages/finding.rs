//! The page of a finding, as a browser shows it.

use kufe::results::finding::{
    Maps, Picture, Place, Plot, Report, Scatter, Series, Strip, StripRun, Verdict,
};

use crate::kufe::Bench;
use crate::pages::browser::{Browser, Look, chromium};

/// Every picture that is shown lies within the screen, with letters that can be read, and there are as many on a phone as on a desk.
#[test]
#[ignore = "slow study: .ci/slow"]
fn a_findings_pictures_are_whole_and_legible_on_a_phone() {
    let Some(program) = chromium() else { return };
    let line: Vec<f64> = (0..100).map(|k| f64::from(k % 17) - 8.0).collect();
    let strip = Strip {
        channel: "yaw".to_owned(),
        unit: "N m".to_owned(),
        track: "east".to_owned(),
        from_m: 0.0,
        step_m: 10.0,
        places: vec![Place {
            effect: "wall-contact".to_owned(),
            from: 100.0,
            to: 120.0,
        }],
        discrepancy: Vec::new(),
        runs: vec![StripRun {
            run: "a".to_owned(),
            session: "d1".to_owned(),
            before: line.clone(),
            after: line.clone(),
        }],
    };
    let scatter = Scatter {
        label: String::new(),
        x_name: "v_mps".to_owned(),
        y_name: "mu without it [1e-3]".to_owned(),
        x: line.clone(),
        series: vec![Series {
            name: "measured".to_owned(),
            y: line,
            sd: Vec::new(),
        }],
        curve: None,
    };
    let maps = Maps {
        measured: kufe::case::effects::Map {
            nx: 2,
            ny: 2,
            x0: 0.0,
            y0: 0.0,
            dx: 1e-3,
            dy: 1e-5,
            pressure: vec![1e6, 2e6, 3e6, 4e6],
        },
        before: vec![1e6, 2e6, 3e6, 3e6],
        after: vec![1e6, 2e6, 3e6, 4e6],
    };
    let picture = |title: &str, plot: Plot| Picture {
        title: title.to_owned(),
        caption: String::new(),
        plot,
    };
    let report = Report {
        verdict: Verdict::Named,
        pictures: vec![
            picture("", Plot::Strip(strip)),
            picture("speed over v_mps", Plot::Scatter(scatter)),
            picture("row 2", Plot::Maps(maps)),
        ],
        ..Report::default()
    };
    let bench = Bench::new();
    bench.write("finding.html", kufe::report::discovery_page(&report, None));
    let page = bench.path("finding.html");
    let mut browser = Browser::start(&program, &[]);
    for width in [390, 1400] {
        let look = Look {
            width,
            height: 900,
            dark: false,
        };
        browser.open(&format!("file://{}", page.display()), look);
        let shown = "[...document.querySelectorAll('svg')].filter((svg) => svg.getBoundingClientRect().width > 0 && !svg.closest('details'))";
        let count = browser.evaluate(&format!("{shown}.length"));
        assert_eq!(count, 5, "{width} px");
        let cropped = browser.evaluate(&format!(
            "{shown}.filter((svg) => svg.getBoundingClientRect().right > innerWidth).length"
        ));
        assert_eq!(cropped, 0, "{width} px");
        let smallest = browser.evaluate(&format!(
            "Math.min(...{shown}.map((svg) => svg.getBoundingClientRect().width / svg.viewBox.baseVal.width * svg.getAttribute('font-size')))"
        ));
        assert!(
            smallest.as_f64().is_some_and(|size| size >= 9.5),
            "{smallest} px high at {width} px"
        );
        let wide = browser.evaluate("document.documentElement.scrollWidth - innerWidth");
        assert!(
            wide.as_i64().is_some_and(|wide| wide <= 0),
            "{wide} at {width} px"
        );
    }
    assert_eq!(browser.errors(), Vec::<String>::new());
}
