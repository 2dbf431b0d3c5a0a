//! A log that nobody reads: the service continues, counts the dropped lines, reports them when the log is read again,
//! and ends in time.

use std::io::{BufRead, BufReader};
use std::process::{ChildStderr, Stdio};
use std::sync::mpsc;

use crate::cli::{Service, ended, exchanged, get, planish};
use crate::http::server::PATIENCE;

/// Number of refusals whose lines fill a pipe (64 KiB) and the buffer of the service (1 MiB).
const N_REFUSALS: usize = 12_000;

/// Starts a service that logs every refusal; returns it with its address and the pipe of its log, of which only the
/// start was read.
fn service() -> (Service, String, BufReader<ChildStderr>) {
    let mut command = planish();
    command.args(["serve", "--listen", "127.0.0.1:0", "--cache-bytes", "0"]).env("PLANISH_LOG", "info");
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let mut log = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    while !line.contains(" on http://") {
        line.clear();
        assert!(log.read_line(&mut line).unwrap() > 0, "it starts");
    }
    let url = line.trim().rsplit("http://").next().unwrap().to_owned();
    (Service(child), url, log)
}

/// Sends many requests for a missing path.
fn be_refused(url: &str) {
    let request = |end: &str| format!("GET /nothing HTTP/1.1\r\nhost: {url}\r\n{end}\r\n");
    for _ in 0..N_REFUSALS / 100 {
        let text = request("").repeat(99) + &request("connection: close\r\n");
        let answers = exchanged(url, &text);
        assert_eq!(answers.matches("HTTP/1.1 404").count(), 100, "{answers}");
    }
}

#[test]
fn l_a_line_of_the_log_is_short_however_long_the_request_was() {
    let (service, url, mut log) = service();
    // escapes make the text longer where it is repeated
    let body = format!("{{\"{}\": 1}}", r#"\u0001\"x"#.repeat(1 << 18));
    let length = body.len();
    let answer = exchanged(
        &url,
        &format!(
            "POST /v1/render HTTP/1.1\r\nhost: {url}\r\nconnection: close\r\ncontent-type: application/json\r\n\
             content-length: {length}\r\n\r\n{body}"
        ),
    );
    assert!(answer.starts_with("HTTP/1.1 422") && answer.len() < 4 << 10, "{} bytes", answer.len());
    let mut line = String::new();
    log.read_line(&mut line).unwrap();
    assert!(line.contains("refused") && line.contains("unknown field") && line.len() < 4 << 10, "{} bytes", line.len());
    assert_eq!(ended(service), Some(0));
}

#[test]
fn m9_a_log_that_nobody_reads_holds_no_request_and_no_end() {
    let (service, url, log) = service();
    be_refused(&url);
    assert_eq!(get(&url, "/livez"), "alive\n");
    assert_eq!(ended(service), Some(0), "though its last lines cannot be written");
    drop(log);
}

#[test]
fn m9_dropped_lines_are_counted_and_told_when_the_log_is_read_again() {
    let (service, url, log) = service();
    be_refused(&url);
    let (found, told) = mpsc::channel();
    std::thread::spawn(move || {
        let mut n_written: usize = 0;
        for line in log.lines().map_while(Result::ok) {
            n_written += usize::from(line.contains("request{"));
            if let Some((_, n)) = line.split_once("were dropped, as nobody read them in time lines=") {
                let _ = found.send((n_written, n.trim().parse::<usize>()));
            }
        }
    });
    let (n_written, n_dropped) = told.recv_timeout(PATIENCE).unwrap();
    let n_dropped = n_dropped.unwrap();
    assert!(n_dropped > 0);
    // each request has two lines: the reason of the refusal, and the answer
    assert_eq!(n_written + n_dropped, 2 * N_REFUSALS, "every line was written or counted");
    assert_eq!(get(&url, "/livez"), "alive\n");
    assert_eq!(ended(service), Some(0));
}
