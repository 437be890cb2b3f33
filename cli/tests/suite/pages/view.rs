//! `kufe view`: what it serves, to whom, and what it refuses.

use kufe_outside::not_here;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{IpAddr, TcpStream, UdpSocket};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use serde_json::Value;

use crate::kufe::{Bench, CASE, errors};
use crate::pages::browser::{Browser, DESK, Look, chromium, wait};

const FORM: &str = "{\"shape\":\"bob\",\"rocker_radius_m\":20.0,\"section_radius_m\":0.005,\"edge_radius_m\":0.0003,\
                    \"tilt_rad\":0.0,\"fz_n\":1000.0,\"curvature_1pm\":0.0,\"offset_x_m\":0.0,\"hardness_pa\":1e9}";

/// A running `kufe view`, ended with this value.
struct View {
    process: Child,
    port: u16,
}

impl View {
    fn start(bench: &Bench, words: &[&str]) -> View {
        let mut process = Command::new(env!("CARGO_BIN_EXE_kufe"))
            .arg("view")
            .args(words)
            .current_dir(bench.folder.path())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the command runs");
        let mut line = String::new();
        let stdout = process.stdout.take().expect("its output");
        BufReader::new(stdout)
            .read_line(&mut line)
            .expect("an address");
        let port = line
            .trim()
            .strip_prefix("http://127.0.0.1:")
            .and_then(|rest| rest.strip_suffix('/'))
            .unwrap_or_else(|| panic!("no address: {line:?}"));
        View {
            port: port.parse().expect("a port"),
            process,
        }
    }

    /// Sends bytes and reads the whole answer.
    fn send(&self, bytes: &[u8]) -> String {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).expect("it listens");
        stream
            .set_read_timeout(Some(Duration::from_secs(120)))
            .expect("a time limit");
        // The server may answer and close before it has read what is too long.
        let _ = stream.write_all(bytes);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        String::from_utf8_lossy(&answer).into_owned()
    }

    fn get(&self, target: &str) -> String {
        self.send(
            format!(
                "GET {target} HTTP/1.1\r\nConnection: close\r\nHost: 127.0.0.1:{}\r\n\r\n",
                self.port
            )
            .as_bytes(),
        )
    }

    fn post(&self, headers: &str, body: &str) -> String {
        let head = format!(
            "POST /solve HTTP/1.1\r\nConnection: close\r\n{headers}Content-Length: {}\r\n\r\n",
            body.len()
        );
        self.send((head + body).as_bytes())
    }

    /// The headers of the page's own requests.
    fn own(&self) -> String {
        let port = self.port;
        format!(
            "Host: 127.0.0.1:{port}\r\nOrigin: http://127.0.0.1:{port}\r\nContent-Type: application/json\r\n"
        )
    }
}

impl Drop for View {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

fn status(answer: &str) -> u16 {
    let word = answer.split(' ').nth(1).unwrap_or_default();
    word.parse()
        .unwrap_or_else(|_| panic!("no answer: {answer:?}"))
}

fn body(answer: &str) -> Value {
    let body = answer.split_once("\r\n\r\n").map_or("", |(_, body)| body);
    serde_json::from_str(body).unwrap_or_else(|error| panic!("{error}: {answer}"))
}

#[test]
fn strangers_and_oversized_requests_are_refused() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    let view = View::start(&bench, &["case.toml"]);
    let port = view.port;

    let page = view.get("/");
    assert_eq!(status(&page), 200);
    for header in [
        "Content-Security-Policy: default-src 'none'",
        "frame-ancestors 'none'",
        "X-Content-Type-Options: nosniff",
        "Cross-Origin-Resource-Policy: same-origin",
        "Cache-Control: no-store",
    ] {
        assert!(page.contains(header), "{header} is missing");
    }
    assert!(!page.contains("Access-Control-Allow"));

