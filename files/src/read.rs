//! Reading regular files up to a size.

use std::fs::File;
use std::io::{Error, ErrorKind, Read, Result};
use std::ops::Range;
use std::path::Path;

use sha2::{Digest, Sha256};

use crate::place::kind;

/// The bytes of a regular file of at most `max_bytes`.
///
/// # Errors
/// [`ErrorKind::InvalidInput`] for a folder, a device, a pipe and a longer file; the system's error
/// if the file cannot be read.
pub fn read_regular(path: &Path, max_bytes: u64) -> Result<Vec<u8>> {
    bytes_of(open_regular(path)?, max_bytes).map_err(unreadable)
}

fn bytes_of(file: File, max_bytes: u64) -> Result<Vec<u8>> {
    let long = |found: u64| {
        let text = format!("{found} bytes or more: expected at most {max_bytes}");
        Error::new(ErrorKind::InvalidInput, text)
    };
    let length = file.metadata()?.len();
    if length > max_bytes {
        return Err(long(length));
    }
    // Bounds the size of a file that grows in the meantime.
    let mut bytes = Vec::with_capacity(length as usize);
    file.take(max_bytes + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > max_bytes {
        return Err(long(bytes.len() as u64));
    }
    Ok(bytes)
}

/// The text of a regular file of at most `max_bytes`.
///
/// # Errors
/// As [`read_regular`]; [`ErrorKind::InvalidData`] if the bytes are not UTF-8.
pub fn text_of_regular(path: &Path, max_bytes: u64) -> Result<String> {
    String::from_utf8(read_regular(path, max_bytes)?)
        .map_err(|error| unreadable(Error::new(ErrorKind::InvalidData, error.utf8_error())))
}

/// An error of the same kind with the message that the file cannot be read.
fn unreadable(error: Error) -> Error {
    Error::new(error.kind(), format!("cannot be read: {error}"))
}

/// Message of a parse error on one line: the number of the line, its text and the parser's message.
pub fn broken_at(text: &str, span: Option<Range<usize>>, message: &str) -> String {
    let start = span.map_or(0, |span| span.start.min(text.len()));
    let before = &text.as_bytes()[..start];
    let line = before.iter().filter(|&&byte| byte == b'\n').count();
    let found = text.lines().nth(line).unwrap_or_default().trim();
    let found: String = found.chars().take(120).collect();
    let found = match &*found {
        "" => found,
        found => format!("`{found}`: "),
    };
    let message = message.lines().collect::<Vec<_>>().join("; ");
    let message = message
        .replace("invalid type: string", "found")
        .replace("invalid type: integer", "found")
        .replace("invalid type: floating point", "found")
        .replace("invalid type: sequence", "found an array")
        .replace("invalid type: map", "found a table")
        .replace("invalid value: string", "found")
        .replace("expected f64", "expected a number")
        .replace("expected usize", "expected a whole number, 0 or more")
        .replace(" as i128", "");
    let message = match message.split_once("expected struct ") {
        // The message contains the name of a type of this program, which is replaced.
        Some((before, name)) => {
            let after = name.trim_start_matches(|c: char| c.is_alphanumeric());
            format!("{before}expected a table{after}")
        }
        None => message,
    };
    format!("line {}: {found}{message}", line + 1)
}

/// Opens a regular file; a pipe is refused before it is opened, which would wait for its writer.
///
/// # Errors
/// [`ErrorKind::InvalidInput`] for a folder, a device and a pipe; the system's error if the file
/// cannot be opened.
pub fn open_regular(path: &Path) -> Result<File> {
    opened(path).map_err(unreadable)
}

fn opened(path: &Path) -> Result<File> {
    let refuse = |found: std::fs::FileType| {
        let text = format!("it is {}, expected a file", kind(found));
        Error::new(ErrorKind::InvalidInput, text)
    };
    let found = path.metadata()?;
    if !found.is_file() {
        return Err(refuse(found.file_type()));
    }
    let file = File::open(path)?;
    let opened = file.metadata()?;
    if !opened.is_file() {
        return Err(refuse(opened.file_type()));
    }
    Ok(file)
}

/// SHA-256 as lower-case hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

/// SHA-256 of a file from its present position on, as lower-case hexadecimal.
///
/// # Errors
/// The system's error if the file cannot be read.
pub fn sha256_of_file(mut file: &File) -> Result<String> {
    let mut hash = Sha256::new();
    let mut buffer = vec![0; 1 << 16];
    loop {
        match file.read(&mut buffer)? {
            0 => return Ok(hexadecimal(&hash.finalize())),
            read => hash.update(&buffer[..read]),
        }
    }
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_read_up_to_their_limit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ten");
        std::fs::write(&path, "0123456789").unwrap();
        assert_eq!(read_regular(&path, 10).unwrap(), b"0123456789");
        assert_eq!(text_of_regular(&path, 10).unwrap(), "0123456789");
        let error = read_regular(&path, 9).unwrap_err().to_string();
        assert_eq!(
            error,
            "cannot be read: 10 bytes or more: expected at most 9"
        );
        assert!(
            read_regular(folder.path(), 9)
                .unwrap_err()
                .to_string()
                .contains("a folder")
        );
        std::fs::write(&path, b"\xff").unwrap();
        assert_eq!(
            text_of_regular(&path, 9).unwrap_err().kind(),
            ErrorKind::InvalidData
        );
    }

    #[cfg(unix)]
    #[test]
    fn devices_and_sockets_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let socket = folder.path().join("socket");
        let _listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
        for (path, printed) in [(Path::new("/dev/zero"), "a device"), (&socket, "a socket")] {
            let error = read_regular(path, 100).unwrap_err().to_string();
            assert!(error.contains(printed), "{error}");
        }
    }
}
