//! The canary: a small real job that is computed every ten seconds on the compute threads, to show that they work.

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use crate::job::limits::{Admitted, Limits};
use crate::job::run;
use crate::service::desk::Desk;
use crate::service::lock::lock;
use crate::watch::Watch;
use crate::wire::JobRequest;

/// Time between two runs. Half of it takes twice the computing for the same answer; twice of it leaves one run within
/// [`STALE_AGE`], so that one late run makes the service not ready.
const CANARY_INTERVAL: Duration = Duration::from_secs(10);
/// Age of the last success from which on the service is not ready: three intervals, so that two runs may fail or be
/// late. Half of it allows no failure; twice of it notices a hanging service after a minute.
pub(super) const STALE_AGE: Duration = Duration::from_secs(30);

/// A cube, refined twice and drawn, which exercises operators, rasteriser and encoder.
const CANARY_JOB: &str = r#"{
  "input": { "mesh": {
    "positions": [[-1,-1,-1],[1,-1,-1],[1,1,-1],[-1,1,-1],[-1,-1,1],[1,-1,1],[1,1,1],[-1,1,1]],
    "faces": [[0,3,2,1],[4,5,6,7],[0,1,5,4],[1,2,6,5],[2,3,7,6],[3,0,4,7]] } },
  "plan": { "preset": "catmull-clark" }, "levels": 2,
  "outputs": [{ "format": "png", "width": 64, "height": 64 }]
}"#;

/// The time and the duration of the canary's last success.
#[derive(Debug, Default)]
pub struct Canary(Mutex<Option<(Instant, Duration)>>);

impl Canary {
    /// Returns age and duration of the last success.
    pub fn last_success(&self) -> Option<(Duration, Duration)> {
        let last = *lock(&self.0);
        last.map(|(at, took)| (at.elapsed(), took))
    }

    fn succeeded(&self, took: Duration) {
        *lock(&self.0) = Some((Instant::now(), took));
    }
}

/// Runs the canary for as long as the service lives.
pub(super) async fn sing(canary: Arc<Canary>, desk: Arc<Desk>) {
    loop {
        let desk = desk.clone();
        let sung = tokio::task::spawn_blocking(move || desk.pool.aside(once)).await;
        match sung {
            Ok(Ok(took)) => canary.succeeded(took),
            Ok(Err(error)) => tracing::error!(%error, "the canary job failed"),
            Err(error) => tracing::error!(%error, "the canary job panicked"),
        }
        tokio::time::sleep(CANARY_INTERVAL).await;
    }
}

fn admitted() -> Admitted {
    let request: JobRequest = serde_json::from_str(CANARY_JOB).expect("the canary job is JSON");
    let job = request.resolve().expect("the canary job is possible");
    Limits::default().admit(job).expect("the canary job is small")
}

/// Reads, admits and runs the job on the calling threads; returns its duration.
fn once() -> Result<Duration, crate::job::RunError> {
    let start = Instant::now();
    let job = admitted();
    run(&job, &job.job().outputs[0], &mut Vec::new(), &Watch::new())?;
    Ok(start.elapsed())
}
