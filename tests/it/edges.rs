//! Strict edges: requests of the wrong shape, headers that say what they may not, answers and logs of bounded length.
#![allow(clippy::unwrap_used, reason = "a test may fail where it stands")]

mod hosts;
mod kinds;
mod lengths;
mod origins;
mod ranges;
mod schema;
mod unread;
