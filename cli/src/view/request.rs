//! One request of HTTP/1.1 on a connection, and its answer.

use std::io::{ErrorKind, Read, Result, Write, copy, sink};
use std::net::{Shutdown, TcpStream};
use std::time::Duration;

/// An HTTP status that is no success, and the reason.
pub type Refusal = (u16, String);

/// Longest head of a request [bytes], and most headers.
const LONGEST_HEAD: usize = 16 << 10;
const MOST_HEADERS: usize = 64;
/// How long a connection may be idle.
const PATIENCE: Duration = Duration::from_secs(60);
/// How long and how much is read after the answer, so that it arrives before the connection ends
/// [bytes].
const LINGER: Duration = Duration::from_secs(1);
const MOST_UNREAD: u64 = 1 << 20;

/// The head of a request, and its connection.
pub struct Request {
    /// `GET`, `POST` and others.
    pub method: String,
    /// The path with its query.
    pub target: String,
    headers: Vec<(String, String)>,
    /// What arrived after the head.
    rest: Vec<u8>,
    stream: TcpStream,
}

impl Request {
    /// Waits for the head of a request.
    ///
    /// # Errors
    /// The system's where the connection ends or stays idle; [`ErrorKind::InvalidData`] for no head
    /// of a request.
    pub fn read(mut stream: TcpStream) -> Result<Request> {
        stream.set_read_timeout(Some(PATIENCE))?;
        stream.set_write_timeout(Some(PATIENCE))?;
        let mut bytes = Vec::new();
        loop {
            let mut headers = [httparse::EMPTY_HEADER; MOST_HEADERS];
            let mut head = httparse::Request::new(&mut headers);
            let parsed = head.parse(&bytes);
            if let Ok(httparse::Status::Complete(end)) = parsed {
                let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
                let headers = head.headers.iter();
                return Ok(Request {
                    method: head.method.unwrap_or_default().to_owned(),
                    target: head.path.unwrap_or_default().to_owned(),
                    headers: headers
                        .map(|header| (header.name.to_owned(), text(header.value)))
                        .collect(),
                    rest: bytes.split_off(end),
                    stream,
                });
            }
            if parsed.is_err() || bytes.len() > LONGEST_HEAD {
                return Err(ErrorKind::InvalidData.into());
            }
            let mut chunk = [0; 4096];
            match stream.read(&mut chunk)? {
                0 => return Err(ErrorKind::UnexpectedEof.into()),
                read => bytes.extend(&chunk[..read]),
            }
        }
    }

    /// The value of the only header of this name; `None` where there is none or more than one.
    pub fn header(&self, name: &str) -> Option<&str> {
        let mut found = self
            .headers
            .iter()
            .filter(|(known, _)| known.eq_ignore_ascii_case(name));
        let (_, value) = found.next()?;
        found.next().is_none().then_some(value)
    }

    /// Reads the body, of a stated length of at most `longest` bytes.
    ///
    /// # Errors
    /// 411 without a length, 413 for a longer body, 408 where the connection ends before.
    pub fn body(&mut self, longest: usize) -> std::result::Result<Vec<u8>, Refusal> {
        let stated = self.header("content-length");
        let Some(length) = stated.and_then(|length| length.parse::<usize>().ok()) else {
            return Err((411, "expected a content-length".into()));
        };
        if length > longest {
            let text = format!("expected a body of at most {longest} bytes");
            return Err((413, text));
        }
        let mut body = std::mem::take(&mut self.rest);
        body.truncate(length);
        let arrived = body.len();
        body.resize(length, 0);
        let read = self.stream.read_exact(&mut body[arrived..]);
        read.map_err(|error| (408, error.to_string()))?;
        Ok(body)
    }

    /// Sends the answer and ends the connection.
    ///
    /// # Errors
    /// The system's where the reader has gone away.
    pub fn answer(mut self, status: u16, headers: &[(&str, &str)], body: &[u8]) -> Result<()> {
        // The number says it all.
        let mut head = format!("HTTP/1.1 {status} \r\nConnection: close\r\n");
        for (name, value) in headers {
            head += &format!("{name}: {value}\r\n");
        }
        head += &format!("Content-Length: {}\r\n\r\n", body.len());
        self.stream.write_all(head.as_bytes())?;
        self.stream.write_all(body)?;
        self.stream.shutdown(Shutdown::Write)?;
        self.stream.set_read_timeout(Some(LINGER))?;
        copy(&mut self.stream.take(MOST_UNREAD), &mut sink()).map(|_| ())
    }
}
