//! How quick planish is, as one table: `cargo bench --bench bench`, followed by `-- refine peers limits polygons
//! schemes analysis pictures encode http` or some of these for some parts only.
//!
//! Every figure is the best of a few runs on a warm heap. Absolute figures drift between machines; the column "ratio"
//! relates each to something measured in the same run.

mod analysis;
mod encode;
mod http;
mod load;
mod nets;
mod peers;
mod pictures;
mod polygons;
mod refine;
mod schemes;
mod table;

use std::error::Error;
use std::io::{self, Write};

use table::Table;

type Part = fn(&mut Table);

/// The maximum number of bytes of large buffers to keep between computations, as a service does: enough for level 6 of
/// the peers.
const KEPT_BYTES: usize = 2 << 30;

const PARTS: &[(&str, Part)] = &[
    ("refine", refine::measure),
    ("peers", peers::measure),
    ("limits", refine::measure_limits),
    ("polygons", polygons::measure),
    ("schemes", schemes::measure),
    ("analysis", analysis::measure),
    ("pictures", pictures::measure),
    ("encode", encode::measure),
    ("http", http::measure),
];

fn main() -> Result<(), Box<dyn Error>> {
    // cargo itself adds --bench
    let asked: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let known = |name: &String| PARTS.iter().any(|(part, _)| part == name);
    if let Some(unknown) = asked.iter().find(|name| !known(name)) {
        let names: Vec<_> = PARTS.iter().map(|(name, _)| *name).collect();
        return Err(format!("there is no part {unknown}; known are {}", names.join(", ")).into());
    }
    planish::kept::keep_at_most(KEPT_BYTES);
    let mut table = Table::default();
    for (name, part) in PARTS {
        if asked.is_empty() || asked.iter().any(|asked| asked == name) {
            part(&mut table);
        }
    }
    io::stdout().write_all(table.text().as_bytes())?;
    Ok(())
}
