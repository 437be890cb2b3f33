//! The page and the solves that its form asks for, a thread a connection.

use std::net::TcpListener;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use kufe::jobs::{Contact, Failure, case_file::LoadedCase};
use kufe::report::ContactPage;
use kufe_contact::{Options, pressure_maps};
use serde::Serialize;

use crate::bodies::placed_hull::placed_hull;
use crate::view::form::Form;
use crate::view::guard;
use crate::view::http::{Answer, Refusal, Request, read_request, respond};
use crate::view::turn::Turn;
use crate::view::waiting::Waiting;

/// Points along and across of the map that a page is sent.
const POINTS: [usize; 2] = [240, 150];
/// A mesh beyond this takes longer than anyone moves a slider.
const MOST_DOFS: usize = 1_500_000;
/// Requests that are answered at once.
const MOST_ANSWERED: usize = 16;

/// What every connection shares.
pub struct Server {
    /// The case to begin with.
    pub base: LoadedCase,
    /// The port that it listens on.
    pub port: u16,
    /// The page, with the first solve.
    pub first: String,
    /// Who is solved for now.
    pub turn: Turn,
}

/// Answers one connection a thread.
pub fn serve(listener: &TcpListener, server: &Server) {
    let (waiting, answered) = (Waiting::default(), AtomicUsize::new(0));
    std::thread::scope(|scope| {
        for (number, stream) in (0..).zip(listener.incoming()) {
            let Ok(mut stream) = stream else { continue };
            if waiting.enter(number, &stream).is_err() {
                continue;
            }
            let (waiting, answered) = (&waiting, &answered);
            scope.spawn(move || {
                let request = read_request(&mut stream);
                waiting.leave(number);
                let full = answered.fetch_add(1, Ordering::Relaxed) >= MOST_ANSWERED;
                let answer = match request {
                    Ok(_) if full => Err(Refusal(503, "too many requests at once".into())),
                    Ok(request) => answer(server, &request),
                    Err(refusal) => Err(refusal),
                };
                let answer = answer.unwrap_or_else(|Refusal(status, text)| {
                    as_json(status, &Refused { error: text })
                });
                respond(&mut stream, &answer);
                answered.fetch_sub(1, Ordering::Relaxed);
            });
        }
    });
}

fn answer(server: &Server, request: &Request) -> Result<Answer, Refusal> {
    guard::check(request, server.port)?;
    match (request.method.as_str(), request.target.as_str()) {
        ("GET", "/") => Ok(Answer {
            status: 200,
            kind: "text/html; charset=utf-8",
            body: server.first.clone().into_bytes(),
        }),
        ("POST", "/solve") => solve_again(server, request),
        (_, "/" | "/solve") => Err(Refusal(405, "expected GET / or POST /solve".into())),
        _ => Err(Refusal(404, "there is only / and /solve".into())),
    }
}

/// Why there is no contact.
#[derive(Serialize)]
struct Refused {
    error: String,
}

/// A contact for the page, with its case as a file would state it.
#[derive(Serialize)]
pub struct Solved {
    /// The contact.
    #[serde(flatten)]
    pub page: ContactPage,
    /// `case.toml`.
    pub case_text: String,
}

fn as_json(status: u16, value: &impl Serialize) -> Answer {
    Answer {
        status,
        kind: "application/json",
        body: serde_json::to_vec(value).unwrap_or_default(),
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
pub fn solved(loaded: LoadedCase, stop: &Arc<AtomicBool>) -> Result<Solved, Failure> {
    let name = loaded.name.clone();
    let options = Options {
        stop: Some(stop.clone()),
        max_dofs: MOST_DOFS,
        ..Options::default()
    };
    let pressed = Contact::from(loaded).options(options).solve()?;
    let maps = pressure_maps(&pressed.solution);
    let hull = placed_hull(&pressed.problem, &pressed.solution);
    let page = ContactPage::new(pressed.result(), &maps, hull.as_ref(), POINTS, name);
    let case_text = pressed.loaded.case.to_toml().map_err(Failure::bad_input)?;
    Ok(Solved { page, case_text })
}
