//! The binary form of records of jobs in durable storage.

use std::time::Duration;

use bytes::Bytes;

use super::record::{JobState, JobSummary, OutputResult, Predicted, Product, Record};
use crate::job::ResolvedLevel;
use crate::output::named;
use crate::service::computation::Timings;
use crate::service::fields::{Fields, RecordWriter};
use crate::service::job_key::{JobKey, JobTerms, Priority};

const JOB_MAGIC: [u8; 8] = *b"plnshjob";
const JOB_VERSION: u32 = 1;
/// Stands for an absent number.
pub(in crate::service) const NO_NUMBER: u64 = u64::MAX;

/// Tags of the fields in their order; the fields of the outputs follow, each with a tag of its own.
mod tag {
    pub(super) const JOB: u8 = 1;
    pub(super) const STANDING: u8 = 2;
    pub(super) const TERMS: u8 = 3;
    pub(super) const REASON: u8 = 4;
    pub(super) const REQUEST: u8 = 5;
    pub(super) const VERTICES: u8 = 6;
    pub(super) const COST: u8 = 7;
    pub(super) const REACHED: u8 = 8;
    pub(super) const DETAILS: u8 = 9;
    pub(super) const NAME: u8 = 10;
    pub(super) const FORMAT: u8 = 11;
    pub(super) const KEY: u8 = 12;
    pub(super) const MADE: u8 = 13;
    pub(super) const FAILED: u8 = 14;
    pub(super) const WARNING: u8 = 15;
    pub(super) const BLOBS: u8 = 16;
}

/// A decoded record.
#[derive(Debug, Clone)]
pub(super) struct DecodedRecord {
    pub(super) job: JobKey,
    pub(super) number: u64,
    pub(super) attempts: u32,
    pub(super) starts: u32,
    pub(super) is_posted: bool,
    pub(super) terms: JobTerms,
    pub(super) state: JobState,
    pub(super) made: Vec<Option<OutputResult>>,
    /// Time at which the job was settled, in seconds since 1970.
    pub(super) settled_s: Option<u64>,
    pub(super) summary: JobSummary,
}

/// Encodes a record; `settled` is the time since 1970 at which the job was settled, if it is.
pub(super) fn encode(record: &Record, settled: Option<Duration>) -> Vec<u8> {
    let summary = &record.summary;
    let mut out = RecordWriter::new(JOB_MAGIC, JOB_VERSION, 1024 + summary.request.len());
    out.field(tag::JOB, &record.job.to_bytes());
    let (state, reason) = numbered(&record.state);
    let settled = settled.map_or(NO_NUMBER, |at| at.as_secs());
    let (starts, is_posted) = (record.starts.into(), record.wanted.is_posted.into());
    out.numbers(tag::STANDING, &[record.number, record.attempts.into(), state, settled, starts, is_posted]);
    out.numbers(tag::TERMS, &numbers_of(record.terms));
    out.field(tag::REASON, reason.as_bytes());
    out.field(tag::REQUEST, &summary.request);
    let Predicted { vertices, faces, memory_bytes, time_ms } = &summary.cost;
    out.numbers(tag::VERTICES, vertices);
    out.numbers(tag::COST, &[*faces, *memory_bytes, *time_ms]);
    let reached = summary.reached.map(|ResolvedLevel { level, bound }| (u64::from(level), bound));
    let reached: Vec<u64> =
        reached.iter().flat_map(|(level, bound)| [Some(*level), bound.map(f64::to_bits)]).flatten().collect();
    out.numbers(tag::REACHED, &reached);
    out.hashes(tag::DETAILS, &summary.details);
    out.hashes(tag::BLOBS, &summary.blobs);
    for (product, made) in summary.products.iter().zip(&record.made) {
        output(&mut out, product, made.as_ref());
    }
    out.closed()
}

/// Returns the number of a state in a record, and the reason of a failure.
pub(in crate::service) fn numbered(state: &JobState) -> (u64, &str) {
    match state {
        JobState::Active => (0, ""),
        JobState::Done => (1, ""),
        JobState::Failed(reason) => (2, reason),
        JobState::Cancelled => (3, ""),
    }
}

/// Returns the terms of a job or a batch as numbers in a record.
pub(in crate::service) fn numbers_of(terms: JobTerms) -> [u64; 3] {
    let JobTerms { priority, queue_timeout_s, run_timeout_s } = terms;
    let is_batch = u64::from(priority == Priority::Batch);
    [is_batch, queue_timeout_s.unwrap_or(NO_NUMBER), run_timeout_s.unwrap_or(NO_NUMBER)]
}

/// Writes an output and its result.
pub(in crate::service) fn output(out: &mut RecordWriter, product: &Product, made: Option<&OutputResult>) {
    out.field(tag::NAME, product.name.as_bytes());
    out.field(tag::FORMAT, product.format.name().as_bytes());
    out.field(tag::KEY, product.key.as_bytes());
    match made {
        None => {}
        Some(OutputResult::Failed(reason)) => out.field(tag::FAILED, reason.as_bytes()),
        Some(OutputResult::Done { bytes, warnings, timings }) => {
            let Timings { queue, refine, swept, render, encode } = timings;
            let us = |time: &Duration| u64::try_from(time.as_micros()).unwrap_or(u64::MAX);
            out.numbers(tag::MADE, &[*bytes, us(queue), us(refine), us(render), us(encode), u64::from(*swept)]);
            warnings.iter().for_each(|warning| out.field(tag::WARNING, warning.as_bytes()));
        }
    }
}

