//! What the cache promises: results outlast the process, no wrong byte is ever served, equal work is done once.
#![allow(clippy::unwrap_used, reason = "a test may fail where it stands")]

mod broken;
mod disk;
mod flight;
mod small;
mod work;
