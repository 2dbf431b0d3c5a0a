//! The robustness of the service: slow, silent, lying and greedy clients, overload, and its own shutdown.
#![allow(clippy::unwrap_used, reason = "a test may fail where it stands")]

mod addresses;
mod bodies;
mod cost;
mod disk;
mod disk_full;
mod disk_slow;
mod memory;
mod overload;
mod parsing;
mod peers;
mod places;
mod searches;
mod shutdown;
mod slow;
mod supply;
mod table;
mod threads;
