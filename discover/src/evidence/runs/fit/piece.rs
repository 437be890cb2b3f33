//! A representative piece of a run for simulations of noise.

use crate::evidence::runs::recordings::frame::Frame;
use crate::null::random::{below, stream};

/// A random piece of the `i`-th run: a third of it, but no shorter than `min_s`.
pub fn piece(frame: &Frame, min_s: f64, round: u64, i: usize) -> Frame {
    const SHARE: f64 = 1.0 / 3.0;
    let n = frame.len();
    let span = frame.t[n - 1] - frame.t[0];
    let length = (n as f64 * (min_s / span.max(1e-9)).max(SHARE)) as usize;
    let length = length.clamp(1, n);
    let from = below(&mut stream(round, 0x91EC, i as u64), n - length + 1);
    match frame.piece(from, from + length) {
        // The piece lies within a gap.
        piece if piece.row_count() == 0 => frame.clone(),
        piece => piece,
    }
}
