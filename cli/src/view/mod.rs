//! `kufe view`: the page of a contact with a form that solves again, served to this machine alone.

mod form;
mod server;
mod turn;

use std::collections::BTreeMap;
use std::net::{Ipv4Addr, TcpListener};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use kufe::jobs::{Failure, case_file::LoadedCase};
use kufe::report::{Kind, page};
use serde::Serialize;

use crate::terminal::Global;
use crate::view::form::Form;
use crate::view::server::{Connections, Server, Solved, serve, solved};
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
/// [`Failure::BadInput`] for the case and a port that is taken, [`Failure::NotConverged`] where the
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
    let port = listener.local_addr().map_err(Failure::bad_input)?.port();
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
