//! Valid files with bytes changed, cut, doubled and swapped.

use std::time::{Duration, Instant};

/// A small generator of its own, so that a failing round can be repeated: xorshift64* (S. Vigna, 2016).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    fn below(&mut self, limit: usize) -> usize {
        (self.next() % limit.max(1) as u64) as usize
    }
}

/// Bytes that readers stumble over: extremes of counts and lengths, signs, separators.
const PIECES: [&[u8]; 16] = [
    b"\0\0\0\0",
    b"\xff\xff\xff\xff",
    b"\xff\xff\xff\x7f",
    b"\0\0\0\x80",
    b"nan",
    b"inf",
    b"-",
    b"1e999",
    b"\n",
    b"/",
    b"\"",
    b"[[",
    b"{",
    b"99999999999999999999",
    b"f 0 0 0\n",
    b"\xf0\x9f\x9b\xb7",
];

fn mutated(seed: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = seed.to_vec();
    for _ in 0..=random.below(4) {
        let at = random.below(bytes.len());
        match random.below(6) {
            0 if !bytes.is_empty() => bytes[at] = random.next() as u8,
            1 if !bytes.is_empty() => bytes[at] ^= 1 << random.below(8),
            2 => bytes.truncate(at),
            3 => {
                let end = (at + random.below(64)).min(bytes.len());
                let piece = bytes[at..end].to_vec();
                let to = random.below(bytes.len());
                bytes.splice(to..to, piece);
            }
            4 => {
                let piece = PIECES[random.below(PIECES.len())];
                let end = (at + piece.len()).min(bytes.len());
                bytes.splice(at..end, piece.iter().copied());
            }
            _ => {
                let end = (at + random.below(32)).min(bytes.len());
                bytes.drain(at..end);
            }
        }
    }
    bytes
}

/// Runs `read` on mutations of the seeds until its time is over; returns how many were accepted and refused.
pub fn rounds(name: &str, seeds: &[Vec<u8>], read: impl Fn(&[u8]) -> bool) {
    let seconds = std::env::var("KUFE_FUZZ_SECONDS")
        .ok()
        .and_then(|text| text.parse().ok())
        .unwrap_or(1.0);
    let end = Instant::now() + Duration::from_secs_f64(seconds);
    for seed in seeds {
        assert!(read(seed), "{name}: the seed itself is refused");
    }
    let mut random = Random(0x6b75_6665);
    let (mut accepted, mut refused) = (0u64, 0u64);
    while Instant::now() < end {
        let bytes = mutated(&seeds[random.below(seeds.len())], &mut random);
        let started = Instant::now();
        match read(&bytes) {
            true => accepted += 1,
            false => refused += 1,
        }
        let took = started.elapsed();
        assert!(
            took < Duration::from_secs(5),
            "{name}: {took:?} on {} bytes",
            bytes.len()
        );
    }
    println!("{name}: {accepted} accepted, {refused} refused");
    if let Some(peak) = peak_memory() {
        assert!(peak < MOST_MEMORY, "{name}: {peak} bytes of memory");
    }
    assert!(refused > 0, "{name}: nothing was ever refused");
}

/// What all readers together may take at the worst [bytes]; the files are of a few kilobytes.
const MOST_MEMORY: u64 = 1 << 30;

/// Largest resident memory of this process so far, if the system states it [bytes].
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kilobytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024 * kilobytes)
}
