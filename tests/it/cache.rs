//! The promises of the cache: results outlast the process, no wrong byte is ever served, and equal work is done once.
#![allow(clippy::unwrap_used, reason = "a test may fail where it stands")]

mod broken;
mod disk;
mod flight;
mod small;
mod work;
