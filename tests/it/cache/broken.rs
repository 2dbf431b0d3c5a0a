//! A computation that fails in the middle of its bytes leaves nothing behind.

use std::io::Write;
use std::sync::Arc;

use planish::job::key::{Key, content};
use planish::job::{KeepWork, Report, RunError};
use planish::service::computation::{Failure, Phase};
use planish::service::peer::Peer;
use planish::service::task::{Cost, Task};
use planish::watch::Watch;

use crate::http::server::{settings, story};

/// A task that writes some bytes and then fails.
#[derive(Debug)]
struct Broken;

impl Task for Broken {
    fn key(&self) -> Key {
        content(b"a broken task")
    }

    fn cost(&self) -> Cost {
        Cost { memory_bytes: 1 << 20, time_ms: 1, work: 1, result_bytes: 1 << 16 }
    }

    fn media_type(&self) -> &'static str {
        "text/plain"
    }

    fn run(&self, out: &mut dyn Write, _: &dyn KeepWork, _watch: &Watch) -> Result<Report, RunError> {
        out.write_all(&vec![b'x'; 1 << 16]).map_err(RunError::Io)?;
        Err(RunError::Io(std::io::Error::other("the document takes 9 bytes, 8 were forecast")))
    }
}

#[test]
fn a_writer_that_fails_half_way_leaves_no_artifact() {
    story(settings(), async |server| {
        let desk = &server.app.desk;
        let interest = desk.compute(Arc::new(Broken), Peer::SELF).unwrap();
        let Phase::Failed(Failure::Internal(detail)) = interest.computation.finished().await else {
            panic!("it failed")
        };
        assert!(detail.contains("8 were forecast"), "{detail}");
        assert!(desk.find_artifact(Broken.key(), Peer::SELF).await.is_none());
        assert!(desk.tiers.usage().iter().all(|(_, usage)| usage.artifacts == 0));
    });
}
