//! `kufe view`: the page of a contact with a form that solves again, served only to this machine.

mod form;
mod turn;

use std::collections::BTreeMap;
use std::error::Error;
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use kufe::jobs::field::placed_hull;
use kufe::jobs::{Contact, Failure, Located, case_file::LoadedCase};
use kufe::report::{ContactPage, Kind, page};
use kufe_contact::{Options, pressure_maps};
use serde::Serialize;
use tiny_http::{Header, Request, Response};

use crate::terminal::Global;
use crate::view::form::Form;
use crate::view::turn::Turn;

/// Arguments of `kufe view`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The case to begin with; a built-in bobsled runner where none is given
    pub case: Option<PathBuf>,
    /// Port to listen on; 0 takes a free one
    #[arg(long, default_value_t = 0)]
    pub port: u16,
}

/// Data of the page.
#[derive(Serialize)]
struct ViewPage {
    #[serde(flatten)]
    solved: Solved,
    form: Form,
    ranges: BTreeMap<&'static str, [f64; 2]>,
}

/// Where the page is served.
#[derive(Serialize)]
struct Listening {
    address: String,
}

/// Serves the page until it is interrupted.
///
/// # Errors
/// [`Failure::BadInput`] for the case and a port that is taken, [`Failure::NotConverged`] if the
/// first solve stops short.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let base = match &args.case {
        Some(path) => LoadedCase::read(path)?,
        None => LoadedCase::example()?,
    };
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, args.port)).map_err(|error| {
        Failure::BadInput(format!(
            "--port {}: cannot be listened on: {error}",
            args.port
        ))
    })?;
    let port = listener.local_addr().bad_input()?.port();
    let solved = global.during("solving the first contact", || {
        solved(base.clone(), &Arc::new(AtomicBool::new(false)))
    })?;
    let title = solved.page.title.clone();
    let data = ViewPage {
        solved,
        form: Form::of(&base.case),
        ranges: Form::ranges(),
    };
    let server = Server {
        first: page(Kind::View, &title, &data),
        base,
        port,
        turn: Turn::default(),
    };
    let address = format!("http://127.0.0.1:{port}/");
    let connections = Connections::new(listener);
    let connections =
        connections.map_err(|error| Failure::BadInput(format!("--port {port}: {error}")))?;
    let listening = Listening { address };
    global.answer(&listening, || format!("{}\n", listening.address))?;
    serve(&connections, &server);
    Ok(())
}

/// Number of points along and across of the map that is sent to the page.
const POINTS: [usize; 2] = [240, 150];
/// Largest number of unknowns: a larger mesh takes longer than a user waits for a slider.
const MAX_DOFS: usize = 1_500_000;
/// Largest body of a request [bytes].
const MAX_BODY_BYTES: usize = 4 << 10;
/// Headers of every answer in addition to its type and the page's content security policy.
const HEADERS: [(&str, &str); 6] = [
    ("Cache-Control", "no-store"),
    ("X-Content-Type-Options", "nosniff"),
    ("X-Frame-Options", "DENY"),
    ("Cross-Origin-Resource-Policy", "same-origin"),
    ("Cross-Origin-Opener-Policy", "same-origin"),
    ("Referrer-Policy", "no-referrer"),
];

/// HTTP status of an error, and the reason.
type Refusal = (u16, String);

/// Data shared by all requests.
struct Server {
    /// The case to begin with.
    base: LoadedCase,
    /// The port that it listens on.
    port: u16,
    /// The page, with the first solve.
    first: String,
    /// The request that is solved now.
    turn: Turn,
}

/// Connections of a listener.
struct Connections {
    http: tiny_http::Server,
    /// Idle connections to itself, which occupy its first threads.
    ///
    /// tiny_http (0.12) may queue two new connections for one waiting thread: the second is then
    /// answered when the first is closed, which a spare connection of a browser is not. A connection
    /// that finds no waiting thread has a thread of its own.
    _idle: Vec<TcpStream>,
}

impl Connections {
    /// Accepts connections from now on.
    ///
    /// # Errors
    /// The system's for a listener that cannot be used.
    fn new(listener: TcpListener) -> Result<Self, Box<dyn Error + Send + Sync>> {
        const FIRST_THREADS: usize = 4;
        let address = listener.local_addr()?;
        let http = tiny_http::Server::from_listener(listener, None)?;
        let connection = |_| {
            let connection = TcpStream::connect(address).ok();
            std::thread::sleep(Duration::from_millis(25));
            connection
        };
        // The first threads of the server must be waiting before the connections.
        std::thread::sleep(Duration::from_millis(25));
        let _idle = (0..FIRST_THREADS).filter_map(connection).collect();
        Ok(Self { http, _idle })
    }
}

