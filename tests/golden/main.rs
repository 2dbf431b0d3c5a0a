//! Every job of `api/examples/jobs` and of `api/examples/figures` gives the result whose hash stands in `hashes.txt`,
//! for any number of threads.
//!
//! This is a binary of its own because it is also run optimised, which the other tests would take minutes to compile
//! for. `BLESS=1 cargo test --test hashes` writes the table anew.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use planish::job::key::content;
use planish::job::limits::Limits;
use planish::job::run;
use planish::watch::Watch;
use planish::wire::JobRequest;
use planish::wire::read::read;

fn path(inside: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(inside)
}

/// Name without `.json` and text of each example job, by name.
fn jobs() -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    for (folder, before) in [("jobs", ""), ("figures", "figures/")] {
        for entry in fs::read_dir(path("api/examples").join(folder)).expect("the examples can be read") {
            let path = entry.expect("the folder can be read").path();
            if path.extension().is_some_and(|extension| extension == "json") {
                let name = path.file_stem().expect("a file has a name").to_string_lossy();
                found.insert(format!("{before}{name}"), fs::read_to_string(&path).expect("the file is text"));
            }
        }
    }
    found
}

/// One line for each result of each job: file, name of the output, hash of the bytes.
fn results(threads: usize) -> Vec<String> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started");
    pool.install(|| jobs().iter().flat_map(|(name, text)| lines(name, text)).collect())
}

fn lines(name: &str, text: &str) -> Vec<String> {
    let request: JobRequest = read(text.as_bytes()).unwrap_or_else(|error| panic!("{name}: {error:?}"));
    let job = request.resolve().unwrap_or_else(|faults| panic!("{name}: {faults:?}"));
    let admitted = Limits::default().admit(job).unwrap_or_else(|refusal| panic!("{name}: {refusal:?}"));
    let line = |output| {
        let mut bytes = Vec::new();
        run(&admitted, output, &mut bytes, &Watch::new()).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(!bytes.is_empty(), "{name}");
        format!("{name} {} {}", output.name, content(&bytes))
    };
    admitted.job().outputs.iter().map(line).collect()
}

#[test]
fn results_have_the_committed_hashes_with_1_2_and_8_threads() {
    let [found, two, eight] = std::thread::scope(|scope| {
        [1, 2, 8].map(|threads| scope.spawn(move || results(threads))).map(|run| run.join().expect("the jobs run"))
    });
    assert!(found.len() > 50, "there are example jobs: {}", found.len());
    assert_eq!(two, found, "with 2 threads");
    assert_eq!(eight, found, "with 8 threads");
    let golden = path("tests/golden/hashes.txt");
    let text = found.join("\n") + "\n";
    if std::env::var_os("BLESS").is_some() {
        fs::write(&golden, text).expect("the table can be written");
        return;
    }
    let committed = fs::read_to_string(&golden)
        .unwrap_or_else(|error| panic!("{}: {error}; BLESS=1 cargo test --test hashes writes it", golden.display()));
    for (found, committed) in text.lines().zip(committed.lines()) {
        assert_eq!(found, committed, "a change of bytes raises RESULTS_VERSION and is named in the changelog");
    }
    assert_eq!(text.lines().count(), committed.lines().count(), "jobs were added or removed: look, then BLESS=1");
}
