//! A headless Chromium, driven over its DevTools protocol.

use kufe_outside::missing;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};
use tempfile::TempDir;

/// How long anything may take; the machine may be busy.
const PATIENCE: Duration = Duration::from_secs(120);

/// A browser with one tab.
pub struct Browser {
    process: Child,
    input: ChildStdin,
    answers: Receiver<Vec<u8>>,
    session: String,
    calls: u64,
    events: Vec<Value>,
    _profile: TempDir,
}

/// How a page is looked at.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// Width of the screen in CSS pixels.
    pub width: u32,
    /// Height of the screen in CSS pixels.
    pub height: u32,
    /// Whether the reader prefers dark pages.
    pub dark: bool,
}

/// A desk's screen, light.
pub const DESK: Look = Look {
    width: 1280,
    height: 900,
    dark: false,
};

/// The installed Chromium; `None`, with a word, where there is none.
pub fn chromium() -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let found = std::env::split_paths(&path).find_map(|folder| {
        ["chromium", "chromium-browser", "google-chrome"]
            .iter()
            .map(|name| folder.join(name))
            .find(|program| program.is_file())
    });
    if found.is_none() {
        missing("there is no chromium on the PATH");
    }
    found
}

/// Where a browser finds a page.
pub fn address(path: &Path) -> String {
    let path = path.canonicalize().expect("a page");
    format!("file://{}", path.display())
}

