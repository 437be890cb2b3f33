//! `kufe view`: the page of a contact with a form that solves again, served to this machine alone.

mod form;
mod guard;
mod http;
mod turn;

use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use form::Form;
use http::{Answer, Refusal, Request, read_request, respond};
use kufe_contact::Options;
use kufe_jobs::{Watch, press_with};
use kufe_report::{Kind, page};
use serde_json::{Value, json};
use turn::Turn;

use crate::case_file::LoadedCase;
use crate::failure::Failure;
use crate::output::{Global, say};
use crate::placed_hull::placed_hull;
use crate::{patches, report};

/// Points along and across of the map that a page is sent.
const POINTS: [usize; 2] = [240, 150];
/// A mesh beyond this takes longer than anyone moves a slider.
const MOST_DOFS: usize = 1_500_000;
/// Connections that are open at once.
const MOST_OPEN: usize = 16;

const EXAMPLES: &str = "\
Examples:
  kufe view                     the built-in runner, with sliders
  kufe view case.toml           a case of your own; save what you find as case.toml
  kufe view --port 8000         at an address that stays

Open the address that is printed; Ctrl-C ends it. It listens on 127.0.0.1 only.";

/// Arguments of `kufe view`.
#[derive(clap::Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// The case to begin with; a built-in bobsled runner where none is given
    pub case: Option<PathBuf>,
    /// Port to listen on; 0 takes a free one
    #[arg(long, default_value_t = 0)]
    pub port: u16,
}

/// What every connection shares.
struct Server {
    base: LoadedCase,
    port: u16,
    first: String,
    turn: Turn,
}

/// Serves the page until it is interrupted.
///
/// # Errors
/// [`Failure::BadInput`] for the case and a port that is taken, [`Failure::NotConverged`] where the first solve stops short.
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
    let port = listener.local_addr().map_err(Failure::bad_input)?.port();
    let bar = global.progress();
    bar.set_message("solving the first contact");
    let mut data = solved(base.clone(), &Arc::new(AtomicBool::new(false)))?;
    bar.finish_and_clear();
    data["form"] = json!(Form::of(&base.case));
    data["ranges"] = Form::ranges();
    let title = data["title"].as_str().unwrap_or_default();
    let server = Server {
        first: page(Kind::View, title, &data),
        base,
        port,
        turn: Turn::default(),
    };
    let address = format!("http://127.0.0.1:{port}/");
    if global.json {
        say(&format!("{:#}\n", json!({ "address": address })));
    } else {
        say(&format!("{address}\n"));
    }
    serve(&listener, &server);
    Ok(())
}

/// Answers one connection a thread.
fn serve(listener: &TcpListener, server: &Server) {
    let open = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for stream in listener.incoming() {
            let Ok(mut stream) = stream else { continue };
            if open.fetch_add(1, Ordering::Relaxed) >= MOST_OPEN {
                open.fetch_sub(1, Ordering::Relaxed);
                continue;
            }
            let open = &open;
            scope.spawn(move || {
                let answer = answer(server, &mut stream).unwrap_or_else(|Refusal(status, text)| {
                    as_json(status, &json!({ "error": text }))
                });
                respond(&mut stream, &answer);
                open.fetch_sub(1, Ordering::Relaxed);
            });
        }
    });
}

fn answer(server: &Server, stream: &mut TcpStream) -> Result<Answer, Refusal> {
    let request = read_request(stream)?;
    guard::check(&request, server.port)?;
    match (request.method.as_str(), request.target.as_str()) {
        ("GET", "/") => Ok(Answer {
            status: 200,
            kind: "text/html; charset=utf-8",
            body: server.first.clone().into_bytes(),
        }),
        ("POST", "/solve") => solve_again(server, &request),
        (_, "/" | "/solve") => Err(Refusal(405, "expected GET / or POST /solve".into())),
        _ => Err(Refusal(404, "there is only / and /solve".into())),
    }
}

fn as_json(status: u16, value: &Value) -> Answer {
    Answer {
        status,
        kind: "application/json",
        body: value.to_string().into_bytes(),
    }
}

/// Solves what the form asks for, unless a newer form arrives.
fn solve_again(server: &Server, request: &Request) -> Result<Answer, Refusal> {
    let form: Form = serde_json::from_slice(&request.body)
        .map_err(|error| Refusal(400, format!("the form: {error}")))?;
    let case = form
        .case(&server.base.case)
        .map_err(|text| Refusal(422, text))?;
    let asked = LoadedCase {
        case,
        ..server.base.clone()
    };
    match server.turn.take(|stop| solved(asked, stop)) {
        None => Err(Refusal(409, "a newer form came first".into())),
        Some(Err(failure)) => Err(Refusal(422, failure.to_string())),
        Some(Ok(data)) => Ok(as_json(200, &data)),
    }
}

/// The data of a case's page, with the case as a file would state it.
fn solved(loaded: LoadedCase, stop: &Arc<AtomicBool>) -> Result<Value, Failure> {
    let name = loaded.name.clone();
    let options = Options {
        stop: Some(stop.clone()),
        max_dofs: MOST_DOFS,
        ..Options::default()
    };
    let pressed = press_with(loaded, &Watch::default(), options)?;
    let maps = patches::maps(&pressed.solution);
    let hull = placed_hull(&pressed.problem, &pressed.solution);
    let document = pressed.document();
    let mut data = report::contact(&document, &maps, hull.as_ref(), POINTS, &name);
    data["case_text"] = json!(pressed.loaded.case.to_toml().map_err(Failure::bad_input)?);
    Ok(data)
}
