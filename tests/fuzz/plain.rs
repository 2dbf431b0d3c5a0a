//! A loop that any stable compiler runs: inputs that are right, changed at random, given to a target again and again.
//!
//! `plain TARGET [SECONDS] [SEED]`, with seeds in `corpus/TARGET` beside what the program knows itself. An input at
//! which the target panics is written to `crashes/TARGET-HASH`, and ends the loop with 1.

use std::fs;
use std::panic::catch_unwind;
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use planish_fuzz::TARGETS;

/// Most bytes of an input: enough for every kind of fault of a reader, and few enough for thousands a second.
const MAX_BYTES: usize = 4096;
/// What is put in at random besides bytes: what readers of text and numbers trip over.
const TOKENS: [&str; 24] = [
    "null",
    "true",
    "-",
    "1e999",
    "-0",
    "0.1",
    "9007199254740993",
    "18446744073709551616",
    "\"\"",
    "[]",
    "{}",
    "[[",
    "\\u0000",
    "U",
    "(",
    ")",
    "^",
    "alpha",
    "1/0",
    "\n",
    "\r",
    "%",
    "\u{feff}",
    "é",
];

/// Splitmix64 (Steele, Lea and Flood 2014): the same numbers for the same seed.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number below `n`, 0 where there is none.
    fn below(&mut self, n: usize) -> usize {
        usize::try_from(self.next() % n.max(1) as u64).expect("below a usize")
    }
}

/// An input with one to eight changes.
fn changed(random: &mut Random, seeds: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = seeds[random.below(seeds.len())].clone();
    for _ in 0..=random.below(8) {
        let at = random.below(bytes.len() + 1);
        let end = at + random.below((bytes.len() - at).min(32) + 1);
        match random.below(7) {
            0 if at < bytes.len() => bytes[at] ^= 1 << random.below(8),
            1 if at < bytes.len() => bytes[at] = random.next().to_le_bytes()[0],
            2 => drop(bytes.drain(at..end)),
            3 => {
                let again = bytes[at..end].to_vec();
                bytes.splice(at..at, again);
            }
            4 => drop(bytes.splice(at..end, TOKENS[random.below(TOKENS.len())].bytes())),
            5 => {
                let other = &seeds[random.below(seeds.len())];
                let from = random.below(other.len() + 1);
                let to = from + random.below((other.len() - from).min(64) + 1);
                bytes.splice(at..end, other[from..to].iter().copied());
            }
            _ => bytes.truncate(at),
        }
    }
    bytes.truncate(MAX_BYTES);
    bytes
}

/// Inputs that are right, or were once found to be wrong.
fn seeds(target: &str) -> Vec<Vec<u8>> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |folder: &Path| -> Vec<Vec<u8>> {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        let mut paths: Vec<_> = entries.map(|entry| entry.path()).filter(|path| path.is_file()).collect();
        paths.sort();
        paths.iter().filter_map(|path| fs::read(path).ok()).filter(|bytes| bytes.len() <= MAX_BYTES).collect()
    };
    let mut found = read(&here.join("corpus").join(target));
    let jobs = || read(&here.join("../../api/examples/jobs"));
    match target {
        "job" => found.extend(jobs()),
        "link" => found.extend(jobs().iter().flat_map(|job| [[&[0], &job[..]].concat(), [&[4], &job[..]].concat()])),
        "reader" => {
            let files = read(&here.join("../../api/examples/meshes"));
            let choices = 0..u8::try_from(planish::input::READERS.len()).unwrap_or(u8::MAX);
            let of_choice = |choice| files.iter().map(move |file| [&[choice], &file[..]].concat()).collect::<Vec<_>>();
            found.extend(choices.flat_map(of_choice));
        }
        _ => {}
    }
    found.push(Vec::new());
    found
}

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_default();
    let Some((name, target)) = TARGETS.iter().find(|(known, _)| *known == name) else {
        let names: Vec<&str> = TARGETS.iter().map(|(name, _)| *name).collect();
        eprintln!("plain TARGET [SECONDS] [SEED]; targets: {}", names.join(", "));
        return ExitCode::from(2);
    };
    let seconds = arguments.next().and_then(|text| text.parse().ok()).unwrap_or(600);
    let seed = arguments.next().and_then(|text| text.parse().ok()).unwrap_or(1);
    let (mut random, seeds) = (Random(seed), seeds(name));
    let (start, mut n) = (Instant::now(), 0_u64);
    while start.elapsed() < Duration::from_secs(seconds) {
        // seeds come first as they are
        let given = seeds.get(usize::try_from(n).unwrap_or(usize::MAX)).cloned();
        let input = given.unwrap_or_else(|| changed(&mut random, &seeds));
        n += 1;
        if catch_unwind(|| target(&input)).is_err() {
            let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("crashes");
            let path = folder.join(format!("{name}-{}", &blake3::hash(&input).to_hex()[..16]));
            let kept = fs::create_dir_all(&folder).and_then(|()| fs::write(&path, &input));
            eprintln!(
                "{name}: input {n} fails; {}",
                kept.map_or_else(|e| e.to_string(), |()| path.display().to_string())
            );
            return ExitCode::FAILURE;
        }
    }
    println!("{name}: {n} inputs in {} s, seed {seed}: no fault", start.elapsed().as_secs());
    ExitCode::SUCCESS
}