impl Browser {
    /// Starts the browser with further `flags`.
    pub fn start(program: &Path, flags: &[&str]) -> Browser {
        let profile = tempfile::tempdir().expect("a temporary folder");
        // Its protocol runs over descriptors 3 and 4, each message ended by a zero.
        let mut process = Command::new("sh")
            .args(["-c", r#"exec "$0" "$@" 3<&0 4>&1 </dev/null >/dev/null"#])
            .arg(program)
            .args(["--headless", "--no-sandbox", "--no-first-run"])
            .args([
                "--disable-background-networking",
                "--disable-component-update",
            ])
            .args([
                "--disable-sync",
                "--disable-dev-shm-usage",
                "--hide-scrollbars",
            ])
            .arg("--remote-debugging-pipe")
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .args(flags)
            .arg("about:blank")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("chromium starts");
        let mut pipe = BufReader::new(process.stdout.take().expect("a pipe"));
        let (send, answers) = channel();
        std::thread::spawn(move || {
            let mut text = Vec::new();
            // Until the browser or the test ends.
            while pipe.read_until(0, &mut text).is_ok() && text.pop() == Some(0) {
                if send.send(std::mem::take(&mut text)).is_err() {
                    break;
                }
            }
        });
        let mut browser = Browser {
            input: process.stdin.take().expect("a pipe"),
            answers,
            process,
            session: String::new(),
            calls: 0,
            events: Vec::new(),
            _profile: profile,
        };
        let target = browser.call("Target.createTarget", json!({ "url": "about:blank" }));
        let attach = json!({ "targetId": target["targetId"], "flatten": true });
        let attached = browser.call("Target.attachToTarget", attach);
        browser.session = attached["sessionId"]
            .as_str()
            .expect("a session")
            .to_string();
        for domain in ["Page.enable", "Runtime.enable", "Log.enable"] {
            browser.call(domain, json!({}));
        }
        browser
    }

    /// Sends a command to the browser and waits for its answer.
    pub fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.calls += 1;
        let mut message = json!({ "id": self.calls, "method": method, "params": parameters });
        if !self.session.is_empty() {
            message["sessionId"] = json!(self.session);
        }
        let mut bytes = message.to_string().into_bytes();
        bytes.push(0);
        let sent = self.input.write_all(&bytes).and(self.input.flush());
        sent.expect("chromium reads");
        loop {
            let text = self.answers.recv_timeout(PATIENCE);
            let text = text.unwrap_or_else(|e| panic!("{method}: chromium does not answer: {e}"));
            let mut answer: Value = serde_json::from_slice(&text).expect("JSON");
            if answer["id"] == self.calls {
                assert!(answer["error"].is_null(), "{method}: {}", answer["error"]);
                return answer["result"].take();
            }
            self.events.push(answer);
        }
    }

    /// Opens a page as it is looked at, and waits until it is drawn.
    pub fn open(&mut self, address: &str, look: Look) {
        self.events.clear();
        self.call(
            "Emulation.setDeviceMetricsOverride",
            json!({ "width": look.width, "height": look.height, "deviceScaleFactor": 1, "mobile": look.width < 600 }),
        );
        let scheme = if look.dark { "dark" } else { "light" };
        let features = json!([{ "name": "prefers-color-scheme", "value": scheme }]);
        self.call(
            "Emulation.setEmulatedMedia",
            json!({ "features": features }),
        );
        self.call("Page.navigate", json!({ "url": address }));
        let begun = Instant::now();
        while self.evaluate("document.readyState === 'complete' && location.href !== 'about:blank'")
            != true
        {
            assert!(begun.elapsed() < PATIENCE, "{address} does not load");
            std::thread::sleep(Duration::from_millis(50));
        }
        self.settle();
    }

    /// Waits for two drawn frames.
    pub fn settle(&mut self) {
        self.evaluate(
            "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(() => done(true)))))",
        );
    }

    /// The value of an expression in the page; a promise is waited for.
    pub fn evaluate(&mut self, expression: &str) -> Value {
        let parameters =
            json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let mut answer = self.call("Runtime.evaluate", parameters);
        assert!(
            answer["exceptionDetails"].is_null(),
            "{expression}: {}",
            answer["exceptionDetails"]
        );
        answer["result"]["value"].take()
    }

    /// The text of what a selector finds.
    pub fn text(&mut self, selector: &str) -> String {
        let found = self.evaluate(&format!("document.querySelector('{selector}').textContent"));
        found.as_str().unwrap_or_default().to_string()
    }

    /// Moves the mouse to parts of a found box, counted from its upper left, pressed or not.
    pub fn mouse(&mut self, kind: &str, selector: &str, at: [f64; 2]) {
        let code = format!(
            "(() => {{ const found = document.querySelector('{selector}'); found.scrollIntoView({{ block: 'center' }}); \
             const b = found.getBoundingClientRect(); return [b.left, b.top, b.width, b.height]; }})()"
        );
        let bounds = self.evaluate(&code);
        let number = |k: usize| bounds[k].as_f64().expect("a box");
        let (x, y) = (number(0) + at[0] * number(2), number(1) + at[1] * number(3));
        let buttons = i32::from(kind != "mouseReleased" && kind != "mouseMoved");
        self.call(
            "Input.dispatchMouseEvent",
            json!({ "type": kind, "x": x, "y": y, "button": "left", "buttons": buttons, "clickCount": 1 }),
        );
        self.settle();
    }

    /// Drags from one part of a found box to another.
    pub fn drag(&mut self, selector: &str, from: [f64; 2], to: [f64; 2]) {
        self.mouse("mousePressed", selector, from);
        self.mouse("mouseMoved", selector, to);
        self.mouse("mouseReleased", selector, to);
    }

    /// Errors of the page since it was opened: exceptions, and errors on the console.
    pub fn errors(&mut self) -> Vec<String> {
        self.settle();
        let bad = |event: &&Value| match event["method"].as_str() {
            Some("Runtime.exceptionThrown") => true,
            Some("Runtime.consoleAPICalled") => event["params"]["type"] == "error",
            Some("Log.entryAdded") => event["params"]["entry"]["level"] == "error",
            _ => false,
        };
        let events = self.events.iter().filter(bad);
        events.map(|event| event["params"].to_string()).collect()
    }

    /// Number of colours on a canvas, and a sum over its pixels that changes with the picture.
    pub fn colours(&mut self, selector: &str) -> (u64, f64) {
        let code = format!(
            "(() => {{ const from = document.querySelector('{selector}'), to = document.createElement('canvas'); \
             to.width = from.width; to.height = from.height; const pen = to.getContext('2d'); pen.drawImage(from, 0, 0); \
             const pixels = new Uint32Array(pen.getImageData(0, 0, to.width, to.height).data.buffer); let sum = 0; \
             pixels.forEach((value, k) => {{ sum = (sum * 31 + value + k) % 1000003; }}); return [new Set(pixels).size, sum]; }})()"
        );
        let found = self.evaluate(&code);
        (
            found[0].as_u64().expect("a count"),
            found[1].as_f64().expect("a sum"),
        )
    }

    /// Keeps a picture of the page's upper `height` pixels where `KUFE_KEEP_PICTURES` names a folder.
    pub fn keep_picture(&mut self, name: &str, look: Look, height: u32) {
        let Some(folder) = std::env::var_os("KUFE_KEEP_PICTURES") else {
            return;
        };
        self.evaluate("scrollTo(0, 0)");
        self.settle();
        let clip = json!({ "x": 0, "y": 0, "width": look.width, "height": height, "scale": 1 });
        let shot = self.call(
            "Page.captureScreenshot",
            json!({ "format": "png", "captureBeyondViewport": true, "clip": clip }),
        );
        let bytes = STANDARD
            .decode(shot["data"].as_str().unwrap_or_default())
            .expect("base64");
        std::fs::write(Path::new(&folder).join(name), bytes).expect("a picture");
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Waits for something to appear.
pub fn wait<T>(mut look: impl FnMut() -> Option<T>) -> T {
    let begun = Instant::now();
    loop {
        if let Some(found) = look() {
            return found;
        }
        assert!(begun.elapsed() < PATIENCE, "waited for {PATIENCE:?}");
        std::thread::sleep(Duration::from_millis(20));
    }
}
