//! Strict edges: requests of the wrong shape, headers with invalid values, and bounded lengths of answers and logs.
#![allow(clippy::unwrap_used, reason = "a test may fail where it stands")]

mod hosts;
mod kinds;
mod lengths;
mod origins;
mod ranges;
mod schema;
mod unread;