/// Returns whether a stored record is the record of a job.
pub(super) fn is_job(record: &[u8]) -> bool {
    record.starts_with(&JOB_MAGIC)
}

/// Decodes a record; returns `None` if it is damaged, of another version, or names an unknown format.
pub(super) fn decode(bytes: &[u8]) -> Option<DecodedRecord> {
    let mut fields = Fields::of(bytes, JOB_MAGIC, JOB_VERSION)?;
    let job = JobKey::from_bytes(fields.take(tag::JOB)?)?;
    let [number, attempts, state, settled, starts, is_posted] = match *fields.numbers(tag::STANDING)?.as_slice() {
        // The form of records before starts were counted and batches existed.
        [number, attempts, state, settled] => [number, attempts, state, settled, 0, 1],
        [number, attempts, state, settled, starts, is_posted] => [number, attempts, state, settled, starts, is_posted],
        _ => return None,
    };
    let terms = terms(&fields.numbers(tag::TERMS)?)?;
    let state = state_of(state, fields.text(tag::REASON)?)?;
    let request = Bytes::copy_from_slice(fields.take(tag::REQUEST)?);
    let vertices = fields.numbers(tag::VERTICES)?;
    let [faces, memory_bytes, time_ms] = fields.numbers(tag::COST)?.try_into().ok()?;
    let cost = Predicted { vertices, faces, memory_bytes, time_ms };
    let reached = match fields.numbers(tag::REACHED)?.as_slice() {
        [] => None,
        [level, rest @ ..] if rest.len() < 2 => {
            let bound = rest.first().copied().map(f64::from_bits);
            Some(ResolvedLevel { level: u32::try_from(*level).ok()?, bound })
        }
        _ => return None,
    };
    let (details, blobs) = (fields.hashes(tag::DETAILS)?, fields.hashes(tag::BLOBS)?);
    let (products, made) = outputs(&mut fields)?;
    let summary = JobSummary { products, cost, reached, details, blobs, request };
    let (number, attempts, starts) = (counted(number)?, u32::try_from(attempts).ok()?, u32::try_from(starts).ok()?);
    let (settled_s, is_posted) = (given(settled), is_posted == 1);
    Some(DecodedRecord { job, number, attempts, starts, is_posted, terms, state, made, settled_s, summary })
}

/// Returns the state of a number and a reason that [`numbered`] gave.
pub(in crate::service) fn state_of(number: u64, reason: String) -> Option<JobState> {
    match number {
        0 => Some(JobState::Active),
        1 => Some(JobState::Done),
        2 => Some(JobState::Failed(reason)),
        3 => Some(JobState::Cancelled),
        _ => None,
    }
}

/// Returns the terms whose numbers [`numbers_of`] gave.
pub(in crate::service) fn terms(numbers: &[u64]) -> Option<JobTerms> {
    let &[is_batch, queue, run] = numbers else { return None };
    let priority = if is_batch == 1 { Priority::Batch } else { Priority::Interactive };
    Some(JobTerms { priority, queue_timeout_s: given(queue), run_timeout_s: given(run) })
}

/// Returns the number of a job or a batch, unless it is so large that no process can have counted so far.
pub(in crate::service) fn counted(number: u64) -> Option<u64> {
    Some(number).filter(|number| *number <= u64::MAX / 2)
}

/// Returns a number, unless it stands for an absent one.
pub(in crate::service) fn given(number: u64) -> Option<u64> {
    Some(number).filter(|number| *number != NO_NUMBER)
}

/// Reads all remaining outputs with their results.
pub(in crate::service) fn outputs(fields: &mut Fields<'_>) -> Option<(Vec<Product>, Vec<Option<OutputResult>>)> {
    let (mut products, mut made) = (Vec::new(), Vec::new());
    while !fields.is_empty() {
        let (name, format) = (fields.text(tag::NAME)?, named(&fields.text(tag::FORMAT)?)?);
        products.push(Product { name, format, key: fields.hash(tag::KEY)? });
        made.push(result(fields)?);
    }
    Some((products, made))
}

#[expect(clippy::option_option, reason = "the outer one says whether the record can be read")]
fn result(fields: &mut Fields<'_>) -> Option<Option<OutputResult>> {
    if fields.is_next(tag::FAILED) {
        return Some(Some(OutputResult::Failed(fields.text(tag::FAILED)?)));
    }
    if !fields.is_next(tag::MADE) {
        return Some(None);
    }
    let [bytes, queue, refine, render, encode, swept] = fields.numbers(tag::MADE)?.try_into().ok()?;
    let [queue, refine, render, encode] = [queue, refine, render, encode].map(Duration::from_micros);
    let mut warnings = Vec::new();
    while fields.is_next(tag::WARNING) {
        warnings.push(fields.text(tag::WARNING)?);
    }
    Some(Some(OutputResult::Done {
        bytes,
        warnings,
        timings: Timings { queue, refine, swept: swept == 1, render, encode },
    }))
}
