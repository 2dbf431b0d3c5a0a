//! Jobs to be accepted, and attempts to run them.

use std::sync::Arc;

use tokio::sync::watch;

use super::record::{Holder, JobSummary, OutputResult, Record};
use crate::service::job_key::{JobKey, JobTerms};
use crate::service::peer::{Peer, Ticket};
use crate::service::store::Pin;

/// A job to be accepted.
#[derive(Debug)]
pub struct New {
    /// The job.
    pub job: JobKey,
    /// The description of the job.
    pub summary: JobSummary,
    /// The priority and the time limits of the job.
    pub terms: JobTerms,
    /// The client whose turn the job takes.
    pub peer: Peer,
    /// The client or batch that wants the job.
    pub holder: Holder,
    /// The job's share of the jobs that its client may have under way; `None` for a job that is done already.
    pub ticket: Option<Ticket>,
    /// The results of the job's outputs; empty for a job that is still to be done.
    pub made: Vec<OutputResult>,
    /// Pins on the uploads that the job needs.
    pub pins: Vec<Arc<Pin>>,
}

/// One attempt to run a job.
#[derive(Debug, Clone)]
pub struct Attempt {
    /// The job.
    pub job: JobKey,
    pub(super) number: u64,
    /// Becomes true when the attempt is over.
    pub ended: watch::Receiver<bool>,
}

/// The result of accepting a job.
#[derive(Debug)]
pub enum Admission {
    /// The job is under way already, or done.
    Known(Box<Record>),
    /// The job is to be done, in this attempt.
    New(Attempt),
}
