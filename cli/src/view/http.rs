//! As much of HTTP/1.1 as a page on the same machine needs, with a limit on everything.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// Longest request line and headers together [bytes].
pub const LONGEST_HEAD: usize = 8 << 10;
/// Longest body [bytes].
pub const LONGEST_BODY: usize = 4 << 10;
/// Most headers.
const MOST_HEADERS: usize = 64;
/// How long a request may take to arrive, and an answer to leave.
const PATIENCE: Duration = Duration::from_secs(10);

/// A request that kept the limits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Request {
    /// `GET`, `POST` or another word.
    pub method: String,
    /// What is asked for, as it was sent.
    pub target: String,
    /// Names in lower case, and values.
    pub headers: Vec<(String, String)>,
    /// The body.
    pub body: Vec<u8>,
}

/// Why a request is not served: an HTTP status and a sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal(pub u16, pub String);

/// An answer.
pub struct Answer {
    /// HTTP status.
    pub status: u16,
    /// Media type of the body.
    pub kind: &'static str,
    /// The body.
    pub body: Vec<u8>,
}

impl Request {
    /// The value of the only header of this name; `None` where there is none or more than one.
    pub fn header(&self, name: &str) -> Option<&str> {
        let mut found = self.headers.iter().filter(|(known, _)| known == name);
        let first = found.next()?;
        found.next().is_none().then_some(first.1.as_str())
    }
}

/// Reads one request.
///
/// # Errors
/// [`Refusal`] where it is no HTTP, too long, too slow, or has a body without a length.
pub fn read_request(stream: &mut TcpStream) -> Result<Request, Refusal> {
    let begun = Instant::now();
    let mut bytes = Vec::new();
    let (mut request, head) = loop {
        more(stream, &mut bytes, LONGEST_HEAD, begun)
            .map_err(|full| refusal_of(full, 431, "the headers are too long"))?;
        if let Some(parsed) = parse_head(&bytes)? {
            break parsed;
        }
    };
    let length = body_length(&request)?;
    bytes.drain(..head);
    while bytes.len() < length {
        more(stream, &mut bytes, length, begun)
            .map_err(|full| refusal_of(full, 413, "the body is too long"))?;
    }
    bytes.truncate(length);
    request.body = bytes;
    Ok(request)
}

/// Why no more bytes came.
enum NoMore {
    Full,
    Gone,
}

fn refusal_of(reason: NoMore, status: u16, text: &str) -> Refusal {
    match reason {
        NoMore::Full => Refusal(status, text.into()),
        NoMore::Gone => Refusal(408, "the request did not arrive".into()),
    }
}

/// Reads on, up to `most` bytes in all.
fn more(
    stream: &mut TcpStream,
    bytes: &mut Vec<u8>,
    most: usize,
    begun: Instant,
) -> Result<(), NoMore> {
    let room = most.saturating_sub(bytes.len()).min(4096);
    let left = PATIENCE.saturating_sub(begun.elapsed());
    if room == 0 {
        return Err(NoMore::Full);
    }
    if left.is_zero() || stream.set_read_timeout(Some(left)).is_err() {
        return Err(NoMore::Gone);
    }
    let mut buffer = [0; 4096];
    match stream.read(&mut buffer[..room]) {
        Ok(count) if count > 0 => bytes.extend(&buffer[..count]),
        _ => return Err(NoMore::Gone),
    }
    Ok(())
}

/// The request without its body and the length of its head, once the head is whole.
fn parse_head(bytes: &[u8]) -> Result<Option<(Request, usize)>, Refusal> {
    let mut headers = [httparse::EMPTY_HEADER; MOST_HEADERS];
    let mut parsed = httparse::Request::new(&mut headers);
    let head = match parsed.parse(bytes) {
        Ok(httparse::Status::Complete(head)) => head,
        Ok(httparse::Status::Partial) => return Ok(None),
        Err(error) => return Err(Refusal(400, format!("not HTTP: {error}"))),
    };
    let headers = parsed
        .headers
        .iter()
        .map(|header| {
            let value = String::from_utf8_lossy(header.value).trim().to_string();
            (header.name.to_ascii_lowercase(), value)
        })
        .collect();
    let request = Request {
        method: parsed.method.unwrap_or_default().to_string(),
        target: parsed.path.unwrap_or_default().to_string(),
        headers,
        body: Vec::new(),
    };
    Ok(Some((request, head)))
}

/// The stated length of the body; 0 where none is stated.
fn body_length(request: &Request) -> Result<usize, Refusal> {
    let stated = |name: &str| request.headers.iter().any(|(known, _)| known == name);
    if stated("transfer-encoding") {
        return Err(Refusal(
            411,
            "a body in chunks: expected a content-length".into(),
        ));
    }
    if !stated("content-length") {
        return Ok(0);
    }
    let length = request.header("content-length").unwrap_or_default();
    match length.parse::<usize>() {
        Ok(length) if length <= LONGEST_BODY => Ok(length),
        Ok(length) => Err(Refusal(
            413,
            format!("a body of {length} bytes: expected at most {LONGEST_BODY}"),
        )),
        Err(_) => Err(Refusal(400, format!("content-length: {length:?}"))),
    }
}

/// Writes an answer and closes; a reader that has gone away is no failure.
pub fn respond(stream: &mut TcpStream, answer: &Answer) {
    let reason = match answer.status {
        200 => "OK",
        400 => "Bad Request",
        403 => "Forbidden",
        404 => "Not Found",
        405 => "Method Not Allowed",
        408 => "Request Timeout",
        409 => "Conflict",
        411 => "Length Required",
        413 => "Content Too Large",
        415 => "Unsupported Media Type",
        422 => "Unprocessable Content",
        431 => "Request Header Fields Too Large",
        _ => "Service Unavailable",
    };
    let head = format!(
        "HTTP/1.1 {} {reason}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\n\
         Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nX-Frame-Options: DENY\r\n\
         Cross-Origin-Resource-Policy: same-origin\r\nCross-Origin-Opener-Policy: same-origin\r\n\
         Referrer-Policy: no-referrer\r\nContent-Security-Policy: {}; frame-ancestors 'none'\r\n\r\n",
        answer.status,
        answer.kind,
        answer.body.len(),
        kufe::report::Kind::View.policy(),
    );
    let _ = stream.set_write_timeout(Some(PATIENCE));
    let _ = stream
        .write_all(head.as_bytes())
        .and_then(|()| stream.write_all(&answer.body))
        .and_then(|()| stream.flush());
    // What the client still sends is read for a moment, or closing would take the answer from it.
    let _ = stream.shutdown(std::net::Shutdown::Write);
    let _ = stream.set_read_timeout(Some(Duration::from_millis(200)));
    let mut rest = [0; 4096];
    for _ in 0..16 {
        if !matches!(stream.read(&mut rest), Ok(count) if count > 0) {
            break;
        }
    }
}
