//! The binary form of batches and of their items in durable storage.

use std::sync::Arc;
use std::time::Duration;

use bytes::Bytes;

use super::record::{Batch, BatchItem, Ending};
use crate::service::fields::{Fields, RecordWriter};
use crate::service::job_key::{JobKey, JobTerms};
use crate::service::jobs::{
    JobState, NO_NUMBER, counted, given, numbered, numbers_of, output, outputs, state_of, terms,
};
use crate::service::journal::RowKey;

const BATCH_MAGIC: [u8; 8] = *b"plnshbat";
const ITEM_MAGIC: [u8; 8] = *b"plnshitm";
const BATCH_VERSION: u32 = 1;

/// Tags of the fields in their order; the fields of outputs follow those of an item.
mod tag {
    pub(super) const BATCH: u8 = 1;
    pub(super) const STANDING: u8 = 2;
    pub(super) const TERMS: u8 = 3;
    pub(super) const REASON: u8 = 4;
    pub(super) const TEXT: u8 = 5;
    pub(super) const JOB: u8 = 6;
}

/// The key of a row in durable storage: a batch, or one item of a batch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum BatchRow {
    Batch(JobKey),
    Item(JobKey, u32),
}

impl RowKey for BatchRow {
    fn key(&self) -> Vec<u8> {
        match self {
            Self::Batch(batch) => batch.to_bytes().to_vec(),
            Self::Item(batch, item) => [batch.to_bytes().as_slice(), &item.to_be_bytes()].concat(),
        }
    }
}

/// A decoded row.
#[derive(Debug)]
pub(super) enum DecodedRow {
    Batch(Box<KeptBatch>),
    Item { batch: JobKey, at: usize, item: BatchItem },
}

/// A decoded batch.
#[derive(Debug)]
pub(super) struct KeptBatch {
    pub(super) batch: JobKey,
    pub(super) number: u64,
    pub(super) attempts: u32,
    pub(super) terms: JobTerms,
    pub(super) state: JobState,
    /// Time at which the batch was settled, in seconds since 1970.
    pub(super) settled_s: Option<u64>,
    pub(super) n_outputs: u64,
    pub(super) text: Bytes,
}

/// Encodes a batch without its items; `settled` is the time since 1970 at which the batch was settled, if it is.
pub(super) fn encode(batch: &Batch, settled: Option<Duration>) -> Vec<u8> {
    let mut out = RecordWriter::new(BATCH_MAGIC, BATCH_VERSION, 256 + batch.request.text.len());
    out.field(tag::BATCH, &batch.batch.to_bytes());
    let (number, reason) = numbered(&batch.state);
    let settled = settled.map_or(NO_NUMBER, |at| at.as_secs());
    let standing = [batch.number, batch.attempts.into(), number, settled, batch.request.n_outputs];
    out.numbers(tag::STANDING, &standing);
    out.numbers(tag::TERMS, &numbers_of(batch.terms));
    out.field(tag::REASON, reason.as_bytes());
    out.field(tag::TEXT, &batch.request.text);
    out.closed()
}

/// Encodes an item.
pub(super) fn encode_item(batch: &JobKey, at: u32, item: &BatchItem) -> Vec<u8> {
    let mut out = RecordWriter::new(ITEM_MAGIC, BATCH_VERSION, 256);
    out.field(tag::BATCH, &batch.to_bytes());
    let (number, reason) = item.ending.as_ref().map_or((0, ""), |ending| numbered(&ending.state));
    out.numbers(tag::STANDING, &[at.into(), number, item.is_hit.into()]);
    out.field(tag::REASON, reason.as_bytes());
    out.hashes(tag::JOB, &item.job);
    for (product, made) in item.ending.iter().flat_map(|ending| &ending.outputs) {
        output(&mut out, product, made.as_ref());
    }
    out.closed()
}

/// Returns whether a stored record is the record of a batch or of an item.
pub(super) fn is_of_batch(record: &[u8]) -> bool {
    record.starts_with(&BATCH_MAGIC) || record.starts_with(&ITEM_MAGIC)
}

/// Decodes a record; returns `None` if it is damaged, of another version, or names an unknown format.
pub(super) fn decode(bytes: &[u8]) -> Option<DecodedRow> {
    if bytes.starts_with(&ITEM_MAGIC) {
        return decode_item(bytes);
    }
    let mut fields = Fields::of(bytes, BATCH_MAGIC, BATCH_VERSION)?;
    let batch = JobKey::from_bytes(fields.take(tag::BATCH)?)?;
    let [number, attempts, standing, settled, n_outputs] = fields.numbers(tag::STANDING)?.try_into().ok()?;
    let terms = terms(&fields.numbers(tag::TERMS)?)?;
    let state = state_of(standing, fields.text(tag::REASON)?)?;
    let text = Bytes::copy_from_slice(fields.take(tag::TEXT)?);
    let (number, attempts, settled_s) = (counted(number)?, u32::try_from(attempts).ok()?, given(settled));
    Some(DecodedRow::Batch(Box::new(KeptBatch { batch, number, attempts, terms, state, settled_s, n_outputs, text })))
}

fn decode_item(bytes: &[u8]) -> Option<DecodedRow> {
    let mut fields = Fields::of(bytes, ITEM_MAGIC, BATCH_VERSION)?;
    let batch = JobKey::from_bytes(fields.take(tag::BATCH)?)?;
    let [at, number, is_hit] = fields.numbers(tag::STANDING)?.try_into().ok()?;
    let state = state_of(number, fields.text(tag::REASON)?)?;
    let job = fields.hashes(tag::JOB)?.first().copied();
    let (products, made) = outputs(&mut fields)?;
    let outputs = products.into_iter().zip(made).collect();
    let ending = (state != JobState::Active).then(|| Arc::new(Ending { state, outputs }));
    Some(DecodedRow::Item {
        batch,
        at: usize::try_from(at).ok()?,
        item: BatchItem { job, is_hit: is_hit == 1, ending },
    })
}