    // Only this machine: its other addresses do not answer.
    let other = UdpSocket::bind("0.0.0.0:0").and_then(|socket| {
        socket.connect("192.0.2.1:9")?;
        socket.local_addr()
    });
    match other.map(|address| address.ip()) {
        Ok(ip @ IpAddr::V4(_)) if !ip.is_loopback() && !ip.is_unspecified() => {
            assert!(
                TcpStream::connect_timeout(&(ip, port).into(), Duration::from_secs(2)).is_err()
            );
        }
        _ => not_here("no address but the loopback's"),
    }

    // Paths lead nowhere, however they are written.
    for target in [
        "/../../etc/passwd",
        "/%2e%2e/%2e%2e/etc/passwd",
        "//etc/passwd",
        "/case.toml",
        "/solve/..",
        "/?x",
    ] {
        assert_eq!(status(&view.get(target)), 404, "{target}");
    }

    // Another name for this machine, and pages of other sites.
    let rebound =
        format!("GET / HTTP/1.1\r\nConnection: close\r\nHost: evil.example:{port}\r\n\r\n");
    assert_eq!(status(&view.send(rebound.as_bytes())), 403);
    let host = format!("Host: 127.0.0.1:{port}\r\n");
    let json = "Content-Type: application/json\r\n";
    for headers in [
        format!("{host}{json}"),
        format!("{host}{json}Origin: https://evil.example\r\n"),
        format!("{host}{json}Origin: null\r\n"),
        format!("{host}{json}Origin: http://127.0.0.1:{}\r\n", port ^ 1),
        format!("Host: evil.example\r\n{json}Origin: http://evil.example\r\n"),
        format!("{}Sec-Fetch-Site: cross-site\r\n", view.own()),
    ] {
        assert_eq!(status(&view.post(&headers, FORM)), 403, "{headers}");
    }
    let form = format!("{host}Origin: http://127.0.0.1:{port}\r\nContent-Type: text/plain\r\n");
    assert_eq!(status(&view.post(&form, FORM)), 415);

    // Too much of anything.
    let own = view.own();
    assert_eq!(status(&view.post(&own, &" ".repeat(5000))), 413);
    let chunks = format!(
        "POST /solve HTTP/1.1\r\nConnection: close\r\n{own}Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n"
    );
    assert_eq!(status(&view.send(chunks.as_bytes())), 411);
    let put = format!("PUT / HTTP/1.1\r\nConnection: close\r\n{own}Content-Length: 0\r\n\r\n");
    assert_eq!(status(&view.send(put.as_bytes())), 405);

    // Forms that are none.
    assert_eq!(status(&view.post(&own, "{}")), 400);
    let hull = FORM.replace("{\"shape\"", "{\"hull\":\"/etc/passwd\",\"shape\"");
    assert_eq!(status(&view.post(&own, &hull)), 400);
    let answer = view.post(&own, &FORM.replace("1000.0", "1e9"));
    assert_eq!(status(&answer), 422);
    assert!(answer.contains("fz_n = 1000000000"), "{answer}");
    // After all of that it still works.
    assert_eq!(status(&view.post(&own, FORM)), 200);
    let taken = bench.kufe(&["view", "case.toml", "--port", &port.to_string()]);
    assert_eq!(taken.status.code(), Some(3), "{}", errors(&taken));
}

#[test]
fn spare_connections_of_a_browser_do_not_block_the_page() {
    let bench = Bench::new();
    let view = View::start(&bench, &[]);
    let idle: Vec<TcpStream> = (0..40)
        .map(|_| TcpStream::connect(("127.0.0.1", view.port)).expect("it listens"))
        .collect();
    for _ in 0..3 {
        assert_eq!(status(&view.get("/")), 200);
    }
    drop(idle);
}

