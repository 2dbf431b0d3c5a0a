//! A lean load generator: connections that are kept, one request after another on each.

use std::error::Error;
use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream as Blocking};
use std::thread;
use std::time::{Duration, Instant};

use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;

/// Threads that ask.
const THREADS: usize = 2;
/// Connections of each.
const CONNECTIONS: usize = 8;
/// Length of one round.
const ROUND: Duration = Duration::from_millis(1500);

/// One answer.
#[derive(Debug)]
pub(crate) struct Answer {
    head: String,
    pub(crate) body: Vec<u8>,
}

impl Answer {
    /// The value of a header.
    pub(crate) fn header(&self, name: &str) -> Option<&str> {
        self.headers().find(|(known, _)| known.eq_ignore_ascii_case(name)).map(|(_, value)| value)
    }

    /// All headers, each with its value.
    pub(crate) fn headers(&self) -> impl Iterator<Item = (&str, &str)> {
        self.head.lines().filter_map(|line| line.split_once(": "))
    }
}

/// Asks once.
pub(crate) fn ask(address: SocketAddr, request: &str) -> Result<Answer, Box<dyn Error>> {
    let mut stream = Blocking::connect(address)?;
    stream.write_all(request.as_bytes())?;
    let mut bytes = Vec::new();
    let mut chunk = [0; 16 << 10];
    loop {
        let n = stream.read(&mut chunk)?;
        if n == 0 {
            return Err("the server closed the connection".into());
        }
        bytes.extend_from_slice(&chunk[..n]);
        let Some(end) = bytes.windows(4).position(|four| four == b"\r\n\r\n") else { continue };
        let head = String::from_utf8(bytes[..end].to_vec())?;
        let mut answer = Answer { head, body: bytes[end + 4..].to_vec() };
        if !answer.head.starts_with("HTTP/1.1 200") {
            return Err(format!("{}\n{}", answer.head, String::from_utf8_lossy(&answer.body)).into());
        }
        let length: usize = answer.header("content-length").ok_or("no content-length")?.parse()?;
        if answer.body.len() >= length {
            answer.body.truncate(length);
            return Ok(answer);
        }
    }
}

/// A request whose answers all have the same length.
#[derive(Debug)]
pub(crate) struct Asked {
    address: SocketAddr,
    request: String,
    /// The answer.
    pub(crate) answer: Answer,
}

impl Asked {
    /// A request that is answered 200, from the second time on with the same length.
    pub(crate) fn new(address: SocketAddr, request: String) -> Result<Self, Box<dyn Error>> {
        ask(address, &request)?;
        let answer = ask(address, &request)?;
        Ok(Self { address, request, answer })
    }
}

/// Answers a second in one round.
pub(crate) fn rate(asked: &Asked) -> Result<f64, Box<dyn Error>> {
    let start = Instant::now();
    let counted: Result<Vec<u32>, String> = thread::scope(|scope| {
        let threads: Vec<_> = (0..THREADS).map(|_| scope.spawn(|| on_thread(asked, start + ROUND))).collect();
        threads.into_iter().map(|thread| thread.join().expect("it does not panic")).collect()
    });
    let counted = counted.map_err(|error| format!("{} did not answer: {error}", asked.address))?;
    Ok(f64::from(counted.iter().sum::<u32>()) / start.elapsed().as_secs_f64())
}

fn on_thread(asked: &Asked, end: Instant) -> Result<u32, String> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(|e| e.to_string())?;
    runtime.block_on(async {
        let connections = (0..CONNECTIONS).map(|_| on_connection(asked, end));
        let counts = futures_util::future::join_all(connections).await;
        counts.into_iter().sum::<std::io::Result<u32>>().map_err(|e| e.to_string())
    })
}

async fn on_connection(asked: &Asked, end: Instant) -> std::io::Result<u32> {
    let mut stream = TcpStream::connect(asked.address).await?;
    stream.set_nodelay(true)?;
    let mut answer = vec![0; asked.answer.head.len() + 4 + asked.answer.body.len()];
    let mut count = 0;
    while Instant::now() < end {
        stream.write_all(asked.request.as_bytes()).await?;
        stream.read_exact(&mut answer).await?;
        if !answer.starts_with(b"HTTP/1.1 200") {
            return Err(std::io::Error::other("an answer was not 200, or of another length"));
        }
        count += 1;
    }
    Ok(count)
}