/// Answers requests until the process ends.
fn serve(connections: &Connections, server: &Server) {
    std::thread::scope(|scope| {
        for request in connections.http.incoming_requests() {
            // A failed answer is ignored: the reader has gone away. If no thread can be started,
            // tiny_http answers with an error.
            let answer = || respond(server, request).ok();
            let _ = std::thread::Builder::new().spawn_scoped(scope, answer);
        }
    });
}

/// Largest stated length of a body that is answered [bytes].
const MAX_UNREAD_BYTES: usize = 1 << 30;

fn respond(server: &Server, mut request: Request) -> std::io::Result<()> {
    // tiny_http (0.12) allocates the stated length of a body that nobody has read, even if it is
    // refused. Such a request has no answer.
    if request.body_length() > Some(MAX_UNREAD_BYTES) {
        std::mem::forget(request);
        return Ok(());
    }
    let (status, kind, body) = match answer(server, &mut request) {
        Ok((kind, body)) => (200, kind, body),
        Err((status, error)) => {
            let body = serde_json::to_string(&Refused { error })?;
            (status, "application/json", body)
        }
    };
    let policy = Kind::View.policy() + "; frame-ancestors 'none'";
    let own = [("Content-Type", kind), ("Content-Security-Policy", &policy)];
    let headers = own.into_iter().chain(HEADERS);
    let headers = headers.filter_map(|(name, value)| Header::from_bytes(name, value).ok());
    // All lengths are known: chunked encoding is disabled.
    let plain = Response::from_data(body)
        .with_status_code(status)
        .with_chunked_threshold(usize::MAX);
    request.respond(headers.fold(plain, Response::with_header))
}

/// The media type and the body of the answer.
fn answer(server: &Server, request: &mut Request) -> Result<(&'static str, String), Refusal> {
    let method = request.method().to_string();
    // The value of a header; `None` if it occurs more than once.
    let header = |name: &str| {
        let mut found = request.headers().iter();
        let mut found = found
            .by_ref()
            .filter(|header| header.field.as_str().as_str().eq_ignore_ascii_case(name));
        let first = found.next()?;
        found.next().is_none().then(|| first.value.as_str())
    };
    check_origin(&method, server.port, header)?;
    match (&*method, request.url()) {
        ("GET", "/") => Ok(("text/html; charset=utf-8", server.first.clone())),
        ("POST", "/solve") => Ok(("application/json", solve_again(server, &body(request)?)?)),
        (_, "/" | "/solve") => Err((405, "expected GET / or POST /solve".into())),
        _ => Err((404, "there is only / and /solve".into())),
    }
}

/// The body of a request, of a stated length.
fn body(request: &mut Request) -> Result<Vec<u8>, Refusal> {
    match request.body_length() {
        None => Err((411, "expected a content-length".into())),
        Some(length) if length > MAX_BODY_BYTES => Err((
            413,
            format!("expected a body of at most {MAX_BODY_BYTES} bytes"),
        )),
        Some(length) => {
            let mut body = vec![0; length];
            let read = request.as_reader().read_exact(&mut body);
            read.map(|()| body)
                .map_err(|error| (408, error.to_string()))
        }
    }
}

/// The error of a failed solve.
#[derive(Serialize)]
struct Refused {
    error: String,
}

/// A contact for the page, with its case as TOML.
#[derive(Serialize)]
struct Solved {
    /// The contact.
    #[serde(flatten)]
    page: ContactPage,
    /// `case.toml`.
    case_text: String,
}

