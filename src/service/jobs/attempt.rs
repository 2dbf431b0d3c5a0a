//! Jobs to be accepted, and attempts at them.

use std::sync::Arc;

use tokio::sync::watch;

use super::record::{Holder, JobSummary, Made, Record};
use crate::service::job_key::{JobKey, JobTerms};
use crate::service::peer::{Peer, Ticket};
use crate::service::store::Pin;

/// A job to be accepted.
#[derive(Debug)]
pub struct New {
    /// The job.
    pub job: JobKey,
    /// What it is.
    pub summary: JobSummary,
    /// What was said of its turn.
    pub terms: JobTerms,
    /// Whose turn it takes.
    pub peer: Peer,
    /// Who wants it.
    pub holder: Holder,
    /// Counts it as one of the jobs that its peer may have under way; none for jobs that are done already.
    pub ticket: Option<Ticket>,
    /// What its outputs came to; empty for jobs that are still to be done.
    pub made: Vec<Made>,
    /// Keeps the uploads that it needs.
    pub pins: Vec<Arc<Pin>>,
}

/// One attempt at a job.
#[derive(Debug, Clone)]
pub struct Run {
    /// The job.
    pub job: JobKey,
    pub(super) number: u64,
    /// Comes true when the attempt is over.
    pub ended: watch::Receiver<bool>,
}

/// What came of accepting a job.
#[derive(Debug)]
pub enum Placed {
    /// It is under way already, or done.
    Known(Box<Record>),
    /// It is to be done.
    New(Run),
}
