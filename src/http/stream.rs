//! The TCP stream of a connection: enforces the minimum rate at which the client reads answers, and replaces refusals
//! of the HTTP library by problems.

use std::io::{self, IoSlice};
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::task::{Context, Poll, ready};

use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::TcpStream;
use tokio::time::{Instant, Sleep, sleep_until};

use super::connections::{Connection, ConnectionPhase};
use super::pace::Pace;
use super::problem;

/// A stream that watches how fast its client reads.
#[derive(Debug)]
pub(super) struct Watched {
    stream: TcpStream,
    connection: Arc<Connection>,
    pace: Pace,
    /// The time at which the current answer began, and the number of its bytes that the system has taken.
    answer: Option<(Instant, u64)>,
    alarm: Option<Pin<Box<Sleep>>>,
    /// The bytes that replace a refusal of the HTTP library, and how many of them are written.
    instead: Option<(Vec<u8>, usize)>,
}

impl Watched {
    pub(super) fn new(stream: TcpStream, connection: Arc<Connection>, pace: Pace) -> Self {
        Self { stream, connection, pace, answer: None, alarm: None, instead: None }
    }

    /// Records the result of a write; a client that stays behind the minimum rate causes an error.
    fn watch(&mut self, context: &mut Context<'_>, poll: Poll<io::Result<usize>>) -> Poll<io::Result<usize>> {
        let (since, taken) = self.answer.get_or_insert_with(|| (Instant::now(), 0));
        match poll {
            Poll::Ready(Ok(n)) => {
                *taken += n as u64;
                self.alarm = None;
                self.connection.is_read();
                Poll::Ready(Ok(n))
            }
            Poll::Ready(Err(error)) => Poll::Ready(Err(error)),
            Poll::Pending => {
                self.connection.enter(ConnectionPhase::Blocked);
                let deadline = *since + self.pace.allows(*taken);
                let alarm = self.alarm.get_or_insert_with(|| Box::pin(sleep_until(deadline)));
                ready!(alarm.as_mut().poll(context));
                Poll::Ready(Err(io::Error::new(io::ErrorKind::TimedOut, "the client reads too slowly")))
            }
        }
    }

    /// Returns whether the bytes to be written are no answer of a handler, but the HTTP library's refusal of an invalid
    /// request; then prepares the problem that replaces them.
    fn is_refusal(&mut self, bytes: &[u8]) -> bool {
        if self.instead.is_none() && !self.connection.answering.load(Ordering::Relaxed) {
            self.instead = Some((problem::unreadable(bytes), 0));
        }
        self.instead.is_some()
    }

    /// Writes the problem, and then reports that `length` bytes were written.
    fn write_instead(&mut self, context: &mut Context<'_>, length: usize) -> Poll<io::Result<usize>> {
        while let Some((bytes, at)) = self.instead.as_ref().filter(|(bytes, at)| *at < bytes.len()) {
            let poll = Pin::new(&mut self.stream).poll_write(context, &bytes[*at..]);
            let n = ready!(self.watch(context, poll))?;
            if n == 0 {
                return Poll::Ready(Err(io::ErrorKind::WriteZero.into()));
            }
            if let Some((_, at)) = &mut self.instead {
                *at += n;
            }
        }
        Poll::Ready(Ok(length))
    }
}

impl AsyncRead for Watched {
    fn poll_read(mut self: Pin<&mut Self>, cx: &mut Context<'_>, buf: &mut ReadBuf<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_read(cx, buf)
    }
}

impl AsyncWrite for Watched {
    fn poll_write(mut self: Pin<&mut Self>, cx: &mut Context<'_>, buf: &[u8]) -> Poll<io::Result<usize>> {
        if self.is_refusal(buf) {
            return self.write_instead(cx, buf.len());
        }
        let poll = Pin::new(&mut self.stream).poll_write(cx, buf);
        self.watch(cx, poll)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        bufs: &[IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let first = bufs.iter().find(|buf| !buf.is_empty()).map_or(&[][..], |buf| buf);
        if self.is_refusal(first) {
            return self.write_instead(cx, bufs.iter().map(|buf| buf.len()).sum());
        }
        let poll = Pin::new(&mut self.stream).poll_write_vectored(cx, bufs);
        self.watch(cx, poll)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        let flushed = ready!(Pin::new(&mut self.stream).poll_flush(cx));
        // everything is written: the time until more bytes are ready is not the client's, and unless an answer is still
        // in progress, the connection waits for the next request
        self.answer = None;
        self.alarm = None;
        if !self.connection.serving.load(Ordering::Relaxed) {
            self.connection.answering.store(false, Ordering::Relaxed);
            self.connection.enter(ConnectionPhase::Listening);
        }
        Poll::Ready(flushed)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(cx)
    }
}
