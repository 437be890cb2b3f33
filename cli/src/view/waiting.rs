//! Connections that have not asked for anything yet: when there are too many, the one that waits longest is closed.

use std::collections::VecDeque;
use std::net::{Shutdown, TcpStream};
use std::sync::{Mutex, PoisonError};

/// Connections that may wait at once.
const MOST: usize = 16;

/// The connections that wait, the oldest first.
#[derive(Default)]
pub struct Waiting {
    streams: Mutex<VecDeque<(u64, TcpStream)>>,
}

impl Waiting {
    /// Takes a connection in under a number of its own, and closes the oldest where there is no room.
    ///
    /// # Errors
    /// The system's, where there is no second handle of it.
    pub fn enter(&self, number: u64, stream: &TcpStream) -> std::io::Result<()> {
        let own = stream.try_clone()?;
        let mut streams = self.streams.lock().unwrap_or_else(PoisonError::into_inner);
        if streams.len() >= MOST
            && let Some((_, oldest)) = streams.pop_front()
        {
            // One that is closed already needs no closing.
            let _ = oldest.shutdown(Shutdown::Both);
        }
        streams.push_back((number, own));
        Ok(())
    }

    /// Lets a connection go that has asked.
    pub fn leave(&self, number: u64) {
        let mut streams = self.streams.lock().unwrap_or_else(PoisonError::into_inner);
        streams.retain(|(other, _)| *other != number);
    }
}
