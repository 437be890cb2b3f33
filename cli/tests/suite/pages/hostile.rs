//! Pages of foreign names: what looks like markup is text, and nothing of it runs.

use crate::kufe::Bench;
use crate::pages::browser::{Browser, DESK, address, chromium};

/// Names as a foreign file may have them.
const NAMES: [&str; 4] = [
    "<img src=x onerror=document.title='ran'>",
    "'\"><script>document.title='ran'</script>",
    "</script><svg onload=document.title='ran'>",
    "javascript:document.title='ran'",
];

/// Nothing was made of the names, nothing was blocked and nothing ran.
fn is_harmless(browser: &mut Browser, bench: &Bench, page: &str) {
    browser.open(&address(&bench.path(page)), DESK);
    let made = "document.querySelectorAll('img[src=\"x\"], svg[onload], [onerror], a[href^=\"javascript\"]').length";
    assert_eq!(browser.evaluate(made), 0, "{page}");
    let ran = "document.title === 'ran'";
    assert_eq!(browser.evaluate(ran), false, "{page}");
    // A policy that blocks a script logs this on the console.
    assert_eq!(browser.errors(), Vec::<String>::new(), "{page}");
    let shown =
        browser.evaluate("document.documentElement.textContent.includes('onerror=document')");
    assert_eq!(shown, true, "{page} does not show the name");
}

fn quoted(cell: &str) -> String {
    format!("\"{}\"", cell.replace('"', "\"\""))
}

#[test]
fn names_in_pages_are_text_and_nothing_runs() {
    let Some(program) = chromium() else { return };
    let bench = Bench::new();
    bench.succeeds(&["simulate", "--sample-data", "sample", "-q"]);
    let index = std::fs::read_to_string(bench.path("sample/runs.csv")).expect("an index");
    let mut rows = csv::Reader::from_reader(index.as_bytes());
    let mut text = rows
        .headers()
        .expect("a header")
        .iter()
        .collect::<Vec<_>>()
        .join(",")
        + "\n";
    for (k, row) in rows
        .records()
        .map(|row| row.expect("a row"))
        .take(8)
        .enumerate()
    {
        let name = NAMES[k % NAMES.len()];
        let cells = row.iter().enumerate().map(|(column, cell)| match column {
            // Run, driver, class and session.
            0 => quoted(&format!("{name}{k}")),
            3..=5 => quoted(name),
            _ => cell.to_owned(),
        });
        text += &(cells.collect::<Vec<_>>().join(",") + "\n");
    }
    bench.write("sample/runs.csv", text);

    let mut experiments = format!(
        "specimen,p_max_pa,p_max_sd_pa,mu,mu_sd,session,v_mps,{}\n",
        quoted(NAMES[0])
    );
    for k in 0..24 {
        let x = f64::from(k);
        let mu = 0.004 + 2e-5 * x;
        let name = quoted(NAMES[k as usize % NAMES.len()]);
        experiments += &format!(
            "{name},{}e6,2e5,{mu},1e-5,{name},{},{x}\n",
            8 + k % 5,
            10 + k % 3
        );
    }
    bench.write("experiments.csv", experiments);
    std::fs::create_dir(bench.path("foreign")).expect("a folder");
    let key = format!("k_n_per_{}", NAMES[0]);
    let fit = serde_json::json!({ &key: 1.0, "parameters": { &key: { "value": 1.0, "low": 0.5, "high": NAMES[1] } }, "remarks": NAMES });
    bench.write("foreign/fit.json", fit.to_string());

    let model = "--model sample/model.toml";
    let of = |words: String| {
        let words: Vec<&str> = words.split(' ').collect();
        // Findings that fall short are pages as well.
        bench.kufe(&[&words[..], &["-q"]].concat());
    };
    of("runs check sample/runs.csv --view -o check".to_owned());
    of(format!("runs view sample/runs.csv {model} -o viewed.html"));
    of(format!(
        "evaluate sample/runs.csv {model} --view -o evaluated"
    ));
    of("report evaluated".to_owned());
    of(format!("discover experiments.csv {model} -o found"));
    of("report foreign".to_owned());
    std::fs::create_dir(bench.path("gathered")).expect("a folder");
    of("runs gather sample -o gathered/runs.csv".to_owned());
    of("report gathered".to_owned());
    let mut browser = Browser::start(
        &program,
        &["--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
    );
    let links = "[...document.querySelectorAll('a[href^=\"view.html#\"]')].length >= 8";
    for page in ["check/check.html", "evaluated/report.html"] {
        browser.open(&address(&bench.path(page)), DESK);
        assert_eq!(browser.evaluate(links), true, "{page}");
    }
    for page in [
        "check/check.html",
        "check/view.html",
        "viewed.html",
        "evaluated/report.html",
        "found/report.html",
        "foreign/report.html",
        "gathered/report.html",
    ] {
        is_harmless(&mut browser, &bench, page);
    }
}