#[test]
fn a_solve_answers_as_press_does_and_a_newer_form_overtakes_it() {
    let bench = Bench::new();
    bench.write("fine.toml", CASE.replace("p_max = 0.02", "p_max = 0.0005"));
    let view = View::start(&bench, &["fine.toml"]);
    let answer = body(&view.post(&view.own(), FORM));
    bench.write("saved.toml", answer["case_text"].as_str().expect("a case"));
    let pressed: Value =
        serde_json::from_str(&bench.succeeds(&["press", "saved.toml", "--json"])).expect("JSON");
    for key in ["p_max_pa", "area_m2", "approach_m", "fz_n"] {
        assert_eq!(answer["result"][key], pressed[key], "{key}");
    }
    assert_eq!(pressed["case"]["runner"]["shape"]["rocker_radius_m"], 20.0);

    let answers: Vec<u16> = std::thread::scope(|scope| {
        let requests: Vec<_> = (0..5)
            .map(|k| {
                let form = FORM.replace("1000.0", &format!("{}.0", 1000 + 100 * k));
                let view = &view;
                // The last one is sent long after the others, so that on a busy machine, too, none of them comes after it.
                let apart_ms = if k == 4 { 600 } else { 40 };
                std::thread::sleep(Duration::from_millis(apart_ms));
                scope.spawn(move || status(&view.post(&view.own(), &form)))
            })
            .collect();
        requests
            .into_iter()
            .map(|one| one.join().expect("no panic"))
            .collect()
    });
    assert_eq!(answers[4], 200, "{answers:?}");
    assert!(answers.contains(&409), "{answers:?}");
    assert!(
        answers.iter().all(|status| [200, 409].contains(status)),
        "{answers:?}"
    );
}

#[test]
#[ignore = "slow study: .ci/slow"]
fn sliders_solve_again_in_a_browser() {
    let Some(program) = chromium() else { return };
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    let view = View::start(&bench, &["case.toml"]);
    let address = format!("http://127.0.0.1:{}/", view.port);
    let mut browser = Browser::start(
        &program,
        &["--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
    );
    let phone = Look {
        width: 390,
        height: 844,
        dark: true,
    };
    for (look, name) in [
        (DESK, "view-wide-light.png"),
        (phone, "view-phone-dark.png"),
    ] {
        browser.open(&address, look);
        let wide = browser.evaluate("document.documentElement.scrollWidth - innerWidth");
        assert!(
            wide.as_i64().expect("a number") <= 0,
            "{wide} px too wide at {look:?}"
        );
        assert!(browser.text("h1").ends_with("under 1.000 kN"));
        let slide = "(() => { const s = document.querySelector('input[name=fz_n]'); s.value = 700; s.dispatchEvent(new Event('input')); })()";
        browser.evaluate(slide);
        wait(|| Some(()).filter(|()| browser.text(".state").starts_with("solved in")));
        // 50 N (10000 / 50)^0.7 = 2040 N; a point contact's peak grows with the cube root of its load.
        let title = browser.text("h1");
        assert!(title.ends_with("under 2.040 kN"), "{title}");
        let peak: f64 = title
            .split(' ')
            .next()
            .and_then(|word| word.parse().ok())
            .expect("a peak");
        assert!(
            (peak / (138.5 * 2.04f64.cbrt()) - 1.0).abs() < 0.02,
            "{peak}"
        );
        assert!(browser.colours(".stage canvas").0 > 100);
        if look.width < 600 {
            // Scrolled to the picture, sliders and picture are both on the screen.
            browser.evaluate("scrollBy(0, document.querySelector('.stage').getBoundingClientRect().bottom - innerHeight)");
            browser.settle();
            let both = "['.sliders', '.stage'].map((name) => document.querySelector(name).getBoundingClientRect()).every((box) => box.top >= 0 && box.bottom <= innerHeight + 1)";
            assert_eq!(browser.evaluate(both), true);
        }
        assert_eq!(browser.errors(), Vec::<String>::new());
        browser.keep_picture(name, look, if look.dark { 1300 } else { 1180 });
    }
}