/// Refuses requests that pages of other sites, or other names for this machine, could send.
///
/// The host must be a name of this machine with the server's port, which prevents DNS rebinding. A
/// solve must be requested by a page of the same origin and as JSON, which no foreign form can
/// send.
fn check_origin<'a>(
    method: &str,
    port: u16,
    header: impl Fn(&str) -> Option<&'a str>,
) -> Result<(), Refusal> {
    let names = [format!("127.0.0.1:{port}"), format!("localhost:{port}")];
    let host = header("host").unwrap_or_default();
    if !names.iter().any(|name| name == host) {
        let [a, b] = names;
        return Err((403, format!("host {host:?}: expected {a} or {b}")));
    }
    let site = header("sec-fetch-site");
    if method == "GET" {
        // Links from other sites are allowed; their scripts cannot read the answer.
        let navigates = header("sec-fetch-mode") == Some("navigate");
        return match site {
            Some("cross-site" | "same-site") if !navigates => {
                Err((403, "requested by a page of another site".into()))
            }
            _ => Ok(()),
        };
    }
    let origin = header("origin").unwrap_or_default();
    if origin != format!("http://{host}") || !matches!(site, None | Some("same-origin")) {
        return Err((403, format!("origin {origin:?}: expected http://{host}")));
    }
    if header("content-type") != Some("application/json") {
        return Err((415, "expected application/json".into()));
    }
    Ok(())
}

/// Solves what the form requests, unless a newer form arrives.
fn solve_again(server: &Server, body: &[u8]) -> Result<String, Refusal> {
    let form: Form =
        serde_json::from_slice(body).map_err(|error| (400, format!("the form: {error}")))?;
    let case = form.case(&server.base.case).map_err(|text| (422, text))?;
    let loaded = LoadedCase {
        case,
        ..server.base.clone()
    };
    match server.turn.take(|stop| solved(loaded, stop)) {
        None => Err((409, "a newer form came first".into())),
        Some(Err(failure)) => Err((422, failure.to_string())),
        Some(Ok(solved)) => {
            serde_json::to_string(&solved).map_err(|error| (422, error.to_string()))
        }
    }
}

/// Solves a case; returns the data of its page, with the case as TOML.
fn solved(loaded: LoadedCase, stop: &Arc<AtomicBool>) -> Result<Solved, Failure> {
    let name = loaded.name.clone();
    let options = Options {
        stop: Some(stop.clone()),
        max_dofs: MAX_DOFS,
        ..Options::default()
    };
    let pressed = Contact::from(loaded).options(options).solve()?;
    let maps = pressure_maps(&pressed.solution);
    let hull = placed_hull(&pressed.problem, &pressed.solution);
    let page = ContactPage::new(pressed.result(), &maps, hull.as_ref(), POINTS, name)?;
    let case_text = pressed.loaded.case.to_toml().bad_input()?;
    Ok(Solved { page, case_text })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status(method: &str, headers: &[(&str, &'static str)]) -> u16 {
        let header = |name: &str| {
            let mut found = headers.iter().filter(|(known, _)| *known == name);
            let first = found.next()?.1;
            found.next().is_none().then_some(first)
        };
        check_origin(method, 4000, header).map_or_else(|refusal| refusal.0, |()| 200)
    }

    #[test]
    fn only_this_servers_own_names_are_hosts() {
        let of = |host| status("GET", &[("host", host)]);
        assert_eq!(of("127.0.0.1:4000"), 200);
        assert_eq!(of("localhost:4000"), 200);
        for host in [
            "127.0.0.1",
            "127.0.0.1:4001",
            "evil.example:4000",
            "localhost:4000.evil.example",
            "",
        ] {
            assert_eq!(of(host), 403, "{host}");
        }
        assert_eq!(status("GET", &[]), 403);
        let twice = [("host", "127.0.0.1:4000"), ("host", "evil.example")];
        assert_eq!(status("GET", &twice), 403);
    }

    #[test]
    fn only_a_page_of_the_same_origin_may_request_work() {
        let host = ("host", "127.0.0.1:4000");
        let json = ("content-type", "application/json");
        let own = ("origin", "http://127.0.0.1:4000");
        let foreign = ("sec-fetch-site", "cross-site");
        let post = |headers: &[(&str, &'static str)]| status("POST", headers);
        assert_eq!(post(&[host, own, json]), 200);
        assert_eq!(
            post(&[host, own, json, ("sec-fetch-site", "same-origin")]),
            200
        );
        for origin in ["null", "http://localhost:4000", "https://evil.example"] {
            assert_eq!(post(&[host, json, ("origin", origin)]), 403, "{origin}");
        }
        assert_eq!(post(&[host, json]), 403);
        assert_eq!(post(&[host, own, json, foreign]), 403);
        assert_eq!(post(&[host, own, ("content-type", "text/plain")]), 415);
        assert_eq!(status("GET", &[host, foreign]), 403);
        let link = [host, foreign, ("sec-fetch-mode", "navigate")];
        assert_eq!(status("GET", &link), 200);
    }
}
